// Contact of rigid bodies by the potentials of their whole polygons.
#pragma once

#include <optional>
#include <vector>

#include "geometry/integrals/penetration.hpp"
#include "lib/contact/kernel.hpp"
#include "lib/contact/rigid/body_loads.hpp"
#include "lib/contact/rigid/pair_batch.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"
#include "lib/contact/rigid/patch_tangential.hpp"
#include "lib/contact/rigid/polygon_events.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

class PolygonKernel final : public Kernel {
 public:
  /// `thickness` is in m. All arguments must outlive this object.
  PolygonKernel(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                FrictionMemory& memory, double thickness, int threads);

  void set_pairs(std::span<const BoxPair> pairs) override;
  void evaluate() override;
  [[nodiscard]] ContactSummary summary() const override { return summary_; }
  void visit_contacts(double least, const ContactVisitor& visit) const override;
  [[nodiscard]] double penetration(const Contact& contact, double floor) override;
  [[nodiscard]] ContactFault fault(const Contact& contact) const override;
  double update_friction(const Kinematics& now, double dt, FrictionMemory& memory) override;
  /// Nothing is to be done: all that the next update needs is in the memory.
  void refresh(const Kinematics& /*now*/, FrictionMemory& /*memory*/) override {}
  void add_forces(const ForceViews& forces) override;
  void add_dashpots(const Kinematics& now, Dashpots& dashpots) override;
  void keep_pushes(const Dashpots& dashpots, size_t& next, FrictionMemory& memory) override;
  bool find_event_impulses(const Kinematics& now, const Dynamics& dynamics, double dt,
                           FrictionMemory& memory) override {
    const bool found =
        events_.find(pairs_, tangential_ ? &*tangential_ : nullptr, now, dynamics, dt);
    if (found) memory.lose(events_.loss());
    return found;
  }
  void add_event_impulses(double scale, const ForceViews& forces) const override {
    events_.add(scale, forces.rigid);
  }
  [[nodiscard]] PairPeak largest_force() const override { return largest_force_; }

  [[nodiscard]] double energy() const override { return thickness_ * pairs_.energy(table_); }
  [[nodiscard]] size_t candidates() const override { return pairs_.candidates(); }
  bool add_tangent(size_t first_node, Tangent& tangent) const override;
  void add_force_sizes(std::span<double> of_bodies) const override;
  void add_records(std::vector<ContactRecord>& records) const override;
  void fields(Archive& archive) override {
    archive("onset", events_);
    if (table_.damped()) archive("pushes", pushes_)("drags", drags_);
  }

 private:
  template <class F>
  void each_patch(const F& f) const;
  /// k_n times the thickness, N/m.
  [[nodiscard]] double stiffness(RigidIndex a, RigidIndex b) const {
    return table_.between(a, b).normal_stiffness * thickness_;
  }
  // The results of one thread.
  struct Found {
    ContactSummary summary;
    PairPeak largest_force;
    PairBatch batch;
    std::vector<PairLoad> loads;
  };
  [[nodiscard]] Contact contact_of(const PairInTouch& pair) const;
  template <class Part>
  void sum_loads(const Part& part);
  void find_normal_loads(int first, int end, int worker);
  void add_block(std::span<const PairLoad> loads, int worker);

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;  // m
  PairIntegrals pairs_;
  PolygonEvents events_;
  std::optional<PatchTangential> tangential_;  // empty without friction
  Threads threads_;
  std::vector<Found> found_;  // results of each thread
  BodyLoads loads_;
  ContactSummary summary_;
  PairPeak largest_force_;
  // Memory for penetrations.
  PatchWorkspace patch_workspace_;
  PenetrationWorkspace penetration_workspace_;
  std::vector<BoundarySegment> segments_;
  std::vector<PairIntegral> patches_;
  std::vector<double> deepest_;  // penetration of each patch, m
  std::vector<char> damped_;     // for each patch of damped pairs, whether it has dashpots
  // Forces of the dashpots of these patches along the normal and along the tangent, N.
  std::vector<double> pushes_, drags_;
};

}  // namespace apothem
