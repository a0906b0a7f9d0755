#include "geometry/exact/pair_methods.hpp"

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"

namespace apothem {

PairResult evaluate_pair(std::string_view method, const Polygon& a, const Polygon& b,
                         const PotentialChoice& choice) {
  if (method == "exact") return exact_method(a, b, choice);
  const Potential potential_a = make_potential(a, choice);
  const Potential potential_b = make_potential(b, choice);
  if (method == "overlap") return overlap_method(a, potential_a, b, potential_b);
  return edge_method(a, potential_a, b, potential_b);
}

Vec2 world_loading_point(const PairIntegral& pair, const Polygon& a) {
  return a.origin() + (area_moments(a).centroid + loading_point(pair));
}

}  // namespace apothem
