#include "geometry/integrals/overlap_energy.hpp"

#include <algorithm>

#include "geometry/integrals/placement.hpp"

namespace apothem {
namespace {

// Rings with more vertices are cut to the common box first.
constexpr int kFewVertices = 8;
// The common box is larger by this part of its size, so that its sides are not part of the overlap.
constexpr double kSlack = 1e-6;

// True if a line is positive in all of a box.
bool positive_in(const Box& box, const lower_envelope::Line<double>& line) {
  const Vec2 lowest(line.gradient.x() > 0 ? box.x0 : box.x1,
                    line.gradient.y() > 0 ? box.y0 : box.y1);
  return line(lowest) > 0;
}

}  // namespace

void OverlapEnergy::clip_overlap(const Line& side) {
  lower_envelope::clip_into(overlap_, side, true, part_);
  overlap_.swap(part_);
}

void OverlapEnergy::intersect(const PlacedPotential& a, const PlacedPotential& b,
                              const Vec2& offset) {
  overlap_.clear();
  const Box of_a = box_of(a, offset), of_b = box_of(b, Vec2::Zero());
  if (apart(of_a, of_b)) return;
  const Box common = Box{std::max(of_a.x0, of_b.x0), std::max(of_a.y0, of_b.y0),
                         std::min(of_a.x1, of_b.x1), std::min(of_a.y1, of_b.y1)}
                         .grown(kSlack * std::max(of_a.extent(), of_b.extent()));
  for (int v = 0; v < b.size; ++v) overlap_.emplace_back(b.x[v], b.y[v]);
  if (b.size > kFewVertices) {
    clip_overlap({Vec2(1, 0), -common.x0});
    clip_overlap({Vec2(-1, 0), common.x1});
    clip_overlap({Vec2(0, 1), -common.y0});
    clip_overlap({Vec2(0, -1), common.y1});
  }
  for (int e = 0; e < a.size && !overlap_.empty(); ++e) {
    const Vec2 gradient(a.gx[e], a.gy[e]);
    const Line line{gradient, -gradient.dot(Vec2(a.x[e], a.y[e]) + offset)};
    if (!positive_in(common, line)) clip_overlap(line);
  }
}

double OverlapEnergy::volume_under(const PlacedPotential& p, const Vec2& shift,
                                   const std::vector<Vec2>& ring) {
  if (ring.size() < 3) return 0;
  // Coordinates begin at a vertex of the ring, so that they are as small as the ring.
  const Vec2& origin = ring.front();
  ring_.clear();
  Vec2 middle = Vec2::Zero();
  for (const Vec2& v : ring) {
    ring_.push_back(v - origin);
    middle += ring_.back();
  }
  middle /= static_cast<double>(ring.size());
  lines_.clear();
  for (int e = 0; e < p.size; ++e) {
    const Vec2 gradient(p.gx[e], p.gy[e]);
    lines_.push_back({gradient, gradient.dot(origin - (Vec2(p.x[e], p.y[e]) + shift))});
  }
  if (p.capped) lines_.push_back({Vec2::Zero(), 1});
  const auto best = std::ranges::min_element(
      lines_, [&](const Line& m, const Line& n) { return m(middle) < n(middle); });
  lowest_.clear();
  for (const Line& line : lines_) {
    const bool lower =
        std::ranges::any_of(ring_, [&](const Vec2& v) { return line(v) < (*best)(v); });
    if (lower || &line == &*best) lowest_.push_back(line);
  }
  return lower_envelope::volume_under(lowest_, ring_, faces_);
}

double OverlapEnergy::of_convex(const PlacedPotential& a, const PlacedPotential& b,
                                const Vec2& offset) {
  intersect(a, b, offset);
  return volume_under(a, offset, overlap_) + volume_under(b, Vec2::Zero(), overlap_);
}

}  // namespace apothem
