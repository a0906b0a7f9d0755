// The common normal of friction springs that are close to each other on a boundary, and the
// fraction of the normal force that counts for friction (docs/theory.md, Friction).
//
// At a corner the edges push against each other. If every edge were treated alone, Coulomb's limit
// would be the sum of the magnitudes of their forces, which exceeds the force that presses the
// bodies together, and the slip would be along the flanks. Therefore the normal forces of a
// neighbourhood are summed: friction acts across the resultant, and the part that cancels does not
// count. A neighbourhood is a few depths long, so that nothing changes where a boundary is
// straight, however the pressure varies.
#pragma once

#include <vector>

#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

/// The sums over those contacts of an edge that share one friction spring, in one evaluation.
/// `Real` is a number, or one that carries derivatives.
template <class Real>
struct SpringContactOf {
  // Sums over the contacts; there is no contact where `normal` is 0.
  Real normal = 0;        ///< magnitude of the elastic normal force on the edge, N
  Real place = 0;         ///< moment of this force along the edge over the length of the edge, N
  Real rate_x = 0;        ///< slip rate of the edge against the faces times the normal force, N m/s
  Real rate_y = 0;        ///< y component, N m/s
  Real slope_x = 0;       ///< stiffness of the faces times their tangents, N/m
  Real slope_y = 0;       ///< y component, N/m
  Real deepest = 0;       ///< largest depth, m
  double ratio = 0;       ///< ratio of the stiffness of the spring to that along the normal
  Real tx = 0, ty = 0;    ///< unit tangent of the edge
  std::int32_t edge = 0;  ///< edge of the outlines
  BodyIndex other = 0;    ///< the body of the faces
  // The spring of the step before.
  bool is_old = false;
  double force_before = 0, stiffness_before = 0;  ///< N, N/m
  double push_before = 0;                         ///< force of the dashpot along the normal, N
  // Results.
  Real nx = 0, ny = 0;  ///< unit vector of the normal force on the edge; zero if there is none
  Real pressed = 0;     ///< normal force that counts for friction, N
  Real resistance = 0;  ///< stiffness along the normal, N/m
  Real stiffness = 0;   ///< stiffness of the spring, N/m
  Real carried = 0;     ///< force at the start of the step, with what neighbours hand over, N
  Real followed = 0;    ///< the stiffness times the part of the slip that the spring follows, N/m
  Real friction = 0;    ///< force of the spring on the edge along (-ny, nx), N
  double drag = 0, push = 0;  ///< forces of the dashpots along the tangent and along the normal, N

  /// The slip rate along (-ny, nx), m/s.
  [[nodiscard]] Real slip() const { return (nx * rate_y - ny * rate_x) / normal; }
};
using SpringContact = SpringContactOf<double>;

template <class Real>
class CommonNormals {
 public:
  using Spring = SpringContactOf<Real>;
  /// `outlines` must outlive this object.
  explicit CommonNormals(const OutlineSurfaces& outlines) : outlines_(outlines) {}

  /// Computes in place the normals, the normal forces and the forces of the springs before the
  /// step. The result has the same bits for any order of the springs and any number of threads.
  void find(std::vector<Spring>& springs);

 private:
  /// The place of a spring along its closed line.
  struct SpringPlace {
    std::int32_t loop;
    BodyIndex other;
    Real arc_length;  // position along the line, m
    std::int32_t spring;
    Real depth = 0;      // largest depth nearby, reduced with the distance, m
    Real sizes = 0;      // sum of the magnitudes of the normal forces of the neighbourhood, N
    Real cancelled = 0;  // part of the own normal force that cancels, N
    Real offered_fraction = 0;  // fraction of a neighbour's growth that this spring can supply
  };

  void find_places(const std::vector<Spring>& springs);
  void spread_depths(size_t first, size_t end);
  void find_neighbourhood(std::vector<Spring>& springs, size_t first, size_t end);
  void transfer_forces(std::vector<Spring>& springs, size_t first, size_t end);
  template <class F>
  void each_neighbour(size_t first, size_t end, size_t i, const F& f) const;

  const OutlineSurfaces& outlines_;
  std::vector<double> arc_length_;      // position of each vertex along its line, m
  std::vector<double> perimeter_;       // length of each line, m
  std::vector<std::int32_t> loop_of_;   // closed line of each vertex
  std::vector<std::uint8_t> measured_;  // whether each line has been measured in this evaluation
  std::vector<SpringPlace> places_;
  std::vector<Real> added_;  // forces taken over from neighbours, N
  Real deepest_ = 0;         // largest depth on the present line, m
};

}  // namespace apothem
