// Friction between outlines, and their dashpots (docs/theory.md, Friction and damping). Each edge
// has, for each body that it touches, one friction spring across the common normal of its
// neighbourhood (common_normals.hpp), which obeys Coulomb's limit, and dashpots along this normal
// and beside the spring. They act on the edge and on the feet of its points on the faces, in
// proportion to the pressure.
#pragma once

#include <span>
#include <vector>

#include "lib/contact/law/dashpots.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/contact/law/pair_table.hpp"
#include "lib/contact/mesh/common_normals.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/outline_slip.hpp"
#include "lib/contact/mesh/outline_tangent.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// Both arguments must outlive this object.
  OutlineFriction(const Surfaces& surfaces, const PairTable& table, int threads);

  /// Sets the number of pairs of bodies that may touch, after a search.
  void set_pair_count(size_t pairs) {
    pairs_.resize(pairs);
    everywhere_ = kBothVectors;
  }

  /// Updates the springs by one step, see Kernel::update_friction. Where slip is spread over more
  /// contact its force is kept, and springs of contact that has ended are lost: friction never adds
  /// energy.
  double update_friction(const EdgeFaceBlocks& blocks, const Kinematics& now, double dt,
                         FrictionMemory& memory);

  /// Undoes the last update, in a scene without damping.
  void undo_friction() {
    std::swap(drags_, drags_before_);
    everywhere_ = kBothVectors;
  }
  /// Adds the dashpots of the contacts of the last update, and stores their forces: see Kernel.
  void add_dashpots(const EdgeFaceBlocks& blocks, const Kinematics& now, Dashpots& dashpots);
  void keep_pushes(const EdgeFaceBlocks& blocks, const Dashpots& dashpots, size_t& next,
                   FrictionMemory& memory);

  /// Adds the tangent of the springs of the last update, which was a trial: the derivatives of
  /// their forces, which are not symmetric; or, if friction sticks, only the stiffness of all
  /// springs along their tangents.
  void add_tangent(const EdgeFaceBlocks& blocks, size_t first_node, Tangent& tangent) const;

  /// The force of the springs on a vertex, N.
  [[nodiscard]] Vec2 force(int vertex) const {
    if (drags_.empty()) return {0, 0};
    const VertexDrag& d = drags_[static_cast<size_t>(vertex)];
    return {d[0], d[1]};
  }
  /// Sets the forces of friction and dashpots in the contacts, which ascend.
  void add_to(const EdgeFaceBlocks& blocks, std::span<EdgeFaceContact> contacts) const;

 private:
  struct Step {
    const EdgeFaceBlocks& blocks;
    double dt;
    bool finite;   ///< see Kinematics
    bool limited;  ///< if false, springs keep forces above their limits
  };
  /// The results of a unit.
  struct UnitResult {
    double power = 0;   ///< power of its springs on the bodies, W
    double energy = 0;  ///< J
  };
  /// Memory of a thread.
  struct FrictionWorkspace {
    std::vector<SlipPull> pulls;  // entry for each block of the present unit
    std::vector<Spring> springs;  // springs of all its units, ascending
    /// Forces on vertices that other threads work on as well, which are added afterwards.
    std::vector<std::pair<std::int32_t, VertexDrag>> deferred;
  };

  [[nodiscard]] double begin(BodyIndex body, const Kinematics& now, const Step& step);
  void find_contacts(const Step& step, const EdgeFaceUnit& unit);
  void find_before(const Step& step, ContactWalk<const Spring> walk);
  void update_unit(const Step& step, size_t index, FrictionWorkspace& worker, bool divided);
  [[nodiscard]] static double followed_fraction(const Step& step, const EdgeFaceUnit& unit,
                                                const EdgeFaceGroup& group,
                                                const SpringContact& contact);
  [[nodiscard]] double follow(const Step& step, const EdgeFaceUnit& unit,
                              FrictionWorkspace& worker);
  [[nodiscard]] double pull(const Step& step, const EdgeFaceUnit& unit, FrictionWorkspace& worker,
                            bool divided);
  void find_pairs(const EdgeFaceBlocks& blocks, const Kinematics& now);
  template <class Add>
  void each_coordinate(const EdgeFaceBlocks& blocks, const EdgeFaceUnit& unit,
                       const EdgeFaceGroup& group, const SpringContact& contact,
                       const Add& add) const;
  void add_sticking_tangent(const EdgeFaceBlocks& blocks, size_t first_node,
                            Tangent& tangent) const;
  template <class F>
  void each_dashpot(const EdgeFaceBlocks& blocks, const F& f);

  const Surfaces& surfaces_;
  const PairTable& table_;
  const OutlineSurfaces& outlines_;
  Threads threads_;
  CommonNormals<double> normals_;
  // Bodies that have become inactive may still have forces, in drags_ or drags_before_. For this
  // number of steps all bodies are treated.
  static constexpr int kBothVectors = 2;
  int everywhere_ = kBothVectors;
  std::vector<BodyIndex> all_;      // all bodies
  std::vector<double> velocities_;  // velocities of the vertices, x and y interleaved, m/s
  std::vector<VertexDrag> drags_, drags_before_;  // friction on the vertices
  std::vector<OutlineSlip> slips_;                // slip of each block
  std::vector<SpringContact> contacts_;           // one entry for each group
  double tried_dt_ = 0;                           // length of the last update, s
  std::vector<double> body_powers_;  // power of the forces of the step before on each body, W
  std::vector<UnitResult> units_;
  /// Sums over all contacts of two bodies, treated as rigid, for their dashpots.
  struct PairSum {
    BodyIndex a = -1, b = -1;
    Vec2 force = Vec2::Zero();   // force on a, N
    double moment = 0;           // moment about the origin, N m
    Vec2 places = Vec2::Zero();  // sum of the points of the forces times their magnitudes, N m
    double sizes = 0;            // sum of the magnitudes of the forces, N
    double resistance = 0, stiffness = 0;         // N/m
    double normal_time = 0, tangential_time = 0;  // s
  };
  std::vector<PairSum> pairs_;
  std::vector<FrictionWorkspace> workers_;
};

}  // namespace apothem
