// Contacts of deformable bodies that begin or end within a step: see onset_rule.hpp. The force of a
// pair of bodies is that on the vertices of both outlines, all at the same samples.
#pragma once

#include <span>
#include <vector>

#include "apothem/archive/archive.hpp"
#include "apothem/contact/edge_face_blocks.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/onset_rule.hpp"
#include "apothem/contact/onset_watch.hpp"
#include "apothem/contact/outline_plateaus.hpp"
#include "apothem/contact/outline_slopes.hpp"
#include "apothem/contact/outlines.hpp"

namespace apothem {

class OutlineOnset {
 public:
  /// Both must outlive this object.
  OutlineOnset(const Outlines& outlines, const OutlineSlopes& slopes)
      : outlines_(outlines), slopes_(slopes) {}

  /// At the end of the drift of a step of dt (s), with the half-step velocities: finds J of the
  /// pairs of bodies whose vertices inside each other are not those of the step before, or of which
  /// much more or less boundary is inside. `blocks` hold the contacts of now, `candidates` ascend.
  /// True if there is a J. With dt = 0, at the start, there is none, and what touches then is new
  /// in the first step. Pairs with `plateaus` are left as they are.
  bool find(std::span<const EdgeFace> candidates, const EdgeFaceBlocks& blocks,
            const OutlinePlateaus& plateaus, const Kinematics& now, const Dynamics& dynamics,
            double dt);
  /// Adds J / dt of the last `find`, times `scale`.
  void add(double scale, const ForceViews& forces) const;

  void fields(Archive& archive) { watch_.fields(archive); }

 private:
  /// A coordinate of a node or of a rigid body.
  struct Coordinate {
    size_t index;     ///< in the order of a state
    double velocity;  ///< of the drift
    OnsetForces force = {};
    double missing = 0;  ///< J / dt, N or N m
  };
  struct Impulse {
    size_t coordinate;  ///< among those of the nodes, or of the rigid bodies
    double mean;        ///< J / dt, N or N m
  };
  struct Step;

  /// One of the two bodies: its ends of edges, and its coordinates, in the lists below.
  struct Side {
    BodyIndex body;
    size_t first_end, end, coordinates;
  };

  void find_touching(const EdgeFaceBlocks& blocks, const OutlinePlateaus& plateaus, bool at_first);
  void find_pair(BodyIndex body_a, BodyIndex body_b, int panels,
                 std::span<const EdgeFace> candidates, const Step& step);
  void take_near(BodyIndex a, BodyIndex b, std::span<const EdgeFace> candidates);
  Side take_side(BodyIndex body, const Step& step);
  void find_events(const Step& step);
  void place(BodyIndex body, const Step& step, double theta);
  void find_forces();
  void add_forces(const Side& side, const Step& step, double theta);
  void balance();
  [[nodiscard]] double moment(const Side& side) const;
  void turn(const Side& side, double moment);
  void keep(const Side& side);
  [[nodiscard]] CollarFace<double> face(int i) const;
  [[nodiscard]] Vec2 point(int vertex) const { return {x_[vertex], y_[vertex]}; }

  const Outlines& outlines_;
  const OutlineSlopes& slopes_;
  OnsetWatch watch_;
  std::vector<Impulse> on_nodes_, on_rigid_;
  // Of the pair at hand, which may be one body that touches itself.
  std::vector<Side> sides_;
  std::vector<EdgeFace> near_;
  std::vector<int> ends_;        // of the near edges, and of the bases of the near faces
  std::vector<int> corners_;     // these, and the vertices that bisectors follow from
  std::vector<double> x_, y_;    // of these among all vertices, somewhere on the path, m
  std::vector<double> fx_, fy_;  // on the ends among all vertices, there, N
  std::vector<Vec2> start_;      // of all vertices, at the start of the step, m
  std::vector<double> events_;
  std::vector<OnsetSample> samples_;
  std::vector<double> forces_;           // of each coordinate, somewhere on the path, N or N m
  std::vector<Coordinate> coordinates_;  // of the ends on a, then on b; of rigid bodies only three
};

}  // namespace apothem
