// The contact of two outlines along their straight paths in a step, at several places of it at
// once: what OutlineOnset needs of a pair.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/onset_rule.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/contact/surface/outlines.hpp"

namespace apothem {

/// Two outlines, or one that touches itself. It keeps its memory from pair to pair.
class OutlinePath {
 public:
  /// Both must outlive this object.
  OutlinePath(const Outlines& outlines, const OutlineSlopes& slopes)
      : outlines_(outlines), slopes_(slopes) {}

  /// At the end of the drift of a step of dt (s).
  struct Step {
    const Kinematics& now;  ///< with the half-step velocities
    const Dynamics& dynamics;
    double dt;
  };
  struct Impulse {
    size_t coordinate;  ///< among those of the nodes, or of the rigid bodies
    double mean;        ///< J / dt, N or N m
  };

  /// Appends J of the pair for samples with so many panels. `candidates` ascend.
  void find(BodyIndex a, BodyIndex b, int panels, std::span<const EdgeFace> candidates,
            const Step& step, std::vector<Impulse>& on_nodes, std::vector<Impulse>& on_rigid);

 private:
  static constexpr int kAtOnce = 4;  // samples
  using Pack = PackOf<kAtOnce>;

  /// A coordinate of a node or of a rigid body.
  struct Coordinate {
    size_t index;     ///< in the order of a state
    double velocity;  ///< of the drift
    OnsetForces force = {};
    double missing = 0;  ///< J / dt, N or N m
  };
  /// One of the two bodies: its ends of edges, its corners and its coordinates, in the lists below.
  struct Side {
    BodyIndex body;
    size_t first_end, end, first_corner, last_corner, coordinates;
  };
  /// A face of a collar, by the corners of its base and those before and after it.
  struct Face {
    size_t before, a, b, after;
    double depth;
    bool placed = false;
    CollarFace<Pack> at = {};
  };
  /// A candidate: the corners of its edge, and its face.
  struct Near {
    size_t p, q, face;
    double slope;
  };
  struct Corners {
    std::vector<Pack> x, y;    // m
    std::vector<Pack> fx, fy;  // N
  };

  void take_near(BodyIndex a, BodyIndex b, std::span<const EdgeFace> candidates);
  Side take_side(BodyIndex body, const Step& step);
  void find_events(const Step& step);
  void find_loads(const Step& step, size_t first, size_t count, size_t inside);
  void place(const Side& side, const Step& step, const Pack& theta);
  void place(Face& face) const;
  void find_forces();
  void add_deep(const Near& near, const Face& face, size_t lane);
  void add_forces(const Side& side, const Step& step, const Pack& theta);
  void balance();
  [[nodiscard]] double moment(const Side& side) const;
  void turn(const Side& side, double moment);
  void keep(const Side& side, std::vector<Impulse>& on_nodes, std::vector<Impulse>& on_rigid) const;

  const Outlines& outlines_;
  const OutlineSlopes& slopes_;
  std::vector<Side> sides_;
  std::vector<EdgeFace> candidates_;
  std::vector<int> ends_;     // vertices of the near edges, and of the bases of the near faces
  std::vector<int> corners_;  // these, and the vertices that bisectors follow from
  std::vector<size_t> corner_of_end_;
  std::vector<int> corner_of_;  // of all vertices; -1 between the pairs
  std::vector<int> face_at_;    // of each corner: the face that begins there, or -1
  std::vector<Near> near_;
  std::vector<Face> faces_;
  Corners at_;  // at some places of the path
  std::vector<double> events_;
  std::vector<OnsetSample> samples_;
  std::vector<Pack> forces_;             // of each coordinate at these places, N or N m
  std::vector<Coordinate> coordinates_;  // of the ends on a, then on b; of rigid bodies only three
};

}  // namespace apothem
