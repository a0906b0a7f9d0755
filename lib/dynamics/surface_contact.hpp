// Contact of bodies with a mesh: with each other and with rigid bodies. Bodies are numbered rigid
// ones first.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "apothem/contact/deformable_friction.hpp"
#include "apothem/contact/element_friction.hpp"
#include "apothem/dynamics/time_step.hpp"
#include "apothem/model/model.hpp"
#include "apothem/model/state.hpp"

namespace apothem {

class SurfaceContact {
 public:
  SurfaceContact(const Model& model, const State& state, int threads);
  /// True if a body with a mesh can touch another body.
  static bool needed(const Model& model);

  /// Bound of the contacts' frequencies, 1/s: that of the boundary nodes (theory: Sec. 5.4) and of
  /// rigid bodies that lie flat on a mesh. `node_mass` in kg, 0 where held.
  [[nodiscard]] double rate(std::span<const double> node_mass) const;

  /// Adds the same bound as a stiffness of each node that is near another body, N/m.
  void add_stiffness(std::span<double> node_stiffness) const {
    std::visit([&](const auto& s) { s.contact.add_stiffness(node_stiffness); }, surface_);
  }

  /// Forces where the bodies are now. Throws Unstable where they are out of the method's range:
  /// deeper than the collar, or a body in contact with itself.
  void evaluate(const State& state);
  /// Friction of a step that ends here, with its half-step velocities.
  void slide(const State& state, double dt);

  void add_to_nodes(std::vector<double>& node_force) const;
  void add_to_bodies(std::vector<double>& force) const;

  /// Of contacts and friction springs, J.
  [[nodiscard]] double energy() const;
  [[nodiscard]] double friction_loss() const;
  [[nodiscard]] double penetration() const;
  /// The bodies of the deepest contact.
  [[nodiscard]] std::pair<int, int> deepest() const;
  [[nodiscard]] int searches() const;
  /// Has the next evaluation search anew.
  void forget_search() {
    std::visit([](auto& s) { s.contact.forget_search(); }, surface_);
  }
  [[nodiscard]] size_t candidates() const;
  [[nodiscard]] size_t touching() const;

  /// What acts on a deformable body from contacts.
  [[nodiscard]] BodyForce on_deformable(int deformable) const;
  [[nodiscard]] std::vector<ContactRecord> records() const;
  [[nodiscard]] std::vector<SurfaceRecord> surfaces() const;

  [[nodiscard]] SlipMemory memory() const;
  void restore(const SlipMemory& memory, const State& state);

 private:
  template <class C, class F>
  struct Rubbing {
    C contact;
    std::optional<F> friction = {};
  };
  using ByBody = Rubbing<DeformableContact, DeformableFriction>;
  using ByElement = Rubbing<ElementContact, ElementFriction>;
  using Surface = std::variant<ByBody, ByElement>;
  static Surface make_surface(const Model& model, int threads);
  void add_friction();
  void find_buried(const State& state) const;
  void refresh(const State& state);
  [[nodiscard]] const std::string& name(int body) const;
  [[nodiscard]] DeformableContact::Resultant sum(int body) const;
  [[nodiscard]] double remembered(double SlipMemory::*value) const;
  void guard(const DeformableContact& contact, const State& state) const;
  void guard(const ElementContact& contact, const State& state) const;
  [[nodiscard]] std::string at(const Vec2& place, const State& state) const;

  const Model& model_;
  Surface surface_;
};

}  // namespace apothem
