// Random rings of whole numbers in which many events of the front coincide, and maps that must not
// change what follows from a ring.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "geometry/skeleton/skeleton.hpp"
#include "tests/support.hpp"

namespace apothem::test {

using TiedRing = std::vector<Vec2>;
using samples::Random;

/// Leaves out vertices on straight lines.
inline TiedRing without_straight(const TiedRing& ring) {
  TiedRing result;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 in = ring[i] - ring[(i + ring.size() - 1) % ring.size()];
    const Vec2 out = ring[(i + 1) % ring.size()] - ring[i];
    if (apothem::cross(in, out) != 0) result.push_back(ring[i]);
  }
  return result;
}

/// The outline of a union of cells of a grid, with the straight vertices; empty if it has holes or
/// touches itself.
inline TiedRing outline_of_cells(const std::set<std::array<int, 2>>& cells) {
  std::map<std::array<int, 2>, std::array<int, 2>> sides;  // from start to end, cells on the left
  const auto add = [&](std::array<int, 2> from, std::array<int, 2> to) {
    return sides.emplace(from, to).second;
  };
  bool simple = true;
  for (const auto& [x, y] : cells) {
    if (!cells.count({x, y - 1})) simple = add({x, y}, {x + 1, y}) && simple;
    if (!cells.count({x + 1, y})) simple = add({x + 1, y}, {x + 1, y + 1}) && simple;
    if (!cells.count({x, y + 1})) simple = add({x + 1, y + 1}, {x, y + 1}) && simple;
    if (!cells.count({x - 1, y})) simple = add({x, y + 1}, {x, y}) && simple;
  }
  TiedRing ring;
  std::array<int, 2> at = sides.begin()->first;
  do {
    ring.emplace_back(at[0], at[1]);
    at = sides[at];
  } while (at != sides.begin()->first && ring.size() <= sides.size());
  return simple && ring.size() == sides.size() ? ring : TiedRing{};
}

/// A union of cells that has grown from one.
inline TiedRing random_cells(Random& random, int count) {
  while (true) {
    std::set<std::array<int, 2>> cells{{0, 0}};
    while (static_cast<int>(cells.size()) < count) {
      auto cell = *std::next(cells.begin(), random.integer(0, static_cast<int>(cells.size()) - 1));
      cell[random.integer(0, 1)] += random.integer(0, 1) ? 1 : -1;
      cells.insert(cell);
    }
    const TiedRing ring = outline_of_cells(cells);
    if (!ring.empty()) return ring;
  }
}

/// Cuts corners by hypotenuses of triangles with the legs 3 and 4, so that all normals remain
/// rational. The ring has sides of 12 and more.
inline TiedRing with_cut_corners(const TiedRing& ring, Random& random, double share) {
  TiedRing result;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Vec2 in = (ring[i] - ring[(i + ring.size() - 1) % ring.size()]).normalized();
    const Vec2 out = (ring[(i + 1) % ring.size()] - ring[i]).normalized();
    if (random.uniform(0, 1) > share) {
      result.push_back(ring[i]);
      continue;
    }
    const int leg = random.integer(3, 4);
    result.emplace_back(ring[i] - leg * in);
    result.emplace_back(ring[i] + (7 - leg) * out);
  }
  return result;
}

/// Cells with cut corners, sometimes with straight vertices.
inline TiedRing random_rational(Random& random, int cells) {
  TiedRing ring = random_cells(random, cells);
  const bool straight = random.integer(0, 3) == 0;
  if (!straight) ring = without_straight(ring);
  for (Vec2& v : ring) v *= 12;
  return straight ? ring : with_cut_corners(ring, random, random.uniform(0, 1));
}

/// A gear, symmetric to both axes and the diagonals: each eighth has the same whole corners.
inline TiedRing random_gear(Random& random) {
  const int root = random.integer(20, 60), tip = root + random.integer(5, 40);
  const int half = random.integer(2, root / 3), top = random.integer(1, half);
  const int fillet = random.integer(0, 5);
  TiedRing ring;
  for (int q = 0; q < 4; ++q) {
    TiedRing tooth{{root, -half}, {tip, -top}, {tip, top}, {root, half}};
    const int bay = random.integer(0, 0) + root - fillet;
    if (bay > half) tooth.emplace_back(bay, bay);
    for (const Vec2& v : tooth) {
      const std::array<Vec2, 4> turns{v, Vec2(-v.y(), v.x()), Vec2(-v), Vec2(v.y(), -v.x())};
      ring.push_back(turns[q]);
    }
  }
  return ring;
}

/// A plate with slots from above whose ends are pointed, blunt or square.
inline TiedRing random_slots(Random& random) {
  const int slots = random.integer(1, 6), width = 2 * random.integer(1, 12);
  const int pitch = width + 2 * random.integer(1, 15), height = random.integer(20, 120);
  TiedRing ring{{0, 0}, {slots * pitch + pitch, 0}, {slots * pitch + pitch, height}};
  for (int s = slots; s > 0; --s) {
    const int x = s * pitch;
    const int depth = random.integer(0, 2) ? height / 2 : random.integer(2, height - 2);
    const int floor = height - depth;
    ring.emplace_back(x, height);
    const int end = random.integer(0, 2);
    if (end == 0) {
      ring.insert(ring.end(), {Vec2(x, floor), Vec2(x - width, floor)});
    } else if (end == 1) {
      ring.insert(ring.end(), {Vec2(x, floor), Vec2(x - width / 2, floor - std::min(floor - 1, 3)),
                               Vec2(x - width, floor)});
    } else {
      const int cut = random.integer(1, std::max(1, width / 2 - 1)), low = std::max(1, floor - 2);
      ring.insert(ring.end(), {Vec2(x, floor), Vec2(x - cut, low)});
      if (x - cut != x - width + cut) ring.emplace_back(x - width + cut, low);
      ring.emplace_back(x - width, floor);
    }
    ring.emplace_back(x - width, height);
  }
  ring.emplace_back(0, height);
  return ring;
}

/// A letter of bars of whole widths.
inline TiedRing random_letter(Random& random) {
  const int w = random.integer(2, 12), h = random.integer(2, 12), a = random.integer(1, 12),
            b = random.integer(1, 12);
  const int x = 2 * w + a, y = 3 * h + 2 * b;
  switch (random.integer(0, 5)) {
    case 0:  // E
      return {{0, 0},
              {x, 0},
              {x, h},
              {w, h},
              {w, h + b},
              {x, h + b},
              {x, 2 * h + b},
              {w, 2 * h + b},
              {w, 2 * h + 2 * b},
              {x, 2 * h + 2 * b},
              {x, y},
              {0, y}};
    case 1:  // H
      return {{0, 0},         {w, 0},     {w, b},         {w + a, b},
              {w + a, 0},     {x, 0},     {x, 2 * b + h}, {w + a, 2 * b + h},
              {w + a, b + h}, {w, b + h}, {w, 2 * b + h}, {0, 2 * b + h}};
    case 2:  // T
      return {{a, 0},         {a + w, 0}, {a + w, y - h}, {2 * a + w, y - h},
              {2 * a + w, y}, {0, y},     {0, y - h},     {a, y - h}};
    case 3:  // U, with cut corners outside
      return {{w, 0},         {x - w, 0}, {x, h}, {x, y}, {x - w, y},
              {x - w, h + 1}, {w, h + 1}, {w, y}, {0, y}, {0, h}};
    case 4:  // X
      return {{0, 0},
              {w, 0},
              {w + a, b},
              {w + 2 * a, 0},
              {2 * w + 2 * a, 0},
              {w + a + w, b + h},
              {2 * w + 2 * a, 2 * (b + h)},
              {w + 2 * a, 2 * (b + h)},
              {w + a, b + 2 * h},
              {w, 2 * (b + h)},
              {0, 2 * (b + h)},
              {a, b + h}};
    default:  // Z
      return {{0, 0}, {x, 0}, {x, h},     {w, h},         {x, y - h},
              {x, y}, {0, y}, {0, y - h}, {x - w, y - h}, {0, h}};
  }
}

/// Half an outline with rounded coordinates of arcs, and its mirror image, like parts of clothes
/// and shoes.
inline TiedRing random_part(Random& random) {
  const int steps = random.integer(3, 25), size = random.integer(50, 3000);
  const double deep = random.uniform(.1, .8), waves = random.integer(1, 4);
  TiedRing right, ring;
  for (int i = 0; i <= steps; ++i) {
    const double angle = M_PI * (i + .5) / (steps + 1);
    const double r = size * (1 + deep * std::cos(2 * waves * angle)) / 2;
    right.emplace_back(std::round(r * std::sin(angle)) + 5, std::round(-2 * r * std::cos(angle)));
  }
  ring = right;
  for (auto v = right.rbegin(); v != right.rend(); ++v) ring.emplace_back(-v->x(), v->y());
  return ring;
}

/// A polygon of one of these kinds.
inline Polygon random_tied(Random& random, int kind) {
  while (true) {
    try {
      switch (kind % 6) {
        case 0: {
          const TiedRing ring = random_cells(random, random.integer(3, 40));
          return Polygon(random.integer(0, 1) ? ring : without_straight(ring));
        }
        case 1:
          return Polygon(random_gear(random));
        case 2:
          return Polygon(random_slots(random));
        case 3:
          return Polygon(random_letter(random));
        case 4:
          return Polygon(random_part(random));
        default:
          return Polygon(random_rational(random, random.integer(3, 20)));
      }
    } catch (const InvalidPolygon&) {  // crosses itself: another one
    }
  }
}

/// A map of the plane, and of the numbering, that must not matter.
struct Map {
  std::string name;
  int start = 0;           // of each ring in thirds of its vertices, and the first of the holes
  bool backwards = false;  // sense of the rings
  bool mirrored = false;   // x changes its sign, after the turn
  int quarters = 0;        // counter-clockwise
  double scale = 1;

  [[nodiscard]] Vec2 operator()(Vec2 v) const {
    for (int q = 0; q < quarters; ++q) v = Vec2(-v.y(), v.x());
    if (mirrored) v.x() = -v.x();
    return scale * v;
  }
  [[nodiscard]] Vec2 undo(Vec2 v) const {
    v /= scale;
    if (mirrored) v.x() = -v.x();
    for (int q = 0; q < quarters; ++q) v = Vec2(v.y(), -v.x());
    return v + Vec2(0, 0);  // no zero has a sign
  }
  [[nodiscard]] Polygon operator()(const Polygon& polygon) const {
    Rings rings = rings_of(polygon);
    for (TiedRing& ring : rings) {
      std::rotate(ring.begin(), ring.begin() + start * static_cast<int>(ring.size()) / 3,
                  ring.end());
      if (backwards) std::reverse(ring.begin(), ring.end());
      for (Vec2& v : ring) v = (*this)(v);
    }
    std::rotate(rings.begin() + 1, rings.begin() + 1 + start * (polygon.rings() - 1) / 3,
                rings.end());
    return Polygon(polygon_of_rings(rings));
  }
};

inline const std::vector<Map>& maps() {
  static const std::vector<Map> all{
      {.name = "start", .start = 1},
      {.name = "sense", .backwards = true},
      {.name = "mirror", .mirrored = true},
      {.name = "quarter turn", .quarters = 1},
      {.name = "power of two", .scale = 0x1p-7},
      {.name = "all", .start = 2, .backwards = true, .mirrored = true, .quarters = 3, .scale = 8}};
  return all;
}

}  // namespace apothem::test
