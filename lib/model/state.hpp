// What changes while a scene runs, and what is recorded of it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"
#include "lib/archive/archive.hpp"
#include "lib/contact/law/contact.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/fem/stress.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// Where the degrees of freedom stand in the vectors of a state: x, y and angle of each rigid body,
/// then x and y of each node.
struct Layout {
  int rigid_bodies = 0;
  int nodes = 0;

  [[nodiscard]] size_t size() const { return node(nodes); }
  /// The first of the three entries of a rigid body, and of the two entries of a node.
  [[nodiscard]] size_t rigid(RigidIndex i) const { return 3 * static_cast<size_t>(i); }
  [[nodiscard]] size_t node(NodeIndex i) const {
    return 3 * static_cast<size_t>(rigid_bodies) + 2 * static_cast<size_t>(i);
  }
  /// The parts of a vector that belong to the rigid bodies, and to the nodes.
  template <class Vector>
  [[nodiscard]] auto of_rigid(Vector& v) const {
    return std::span(v).first(node(0));
  }
  template <class Vector>
  [[nodiscard]] auto of_nodes(Vector& v) const {
    return std::span(v).subspan(node(0));
  }
};

/// How far a body with a mesh had turned when somebody looked last, whole turns included.
struct MeanTurn {
  double angle = 0;  ///< rad
  double spin = 0;   ///< rad/s
  double time = 0;   ///< s
  void fields(Archive& archive) { archive("angle", angle)("spin", spin)("time", time); }
};

struct State {
  Layout layout;
  double time = 0;  ///< s
  std::int64_t step = 0;
  /// Of rigid bodies place (m, relative to the model's origin) and angle (rad) of the mass centre;
  /// of nodes the displacement from the mesh as given (m).
  std::vector<double> x;
  std::vector<double> v;  ///< m/s, rad/s
  /// Of rigid bodies contact force (N) and moment about the mass centre (N m); of nodes the force
  /// of elements, loads and contacts (N). Without gravity.
  std::vector<double> f;
  std::vector<double> remainder;  ///< what rounding has kept out of x of rigid bodies so far
  /// Of each body, rigid ones first: 0 if it is there, 1 if it comes later, 2 if it has left the
  /// world. Empty in a scene where all bodies are always there.
  std::vector<std::uint8_t> absent;
  /// Of each body with a mesh. Nodes tell its angle without whole turns: these follow from one look
  /// to the next. Empty where nobody has looked.
  std::vector<MeanTurn> turns;

  explicit State(Layout of = {})
      : layout(of), x(of.size()), v(of.size()), f(of.size()), remainder(of.node(0)) {}

  using Triple = Eigen::Map<Eigen::Vector3d>;
  using ConstTriple = Eigen::Map<const Eigen::Vector3d>;
  using Pair = Eigen::Map<Vec2>;
  using ConstPair = Eigen::Map<const Vec2>;
  /// x, y, angle of a rigid body; their rates; force and moment on it.
  [[nodiscard]] Triple pose(RigidIndex i) { return Triple(&x[layout.rigid(i)]); }
  [[nodiscard]] ConstTriple pose(RigidIndex i) const { return ConstTriple(&x[layout.rigid(i)]); }
  [[nodiscard]] Triple pose_rate(RigidIndex i) { return Triple(&v[layout.rigid(i)]); }
  [[nodiscard]] ConstTriple pose_rate(RigidIndex i) const {
    return ConstTriple(&v[layout.rigid(i)]);
  }
  [[nodiscard]] ConstTriple force(RigidIndex i) const { return ConstTriple(&f[layout.rigid(i)]); }
  /// Displacement of a node, and its velocity.
  [[nodiscard]] Pair node(NodeIndex i) { return Pair(&x[layout.node(i)]); }
  [[nodiscard]] ConstPair node(NodeIndex i) const { return ConstPair(&x[layout.node(i)]); }
  [[nodiscard]] ConstPair node_velocity(NodeIndex i) const { return ConstPair(&v[layout.node(i)]); }
  [[nodiscard]] bool is_absent(BodyIndex body) const {
    return !absent.empty() && absent[static_cast<size_t>(body)] != 0;
  }

  /// As contact sees it, with these velocities.
  [[nodiscard]] Kinematics kinematics(std::span<const double> velocity) const {
    return {layout.of_rigid(x), layout.of_nodes(x), velocity.first(layout.node(0)),
            velocity.subspan(layout.node(0))};
  }

  void fields(Archive& archive) {
    archive("time", time)("step", step);
    archive.sized("x", x).sized("v", v).sized("f", f).sized("remainder", remainder);
    if (!turns.empty()) archive("turns", turns);
    if (absent.empty()) return;
    std::string flags;
    for (const std::uint8_t flag : absent) flags += static_cast<char>('0' + flag);
    archive("absent", flags);
    if (flags.size() != absent.size()) throw ArchiveMismatch("absent has another size");
    for (size_t i = 0; i < flags.size(); ++i) absent[i] = static_cast<std::uint8_t>(flags[i] - '0');
  }
};

/// The energy ledger of the moving bodies and the contacts between them and all others, in J.
/// kinetic + strain + contact + gravity + friction_loss + damping_loss + numerical_loss -
/// external_work is constant;
/// total_error is how far it is from its value at time 0.
struct Energies {
  double kinetic = 0;
  double strain = 0;
  double contact = 0;
  double gravity = 0;  ///< zero at time 0
  double friction_loss = 0;
  double damping_loss = 0;
  double numerical_loss =
      0;  ///< what implicit steps take from vibrations that are too fast for them
  double external_work = 0;  ///< done by loads, bodies and supports with prescribed motion
  double total_error = 0;
};

/// Momentum of the free bodies (angular about the model's origin) and how far it is from its value
/// at time 0 plus the impulses of gravity and of the bodies that are not free.
struct Momenta {
  double x = 0, y = 0, angular = 0;
  double x_error = 0, y_error = 0, angular_error = 0;
};

/// Contact force on a body, N; `friction` sums the sizes of the friction forces.
struct BodyForce {
  double fx = 0, fy = 0, friction = 0;
};

}  // namespace apothem
