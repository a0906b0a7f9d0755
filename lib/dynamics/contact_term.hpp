// All contact of a scene as a term: from the model to surfaces, from faults to messages.
#pragma once

#include <vector>

#include "lib/contact/contacts.hpp"
#include "lib/dynamics/results.hpp"
#include "lib/dynamics/stride_watch.hpp"
#include "lib/dynamics/term.hpp"
#include "lib/model/model.hpp"

namespace apothem {

class ContactTerm final : public Term {
 public:
  /// True if a force on a body could come from another body.
  static bool needed(const Model& model);
  /// True if a body with a mesh can touch another body.
  static bool touches_meshes(const Model& model);
  /// True if bodies with a mesh touch themselves as well.
  static bool touches_itself(const Model& model);
  /// Throws Unrunnable if elements cannot have potentials of their own, or a body with a mesh and
  /// another body are inside each other.
  ContactTerm(const Model& model, const DegreesOfFreedom& dofs, const State& state, int threads);

  [[nodiscard]] std::string describe() const override;
  /// Throws Unstable where bodies are out of the method's range.
  void add_forces(const Evaluation& evaluation) override;
  /// True if there is friction or damping: what they take on a path that bends within a step has to
  /// be booked.
  [[nodiscard]] bool dissipates() const { return contacts_.dissipates(); }
  /// After add_forces at the end of a drift of dt (s), with all forces at the start of the step as
  /// `before`: books what the trapezoid rule leaves out of the work of friction and damping.
  void add_bend_losses(const State& state, std::span<const double> before, double dt) {
    contacts_.add_bend_losses({dofs_.inverse_mass(), before, state.f, dofs_.weight()}, dt);
  }
  /// Likewise: finds the impulses that the two ends of the step do not tell of, because a contact
  /// has begun or ended in between. True if there is one.
  bool find_event_impulses(const State& state, std::span<const double> before, double dt) {
    return contacts_.find_event_impulses(
        state.kinematics(state.v), {dofs_.inverse_mass(), before, state.f, dofs_.weight()}, dt);
  }
  /// Adds these impulses as a force over the second half of the step.
  void add_event_impulses(State& state) const { add_event_impulses(state.layout, state.f); }
  [[nodiscard]] bool damped() const { return contacts_.damped(); }
  /// Adds the forces of dashpots, when all other ones in a step of dt (s) are known; `onsets`:
  /// there are such impulses. `first`: nothing has moved since the last look.
  void add_dashpots(State& state, double dt, bool onsets, bool first);
  void silence_dashpots(const State& state) {
    contacts_.silence_dashpots(state.kinematics(state.v));
  }
  /// Throws Unstable if bodies that meet have moved so far that contacts may have been missed.
  void check_drift(const State& state, double dt);
  void watch(const State& state) override;
  void add_energies(const State& /*state*/, Energies& energies) override {
    energies.contact += contacts_.energy();
  }
  void add_losses(double /*dt*/, Energies& energies) const override {
    energies.friction_loss += contacts_.friction_loss();
    energies.damping_loss += contacts_.damping_loss();
  }
  void start_ledger() override;
  void bound_step(StepBounds& bounds) override;

  void forget_search() { contacts_.forget_search(); }
  [[nodiscard]] std::int64_t searches() const { return contacts_.searches(); }
  bool add_tangent(const State& state, Tangent& tangent) const override {
    return contacts_.add_tangent(state.layout.node(0), tangent);
  }
  void add_stiffness(const State& /*state*/, NodeStiffness& stiffness) override {
    contacts_.add_stiffness(stiffness.contact, stiffness.rigid);
  }
  /// Contacts remember what they did before the states that were tried. The next refresh() keeps
  /// what was near something in the last of them as candidates.
  void drop_trial() {
    contacts_.drop_trial();
    contacts_.keep_search();
  }
  /// Contacts remember what they did in the last state that was tried.
  void keep_trial() { contacts_.keep_trial(); }
  /// Adds the sizes of the normal forces on each body, rigid ones first, N.
  void add_force_sizes(std::span<double> of_bodies) const { contacts_.add_force_sizes(of_bodies); }
  /// The resultant of what other bodies do to a deformable one, N.
  [[nodiscard]] Vec2 force_on(DeformableIndex body) const {
    return contacts_.force_on(contacts_.surfaces().rigid_count() + body);
  }
  void fields(Archive& archive) override;
  void refresh(const State& state) override { contacts_.refresh(state.kinematics(state.v)); }

  void set_absent(const std::vector<std::uint8_t>& absent) { contacts_.set_absent(absent); }

  /// See Contacts for these.
  void let_bodies_rest() { contacts_.let_bodies_rest(model_.contact, model_.thickness); }
  void set_resting(const std::vector<std::uint8_t>& resting, const State& state) {
    contacts_.set_resting(resting, state.kinematics(state.v));
  }
  void restore_resting(const std::vector<std::uint8_t>& resting) {
    contacts_.restore_resting(resting);
  }
  [[nodiscard]] bool disturbs_rest() const { return contacts_.disturbs_rest(); }

  /// See Simulation::inherit.
  void inherit(const FrictionMemory& memory) { contacts_.set_memory(memory); }

  /// What was wrong with the contact of a body with itself in one of the last looks, in words.
  [[nodiscard]] const std::string& closed_notch() const { return closed_notch_; }

  [[nodiscard]] const Contacts& contacts() const { return contacts_; }
  [[nodiscard]] const Peak& penetration() const { return penetration_; }
  [[nodiscard]] const Peak& relative_penetration() const { return relative_penetration_; }
  [[nodiscard]] const Peak& force() const { return force_; }
  [[nodiscard]] const ContactCounts& counts() const { return counts_; }

 private:
  static Surfaces surfaces_of(const Model& model, const DegreesOfFreedom& dofs);
  void add_event_impulses(const Layout& layout, std::vector<double>& forces) const {
    contacts_.add_event_impulses(2, {layout.of_rigid(forces), layout.of_nodes(forces), {}});
  }
  void refuse_engulfed(const State& state) const;
  [[nodiscard]] std::string describe_shallow_collars() const;
  [[noreturn]] void refuse(const ContactFault& fault, const State& state) const;
  void note_peaks(const State& state);
  void refuse_passage(const State& state);
  [[nodiscard]] const std::string& name(BodyIndex body) const { return model_.name_of(body); }

  const Model& model_;
  const DegreesOfFreedom& dofs_;
  Contacts contacts_;
  std::vector<double> inradius_;  // of each body, m
  double shortest_inradius_ = 0;  // of these, m
  StrideWatch strides_;
  std::vector<double> with_event_impulses_;    // all forces but those of dashpots
  std::vector<Dashpots::Motion::Rail> rails_;  // servo walls
  Peak penetration_, relative_penetration_, force_;
  ContactCounts counts_;
  std::string closed_notch_;
  int looks_without_notch_ = 0;  // since then
};

/// The smallest inradius of elements at the boundaries of all meshes, m.
double shortest_inradius(const Model& model);

}  // namespace apothem
