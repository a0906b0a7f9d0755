// Polygons in which decisions about sides and directions are hard. They have almost straight
// vertices, vertices that almost coincide, and structure that repeats (steps, teeth and notches of
// one size), all of it next to reflex vertices, in many sizes and turns.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/random_simple.hpp"

namespace apothem::samples {

/// Steps of the same width and height, with the corner below them at the origin.
inline Polygon stairs(int steps, double width, double height) {
  std::vector<Vec2> ring{{0, 0}, {steps * width, 0}};
  for (int i = steps; i > 0; --i) {
    const double y = (steps - i + 1) * height;
    ring.emplace_back(i * width, y);
    ring.emplace_back((i - 1) * width, y);
  }
  return Polygon(ring);
}

/// Bar of height 1 with notches of width 1 at equal distances, rectangular or with the shape of
/// wedges.
inline Polygon notched_bar(int notches, double depth, bool wedges) {
  std::vector<Vec2> ring{{0, 0}, {3.0 * notches, 0}, {3.0 * notches, 1}};
  for (int i = notches - 1; i >= 0; --i) {
    const double x = 3.0 * i + 1;
    ring.emplace_back(x + 1, 1);
    if (wedges) {
      ring.emplace_back(x + .5, 1 - depth);
    } else {
      ring.emplace_back(x + 1, 1 - depth);
      ring.emplace_back(x, 1 - depth);
    }
    ring.emplace_back(x, 1);
  }
  ring.emplace_back(0, 1);
  return Polygon(ring);
}

namespace detail {

using Ring = std::vector<Vec2>;

// 10^-u with u uniform between `low` and `high`.
inline double power(Random& random, double low, double high) {
  return std::pow(10, -random.uniform(low, high));
}

// Half of them have vertices on a lattice, where many distances and directions are equal.
inline Ring outline(Random& random) {
  switch (random.integer(0, 8)) {
    case 0:
      return cross_of_squares(.5 * random.integer(1, 4)).vertices();
    case 1: {
      const int teeth = random.integer(2, 4);
      return comb(teeth, random.integer(1, 3)).vertices();
    }
    case 2: {
      const int steps = random.integer(2, 5);
      const double width = .5 * random.integer(1, 3);
      return stairs(steps, width, .5 * random.integer(1, 3)).vertices();
    }
    case 3: {
      const int notches = random.integer(1, 4);
      const double depth = .25 * random.integer(1, 3);
      return notched_bar(notches, depth, random.integer(0, 1) == 1).vertices();
    }
    case 4:
      return l_shape(1 + .5 * random.integer(1, 3)).vertices();
    case 5: {
      const int tips = random.integer(3, 7);
      return star(tips, random.uniform(.3, .8)).vertices();
    }
    case 6:
      return random_simple(random, random.integer(5, 12)).vertices();
    case 7:
      return random_star_shaped(random, random.integer(5, 12), .3).vertices();
    default:
      return random_convex(random, random.integer(3, 6)).vertices();
  }
}

// Where on an edge, from 0 to 1: near an end, at equal distances, or anywhere.
inline std::vector<double> places(Random& random) {
  const int count = random.integer(1, 4);
  std::vector<double> shares;
  for (int k = 0; k < count; ++k) {
    switch (random.integer(0, 3)) {
      case 0:
        shares.push_back(power(random, 2, 15));
        break;
      case 1:
        shares.push_back(1 - power(random, 2, 15));
        break;
      case 2:
        shares.push_back((k + 1.0) / (count + 1));
        break;
      default:
        shares.push_back(random.uniform(0, 1));
    }
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

// By how much a vertex is off the straight line: not at all, by round-off, or by more.
inline double offset(Random& random, double most) {
  const int kind = random.integer(0, 3);
  if (kind == 0) return 0;
  const double least = -std::log10(most);
  const double much = kind == 1 ? power(random, 14, 17) : power(random, least, 16);
  return random.integer(0, 1) == 0 ? much : -much;
}

// The nearest point in one of eight directions.
inline Vec2 one_unit_off(Random& random, const Vec2& p) {
  const int direction = random.integer(0, 7);
  const auto step = [](double x, int sign) {
    return sign == 0 ? x : std::nextafter(x, sign * HUGE_VAL);
  };
  const int k = direction < 4 ? direction : direction + 1;  // 0 to 8 without 4
  return {step(p.x(), k / 3 - 1), step(p.y(), k % 3 - 1)};
}

inline Ring with_needless_vertices(Random& random, const Ring& ring, double most) {
  const double size = box_of(ring).extent();
  const double least = -std::log10(most);
  const double share = random.uniform(0, .8);
  Ring result;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2& p = ring[i];
    const Vec2 edge = after(ring, i) - p;
    const Vec2 normal = Vec2(-edge.y(), edge.x()).normalized();
    result.push_back(p);
    if (random.uniform(0, 1) < share / 2) {  // one or two that almost coincide with p
      for (int more = random.integer(0, 3) == 0 ? 2 : 1; more > 0; --more) {
        if (random.integer(0, 2) == 0) {
          result.push_back(one_unit_off(random, result.back()));
          continue;
        }
        const double far = size * power(random, least, 16);
        const double turn =
            random.integer(0, 1) == 0 ? random.integer(0, 7) * M_PI / 4 : random.uniform(0, 6.3);
        result.push_back(result.back() + far * Vec2(std::cos(turn), std::sin(turn)));
      }
    }
    if (random.uniform(0, 1) >= share) continue;
    for (const double s : places(random)) {
      result.push_back(p + s * edge + size * offset(random, most) * normal);
    }
  }
  result.erase(std::unique(result.begin(), result.end()), result.end());
  while (result.size() > 1 && result.back() == result.front()) result.pop_back();
  return result;
}

// Turned, scaled and shifted in one of several ways each.
inline Ring posed(Random& random, Ring ring) {
  const double turn = random.integer(0, 1) == 0   ? 0
                      : random.integer(0, 1) == 0 ? random.integer(1, 7) * M_PI / 4
                                                  : random.uniform(0, 6.3);
  const int kind = random.integer(0, 3);
  const double scale = kind == 0   ? .1 * random.integer(1, 30)
                       : kind == 1 ? random.uniform(.1, 300)
                                   : 1.0;
  Vec2 shift = Vec2::Zero();
  if (random.integer(0, 1) == 0) {
    shift.x() = scale * random.uniform(-10, 10);
    shift.y() = scale * random.uniform(-10, 10);
  }
  for (Vec2& v : ring) v = scale * (turn == 0 ? v : turned(v, turn)) + shift;
  return ring;
}

}  // namespace detail

/// A polygon, and the same with vertices that it does not need.
struct NearDegenerate {
  Polygon plain;    ///< without the needless vertices
  Polygon polygon;  ///< with them
};

namespace detail {

// Scales a polygon and brings `from`, one of its points after scaling, to `to`.
inline NearDegenerate moved(const NearDegenerate& shape, double scale, const Vec2& from,
                            const Vec2& to) {
  const auto move = [&](const Vec2& v) -> Vec2 { return scale * v - from + to; };
  return {mapped(shape.plain, move), mapped(shape.polygon, move)};
}

}  // namespace detail

/// A random outline, turned, scaled and shifted. No point of the boundary of `polygon` is farther
/// from that of `plain` than about `most` times the size, m/m.
inline NearDegenerate near_degenerate(Random& random, double most) {
  while (true) {
    const detail::Ring plain = detail::posed(random, detail::outline(random));
    try {
      return {Polygon(plain), Polygon(detail::with_needless_vertices(random, plain, most))};
    } catch (const InvalidPolygon&) {
      // The needless vertices have made the outline cross itself: try the next one.
    }
  }
}

/// Two of them, or one in a large square, or one on itself, with an exact or random contact.
struct NearDegeneratePair {
  NearDegenerate a, b;
};
inline NearDegeneratePair near_degenerate_pair(Random& random, double most) {
  while (true) {
    const NearDegenerate a = near_degenerate(random, most);
    const Box box = bounding_box(a.plain);
    const double size = box.extent();
    const int kind = random.integer(0, 5);
    if (kind == 0) {  // all of it in a square
      const Polygon square = block(box.x0 - size, box.y0 - size, box.x1 + size, box.y1 + size);
      return {{square, square}, a};
    }
    if (kind == 1) return {a, a};
    const NearDegenerate b = kind == 2 ? a : near_degenerate(random, most);
    const double scale =
        kind == 2 ? 1.0 : size / bounding_box(b.plain).extent() * random.uniform(.5, 1);
    const Vec2 from = scale * b.plain[random.integer(0, b.plain.size() - 1)];
    const int edge = random.integer(0, a.plain.size() - 1);
    Vec2 to = a.plain[edge];  // a vertex on a vertex, on an edge, or somewhere
    const int place = random.integer(0, 2);
    if (place == 1) to += random.uniform(0, 1) * (a.plain.after(edge) - to);
    if (place == 2) {
      to.x() = (box.x0 + box.x1) / 2 + .3 * size * random.uniform(-1, 1);
      to.y() = (box.y0 + box.y1) / 2 + .3 * size * random.uniform(-1, 1);
    }
    try {
      return {a, detail::moved(b, scale, from, to)};
    } catch (const InvalidPolygon&) {
      // Two of its vertices have become one: try the next pair.
    }
  }
}

}  // namespace apothem::samples
