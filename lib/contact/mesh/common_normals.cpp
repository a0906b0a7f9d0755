#include "lib/contact/mesh/common_normals.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lib/contact/law/pair_vector.hpp"
#include "lib/execution/sparse_dual.hpp"

namespace apothem {
namespace {

constexpr double kReach = 8;        // length of a neighbourhood, as a multiple of the depth
constexpr double kRounded = 1e-14;  // round-off error of a normal force, relative

template <class Real>
VectorOf<Real> inward(const SpringContactOf<Real>& spring) {
  return {-spring.ty, spring.tx};
}
// The smaller of two numbers, and the larger one, with its derivatives.
template <class Real>
Real at_most(const Real& a, double limit) {
  return limit < a ? Real(limit) : a;
}
template <class Real>
Real not_negative(const Real& a) {
  return Real(0.) < a ? a : Real(0.);
}

}  // namespace

template <class Real>
void CommonNormals<Real>::find(std::vector<Spring>& springs) {
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

template <class Real>
void CommonNormals<Real>::find_places(const std::vector<Spring>& springs) {
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
    const Spring& spring = springs[i];
    if (!(spring.normal > Real(0.))) continue;
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
    const Real on_edge = spring.place / spring.normal * Real(o.length[spring.edge]);
    places_.push_back({loop, spring.other, Real(arc_length_[spring.edge]) + on_edge,
                       static_cast<std::int32_t>(i), spring.deepest});
  }
  const auto key = [](const SpringPlace& p) {
    return std::tuple(p.loop, p.other, real_part(p.arc_length), p.spring);
  };
  // The places are usually in order already.
  if (!std::ranges::is_sorted(places_, {}, key)) std::ranges::sort(places_, {}, key);
}

// Calls f(index, weight) for the neighbours of the place i, first for those before it.
template <class Real>
template <class F>
void CommonNormals<Real>::each_neighbour(size_t first, size_t end, size_t i, const F& f) const {
  const size_t count = end - first;
  const SpringPlace& own = places_[i];
  const double perimeter = perimeter_[own.loop];
  const auto visit = [&](size_t k, const Real& distance) {
    const Real& depth = own.depth < places_[k].depth ? places_[k].depth : own.depth;
    const Real weight = at_most(Real(Real(2.) - Real(2.) * distance / (Real(kReach) * depth)), 1.);
    if (weight > Real(0.)) f(k, weight);
  };
  const double farthest = std::min(kReach * real_part(deepest_), perimeter / 2);
  for (size_t step = 1; step < count; ++step) {
    const size_t k = i >= first + step ? i - step : i + count - step;
    const Real distance = own.arc_length - places_[k].arc_length + Real(k > i ? perimeter : 0);
    if (!(real_part(distance) < farthest)) break;
    visit(k, distance);
  }
  for (size_t step = 1; step < count; ++step) {
    const size_t k = i + step < end ? i + step : i + step - count;
    const Real distance = places_[k].arc_length - own.arc_length + Real(k < i ? perimeter : 0);
    const double away = real_part(distance);
    if (!(away <= farthest) || (away == farthest && away < perimeter / 2)) break;
    visit(k, distance);
  }
}

// A depth spreads along the line, reduced by the distance over kReach. Two rounds are needed
// because the line is closed.
template <class Real>
void CommonNormals<Real>::spread_depths(size_t first, size_t end) {
  const double perimeter = perimeter_[places_[first].loop];
  deepest_ = places_[first].depth;
  const auto raise = [](Real& depth, const Real& to) {
    if (depth < to) depth = to;
  };
  for (size_t i = first; i < end; ++i) raise(deepest_, places_[i].depth);
  const auto spread = [&](size_t from, size_t to, const Real& distance) {
    raise(places_[to].depth, places_[from].depth - distance / Real(kReach));
  };
  const auto between = [&](size_t i) -> Real {
    return places_[i].arc_length - places_[i - 1].arc_length;
  };
  for (int round = 0; round < 2; ++round) {
    const Real seam = places_[first].arc_length + Real(perimeter) - places_[end - 1].arc_length;
    spread(end - 1, first, seam);
    for (size_t i = first + 1; i < end; ++i) spread(i - 1, i, between(i));
    spread(first, end - 1, seam);
    for (size_t i = end - 1; i > first; --i) spread(i, i - 1, between(i));
  }
}

// The places from `first` to `end` belong to one closed line and one other body.
template <class Real>
void CommonNormals<Real>::find_neighbourhood(std::vector<Spring>& springs, size_t first,
                                             size_t end) {
  spread_depths(first, end);
  bool bent = false;
  for (size_t i = first; i < end; ++i) {
    Spring& own = springs[places_[i].spring];
    VectorOf<Real> sum = own.normal * inward(own);
    bool alone = true;
    Real sizes = own.normal;
    each_neighbour(first, end, i, [&](size_t k, const Real& weight) {
      const Spring& other = springs[places_[k].spring];
      sum = sum + (weight * other.normal) * inward(other);
      sizes += weight * other.normal;
      alone = false;
    });
    VectorOf<Real> normal = inward(own);
    if (!alone) {
      const bool none = sum.x == Real(0.) && sum.y == Real(0.);
      const Real size = none ? Real(1.) : sum.size();
      normal = {sum.x / size, sum.y / size};
    }
    own.nx = normal.x, own.ny = normal.y;
    places_[i].sizes = sizes;
    own.pressed = own.normal;
    const Real cancelled = alone ? Real(0.) : own.normal - own.normal * inward(own).dot(normal);
    const bool counts = real_part(cancelled) > kRounded * real_part(own.normal);
    places_[i].cancelled = counts ? cancelled : Real(0.);
    bent = bent || counts;
  }
  for (size_t i = first; bent && i < end; ++i) {
    Spring& own = springs[places_[i].spring];
    Real lost = places_[i].cancelled / places_[i].sizes;
    each_neighbour(first, end, i, [&](size_t k, const Real& weight) {
      lost += weight * places_[k].cancelled / places_[k].sizes;
    });
    own.pressed = own.normal * not_negative(Real(1.) - lost);
  }
  // The segments of the faces contribute with the cosine of their angle to the common normal. The
  // part of the normal force that cancels does not contribute.
  for (size_t i = first; i < end; ++i) {
    Spring& own = springs[places_[i].spring];
    const Real along = own.slope_y * own.nx - own.slope_x * own.ny;
    own.resistance = own.pressed / own.normal * not_negative(along);
    own.stiffness = Real(own.ratio) * own.resistance;
  }
  transfer_forces(springs, first, end);
}

// Where contact moves along the boundary, springs that grow take over stiffness and elastic slip
// from neighbouring springs that shrink. The remaining growth starts without a force, and the
// remaining loss is dissipated.
template <class Real>
void CommonNormals<Real>::transfer_forces(std::vector<Spring>& springs, size_t first, size_t end) {
  const auto grown = [&](size_t k) -> Real {
    const Spring& s = springs[places_[k].spring];
    return not_negative(Real(s.stiffness - Real(s.stiffness_before)));
  };
  const auto gone = [&](size_t k) -> Real {
    const Spring& s = springs[places_[k].spring];
    return not_negative(Real(Real(s.stiffness_before) - s.stiffness));
  };
  bool any = false;
  for (size_t k = first; k < end; ++k) {
    places_[k].offered_fraction = Real(0.);
    const Real supply = gone(k);
    if (!(supply > Real(0.))) continue;
    Real wanted = 0;
    each_neighbour(first, end, k,
                   [&](size_t i, const Real& weight) { wanted += weight * grown(i); });
    if (!(wanted > Real(0.))) continue;
    places_[k].offered_fraction = at_most(Real(supply / wanted), 1.);
    any = true;
  }
  added_.assign(end - first, Real(0.));
  for (size_t i = first; any && i < end; ++i) {
    const Real growth = grown(i);
    if (!(growth > Real(0.))) continue;
    const Spring& own = springs[places_[i].spring];
    Real taken = 0, force = 0;
    each_neighbour(first, end, i, [&](size_t k, const Real& weight) {
      const Real from = weight * growth * places_[k].offered_fraction;
      if (!(from > Real(0.))) return;
      const Spring& other = springs[places_[k].spring];
      taken += from;
      force += from * Real(other.force_before) / Real(other.stiffness_before) *
               not_negative(Real(own.nx * other.nx + own.ny * other.ny));
    });
    if (taken > Real(0.)) added_[i - first] = at_most(Real(growth / taken), 1.) * force;
  }
  for (size_t i = first; i < end; ++i) {
    Spring& own = springs[places_[i].spring];
    own.carried = own.force_before;
    if (own.stiffness < Real(own.stiffness_before)) {
      own.carried = own.carried * (own.stiffness / Real(own.stiffness_before));
    }
    own.carried += added_[i - first];
  }
}

template class CommonNormals<double>;
template class CommonNormals<SparseDual>;

}  // namespace apothem
