// Friction and contact damping: the forces beside the normal ones. They need a memory from step to
// step, one per connected contact patch, and only scenes that ask for them have one (theory: Sec.
// 3).
#pragma once

#include <vector>

#include "apothem/contact/law.hpp"
#include "apothem/contact/placed_shapes.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"
#include "apothem/geometry/spatial/boxes.hpp"

namespace apothem {

/// A normal force that is so much smaller than the pressures it is the sum of has no direction
/// worth following.
inline constexpr double kNoResultant = 1e-9;

/// Along which friction acts: (-n_y, n_x), n the direction of the normal force; zero if there is
/// none.
inline Vec2 tangent_of(const Vec2& normal_force) {
  const double size = normal_force.norm();
  return size > 0 ? Vec2(Vec2(-normal_force.y(), normal_force.x()) / size) : Vec2(Vec2::Zero());
}

/// What a patch remembers. Forces are on the pair's first body.
struct PatchMemory {
  double spring = 0;            ///< tangential force along `tangent`, N (Eqs. 11-14)
  Vec2 tangent = Vec2::Zero();  ///< tangent_of the normal force
  Vec2 normal = Vec2::Zero();   ///< elastic normal force, N
  double moment_a = 0;          ///< of it, N m
  double moment_b = 0;          ///< N m
  Vec2 damping = Vec2::Zero();  ///< damping force, N
  double damping_a = 0;         ///< its moments, N m
  double damping_b = 0;
};

/// One spring of the per-edge law (Eq. 9): along a part of an edge's boundary.
struct EdgeSpring {
  bool of_a;
  int edge;
  double spring;  ///< N, along the edge
};

struct PairMemory {
  BoxPair pair;
  int patches;  ///< how many entries of each list are this pair's
  int runs;
  int springs;
};

/// Everything that tangential contact carries from one step to the next.
struct TangentialMemory {
  std::vector<PairMemory> pairs;  ///< ascending
  std::vector<PatchMemory> patches;
  std::vector<BoundaryRun> runs;  ///< of pairs that are not both convex
  std::vector<EdgeSpring> springs;
  double energy = 0;         ///< of the springs, J
  double friction_loss = 0;  ///< J since time 0
  double damping_loss = 0;   ///< J since time 0

  void clear() {
    pairs.clear();
    patches.clear();
    runs.clear();
    springs.clear();
  }
};

/// Friction and damping of one pair, in N and N m; moments about the mass centres.
struct TangentialForce {
  int pair;                   ///< index in the list of pairs
  Vec2 force = Vec2::Zero();  ///< on the first body
  double moment_a = 0;
  double moment_b = 0;
  double stiffness = 0;  ///< of the springs, N/m
  double arm = 0;        ///< largest lever of a spring about either mass centre, m
};

class TangentialContact {
 public:
  /// `material[i]` of body i, `inverse_mass[i]` its 1/m, 1/m, 1/I (0 where it cannot move);
  /// thickness in m.
  TangentialContact(const ContactLaw& law, double thickness, std::vector<int> material,
                    std::vector<std::array<double, 3>> inverse_mass);

  /// True if a scene with this law needs tangential contact at all.
  static bool needed(const ContactLaw& law);

  /// One step further: `position` and half-step `velocity` (Eq. 18: the full-step one would pump
  /// energy in) as in State, and the normal contact of the pairs.
  void update(const PlacedShapes& shapes, const std::vector<double>& position,
              const std::vector<double>& velocity, double dt, const std::vector<BoxPair>& pairs,
              const std::vector<PairIntegral>& integrals);

  /// Of the touching pairs with friction or damping, ascending.
  [[nodiscard]] const std::vector<TangentialForce>& forces() const { return forces_; }
  /// The sizes of the friction forces on each of so many bodies, summed over its springs, N.
  [[nodiscard]] std::vector<double> friction(size_t bodies) const;
  /// Elastic energy of the springs, J.
  [[nodiscard]] double energy() const { return now_.energy; }
  [[nodiscard]] const TangentialMemory& memory() const { return now_; }
  void restore(const TangentialMemory& memory) { now_ = memory; }
  /// What has been lost so far does not count.
  void start_ledger() { now_.friction_loss = now_.damping_loss = 0; }

 private:
  struct Motion {
    Vec2 velocity_a, velocity_b;  // of the mass centres
    double spin_a, spin_b;
    Vec2 between;  // mass centre of a minus that of b
    // Of a's material against b's at a point relative to a's mass centre.
    [[nodiscard]] Vec2 slip(const Vec2& point) const {
      return velocity_a + cross(spin_a, point) - velocity_b - cross(spin_b, point + between);
    }
  };
  struct Place {
    size_t pair, patch, run, spring;
  };

  [[nodiscard]] Friction friction_of(int a, int b) const;
  void step_pair(int p, const BoxPair& pair, const PlacedShapes& shapes, const Motion& motion,
                 double dt, const PairIntegral& integral, const PairMemory* before,
                 const Place& place);
  void inherit(const PairMemory* before, const Place& place, double stiffness);
  /// `force_error`: of the patch's normal force, m.
  void resultant(const PairIntegral& patch, const Motion& motion, double dt,
                 const Friction& friction, double force_error, PatchMemory& memory,
                 TangentialForce& total);
  void per_edge(const Motion& motion, double dt, const Friction& friction, const PairMemory* before,
                const Place& place, TangentialForce& total);
  void damp(int a, int b, const PlacedShapes& shapes, const PairIntegral& patch,
            const Motion& motion, double dt, PatchMemory& memory, TangentialForce& total);
  void release(const PairMemory& pair, const Place& place);
  /// New spring force after a slip, clamped by Coulomb's law; books energy and loss.
  double slide(double spring, double slip, double limit, double stiffness);

  const ContactLaw law_;
  double thickness_;
  std::vector<int> material_;
  std::vector<std::array<double, 3>> inverse_mass_;
  TangentialMemory now_, before_;
  std::vector<TangentialForce> forces_;
  // Of the pair at hand; kept for their memory.
  PatchWorkspace workspace_;
  std::vector<BoundaryRun> runs_;
  std::vector<PairIntegral> patches_;
  std::vector<PatchMemory> inherited_;
  std::vector<double> shared_;
};

}  // namespace apothem
