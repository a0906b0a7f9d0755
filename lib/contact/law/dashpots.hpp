// All dashpots of a step (docs/theory.md, Dashpots).
//
// A contact of any two surfaces has one direction g in the space of all coordinates along its
// normal, and one along its tangent: g.v is the rate at which its two sides move relative to each
// other, and an impulse J on them changes v by W J g, with the inverse masses W. A dashpot with the
// coefficient c gives
//
//   J = -c h [theta g.v1 + (1 - theta) g.v0],   theta = max(1/2, 1 - 1/x),
//   x = sum over the coordinates q of W_q |g_q| sum over all contacts j of c_j h |g_jq|,
//
// over a step of h, where v0 and v1 are the velocities half a step before and after. This is the
// midpoint rule where that is stable; beyond, theta is just large enough that the two sides come to
// rest. x is the fraction of the rate that all dashpots at these bodies would remove at v0. The
// dashpots of all contacts are solved together, one after the other, forwards and backwards, until
// they agree. Energy is removed for any coefficient, step and masses, and for any number of sweeps,
// so dashpots do not limit the step. g vanishes in rigid motion, so that momenta are conserved.
//
// A contact does not pull at any of its points. Those that are less deep than the time c/K times
// the rate at which the sides part have no pressure, and the dashpot takes less there
// (Normal::push). Along the tangent the friction spring and the dashpot beside it together stay
// within Coulomb's limit.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// A contact with dashpots. Forces act on the body a along the normal or along the tangent (-n_y,
/// n_x).
struct Dashpot {
  BodyIndex a, b;
  Vec2 normal;  ///< unit vector
  /// A dashpot along the normal. A contact has one, or two at different points.
  struct Normal {
    double rate = 0;     ///< coefficient, N s/m
    double pressed = 0;  ///< elastic normal force at its point, N
    double depth = 0;    ///< depth over which this force has risen from zero, m
    double power = 1;    ///< power of the depth with which it has risen: 1 if flat, 2 at a corner
    // The depths of its points: a part `level` of them has the depth above, and those of the others
    // are spread evenly between this and the fraction `least` of it.
    double level = 0, least = 1;
    /// The dashpot of a part of a contact with the contact stiffness `stiffness`, N/m. `deepest` is
    /// the largest depth of the part, m. If not all of its points are so deep, the fraction
    /// `plateau` says how many are: none with 0, and with 1 as many as can be if the others begin
    /// at the surface.
    static Normal of(double rate, double pressed, double stiffness, double deepest,
                     double plateau = 0);
    /// The impulse, N s, if none of its points pulls. It is `free` if they could, and `elastic` is
    /// that of `pressed`. `kept` is the fraction of an impulse on the dashpot that it takes back.
    [[nodiscard]] double push(double free, double elastic, double kept) const;
  };
  std::array<Normal, 2> across;
  double tangential_rate = 0;  ///< coefficient along the tangent, N s/m
  double spring = 0;           ///< force of the friction spring, N
  FrictionLimit<double> limit = {};
};

/// The coefficient of a dashpot over the stiffness `k` (N/m) of the spring beside it, s. This is
/// `value` if `value` is a time. If it is a ratio of critical damping, the result is 2 value/omega
/// for two bodies that a force of 1 N accelerates relative to each other by `mobility` (1/kg), and
/// 0 if nothing can move.
double dashpot_time(double value, bool is_time, double k, double mobility);

class Dashpots {
 public:
  /// Velocities and forces of every coordinate, in the order of a state.
  struct Motion {
    /// 1/kg and 1/(kg m^2); 0 where forces cannot move the coordinate.
    std::span<const double> inverse_mass;
    std::span<const double> velocity;  ///< velocities half a step before
    /// All forces except those of dashpots, in the second half of the last step and in the first
    /// half of the next one, N.
    std::span<const double> before, after;
    std::span<const double> weight;  ///< weight, in addition to these forces; may be empty
    /// A body with prescribed motion, so that its inverse mass above is 0, that yields along one
    /// direction: a servo wall.
    struct Rail {
      RigidIndex body;
      Vec2 direction;       ///< unit vector
      double inverse_mass;  ///< inverse mass along the direction, 1/kg
      /// Change of the speed along the direction in this step by all other forces, m/s.
      double gain;
    };
    std::span<const Rail> rails = {};
  };

  explicit Dashpots(int rigid_bodies) : nodes_(3 * static_cast<size_t>(rigid_bodies)) {}

  /// Removes all contacts. Every step adds its contacts again, always in the same order.
  void clear();
  /// Adds a contact. The coordinates that belong to it are added next.
  void add(const Dashpot& dashpot) {
    dashpots_.push_back(dashpot);
    solved_.push_back({.first = static_cast<std::uint32_t>(entries_.size()), .along = {}});
  }
  /// Adds the contribution of a node, or of a rigid body, to the rates of the last contact, along
  /// the normal at both points and along the tangent. A node contributes by its coefficient
  /// vectors. For a body a force acts at these points relative to its mass centre, with the sign
  /// `sign` relative to the body a. Both functions may be called several times per contact.
  void add_node(NodeIndex node, const Vec2& normal, const Vec2& tangential);
  void add_rigid(RigidIndex body, double sign, const std::array<Vec2, 2>& normal_at,
                 const Vec2& tangential_at);
  /// Adds a point of a rigid body at `arm` from its mass centre, m, by coefficient vectors as for a
  /// node.
  void add_point(RigidIndex body, const Vec2& arm, const Vec2& normal, const Vec2& tangential);

  /// Finds the forces of a step of dt (s).
  void solve(const Motion& motion, double dt);

  [[nodiscard]] size_t size() const { return dashpots_.size(); }
  [[nodiscard]] const Dashpot& operator[](size_t i) const { return dashpots_[i]; }
  /// The forces on body a along the normal and along the tangent, N.
  [[nodiscard]] double normal_force(size_t i) const {
    return (solved_[i].along[0].impulse + solved_[i].along[1].impulse) / dt_;
  }
  [[nodiscard]] double tangential_force(size_t i) const {
    return solved_[i].along[2].impulse / dt_;
  }
  [[nodiscard]] Vec2 force_on_a(size_t i) const;
  /// Adds the dashpot forces to the first forces.size() coordinates, N and N m.
  void add_forces(std::span<double> forces) const;
  /// The energy that the dashpots remove from the bodies, J: in the second half of the last step,
  /// and in the first half of the next one with the velocities `velocity`.
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
    std::uint32_t end = 0;  // index after its last entries and those of the adjacent coordinates
    double kick = 0;        // change of velocity by all other forces over this step
    double reach = 0;       // impulse per velocity of all its dashpots together, N s/(m/s)
    double force = 0;

    // The ledger needs these values of the step before.
    void fields(Archive& archive) { archive("coordinate", coordinate)("force", force); }
  };
  struct Moving {
    // Velocity half a step later, including the impulses found so far.
    double inverse_mass, velocity;
  };
  using Parts = std::array<double, 3>;
  // The contributions of a coordinate to the three rates of a contact.
  struct Entry {
    std::uint32_t moved;
    Parts part;
  };
  // The update of one of these rates: the new impulse is kept times the impulse, minus gain times
  // the rate half a step later, minus offset.
  struct Along {
    double kept = 0, gain = 0, offset = 0;
    double impulse = 0;  // N s
  };
  // The solution for a contact.
  struct Solved {
    std::uint32_t first;               // index of its first entry
    std::array<Along, 3> along;        // along the normal at both points, and along the tangent
    double d01 = 0, d02 = 0, d12 = 0;  // change of one rate by an impulse along another one, 1/kg
    double slip = 0;                   // rate along the tangent half a step before, m/s
  };
  std::uint32_t find(size_t first, size_t count);
  template <size_t count>
  void add(size_t first, const std::array<Parts, count>& parts);
  void put_on(const Motion::Rail& rail);
  // The largest change and the largest normal impulse in a pass over contacts, N s.
  struct Pass {
    double change = 0, largest = 0;
  };
  [[nodiscard]] std::span<const Entry> entries(size_t i) const;
  void find_kicks(const Motion& motion, double dt);
  void find_rates(double dt);
  void find_gains();
  double relax(size_t i, double dt);
  Pass relax_all(bool forwards, double dt);
  void sum_forces(const Motion& motion, double dt);

  size_t nodes_;  // the first coordinate of a node
  std::vector<Dashpot> dashpots_;
  std::vector<Solved> solved_;
  std::vector<Entry> entries_;
  std::vector<Moved> moved_;             // coordinates in the order in which they were first added
  std::vector<Moving> moving_;           // the same coordinates while solving
  std::vector<std::uint32_t> index_;     // index of every coordinate in moved_, or kNone
  std::vector<Entry> across_rails_;      // parts of entries across the rails of bodies
  std::vector<std::uint32_t> of_these_;  // the contact of each of these parts
  double lost_ = 0;                      // J
  double gain_ = 0;  // contribution of their impulses to their own power in the next half step, W
  double dt_ = 1;
};

}  // namespace apothem
