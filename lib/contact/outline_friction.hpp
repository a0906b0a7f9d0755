// Friction and viscous damping of deformable bodies: one elastic slip for each boundary edge in
// contact, both bodies in turn being the one that slides on the other's faces (docs/theory.md,
// Friction).
//
// The slip rate of an edge c against a face a->b is objective,
//   g' = t . (v_c - (1 - s) v_a - s v_b) + (h/L) n . (v_b - v_a),
// its mean is weighted with the pressure, and the nodal forces are the friction force times the
// coefficients of g': they keep linear and angular momentum. A dashpot along t acts beside the
// spring, within Coulomb's limit. Dashpots along n act in two points of each piece of an edge in a
// face, on the edge and on the foot of the point on the face, and never pull.
#pragma once

#include <span>
#include <vector>

#include "apothem/contact/damping_times.hpp"
#include "apothem/contact/edge_face.hpp"
#include "apothem/contact/friction_memory.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/outline_slip.hpp"
#include "apothem/contact/outlines.hpp"
#include "apothem/contact/pair_table.hpp"
#include "apothem/execution/parallel.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// `inverse_mass` of each body, 1/kg. All must outlive this object.
  OutlineFriction(const Outlines& outlines, const PairTable& table,
                  const std::vector<double>& inverse_mass, int threads)
      : outlines_(outlines),
        damped_(table.damped()),
        threads_(threads),
        times_(table, inverse_mass) {}

  /// See Kernel.
  void limit_damping(double rate) { times_.limit(rate); }
  /// After a search: the pairs of bodies that may touch.
  void take(std::span<const BoxPair> pairs) {
    times_.take(pairs);
    everywhere_ = true;
  }
  /// Index of two of them: see EdgeFaceLaw.
  [[nodiscard]] int bodies(BodyIndex a, BodyIndex b) const { return times_.index(a, b); }

  /// One step further: see Kernel::slide. Slip that is spread over more contact keeps its force,
  /// and springs of contact that has ended are lost: friction never adds energy.
  double slide(std::span<const EdgeFaceContact> contacts, std::span<const EdgeFaceLaw> laws,
               const Kinematics& now, double dt, FrictionMemory& memory);

  void fields(Archive& archive) {
    if (damped_) archive("damping", damping_);
  }
  /// Takes back the last slide of a scene without damping.
  void undo_slide() {
    std::swap(friction_, friction_before_);
    everywhere_ = true;
  }

  [[nodiscard]] const VertexForces& friction() const { return friction_; }
  /// Of all dashpots; none where no pair is damped.
  [[nodiscard]] const VertexForces& damping() const { return damping_; }
  /// The friction force in each contact along its face with the dashpot beside it, and the force of
  /// the dashpots against its face, on the body of the edge, N.
  [[nodiscard]] const std::vector<double>& shares() const { return shares_; }
  [[nodiscard]] const std::vector<double>& pushes() const { return pushes_; }

 private:
  /// The contacts from `first` to `end` - 1, which have one spring.
  struct Group {
    size_t first, end;
    const Spring* before;  ///< of the step before, or null
    Spring spring;
    bool slides;  ///< whether it has friction
  };
  struct Step {
    std::span<const EdgeFaceContact> contacts;
    std::span<const EdgeFaceLaw> laws;
    double dt;
    bool finite;    ///< see Kinematics
    bool dashpots;  ///< whether there are any
  };

  void find_velocities(const Kinematics& now, double dt);
  /// Of the forces of springs and dashpots on the bodies, W.
  struct Powers {
    double friction = 0, damping = 0;
  };
  [[nodiscard]] Powers powers(const VertexForces& friction) const;
  void find_times(const Step& step);
  void find_groups(const Step& step, FrictionMemory& memory);
  void follow(const Step& step, Group& group, size_t place);
  /// Some contacts, by their numbers from `first` to `end` - 1, whose slips have the places from
  /// `place` on.
  struct Part {
    size_t first, end, place;
  };
  void find_slips(const Step& step, const Part& part);
  void add_forces(const Part& part, int first, int end);
  void slide_by_parts(const Step& step, FrictionMemory& memory);
  void slide_on_threads(const Step& step, FrictionMemory& memory);

  const Outlines& outlines_;
  bool damped_;
  Threads threads_;
  DampingTimes times_;
  bool everywhere_ = true;          // bodies that have become inactive may still have forces
  std::vector<double> velocities_;  // of the vertices, interleaved
  OutlineSlips slips_;              // of the contacts
  std::vector<Group> groups_;
  VertexForces friction_, friction_before_, damping_;
  std::vector<double> shares_, pushes_;
};

}  // namespace apothem
