#include "lib/contact/mesh/common_normals.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace apothem {
namespace {

constexpr double kReach = 8;        // length of a neighbourhood, as a multiple of the depth
constexpr double kRounded = 1e-14;  // round-off error of a normal force, relative

}  // namespace

void CommonNormals::find(std::vector<SpringContact>& springs) {
  find_places(springs);
  for (size_t first = 0, end = 0; first < places_.size(); first = end) {
    const SpringPlace& place = places_[first];
    while (end < places_.size() && places_[end].loop == place.loop &&
           places_[end].other == place.other) {
      ++end;
    }
    find_neighbourhood(springs, first, end);
  }
}

void CommonNormals::find_places(const std::vector<SpringContact>& springs) {
  const OutlineSurfaces& o = outlines_;
  if (loop_of_.empty()) {
    loop_of_.resize(static_cast<size_t>(o.size()));
    arc_length_.resize(loop_of_.size());
    perimeter_.resize(o.loops.size());
    for (size_t k = 0; k < o.loops.size(); ++k) {
      const OutlineSurfaces::Loop& loop = o.loops[k];
      std::fill(loop_of_.begin() + loop.first, loop_of_.begin() + loop.end,
                static_cast<std::int32_t>(k));
    }
  }
  measured_.assign(o.loops.size(), 0);
  places_.clear();
  for (size_t i = 0; i < springs.size(); ++i) {
    const SpringContact& spring = springs[i];
    if (!(spring.normal > 0)) continue;
    const std::int32_t loop = loop_of_[spring.edge];
    if (measured_[loop] == 0) {
      double sum = 0;
      for (int v = o.loops[loop].first; v < o.loops[loop].end; ++v) {
        arc_length_[v] = sum;
        sum += o.length[v];
      }
      perimeter_[loop] = sum;
      measured_[loop] = 1;
    }
    const double on_edge = spring.place / spring.normal * o.length[spring.edge];
    places_.push_back({loop, spring.other, arc_length_[spring.edge] + on_edge,
                       static_cast<std::int32_t>(i), spring.deepest});
  }
  const auto key = [](const SpringPlace& p) {
    return std::tuple(p.loop, p.other, p.arc_length, p.spring);
  };
  // The places are usually in order already.
  if (!std::ranges::is_sorted(places_, {}, key)) std::ranges::sort(places_, {}, key);
}

// Calls f(index, weight) for the neighbours of the place i, first for those before it.
template <class F>
void CommonNormals::each_neighbour(size_t first, size_t end, size_t i, const F& f) const {
  const size_t count = end - first;
  const SpringPlace& own = places_[i];
  const double perimeter = perimeter_[own.loop];
  const auto visit = [&](size_t k, double distance) {
    const double reach = kReach * std::max(own.depth, places_[k].depth);
    const double weight = std::min(1., 2 - 2 * distance / reach);
    if (weight > 0) f(k, weight);
  };
  const double farthest = std::min(kReach * deepest_, perimeter / 2);
  for (size_t step = 1; step < count; ++step) {
    const size_t k = i >= first + step ? i - step : i + count - step;
    const double distance = own.arc_length - places_[k].arc_length + (k > i ? perimeter : 0);
    if (!(distance < farthest)) break;
    visit(k, distance);
  }
  for (size_t step = 1; step < count; ++step) {
    const size_t k = i + step < end ? i + step : i + step - count;
    const double distance = places_[k].arc_length - own.arc_length + (k < i ? perimeter : 0);
    if (!(distance <= farthest) || (distance == farthest && distance < perimeter / 2)) break;
    visit(k, distance);
  }
}

// The places from `first` to `end` belong to one closed line and one other body.
void CommonNormals::find_neighbourhood(std::vector<SpringContact>& springs, size_t first,
                                       size_t end) {
  const OutlineSurfaces& o = outlines_;
  const auto inward = [&](const SpringContact& s) { return Vec2(-o.ty[s.edge], o.tx[s.edge]); };
  const double perimeter = perimeter_[places_[first].loop];
  // A depth spreads along the line, reduced by the distance over kReach. Two rounds are needed
  // because the line is closed.
  deepest_ = places_[first].depth;
  for (size_t i = first; i < end; ++i) deepest_ = std::max(deepest_, places_[i].depth);
  const auto spread = [&](size_t from, size_t to, double distance) {
    places_[to].depth = std::max(places_[to].depth, places_[from].depth - distance / kReach);
  };
  for (int round = 0; round < 2; ++round) {
    const double seam = places_[first].arc_length + perimeter - places_[end - 1].arc_length;
    spread(end - 1, first, seam);
    for (size_t i = first + 1; i < end; ++i)
      spread(i - 1, i, places_[i].arc_length - places_[i - 1].arc_length);
    spread(first, end - 1, seam);
    for (size_t i = end - 1; i > first; --i)
      spread(i, i - 1, places_[i].arc_length - places_[i - 1].arc_length);
  }
  bool bent = false;
  for (size_t i = first; i < end; ++i) {
    SpringContact& own = springs[places_[i].spring];
    Vec2 sum = own.normal * inward(own);
    bool alone = true;
    double sizes = own.normal;
    each_neighbour(first, end, i, [&](size_t k, double weight) {
      const SpringContact& other = springs[places_[k].spring];
      sum += weight * other.normal * inward(other);
      sizes += weight * other.normal;
      alone = false;
    });
    Vec2 normal = inward(own);
    if (!alone) {
      const double size = sum.norm();
      normal = size > 0 ? Vec2(sum / size) : Vec2(Vec2::Zero());
    }
    own.nx = normal.x(), own.ny = normal.y();
    places_[i].sizes = sizes;
    own.pressed = own.normal;
    const double cancelled = alone ? 0 : own.normal - own.normal * inward(own).dot(normal);
    places_[i].cancelled = cancelled > kRounded * own.normal ? cancelled : 0;
    bent = bent || places_[i].cancelled > 0;
  }
  for (size_t i = first; bent && i < end; ++i) {
    SpringContact& own = springs[places_[i].spring];
    double lost = places_[i].cancelled / places_[i].sizes;
    each_neighbour(first, end, i, [&](size_t k, double weight) {
      lost += weight * places_[k].cancelled / places_[k].sizes;
    });
    own.pressed = own.normal * std::max(0., 1 - lost);
  }
  // The segments of the faces contribute with the cosine of their angle to the common normal. The
  // part of the normal force that cancels does not contribute.
  for (size_t i = first; i < end; ++i) {
    SpringContact& own = springs[places_[i].spring];
    const double along = own.slope_y * own.nx - own.slope_x * own.ny;
    own.resistance = own.pressed / own.normal * std::max(0., along);
    own.stiffness = own.ratio * own.resistance;
  }
  transfer_forces(springs, first, end);
}

// Where contact moves along the boundary, springs that grow take over stiffness and elastic slip
// from neighbouring springs that shrink. The remaining growth starts without a force, and the
// remaining loss is dissipated.
void CommonNormals::transfer_forces(std::vector<SpringContact>& springs, size_t first, size_t end) {
  const auto grown = [&](size_t k) {
    const SpringContact& s = springs[places_[k].spring];
    return std::max(0., s.stiffness - s.stiffness_before);
  };
  const auto gone = [&](size_t k) {
    const SpringContact& s = springs[places_[k].spring];
    return std::max(0., s.stiffness_before - s.stiffness);
  };
  bool any = false;
  for (size_t k = first; k < end; ++k) {
    places_[k].offered_fraction = 0;
    if (!(gone(k) > 0)) continue;
    double wanted = 0;
    each_neighbour(first, end, k, [&](size_t i, double weight) { wanted += weight * grown(i); });
    if (wanted > 0) places_[k].offered_fraction = std::min(1., gone(k) / wanted);
    any = any || wanted > 0;
  }
  added_.assign(end - first, 0);
  for (size_t i = first; any && i < end; ++i) {
    const double growth = grown(i);
    if (!(growth > 0)) continue;
    const SpringContact& own = springs[places_[i].spring];
    double taken = 0, force = 0;
    each_neighbour(first, end, i, [&](size_t k, double weight) {
      const double from = weight * growth * places_[k].offered_fraction;
      if (!(from > 0)) return;
      const SpringContact& other = springs[places_[k].spring];
      taken += from;
      force += from * other.force_before / other.stiffness_before *
               std::max(0., own.nx * other.nx + own.ny * other.ny);
    });
    if (taken > 0) added_[i - first] = std::min(1., growth / taken) * force;
  }
  for (size_t i = first; i < end; ++i) {
    SpringContact& own = springs[places_[i].spring];
    if (own.stiffness < own.stiffness_before) {
      own.force_before *= own.stiffness / own.stiffness_before;
    }
    own.force_before += added_[i - first];
  }
}

}  // namespace apothem
