// Contact of deformable bodies with each other and with rigid bodies. The nodal forces are the
// gradient of an energy, which follows from the collars of the deformed outlines (docs/theory.md,
// Contact).
//
//   E = k_n SUM over pairs of bodies  INT over the overlap  (h_a/r_a + h_b/r_b) dA
//
// with the depth h below the surface of each body, which is limited to the depth of its collar. A
// body that may touch itself is a pair with itself, whose overlap is where the body lies twice.
// Every term is a sum over pairs of an edge of one outline and a face of the other one's collar,
// and over the edges and faces inside saturated regions. Only the vertices of the outlines get
// forces.
#pragma once

#include <optional>
#include <vector>

#include "lib/contact/kernel.hpp"
#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/mesh/edge_face_pack.hpp"
#include "lib/contact/mesh/outline_depths.hpp"
#include "lib/contact/mesh/outline_events.hpp"
#include "lib/contact/mesh/outline_friction.hpp"
#include "lib/contact/mesh/outline_records.hpp"
#include "lib/contact/mesh/outline_slopes.hpp"
#include "lib/contact/mesh/saturated_regions.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class OutlineKernel final : public Kernel {
 public:
  /// `thickness` is in m. All arguments must outlive this object.
  OutlineKernel(const Surfaces& surfaces, double thickness, const PairTable& table, int threads);

  void set_pairs(std::span<const BoxPair> pairs) override;
  /// The contacts are first those of edges with faces, then those of edges in saturated regions,
  /// then those of faces whose saturated region lies in another body.
  void evaluate() override;
  [[nodiscard]] ContactSummary summary() const override;
  void visit_contacts(double least, const ContactVisitor& visit) const override;
  [[nodiscard]] double penetration(const Contact& contact, double floor) override;
  double update_friction(const Kinematics& now, double dt, FrictionMemory& memory) override;
  void undo_friction() override {
    if (friction_) friction_->undo_friction();
  }
  void add_forces(const ForceViews& forces) override;
  void add_dashpots(const Kinematics& now, Dashpots& dashpots) override {
    if (friction_) friction_->add_dashpots(blocks_, now, dashpots);
  }
  void keep_pushes(const Dashpots& dashpots, size_t& next, FrictionMemory& memory) override {
    listed_ = false;
    if (friction_) friction_->keep_pushes(blocks_, dashpots, next, memory);
  }
  bool find_event_impulses(const Kinematics& now, const Dynamics& dynamics, double dt,
                           FrictionMemory& /*memory*/) override {
    return events_.find(candidates_, blocks_, saturated_, now, dynamics, dt);
  }
  void add_event_impulses(double scale, const ForceViews& forces) const override {
    events_.add(scale, forces);
  }
  void fields(Archive& archive) override { archive("outline_onset", events_); }

  [[nodiscard]] PairPeak largest_force() const override { return largest_force_; }
  [[nodiscard]] double energy() const override;
  /// The largest 2 k (1/r_c + 1/r_t) l_i/m_i of a boundary node (docs/theory.md, Step) for nodes
  /// with these masses in kg (0 where a support fixes the node). The outlines must have been
  /// placed.
  [[nodiscard]] double rate(std::span<const double> node_mass) const override;
  void add_stiffness(std::span<double> nodes, std::span<double> rigid) const override;
  [[nodiscard]] size_t candidates() const override { return candidates_.size(); }
  [[nodiscard]] Vec2 force_on(BodyIndex body) const override { return resultant(body).force; }
  bool add_tangent(size_t first_node, Tangent& tangent) const override;
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
  void add_saturated();
  [[nodiscard]] Vec2 normal_force(int vertex) const;
  [[nodiscard]] Vec2 force(int vertex) const;
  [[nodiscard]] OutlineState state() const { return {slopes_, edge_faces(), saturated_}; }

  const OutlineSurfaces& outlines_;
  double thickness_;
  const PairTable& table_;
  OutlineSlopes slopes_;
  Threads threads_;
  std::optional<OutlineFriction> friction_;  // empty without friction and damping
  std::vector<EdgeFace> candidates_;
  std::vector<EdgeFaceLaw> laws_;  // laws of the candidates
  /// Two bodies, the one with the lower number first, and the normal force on that one, N.
  struct BodyPairForce {
    BoxPair bodies;
    Vec2 force;
  };
  std::vector<BodyPairForce> pair_forces_;  // one entry per pair, ascending
  PairPeak largest_force_;
  std::vector<int> near_edges_, near_faces_;
  EdgeFaceBlocks blocks_;  // the candidates in blocks
  /// The results of a thread. Its forces on edges that other threads work on as well are deferred.
  struct EvaluationWorkspace {
    EdgeFaceCrossings crossings;
    std::vector<std::pair<std::int32_t, EndForces>> deferred;
  };
  std::vector<EvaluationWorkspace> workers_;
  mutable std::vector<EdgeFaceContact> edge_faces_;  // contacts, found when they are asked for
  mutable bool listed_ = false;                      // true if edge_faces_ is up to date
  std::vector<EndForces> ends_;  // forces on the two ends of each edge, along its inward normal, N
  SaturatedRegions saturated_;
  OutlineDepths depths_;
  OutlineEvents events_;
};

}  // namespace apothem
