#include "apothem/contact/pair_loads.hpp"

#include <algorithm>

#include "apothem/contact/pair_lanes.hpp"
#include "apothem/execution/dispatch.hpp"

namespace apothem {
namespace {

constexpr int kAtOnce = kComparedLanes;

using Four = PackOf<kAtOnce>;

struct Lane {
  const PairIntegral* pair;
  RigidIndex a, b;
  size_t touching;
};

using Stiffness = BodyStiffnessOf<Four>;

APOTHEM_INLINE Stiffness read(const BodyStiffness* const* from) {
  FourOf<Four> four;
  Stiffness s;
  read_rows([&](int k) APOTHEM_LAMBDA { return &from[k]->xx; }, four);
  s.xx = four[0], s.xy = four[1], s.yy = four[2], s.xt = four[3];
  read_lanes(s.yt, [&](int k) APOTHEM_LAMBDA { return from[k]->yt; });
  read_lanes(s.tt, [&](int k) APOTHEM_LAMBDA { return from[k]->tt; });
  return s;
}

// How a contact holds a body: see find_loads. The displacements of both bodies add where both can
// move: K (x_a - x_b)^2 <= 2 K (x_a^2 + x_b^2).
struct Strip {
  Four stiffness, across, breadth, times;
  VectorOf<Four> normal, tangent;

  APOTHEM_INLINE void hold(const VectorOf<Four>& middle, const VectorOf<Four>& centre, bool springs,
                           BodyStiffness* const* held) const {
    Stiffness sum;
    sum.add(stiffness, normal.x, normal.y, middle.cross(normal));
    sum.add(across, tangent.x, tangent.y, centre.cross(tangent));
    sum.tt = sum.tt + stiffness * breadth * breadth / Four(12.);
    if (springs) sum.add(read(held), Four(1.));
    Stiffness all;
    all.add(sum, times);
    write_held(all, [&](int k) APOTHEM_LAMBDA -> BodyStiffness& { return *held[k]; });
  }
};

APOTHEM_INLINE void load_lanes(const TouchingPairs& all, const Lane* lanes,
                               std::span<PairLoad> loads, std::span<PairStiffness> held,
                               Four& sizes) {
  const bool springs = !all.tangential.empty();
  const Surfaces& surfaces = all.surfaces;
  FourOf<Four> four;
  const auto integral = [&](int first) APOTHEM_LAMBDA {
    read_rows([&](int k) APOTHEM_LAMBDA { return integral_numbers(*lanes[k].pair) + first; }, four);
  };
  integral(kForceNumbers);
  const VectorOf<Four> force{four[0], four[1]};
  const Four moment_a = four[2], moment_b = four[3];
  integral(kCentreNumbers);
  const Four weight = four[0];
  const VectorOf<Four> centre{four[2], four[3]};
  integral(kBreadthNumbers);
  const Four breadth = four[0], middle_along = four[1];
  integral(kLengthNumbers);
  const Four length_a = four[0], length_b = four[1];
  Four k, slope_a, slope_b;
  read_lanes(k, [&](int i) APOTHEM_LAMBDA {
    return all.table.between(lanes[i].a, lanes[i].b).normal_stiffness * all.thickness;
  });
  read_lanes(slope_a, [&](int i) APOTHEM_LAMBDA { return surfaces.shapes().slope(lanes[i].a); });
  read_lanes(slope_b, [&](int i) APOTHEM_LAMBDA { return surfaces.shapes().slope(lanes[i].b); });
  Strip strip;
  strip.stiffness = k * (length_a * slope_b + length_b * slope_a);  // as Contact::stiffness
  read_lanes(strip.times, [&](int i) APOTHEM_LAMBDA {
    return surfaces.responsive(lanes[i].a) && surfaces.responsive(lanes[i].b) ? 2. : 1.;
  });
  VectorOf<Four> between;
  read_between(surfaces, lanes, between);
  const Four size = force.size(), zero(0.), one(1.);
  // Of the pushes of the edges: 1 if all have one direction.
  const Four share = size / weight;
  const Four aligned = select(share < one, share, one);
  const Four::Mask pushes = size > zero;
  strip.normal = {select(pushes, force.x / size, one), select(pushes, force.y / size, zero)};
  strip.tangent = strip.normal.turned();
  strip.across = (one - aligned * aligned) * strip.stiffness;
  strip.breadth = breadth;
  // Where the resultant acts says little: boundary that is hardly inside is as stiff as any other.
  const VectorOf<Four> middle = middle_along * strip.tangent;
  BodyStiffness *of_a[kAtOnce], *of_b[kAtOnce];
  for (int i = 0; i < kAtOnce; ++i) {
    of_a[i] = &held[lanes[i].touching].a;
    of_b[i] = &held[lanes[i].touching].b;
  }
  strip.hold(middle, centre, springs, of_a);
  strip.hold(middle + between, centre + between, springs, of_b);
  sizes = k * size;
  PairVectorOf<Four> load{k * force.x, k * force.y, k * moment_a, k * moment_b};
  if (springs) {
    PairVectorOf<Four> beside;
    read_lanes(beside, [&](int i) APOTHEM_LAMBDA -> const PairForce& {
      return all.tangential[lanes[i].touching].all;
    });
    load = load + beside;
  }
  write_lanes(load,
              [&](int i) APOTHEM_LAMBDA -> PairForce& { return loads[lanes[i].touching].force; });
}

}  // namespace

PairPeak find_loads(const TouchingPairs& all, int first, int end, std::span<PairLoad> loads,
                    std::span<PairStiffness> held) {
  PairPeak largest;
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    for (int i = first; i < end; i += kAtOnce) {
      Lane lanes[kAtOnce];
      for (int k = 0; k < kAtOnce; ++k) {
        const auto t = static_cast<size_t>(std::min(i + k, end - 1));  // the last one again
        const PairInTouch& pair = all.pairs[t];
        lanes[k] = {pair.integral, pair.a, pair.b, t};
        loads[t].a = pair.a;
        loads[t].b = pair.b;
      }
      Four sizes;
      // The sums of a lane are written once more with what has been read before.
      load_lanes(all, lanes, loads, held, sizes);
      for (int k = 0; k < kAtOnce && i + k < end; ++k) {
        if (sizes.v[k] > largest.value) largest = {sizes.v[k], lanes[k].a, lanes[k].b};
      }
    }
    return 0.;
  });
  return largest;
}

}  // namespace apothem
