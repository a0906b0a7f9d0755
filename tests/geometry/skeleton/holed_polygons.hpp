// Random polygons with holes: in general position, and of whole numbers with many coinciding
// events.
#pragma once

#include "tests/geometry/skeleton/tied_rings.hpp"
#include "tests/random_simple.hpp"

namespace apothem::test {

/// Adds up to `count` holes, which `draw` proposes, and at least one to a ring. Those that touch
/// another ring are left out.
template <class Draw>
Polygon with_holes(const TiedRing& outer, int count, const Draw& draw) {
  Rings holes;
  for (int tries = 0;
       static_cast<int>(holes.size()) < count && (tries < 40 * count || holes.empty()); ++tries) {
    holes.push_back(draw());
    try {
      const Polygon polygon(outer, holes);
    } catch (const InvalidPolygon&) {
      holes.pop_back();
    }
  }
  return {outer, holes};
}

/// A star-shaped outline or one without any order, and up to `count` star-shaped holes.
inline Polygon random_drilled(Random& random, int count) {
  const Polygon outer =
      random.integer(0, 2)
          ? samples::random_star_shaped(random, random.integer(3, 40), random.uniform(.4, 1))
          : samples::random_simple(random, random.integer(4, 30));
  const Box box = bounding_box(outer);
  return with_holes(outer.vertices(), count, [&] {
    const double size = box.extent() * random.uniform(.01, .6) / std::sqrt(count + 1.);
    const Vec2 centre(random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1));
    TiedRing hole =
        samples::random_star_shaped(random, random.integer(3, 20), random.uniform(.3, 1))
            .vertices();
    for (Vec2& v : hole) v = centre + size * v;
    return hole;
  });
}

/// The outlines of a union of cells of a grid, with the straight vertices: the outer ring first.
/// Empty if they touch themselves or each other.
inline Rings outlines_of_cells(const std::set<std::array<int, 2>>& cells) {
  std::map<std::array<int, 2>, std::array<int, 2>> sides;  // from start to end, cells on the left
  bool simple = true;
  const auto add = [&](std::array<int, 2> from, std::array<int, 2> to) {
    simple = sides.emplace(from, to).second && simple;
  };
  for (const auto& [x, y] : cells) {
    if (!cells.count({x, y - 1})) add({x, y}, {x + 1, y});
    if (!cells.count({x + 1, y})) add({x + 1, y}, {x + 1, y + 1});
    if (!cells.count({x, y + 1})) add({x + 1, y + 1}, {x, y + 1});
    if (!cells.count({x - 1, y})) add({x, y + 1}, {x, y});
  }
  if (!simple) return {};
  Rings rings;  // the first side is the lower one of the leftmost cell
  while (!sides.empty()) {
    rings.emplace_back();
    for (auto at = sides.begin(); at != sides.end();) {
      rings.back().emplace_back(at->first[0], at->first[1]);
      const std::array<int, 2> end = at->second;
      sides.erase(at);
      at = sides.find(end);
    }
  }
  return rings;
}

/// A block of cells, up to `most` in each direction, with `holes` holes or more, and with other
/// cells taken out of it where that makes no rings touch.
inline Rings random_cells_with_holes(Random& random, int most, int holes) {
  const int width = random.integer(2 * holes + 1, most), height = random.integer(3, most);
  std::set<std::array<int, 2>> cells;
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y) cells.insert({x, y});
  }
  for (int k = 0; k < holes; ++k) cells.erase({2 * k + 1, random.integer(1, height - 2)});
  Rings rings = outlines_of_cells(cells);
  for (int i = random.integer(0, 8); i > 0; --i) {
    std::set<std::array<int, 2>> fewer = cells;
    std::array<int, 2> cell{random.integer(0, width - 1), random.integer(0, height - 1)};
    for (int length = random.integer(1, 4); length > 0; --length) {
      fewer.erase(cell);
      cell[random.integer(0, 1)] += random.integer(0, 1) ? 1 : -1;
    }
    Rings others = outlines_of_cells(fewer);
    // A second piece would be another counter-clockwise ring.
    if (static_cast<int>(others.size()) > holes &&
        std::all_of(others.begin() + 1, others.end(),
                    [](const TiedRing& ring) { return ring_area(ring) < 0; })) {
      cells = fewer;
      rings = std::move(others);
    }
  }
  return rings;
}

inline Polygon polygon_of(const Rings& rings) { return Polygon(polygon_of_rings(rings)); }

/// Cells with cut corners, sometimes with straight vertices: all normals are rational.
inline Polygon random_rational_with_holes(Random& random) {
  Rings rings = random_cells_with_holes(random, 5, random.integer(1, 2));
  const bool straight = random.integer(0, 3) == 0;
  const double share = random.uniform(0, 1);
  for (TiedRing& ring : rings) {
    if (!straight) ring = without_straight(ring);
    for (Vec2& v : ring) v *= 12;
    if (!straight) ring = with_cut_corners(ring, random, share);
  }
  return polygon_of(rings);
}

inline TiedRing rectangle(int x, int y, int width, int height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

/// A gear with a bore: a rectangle, an octagon or another gear, sometimes beside the middle, and
/// sometimes with four equal holes around it.
inline Polygon random_gear_with_bore(Random& random) {
  const TiedRing outer = random_gear(random);
  const int shift = random.integer(0, 1) * random.integer(-3, 3), half = random.integer(1, 6);
  TiedRing bore;
  switch (random.integer(0, 2)) {
    case 0:
      bore = rectangle(shift - half, -half, 2 * half, 2 * half);
      break;
    case 1:
      for (const Vec2& v : {Vec2(2 * half, half), Vec2(half, 2 * half)}) {
        bore.insert(bore.end(), {v, Vec2(-v.y(), v.x()), Vec2(-v), Vec2(v.y(), -v.x())});
      }
      std::sort(bore.begin(), bore.end(), [](const Vec2& p, const Vec2& q) {
        return std::atan2(p.y(), p.x()) < std::atan2(q.y(), q.x());
      });
      for (Vec2& v : bore) v.x() += shift;
      break;
    default:
      bore = random_gear(random);
      for (Vec2& v : bore) v /= 8;
  }
  Rings holes{bore};
  if (random.integer(0, 1)) {
    const int out = random.integer(10, 18);
    for (const Vec2& v : {Vec2(out, 0), Vec2(0, out), Vec2(-out, 0), Vec2(0, -out)}) {
      holes.push_back(rectangle(static_cast<int>(v.x()) - 1, static_cast<int>(v.y()) - 1, 2, 2));
    }
  }
  return {outer, holes};
}

/// A plate with a grid of equal slots, upright, lying or pointed, and some of them missing.
inline Polygon random_perforated(Random& random) {
  const int columns = random.integer(1, 5), rows = random.integer(1, 4);
  const int width = 2 * random.integer(1, 6), height = 2 * random.integer(1, 6);
  const int web = 2 * random.integer(1, 6), kind = random.integer(0, 2);
  const int x = columns * (width + web) + web, y = rows * (height + web) + web;
  Rings holes;
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) {
      if (columns * rows > 2 && random.integer(0, 5) == 0) continue;
      const int left = web + c * (width + web), low = web + r * (height + web);
      TiedRing hole = rectangle(left, low, width, height);
      if (kind == 1) {
        hole = {{left + width / 2, low},
                {left + width, low + height / 2},
                {left + width / 2, low + height},
                {left, low + height / 2}};
      } else if (kind == 2) {
        hole.insert(hole.begin() + 2, Vec2(left + width + web / 2 - 1, low + height / 2));
      }
      holes.push_back(hole);
    }
  }
  if (holes.empty()) holes.push_back(rectangle(web, web, width, height));
  return {rectangle(0, 0, x, y), holes};
}

/// A letter with holes, of bars of whole widths: O, B or 8, A, D, or a frame with another width on
/// each side.
inline Polygon random_holed_letter(Random& random) {
  const int w = random.integer(1, 8), h = random.integer(1, 8), a = random.integer(1, 12),
            b = random.integer(1, 12);
  const int x = 2 * w + a, y = 3 * h + 2 * b;
  switch (random.integer(0, 4)) {
    case 0:  // O
      return {rectangle(0, 0, x, 2 * h + b), {rectangle(w, h, a, b)}};
    case 1:  // 8
      return {rectangle(0, 0, x, y), {rectangle(w, h, a, b), rectangle(w, 2 * h + b, a, b)}};
    case 2:  // A
      return {{{0, 0},
               {w, 0},
               {w, b},
               {w + a, b},
               {w + a, 0},
               {x, 0},
               {x, 2 * b + h},
               {x - w, 2 * b + 2 * h},
               {w, 2 * b + 2 * h},
               {0, 2 * b + h}},
              {rectangle(w, b + h, a, b)}};
    case 3:  // D
      return {{{0, 0}, {x, 0}, {x + h, h}, {x + h, h + b}, {x, 2 * h + b}, {0, 2 * h + b}},
              {rectangle(w, h, a, b)}};
    default:
      return {rectangle(0, 0, x + random.integer(0, 4), y),
              {rectangle(w, random.integer(1, h), a, b)}};
  }
}

/// A polygon with holes of one of these kinds.
inline Polygon random_tied_with_holes(Random& random, int kind) {
  while (true) {
    try {
      switch (kind % 5) {
        case 0: {
          Rings rings = random_cells_with_holes(random, 8, random.integer(1, 3));
          if (random.integer(0, 1)) {
            for (TiedRing& ring : rings) ring = without_straight(ring);
          }
          return polygon_of(rings);
        }
        case 1:
          return random_gear_with_bore(random);
        case 2:
          return random_perforated(random);
        case 3:
          return random_holed_letter(random);
        default:
          return random_rational_with_holes(random);
      }
    } catch (const InvalidPolygon&) {  // rings that touch: another one
    }
  }
}

/// A ring between two regular n-gons of the circumradii 1 and `inner`, turned by an angle.
inline Polygon annulus(int n, double inner, double angle = 0) {
  Rings rings(2);
  for (int i = 0; i < n; ++i) {
    const Vec2 v = samples::turned(Vec2(1, 0), angle + 2 * M_PI * i / n);
    rings[0].push_back(v);
    rings[1].push_back(inner * v);
  }
  return polygon_of(rings);
}

}  // namespace apothem::test
