#include "geometry/exact/pair_methods.hpp"

#include "geometry/exact/exact_integral.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/penetration.hpp"
#include "geometry/polygon/canonical_pose.hpp"

namespace apothem {
namespace {

PairResult by_method(std::string_view method, const Polygon& a, const Polygon& b,
                     const PotentialChoice& choice) {
  if (method == "exact") return exact_method(a, b, choice);
  const Potential potential_a = make_potential(a, choice);
  const Potential potential_b = make_potential(b, choice);
  if (method == "overlap") return overlap_method(a, potential_a, b, potential_b);
  return edge_method(a, potential_a, b, potential_b);
}

}  // namespace

PosedPair::PosedPair(const Polygon& a, const Polygon& b) : PosedPair(a, b, first_image({&a, &b})) {}

PosedPair::PosedPair(const Polygon& a, const Polygon& b, const FirstImage& image)
    : given_a_(a),
      given_b_(b),
      a_(polygon_of_rings(image.polygons[0])),
      b_(polygon_of_rings(image.polygons[1])) {
  back_.setZero();
  sense_ = 0;
  for (const AxisMap& map : image.maps) {
    back_.col(0) += map.undo({1, 0});
    back_.col(1) += map.undo({0, 1});
    sense_ += map.mirrors() ? -1 : 1;
  }
  const auto count = static_cast<double>(image.maps.size());
  back_ /= count;
  sense_ /= count;
}

PairContact PosedPair::contact(std::string_view method, const PotentialChoice& choice) const {
  const PairResult result = [&] {
    try {
      return by_method(method, a_, b_, choice);
    } catch (const InvalidPolygon&) {
      // The vertex that the error names is one of the polygons as they were given.
      make_potential(given_a_, choice);
      make_potential(given_b_, choice);
      throw;
    }
  }();
  const PairIntegral& pair = result.integral;
  const Vec2 point = a_.origin() + (area_moments(a_).centroid + loading_point(pair));
  // Adding a zero takes the sign of zeros away.
  const Vec2 zero = Vec2::Zero();
  return {.force = back_ * pair.force + zero,
          .moment_a = sense_ * pair.moment_a + 0,
          .moment_b = sense_ * pair.moment_b + 0,
          .loading_point = back_ * point + zero,
          .energy = result.volume.energy,
          .overlap_area = result.volume.overlap_area,
          .own_length_a = pair.own_length_a,
          .own_length_b = pair.own_length_b,
          .weight = pair.weight,
          .largest_phi = pair.largest_phi};
}

double PosedPair::penetration() const { return apothem::penetration(a_, b_); }

}  // namespace apothem
