#include <algorithm>
#include <cmath>

#include "apothem/contact/contacts.hpp"
#include "apothem/geometry/polygon/predicates.hpp"

namespace apothem {
namespace {

// The closed lines around a body, with the inside on their left.
struct Lines {
  std::vector<std::vector<Vec2>> loops;
  double reach;  // of its potentials, m
  Box box;
};

double distance(const Lines& lines, const Vec2& p) {
  double least = HUGE_VAL;
  for (const std::vector<Vec2>& ring : lines.loops) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 edge = ring[(i + 1) % ring.size()] - ring[i];
      const double along = std::clamp((p - ring[i]).dot(edge) / edge.squaredNorm(), 0., 1.);
      least = std::min(least, (ring[i] + along * edge - p).norm());
    }
  }
  return least;
}

std::optional<Vec2> buried(const Lines& a, const Lines& b) {
  for (const std::vector<Vec2>& ring : a.loops) {
    for (const Vec2& p : ring) {
      if (apart({p.x(), p.y(), p.x(), p.y()}, b.box)) continue;
      bool inside = false;
      for (const std::vector<Vec2>& other : b.loops) inside ^= strictly_inside(other, p);
      if (inside && distance(b, p) > b.reach) return p;
    }
  }
  return {};
}

std::vector<Lines> lines_of(const Outlines& o) {
  std::vector<Lines> result;
  for (const Outlines::Body& body : o.bodies) {
    Lines lines{{}, 0, {}};
    for (int i = body.first; i < body.end;) {
      std::vector<Vec2>& ring = lines.loops.emplace_back();
      const int first = i;
      do {
        ring.push_back(o.point(i));
        lines.box.include(o.x[i], o.y[i]);
        lines.reach = std::max(lines.reach, o.cap[i]);
        ++i;
      } while (o.next[i - 1] != first);
    }
    result.push_back(std::move(lines));
  }
  return result;
}

}  // namespace

std::optional<Buried> find_buried(const Outlines& outlines) {
  const std::vector<Lines> lines = lines_of(outlines);
  std::vector<Box> boxes;
  for (const Lines& l : lines) boxes.push_back(l.box);
  std::vector<BoxPair> pairs;
  BoxGrid().find_pairs(boxes, pairs);
  for (const auto& [a, b] : pairs) {
    if (outlines.bodies[a].is_rigid() && outlines.bodies[b].is_rigid()) continue;
    if (const auto place = buried(lines[a], lines[b])) return Buried{a, b, *place};
    if (const auto place = buried(lines[b], lines[a])) return Buried{b, a, *place};
  }
  return {};
}

}  // namespace apothem
