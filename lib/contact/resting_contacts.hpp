// The contacts of rigid bodies that rest: with each other, and with bodies that cannot move.
//
// Nothing moves there, so that these contacts are evaluated once. Until a body moves again their
// forces, energies and friction springs stay what they are.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/rigid/polygon_kernel.hpp"

namespace apothem {

class RestingContacts {
 public:
  /// As PolygonKernel.
  RestingContacts(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                  double thickness);
  RestingContacts(const RestingContacts&) = delete;
  RestingContacts& operator=(const RestingContacts&) = delete;

  /// True if the contacts of two surfaces belong here.
  [[nodiscard]] bool has(SurfaceIndex a, SurfaceIndex b) const {
    return is_still(a) && is_still(b);
  }
  /// After bodies have come to rest or begun to move: takes what belongs here from the memory of
  /// the other contacts, and gives back what does not.
  void exchange(FrictionMemory& others);
  /// Finds the contacts of those of the `near` pairs of surfaces that belong here, and their
  /// forces.
  void evaluate(std::span<const BoxPair> near, const Kinematics& now);
  /// Adds the forces on rigid bodies, N and N m.
  void add_forces(std::span<double> rigid) const;

  /// One record for each contact patch, in ascending order of the pairs of bodies.
  [[nodiscard]] const std::vector<ContactRecord>& records();

  [[nodiscard]] const PolygonKernel& kernel() const { return kernel_; }
  [[nodiscard]] const FrictionMemory& memory() const { return memory_; }
  [[nodiscard]] double energy() const { return energy_; }

  void fields(Archive& archive) { archive("friction", memory_); }

 private:
  [[nodiscard]] bool is_still(SurfaceIndex i) const {
    return surfaces_.is_rigid(i) && (surfaces_.is_resting(i) || !surfaces_.responsive(i));
  }

  const Surfaces& surfaces_;
  FrictionMemory memory_;
  PolygonKernel kernel_;
  struct Force {
    size_t coordinate;
    double value;  // N or N m
  };
  std::vector<Force> forces_;
  double energy_ = 0;                                  // J
  std::optional<std::vector<ContactRecord>> records_;  // empty until they are asked for
};

}  // namespace apothem
