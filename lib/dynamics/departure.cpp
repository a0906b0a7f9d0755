#include "lib/dynamics/departure.hpp"

#include <fmt/format.h>

#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {
namespace {

constexpr double kSlides = 0.99;  // of the largest friction: springs next to their limit count

BodyShift motion_of_nodes(const DeformableBody& body, const State& state, const State& before) {
  const auto count = static_cast<NodeIndex>(body.mesh.nodes.size());
  Vec2 centre = Vec2::Zero(), shift = Vec2::Zero();
  for (NodeIndex i = 0; i < count; ++i) {
    centre += body.mesh.nodes[i] / count;
    shift += (state.node(body.first_node + i) - before.node(body.first_node + i)) / count;
  }
  double turned = 0, inertia = 0, size = 0;
  for (NodeIndex i = 0; i < count; ++i) {
    const Vec2 arm = body.mesh.nodes[i] - centre;
    const Vec2 way = state.node(body.first_node + i) - before.node(body.first_node + i) - shift;
    turned += cross(arm, way);
    inertia += arm.squaredNorm();
    size = std::max(size, arm.norm());
  }
  return {shift, turned / inertia, size};
}

// What presses on a body: the partner that presses most, and how much of the largest friction acts.
struct Grip {
  BodyIndex partner = -1;
  double pressed = 0, rubbed = 0, limit = 0;  // sums of sizes, N
};

Grip grip_of(const Model& model, BodyIndex body, std::span<const ContactRecord> contacts) {
  const PairTable table = pair_table(model);
  Grip grip;
  double most = 0;
  for (const ContactRecord& c : contacts) {
    if (c.a != body && c.b != body) continue;
    const double pressed = c.normal.norm();
    grip.pressed += pressed;
    grip.rubbed += c.tangential.norm();
    grip.limit += table.between(c.a, c.b).friction.coefficient * pressed;
    if (pressed > most) most = pressed, grip.partner = c.a == body ? c.b : c.a;
  }
  return grip;
}

}  // namespace

BodyShift motion_of(const Model& model, const State& state, const State& before, BodyIndex b) {
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  if (b >= rigid) return motion_of_nodes(model.deformables[b - rigid], state, before);
  const Eigen::Vector3d way = state.pose(b) - before.pose(b);
  return {way.head<2>(), way[2], model.bodies[b].reach()};
}

Departure describe_departure(const Model& model, const State& state, const State& before,
                             BodyIndex body, std::span<const ContactRecord> contacts) {
  const BodyShift motion = motion_of(model, state, before, body);
  const Grip grip = grip_of(model, body, contacts);
  const std::string& name = model.name_of(body);
  if (!(grip.pressed > 0)) {
    return {fmt::format("\"{}\" falls, or flies off: it touches nothing that presses on it", name),
            true};
  }
  const std::string& on = model.name_of(grip.partner);
  const bool at_limit = grip.rubbed >= kSlides * grip.limit;
  if (motion.size * std::abs(motion.turn) > motion.shift.norm()) {
    return {fmt::format("\"{}\" tips over or rolls on \"{}\"", name, on)};
  }
  if (at_limit) {
    return {fmt::format("\"{}\" slides on \"{}\", {}", name, on,
                        grip.limit > 0 ? "with friction at its limit" : "without friction"),
            true};
  }
  return {fmt::format("\"{}\" moves away from where it lies on \"{}\": it tips over, or is pushed",
                      name, on)};
}

}  // namespace apothem
