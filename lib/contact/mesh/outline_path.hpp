// The contact of two outlines along their straight paths in a step, at several samples of the path
// at once. OutlineEvents uses it for one pair at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "lib/contact/law/event_impulse.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

/// The path of two outlines, or of one outline that touches itself. The object keeps its memory
/// from pair to pair.
class OutlinePath {
 public:
  /// Both arguments must outlive this object.
  OutlinePath(const OutlineSurfaces& outlines, const OutlineSlopes& slopes)
      : outlines_(outlines), slopes_(slopes) {}

  /// A step of dt (s) at the end of its drift.
  struct Step {
    const Kinematics& now;  ///< holds the half-step velocities
    const Dynamics& dynamics;
    double dt;
  };
  struct Impulse {
    size_t coordinate;  ///< index among the coordinates of the nodes, or of the rigid bodies
    double mean;        ///< J / dt, N or N m
  };

  /// Appends the missing impulses J of the pair for samples with `panels` panels. `candidates`
  /// ascend.
  void find(BodyIndex a, BodyIndex b, int panels, std::span<const EdgeFace> candidates,
            const Step& step, std::vector<Impulse>& on_nodes, std::vector<Impulse>& on_rigid);

 private:
  static constexpr int kAtOnce = 4;  // samples at once
  using Pack = PackOf<kAtOnce>;

  /// A coordinate of a node or of a rigid body.
  struct Coordinate {
    size_t index;     ///< in the order of a state
    double velocity;  ///< velocity of the drift
    EventForces force = {};
    double missing = 0;  ///< J / dt, N or N m
  };
  /// One of the two bodies, with its ranges in ends_ and corners_ and its first index in
  /// coordinates_.
  struct PathBody {
    BodyIndex body;
    size_t first_end, end, first_corner, last_corner, coordinates;
  };
  /// A face of a collar, given by the corners of its base and the corners before and after them.
  struct PathFace {
    size_t before, a, b, after;
    double depth;
    bool placed = false;
    CollarFace<Pack> collar_face = {};
  };
  /// A candidate, given by the corners of its edge and by its face.
  struct PathEdge {
    size_t p, q, face;
    double slope;
  };
  struct CornerValues {
    std::vector<Pack> x, y;    // m
    std::vector<Pack> fx, fy;  // N
  };

  void list_candidates(BodyIndex a, BodyIndex b, std::span<const EdgeFace> candidates);
  PathBody add_side(BodyIndex body, const Step& step);
  void find_kinks(const Step& step);
  void find_loads(const Step& step, size_t first, size_t count, size_t inside);
  void place(const PathBody& side, const Step& step, const Pack& theta);
  void place(PathFace& face) const;
  void find_forces();
  void add_general(const PathEdge& near, const PathFace& face, size_t lane);
  void add_forces(const PathBody& side, const Step& step, const Pack& theta);
  void balance();
  [[nodiscard]] double moment(const PathBody& side) const;
  void turn(const PathBody& side, double moment);
  void keep(const PathBody& side, std::vector<Impulse>& on_nodes,
            std::vector<Impulse>& on_rigid) const;

  const OutlineSurfaces& outlines_;
  const OutlineSlopes& slopes_;
  std::vector<PathBody> sides_;
  std::vector<EdgeFace> candidates_;
  std::vector<int> ends_;     // vertices of the near edges and of the bases of the near faces
  std::vector<int> corners_;  // these vertices and those that determine the bisectors
  std::vector<size_t> corner_of_end_;
  std::vector<int> corner_of_;       // corner of each vertex, or -1; all are -1 between two pairs
  std::vector<int> face_of_corner_;  // face that begins at each corner, or -1
  std::vector<PathEdge> edges_;
  std::vector<PathFace> faces_;
  CornerValues corner_values_;  // positions and forces at the present samples
  std::vector<double> kinks_;
  std::vector<EventSample> samples_;
  std::vector<Pack> forces_;             // force on each coordinate at these samples, N or N m
  std::vector<Coordinate> coordinates_;  // coordinates of body a, then of b; three for a rigid body
};

}  // namespace apothem
