// Private header: how packs read and write what pairs of rigid bodies have, one pair in each lane.
#pragma once

#include <cstddef>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/law/stiffness.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

// A number of each lane; a plain number is that of the first one.
template <class F>
APOTHEM_INLINE void read_lanes(double& number, const F& of) {
  number = of(0);
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(PackOf<lanes>& pack, const F& of) {
  pack = pack_of<lanes>(of);
}
// A truth value of each lane, from 1 or 0.
template <class F>
APOTHEM_INLINE void read_lanes(bool& truth, const F& of) {
  truth = of(0) > 0;
}
template <int lanes, class F>
APOTHEM_INLINE void read_lanes(MaskOf<lanes>& mask, const F& of) {
  PackOf<lanes> number;
  read_lanes(number, of);
  mask = number > PackOf<lanes>(0.);
}
template <class Real, class F>
APOTHEM_INLINE void read_lanes(PairVectorOf<Real>& vector, const F& of) {
  FourOf<Real> four;
  read_rows([&](int k) APOTHEM_LAMBDA { return &of(k).x; }, four);
  vector = {four[0], four[1], four[2], four[3]};
}

template <int lanes, class F>
APOTHEM_INLINE void write_lanes(const PairVectorOf<PackOf<lanes>>& vector, const F& to) {
  write_rows({vector.x, vector.y, vector.a, vector.b},
             [&](int k) APOTHEM_LAMBDA { return &to(k).x; });
}
template <int lanes, class F>
APOTHEM_INLINE void write_held(const BodyStiffnessOf<PackOf<lanes>>& s, const F& to) {
  write_rows({s.xx, s.xy, s.yy, s.xt}, [&](int k) APOTHEM_LAMBDA { return &to(k).xx; });
  for (int k = 0; k < lanes; ++k) {
    to(k).yt = s.yt.v[k];
    to(k).tt = s.tt.v[k];
  }
}

// The mass centre of a minus that of b; `lanes` have these numbers.
template <class Real, class Lane>
APOTHEM_INLINE void read_between(const Surfaces& surfaces, const Lane* lanes,
                                 VectorOf<Real>& between) {
  read_lanes(between.x, [&](int k) APOTHEM_LAMBDA {
    return surfaces.pose(lanes[k].a)[0] - surfaces.pose(lanes[k].b)[0];
  });
  read_lanes(between.y, [&](int k) APOTHEM_LAMBDA {
    return surfaces.pose(lanes[k].a)[1] - surfaces.pose(lanes[k].b)[1];
  });
}

}  // namespace apothem
