// The methods for the contact of two polygons, by name.
#pragma once

#include <array>
#include <string_view>

#include "geometry/integrals/edge_integral.hpp"
#include "geometry/polygon/polygon.hpp"
#include "geometry/potential/potential.hpp"

namespace apothem {

/// Integrals along the edges; Eq. 8 on the overlap polygon; or that with 100 digits.
inline constexpr std::array<std::string_view, 3> kPairMethods{"edge", "overlap", "exact"};

struct FirstImage;

/// The contact of two polygons, for a normal stiffness of 1 Pa.
struct PairContact {
  Vec2 force;                         ///< force on a, m
  double moment_a, moment_b;          ///< moments about the centroids, m^2
  Vec2 loading_point;                 ///< in the coordinates of the vertices, m
  double energy;                      ///< m^2
  double overlap_area;                ///< m^2
  double own_length_a, own_length_b;  ///< as in PairIntegral, m
  double weight;                      ///< as in PairIntegral, m
  double largest_phi;                 ///< as in PairIntegral
};

/// Two polygons in a pose that they share with all their images by other first vertices and senses
/// of rings, by mirrors that keep the pair of axes, and by quarter turns. What is computed in it
/// and mapped back depends on none of these, to the last bit, nor on a scale that is a power of
/// two. Contacts of runs are sums in the order of the vertices, in the pose at hand.
class PosedPair {
 public:
  PosedPair(const Polygon& a, const Polygon& b);

  /// The contact by one of the methods, for potentials made by make_potential. Throws
  /// InvalidPolygon as that does.
  [[nodiscard]] PairContact contact(std::string_view method, const PotentialChoice& choice) const;
  /// How deep the boundary of one polygon lies in the other, m; see penetration.hpp.
  [[nodiscard]] double penetration() const;

 private:
  PosedPair(const Polygon& a, const Polygon& b, const FirstImage& image);

  Polygon given_a_, given_b_;
  Polygon a_, b_;  // in the pose
  // Maps back from the pose: the mean of all that do if the pair is symmetric, of vectors and of
  // moments.
  Eigen::Matrix2d back_;
  double sense_;
};

}  // namespace apothem
