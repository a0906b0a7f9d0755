// Contact of deformable bodies with each other and with rigid ones: nodal forces that are the
// gradient of an energy, from the collars of the deformed outlines (docs/theory.md, Contact).
//
//   E = k_n SUM over pairs of bodies  INT over the overlap  (h_a/r_a + h_b/r_b) dA
//
// with the depth h below each body's own surface, which is limited to that of its collar. A body
// that touches itself is a pair with itself, whose overlap is where it lies twice. Every
// term is a sum over (edge of one outline) x (face of the other's collar) and what lies inside the
// tops of collars; only the vertices of the outlines get forces.
#pragma once

#include <optional>
#include <vector>

#include "lib/contact/kernel.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/edge_face_pack.hpp"
#include "lib/contact/mesh/outline_depths.hpp"
#include "lib/contact/mesh/outline_friction.hpp"
#include "lib/contact/mesh/outline_onset.hpp"
#include "lib/contact/mesh/outline_plateaus.hpp"
#include "lib/contact/mesh/outline_records.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class OutlineKernel final : public Kernel {
 public:
  /// `thickness` in m. All must outlive this object.
  OutlineKernel(const Surfaces& surfaces, double thickness, const PairTable& table, int threads);

  void take(std::span<const BoxPair> pairs) override;
  /// The contacts are those of edges with faces, then of edges with tops and of tops with edges.
  void evaluate() override;
  [[nodiscard]] ContactSummary summary() const override;
  void visit_contacts(double least, const ContactVisitor& visit) const override;
  [[nodiscard]] double penetration(const Contact& contact, double floor) override;
  double slide(const Kinematics& now, double dt, FrictionMemory& memory) override;
  void undo_slide() override {
    if (friction_) friction_->undo_slide();
  }
  void add_forces(const ForceViews& forces) override;
  void add_dashpots(const Kinematics& now, Dashpots& to) override {
    if (friction_) friction_->add_dashpots(blocks_, now, to);
  }
  void keep_pushes(const Dashpots& from, size_t& next, FrictionMemory& memory) override {
    listed_ = false;
    if (friction_) friction_->keep_pushes(blocks_, from, next, memory);
  }
  bool find_onsets(const Kinematics& now, const Dynamics& dynamics, double dt,
                   FrictionMemory& /*memory*/) override {
    return onset_.find(candidates_, blocks_, plateaus_, now, dynamics, dt);
  }
  void add_onsets(double scale, const ForceViews& forces) const override {
    onset_.add(scale, forces);
  }
  void fields(Archive& archive) override { archive("outline_onset", onset_); }

  [[nodiscard]] PairPeak largest_force() const override { return largest_force_; }
  [[nodiscard]] double energy() const override;
  /// The largest 2 k (1/r_c + 1/r_t) l_i/m_i of a boundary node (docs/theory.md, Step) for nodes of
  /// these masses in kg (0 where held). Needs placed outlines.
  [[nodiscard]] double rate(std::span<const double> node_mass) const override;
  void add_stiffness(std::span<double> nodes, std::span<double> rigid) const override;
  [[nodiscard]] size_t candidates() const override { return candidates_.size(); }
  [[nodiscard]] Vec2 force_on(BodyIndex body) const override { return resultant(body).force; }
  void add_force_sizes(std::span<double> of_bodies) const override;
  void add_records(std::vector<ContactRecord>& records) const override {
    add_patch_records(state(), records);
  }
  void add_surfaces(std::vector<SurfaceRecord>& records) const override {
    add_surface_records(state(), records);
  }

 private:
  /// All contacts of edges with faces, ascending.
  [[nodiscard]] const std::vector<EdgeFaceContact>& edge_faces() const;
  [[nodiscard]] Resultant resultant(BodyIndex body) const;
  void find_candidates(BodyIndex a, BodyIndex b);
  [[nodiscard]] EdgeFaceLaw law_of(BodyIndex edges, BodyIndex faces) const;
  [[nodiscard]] std::int32_t pair_number(BodyIndex a, BodyIndex b) const;
  void find_largest_force();
  [[nodiscard]] bool are_neighbours(int edge, int face) const;
  void add_plateaus();
  [[nodiscard]] Vec2 normal_force(int vertex) const;
  [[nodiscard]] Vec2 force(int vertex) const;
  [[nodiscard]] OutlineState state() const { return {slopes_, edge_faces(), plateaus_}; }

  const Outlines& outlines_;
  double thickness_;
  const PairTable& table_;
  OutlineSlopes slopes_;
  Threads threads_;
  std::optional<OutlineFriction> friction_;  // only where there is friction or damping
  std::vector<EdgeFace> candidates_;
  std::vector<EdgeFaceLaw> laws_;  // of these
  /// Two bodies, the lower number first, and the normal force on that one, N.
  struct PairForce {
    BoxPair bodies;
    Vec2 force;
  };
  std::vector<PairForce> pair_forces_;  // ascending
  PairPeak largest_force_;
  std::vector<int> near_edges_, near_faces_;
  EdgeFaceBlocks blocks_;  // of the candidates
  /// What a thread finds, and its forces on edges that other threads have forces for as well.
  struct Worker {
    EdgeFaceCrossings crossings;
    std::vector<std::pair<std::int32_t, EndForces>> late;
  };
  std::vector<Worker> workers_;
  mutable std::vector<EdgeFaceContact> edge_faces_;  // if they have been asked for
  mutable bool listed_ = false;                      // whether they have
  std::vector<EndForces> ends_;  // force of each edge on its two ends, along its inward normal, N
  OutlinePlateaus plateaus_;
  OutlineDepths depths_;
  OutlineOnset onset_;
};

}  // namespace apothem
