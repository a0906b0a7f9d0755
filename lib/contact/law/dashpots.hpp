// All dashpots of a step (docs/theory.md, Dashpots).
//
// A contact of any two surfaces has one direction in the coordinates along its normal and one along
// its tangent: g.v is the rate at which its two sides move against each other, and the impulse J on
// them changes v by W J g, with the inverse masses W. A dashpot of the coefficient c gives
//
//   J = -c h [theta g.v1 + (1 - theta) g.v0],   theta = max(1/2, 1 - 1/x),
//   x = sum over the coordinates q of W_q |g_q| sum over all contacts j of c_j h |g_jq|,
//
// over a step of h from the velocities v0 half a step before to v1 half a step behind: the midpoint
// rule where it bears it, and beyond no more than what brings the two sides to rest. x is the part
// of the rate that all dashpots at these bodies would take at v0. The dashpots of all contacts are
// solved for together, one after the other forwards and backwards, until they
// agree. This takes energy with any coefficient, step and masses, and however often it is done: the
// step needs no bound for it. g vanishes in rigid motion, so that momenta are kept.
//
// A contact does not pull: J >= -N h along the normal with the elastic force N. Along the tangent
// the friction spring and the dashpot beside it together stay within Coulomb's limit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// A contact with dashpots. Forces act on the body a, along the normal or the tangent (-n_y, n_x).
struct Dashpot {
  BodyIndex a, b;
  Vec2 normal;  ///< unit vector
  /// Of one dashpot along the normal, or of two at different places of the contact.
  struct Normal {
    double rate = 0;     ///< coefficient, N s/m
    double pressed = 0;  ///< elastic normal force there, N
    double depth = 0;    ///< over which that has risen from nothing, m
    double mean = 1;     ///< of the coefficient over this depth, as a part of it
    /// `stiffness` there, N/m; `deepest`: of the whole contact, m.
    static Normal of(double rate, double pressed, double stiffness, double deepest);
  };
  std::array<Normal, 2> across;
  double tangential_rate = 0;  ///< coefficient along the tangent, N s/m
  double spring = 0;           ///< force of the friction spring, N
  double coefficient = 0;      ///< of friction
};

/// Coefficient of a dashpot over the stiffness `k` (N/m) of the spring beside it, s: `value`, or,
/// if this is a ratio of critical damping, 2 value/omega for two bodies that a force of 1 N
/// accelerates by `mobility` (1/kg) against each other. 0 where nothing can move.
double dashpot_time(double value, bool is_time, double k, double mobility);

class Dashpots {
 public:
  /// What moves the bodies, of every coordinate in the order of a state.
  struct Motion {
    std::span<const double> inverse_mass;  ///< 1/kg and 1/(kg m^2); 0 where forces cannot move it
    std::span<const double> velocity;      ///< half a step before
    /// All other forces in the second half of the step before and in the first half of the next, N.
    std::span<const double> before, after;
    std::span<const double> weight;  ///< of gravity, besides; may be empty
    /// Bodies that are steered, so that their inverse masses above are 0, but give way along a
    /// direction: servo walls.
    struct Rail {
      RigidIndex body;
      Vec2 direction;       ///< of unit length
      double inverse_mass;  ///< along it, 1/kg
      double gain;          ///< of the speed along it in this step by all other forces, m/s
    };
    std::span<const Rail> rails = {};
  };

  explicit Dashpots(int rigid_bodies) : nodes_(3 * static_cast<size_t>(rigid_bodies)) {}

  /// The contacts of a step are added anew, always in the same order.
  void clear();
  /// Begins a contact, whose coordinates follow.
  void add(const Dashpot& dashpot) {
    dashpots_.push_back(dashpot);
    solved_.push_back({.first = static_cast<std::uint32_t>(entries_.size()), .along = {}});
  }
  /// How the velocity of a node, or of a rigid body, counts in the rates of the last contact: along
  /// the normal at both places, and along the tangent. Vectors for a node; for a body a force acts
  /// on it at these places relative to its mass centre, `sign` times as on a. Both may come several
  /// times.
  void add_node(NodeIndex node, const Vec2& normal, const Vec2& tangential);
  void add_rigid(RigidIndex body, double sign, const std::array<Vec2, 2>& normal_at,
                 const Vec2& tangential_at);
  /// A point of a rigid body at `arm` counts by vectors as a node does.
  void add_point(RigidIndex body, const Vec2& arm, const Vec2& normal, const Vec2& tangential);

  /// Finds the forces of a step of dt (s).
  void solve(const Motion& motion, double dt);

  [[nodiscard]] size_t size() const { return dashpots_.size(); }
  [[nodiscard]] const Dashpot& operator[](size_t i) const { return dashpots_[i]; }
  /// On a, N: along the normal, and along the tangent.
  [[nodiscard]] double normal_force(size_t i) const {
    return (solved_[i].along[0].impulse + solved_[i].along[1].impulse) / dt_;
  }
  [[nodiscard]] double tangential_force(size_t i) const {
    return solved_[i].along[2].impulse / dt_;
  }
  [[nodiscard]] Vec2 force_on_a(size_t i) const;
  /// Adds the forces on the first coordinates, as many as there are, N and N m.
  void add_forces(std::span<double> to) const;
  /// What they take from the bodies, J: in the second half of the last step, and in the first half
  /// of the next one, whose velocities these are.
  [[nodiscard]] double lost_before() const { return lost_; }
  [[nodiscard]] double lost_after(std::span<const double> velocity, double dt) const;

  void fields(Archive& archive) {
    if (archive.loads()) clear();
    archive("moved", moved_)("gain", gain_);
  }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  // A coordinate that dashpots move.
  struct Moved {
    std::uint32_t coordinate = 0;
    std::uint32_t end = 0;  // behind its last entries, and those of the coordinates next to it
    double kick = 0;        // by all other forces over this step
    double reach = 0;       // of its dashpots together: impulse per velocity, N s/(m/s)
    double force = 0;

    // What the ledger needs of the step before.
    void fields(Archive& archive) { archive("coordinate", coordinate)("force", force); }
  };
  struct Moving {
    double inverse_mass, velocity;  // half a step behind, with the impulses so far
  };
  using Parts = std::array<double, 3>;
  // How such a coordinate counts in the three rates of a contact.
  struct Entry {
    std::uint32_t moved;
    Parts part;
  };
  // Of one of these rates. An impulse becomes kept times itself, less gain times the rate half a
  // step behind, less offset.
  struct Along {
    double kept = 0, gain = 0, offset = 0;
    double impulse = 0;  // N s
  };
  // What is found of a contact.
  struct Solved {
    std::uint32_t first;               // of its entries
    std::array<Along, 3> along;        // along the normal at both places, and along the tangent
    double d01 = 0, d02 = 0, d12 = 0;  // what an impulse along one does to another rate, 1/kg
  };
  std::uint32_t find(size_t first, size_t count);
  template <size_t count>
  void add(size_t first, const std::array<Parts, count>& parts);
  void put_on(const Motion::Rail& rail);
  [[nodiscard]] std::span<const Entry> entries(size_t i) const;
  void find_kicks(const Motion& motion, double dt);
  void find_rates(double dt);
  void find_gains();
  double relax(size_t i, double dt);
  void sum_forces(const Motion& motion, double dt);

  size_t nodes_;  // the first coordinate of a node
  std::vector<Dashpot> dashpots_;
  std::vector<Solved> solved_;
  std::vector<Entry> entries_;
  std::vector<Moved> moved_;             // in the order in which they were first added
  std::vector<Moving> moving_;           // the same
  std::vector<std::uint32_t> index_;     // of every coordinate in this list, or kNone
  std::vector<Entry> across_rails_;      // what entries of bodies on rails have lost
  std::vector<std::uint32_t> of_these_;  // the contacts of those
  double lost_ = 0;                      // J
  double gain_ = 0;  // of their power, in a half of the first half of the next step, W
  double dt_ = 1;
};

}  // namespace apothem
