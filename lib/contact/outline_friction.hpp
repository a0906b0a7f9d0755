// Friction of deformable bodies: one elastic slip for each boundary edge in contact, both bodies in
// turn being the one that slides on the other's faces (docs/theory.md, Friction).
//
// The slip rate of an edge c against a face a->b is objective,
//   g' = t . (v_c - (1 - s) v_a - s v_b) + (h/L) n . (v_b - v_a),
// its mean is weighted with the pressure, and the nodal forces are the friction force times the
// coefficients of g': they keep linear and angular momentum.
#pragma once

#include <vector>

#include "apothem/contact/edge_face.hpp"
#include "apothem/contact/friction_memory.hpp"
#include "apothem/contact/friction_table.hpp"
#include "apothem/contact/kinematics.hpp"
#include "apothem/contact/outlines.hpp"

namespace apothem {

class OutlineFriction {
 public:
  /// `slope`: k_n thickness / r of each face, N/m^2; `thickness` in m. All must outlive this
  /// object.
  OutlineFriction(const Outlines& outlines, const FrictionTable& table,
                  const std::vector<double>& slope, double thickness)
      : outlines_(outlines), table_(table), slope_(slope), thickness_(thickness) {}

  /// One step further: see Kernel::slide. Slip that is spread over more contact keeps its force,
  /// and springs of contact that has ended are lost: friction never adds energy.
  double slide(const std::vector<EdgeFaceContact>& contacts, const Kinematics& now, double dt,
               FrictionMemory& memory);

  /// Takes back the last slide.
  void undo_slide() {
    fx_.swap(fx_before_);
    fy_.swap(fy_before_);
  }

  /// Forces on the vertices of the outlines, N.
  [[nodiscard]] const std::vector<double>& fx() const { return fx_; }
  [[nodiscard]] const std::vector<double>& fy() const { return fy_; }
  /// The friction force in each contact along its face, on the body of the edge, N.
  [[nodiscard]] const std::vector<double>& shares() const { return shares_; }

 private:
  void find_velocities(const Kinematics& now, double dt);
  [[nodiscard]] double power(const std::vector<double>& fx, const std::vector<double>& fy) const;
  void apply(const EdgeFaceContact& contact, double weight);

  const Outlines& outlines_;
  const FrictionTable& table_;
  const std::vector<double>& slope_;
  double thickness_;
  std::vector<double> vx_, vy_, fx_, fy_;  // of the vertices
  std::vector<double> fx_before_, fy_before_;
  std::vector<double> shares_;
};

}  // namespace apothem
