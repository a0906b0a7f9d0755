#include "lib/dynamics/degrees_of_freedom.hpp"

#include <algorithm>
#include <cstdint>

#include "lib/execution/dispatch.hpp"
#include "lib/model/rotation.hpp"

namespace apothem {
namespace {

constexpr double kKickTime = .7, kDriftTime = .5;  // of a coordinate, ns
constexpr double kTorqueTime = 1.5;                // of a rigid body, ns
constexpr int kParts = 64;  // of a sum over all bodies, for any number of threads: the same bits

}  // namespace

DegreesOfFreedom::DegreesOfFreedom(const Model& model, std::span<const double> node_mass,
                                   int threads)
    : model_(model),
      threads_(threads),
      layout_{static_cast<int>(model.bodies.size()), static_cast<int>(node_mass.size())} {
  for (auto* const of_coordinates : {&inverse_mass_, &mass_, &acceleration_, &start_}) {
    of_coordinates->reserve(layout_.size());
  }
  for (const RigidBody& body : model.bodies) add_rigid(body);
  for (const DeformableBody& body : model.deformables) {
    add_nodes(body, node_mass.subspan(static_cast<size_t>(body.first_node)));
  }
  if (!model.has_gravity()) acceleration_.clear();
  weight_ = acceleration_;
  for (size_t c = 0; c < weight_.size(); ++c) {
    if (can_move(c)) weight_[c] /= inverse_mass_[c];
  }
  const size_t rigid = layout_.node(0);
  for (size_t c = 0; c < layout_.size(); ++c) {
    if (can_move(c)) continue;
    const size_t axis = c < rigid ? c % 3 : (c - rigid) % 2;
    const size_t across = axis == 0 ? c + 1 : c - 1;
    held_[axis].push_back({c, across, c < rigid ? 0 : start_[across]});
  }
  weight_at_start_ = weight_at_start(weight_);
}

Impulse DegreesOfFreedom::weight_at_start(const std::vector<double>& weight) const {
  const size_t rigid = layout_.node(0);
  Impulse sum;
  for (size_t c = 0; c < weight.size(); ++c) {
    const size_t axis = c < rigid ? c % 3 : (c - rigid) % 2;
    if (axis == 0) sum.x += weight[c];
    if (axis == 1) sum.y += weight[c];
  }
  for (size_t c = rigid; c < weight.size(); c += 2) {
    sum.angular += start_[c] * weight[c + 1] - start_[c + 1] * weight[c];
  }
  return sum;
}

std::pair<size_t, size_t> DegreesOfFreedom::coordinates(BodyIndex body) const {
  if (body < layout_.rigid_bodies) return {layout_.rigid(body), layout_.rigid(body) + 3};
  const DeformableBody& of = model_.deformables[body - layout_.rigid_bodies];
  return {layout_.node(of.first_node),
          layout_.node(of.first_node + static_cast<int>(of.mesh.nodes.size()))};
}

void DegreesOfFreedom::set_absent(const std::vector<std::uint8_t>& absent) {
  absent_ = absent;
  take_out();
}

void DegreesOfFreedom::set_resting(const std::vector<std::uint8_t>& resting, const State& state) {
  resting_ = resting;
  take_out();
  resting_energy_ = 0;
  for (size_t axis = 0; axis < 3; ++axis) held_[axis].resize(held_at_start_[axis]);
  for (size_t c = 0; c < 3 * resting_.size(); ++c) {
    if (resting_[c / 3] == 0 || is_held(c)) continue;
    held_[c % 3].push_back({c, c % 3 == 0 ? c + 1 : c - 1, 0});
    if (given_acceleration_.empty()) continue;
    resting_energy_ -=
        given_acceleration_[c] * mass_[c] * ((state.x[c] - start_[c]) + state.remainder[c]);
  }
}

// Takes bodies out that are absent or rest, and puts those back that no longer are.
void DegreesOfFreedom::take_out() {
  if (given_inverse_mass_.empty()) {
    given_inverse_mass_ = inverse_mass_;
    given_acceleration_ = full_acceleration_.empty() ? acceleration_ : full_acceleration_;
    out_.resize(model_.bodies.size() + model_.deformables.size());
    for (size_t axis = 0; axis < 3; ++axis) held_at_start_[axis] = held_[axis].size();
  }
  const auto is_set = [](const std::vector<std::uint8_t>& flags, size_t b) {
    return b < flags.size() && flags[b] != 0;
  };
  for (size_t b = 0; b < out_.size(); ++b) {
    const bool out = is_set(absent_, b) || is_set(resting_, b);
    if (out != (out_[b] != 0)) set_present(static_cast<BodyIndex>(b), !out);
    out_[b] = out ? 1 : 0;
  }
  weight_at_start_ = weight_at_start(weight_);
  if (!full_weight_.empty()) full_weight_at_start_ = weight_at_start(full_weight_);
}

void DegreesOfFreedom::set_present(BodyIndex body, bool present) {
  const auto [first, end] = coordinates(body);
  for (size_t c = first; c < end; ++c) {
    inverse_mass_[c] = present ? given_inverse_mass_[c] : 0;
    if (acceleration_.empty()) continue;
    const double full = present ? given_acceleration_[c] : 0;
    // As the constructor finds it, so that it has the same bits again.
    const double weight = can_move(c) ? full / inverse_mass_[c] : 0;
    acceleration_[c] = gravity_factor_ * full;
    weight_[c] = gravity_factor_ * weight;
    if (!full_weight_.empty()) full_acceleration_[c] = full, full_weight_[c] = weight;
  }
}

void DegreesOfFreedom::add_rigid(const RigidBody& body) {
  const size_t first = inverse_mass_.size();
  // A servo moves its wall itself.
  const std::array<double, 3> inverse =
      body.motion == Motion::free ? body.inverse_mass() : std::array<double, 3>{};
  const std::array<double, 3> place{body.position.x(), body.position.y(), body.angle};
  const Vec2 arm = -turned(body.pivot, body.angle);
  for (int k = 0; k < 3; ++k) {
    inverse_mass_.push_back(inverse[k]);
    mass_.push_back(k < 2 ? body.mass : body.inertia);
    acceleration_.push_back(k < 2 && inverse[k] > 0 ? model_.gravity[k] : 0);
    start_.push_back(place[k]);
    if (body.motion == Motion::prescribed) {
      driven_.push_back({first + static_cast<size_t>(k), k, &body.history, place[k], arm,
                         body.servo ? &*body.servo : nullptr});
    }
  }
}

void DegreesOfFreedom::add_nodes(const DeformableBody& body, std::span<const double> mass) {
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      inverse_mass_.push_back(1 / mass[i]);
      mass_.push_back(mass[i]);
      acceleration_.push_back(model_.gravity[axis]);
      start_.push_back(body.mesh.nodes[i][axis]);
    }
  }
  if (!body.displacement.empty()) {
    displaced_.resize(layout_.size());
    std::ranges::copy(body.displacement, &displaced_[layout_.node(body.first_node)]);
  }
  add_supports(body);
}

void DegreesOfFreedom::add_supports(const DeformableBody& body) {
  for (const Support& support : body.supports) {
    for (const int node : support.nodes) {
      const size_t first = layout_.node(body.first_node + node);
      const Vec2 start = displaced_.empty() ? Vec2(0, 0) : Vec2(&displaced_[first]);
      for (int axis = 0; axis < 2; ++axis) {
        if (!support.held[axis]) continue;
        const size_t c = first + static_cast<size_t>(axis);
        inverse_mass_[c] = acceleration_[c] = 0;
        if (support.motion.empty()) continue;
        driven_.push_back(
            {c, axis, &support.motion, start[axis], body.mesh.nodes[node] + start - support.pivot});
      }
    }
  }
}

void DegreesOfFreedom::scale_gravity(double factor) {
  if (factor == gravity_factor_) return;
  if (full_weight_.empty()) {
    full_acceleration_ = acceleration_;
    full_weight_ = weight_;
    full_weight_at_start_ = weight_at_start_;
  }
  gravity_factor_ = factor;
  for (size_t c = 0; c < weight_.size(); ++c) {
    acceleration_[c] = factor * full_acceleration_[c];
    weight_[c] = factor * full_weight_[c];
  }
  const Impulse& full = full_weight_at_start_;
  weight_at_start_ = {factor * full.x, factor * full.y, factor * full.angular};
}

// Its factor is 1 from now on.
void DegreesOfFreedom::set_gravity(const Vec2& value) {
  const size_t rigid = layout_.node(0);
  const auto on = [&](size_t c) {
    if (c >= rigid) return value[static_cast<Eigen::Index>((c - rigid) % 2)];
    return c % 3 == 2 ? 0 : value[static_cast<Eigen::Index>(c % 3)];
  };
  for (size_t c = 0; c < weight_.size(); ++c) {
    acceleration_[c] = can_move(c) ? on(c) : 0;
    weight_[c] = acceleration_[c] * mass_[c];
    if (!given_acceleration_.empty()) given_acceleration_[c] = is_held(c) ? 0 : on(c);
  }
  weight_at_start_ = weight_at_start(weight_);
}

Vec2 DegreesOfFreedom::mass_moved(const State& state) const {
  Vec2 sum = Vec2::Zero();
  const size_t rigid = layout_.node(0);
  for (size_t c = 0; c < layout_.size(); ++c) {
    if (!can_move(c) || (c < rigid && c % 3 == 2)) continue;
    const double moved = displaced_.empty() ? state.x[c] : state.x[c] - displaced_[c];
    sum[static_cast<Eigen::Index>(c < rigid ? c % 3 : (c - rigid) % 2)] +=
        mass_[c] * (c < rigid ? (state.x[c] - start_[c]) + state.remainder[c] : moved);
  }
  return sum;
}

State DegreesOfFreedom::start() const {
  State state(layout_);
  for (RigidIndex i = 0; i < layout_.rigid_bodies; ++i) {
    const RigidBody& body = model_.bodies[i];
    for (int k = 0; k < 3; ++k) state.pose(i)[k] = start_[layout_.rigid(i) + size_t(k)];
    if (absent_.empty() || absent_[static_cast<size_t>(i)] == 0) {
      state.pose_rate(i) << body.velocity, body.spin;
    }
  }
  for (const DeformableBody& body : model_.deformables) {
    const auto n = static_cast<int>(body.mesh.nodes.size());
    double whole = 0;
    Vec2 centre = Vec2::Zero();
    for (int i = 0; i < n; ++i) {
      const double m = mass_[layout_.node(body.first_node + i)];
      whole += m;
      centre += m * body.mesh.nodes[i];
    }
    centre /= whole;
    const std::vector<double>& given = body.node_velocity;
    for (int i = 0; i < n; ++i) {
      Vec2 v = body.velocity + cross(body.spin, Vec2(body.mesh.nodes[i] - centre));
      if (!given.empty())
        v = {given[2 * static_cast<size_t>(i)], given[2 * static_cast<size_t>(i) + 1]};
      for (int axis = 0; axis < 2; ++axis) {
        const size_t c = layout_.node(body.first_node + i) + static_cast<size_t>(axis);
        if (can_move(c)) state.v[c] = v[axis];
      }
    }
  }
  if (!displaced_.empty()) {
    std::copy(displaced_.begin() + static_cast<std::ptrdiff_t>(layout_.node(0)), displaced_.end(),
              state.x.begin() + static_cast<std::ptrdiff_t>(layout_.node(0)));
  }
  follow(state);
  return state;
}

void DegreesOfFreedom::kick(State& state, double h) const {
  // What a loop reads is local, so that it does not look again after each number that it writes.
  threads_.chunks(static_cast<int>(inverse_mass_.size()), kKickTime, [&](int first, int end, int) {
    const auto n = static_cast<size_t>(end - first);
    const double time = h;
    double* __restrict v = state.v.data() + first;
    const double* __restrict f = state.f.data() + first;
    const double* __restrict w = inverse_mass_.data() + first;
    const double* __restrict g = acceleration_.empty() ? nullptr : acceleration_.data() + first;
    with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
      if (g) {
        for (size_t c = 0; c < n; ++c) v[c] += time * (w[c] * f[c] + g[c]);
      } else {
        for (size_t c = 0; c < n; ++c) v[c] += time * (w[c] * f[c]);
      }
      return 0.;
    });
  });
}

// Gives the wall whose coordinates begin with `first` its velocity.
void DegreesOfFreedom::push_servo(const Servo& servo, State& state, size_t first, double dt) const {
  const double before = Vec2(&state.v[first]).dot(servo.direction);
  const double rate = servo.rate(state.time, Vec2(&state.f[first]), before, mass_[first], dt);
  state.v[first] = rate * servo.direction.x();
  state.v[first + 1] = rate * servo.direction.y();
  state.v[first + 2] = 0;
}

void DegreesOfFreedom::steer(State& state, double dt) {
  for (Driven& d : driven_) {
    if (d.servo) {
      if (d.axis == 0) push_servo(*d.servo, state, d.coordinate, dt);
      d.move = dt * state.v[d.coordinate];
      continue;
    }
    d.move = d.start + d.displacement(state.time) - state.x[d.coordinate];
    state.v[d.coordinate] = d.move / dt;
  }
}

void DegreesOfFreedom::drift(State& state, double dt) const {
  const auto rigid = static_cast<int>(layout_.node(0));
  // Compensated sum (Kahan): at constant velocity every step rounds the same way, and the angular
  // momentum of a million steps would show it. Displacements of nodes are small: they need none.
  threads_.chunks(rigid, kDriftTime, [&](int first, int end, int) {
    double* __restrict x = state.x.data();
    const double* __restrict v = state.v.data();
    double* __restrict r = state.remainder.data();
    const double* __restrict w = inverse_mass_.data();
    const double time = dt;
    for (int c = first; c < end; ++c) {
      if (!(w[c] > 0)) continue;
      const double dx = time * v[c] + r[c];
      const double sum = x[c] + dx;
      r[c] = dx - (sum - x[c]);
      x[c] = sum;
    }
  });
  const int nodes = static_cast<int>(layout_.size()) - rigid;
  threads_.chunks(nodes, kDriftTime, [&](int first, int end, int) {
    const auto n = static_cast<size_t>(end - first);
    double* __restrict x = state.x.data() + rigid + first;
    const double* __restrict v = state.v.data() + rigid + first;
    const double time = dt;
    with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
      for (size_t c = 0; c < n; ++c) x[c] += time * v[c];
      return 0.;
    });
  });
  for (const Driven& d : driven_) {
    if (d.coordinate < layout_.node(0)) state.x[d.coordinate] += d.move;
  }
}

void DegreesOfFreedom::follow(State& state) const {
  for (const Driven& d : driven_) {
    if (!d.servo) state.v[d.coordinate] = d.rate(state.time);
  }
}

void DegreesOfFreedom::place_driven(State& state) const {
  for (const Driven& d : driven_) {
    if (!d.servo) state.x[d.coordinate] = d.start + d.displacement(state.time);
  }
}

void DegreesOfFreedom::plan_moves(const State& state, double time) {
  for (Driven& d : driven_) {
    d.move = d.displacement(time) - d.displacement(state.time);
  }
}

std::vector<double> DegreesOfFreedom::free_node_mass() const {
  std::vector<double> mass;
  for (NodeIndex i = 0; i < layout_.nodes; ++i) {
    const size_t c = layout_.node(i);
    mass.push_back(can_move(c) || can_move(c + 1) ? mass_[c] : 0);
  }
  return mass;
}

double DegreesOfFreedom::kinetic(const State& state) const {
  double sum = 0;
  for (size_t c = 0; c < layout_.size(); ++c) {
    if (can_move(c)) sum += mass_[c] * state.v[c] * state.v[c] / 2;
  }
  return sum;
}

double DegreesOfFreedom::full_gravity_energy(const State& state) const {
  const std::vector<double>& weight = full_weight_.empty() ? weight_ : full_weight_;
  double sum = resting_energy_;
  const size_t rigid = layout_.node(0);
  for (size_t c = 0; c < weight.size(); ++c) {
    // What rounding keeps out of the position counts: the fall may be far smaller than the height.
    const double moved = displaced_.empty() ? state.x[c] : state.x[c] - displaced_[c];
    sum -= weight[c] * (c < rigid ? (state.x[c] - start_[c]) + state.remainder[c] : moved);
  }
  return sum;
}

Impulse DegreesOfFreedom::momentum(const State& state) const {
  Impulse sum;
  for (size_t c = 0; c < layout_.size(); ++c) {
    if (can_move(c)) sum.add(impulse(state, c, mass_[c] * state.v[c]));
  }
  return sum;
}

Impulse DegreesOfFreedom::impulse(const State& state, size_t c, double j) const {
  const size_t rigid = layout_.node(0);
  if (c < rigid) {
    const size_t axis = c % 3;
    if (axis == 0) return {j, 0, -state.x[c + 1] * j};
    if (axis == 1) return {0, j, state.x[c - 1] * j};
    return {0, 0, j};
  }
  if ((c - rigid) % 2 == 0) return {j, 0, -(start_[c + 1] + state.x[c + 1]) * j};
  return {0, j, (start_[c - 1] + state.x[c - 1]) * j};
}

void DegreesOfFreedom::add_reactions(const State& state, double h, Impulse& sum) const {
  const double* x = state.x.data();
  const double* f = state.f.data();
  double along_x = 0, along_y = 0, angular = 0;
  for (const Held& held : held_[0]) {
    along_x -= f[held.coordinate];
    angular += (held.start + x[held.across]) * f[held.coordinate];
  }
  for (const Held& held : held_[1]) {
    along_y -= f[held.coordinate];
    angular -= (held.start + x[held.across]) * f[held.coordinate];
  }
  for (const Held& held : held_[2]) angular -= f[held.coordinate];
  sum.add({h * along_x, h * along_y, h * angular});
}

DegreesOfFreedom::Braked DegreesOfFreedom::brake(State& state, size_t first, size_t end,
                                                 double rest) const {
  const double* const x = state.x.data();
  const double* const start = start_.data();
  const double* const mass = mass_.data();
  const double* const w = inverse_mass_.data();
  double* const v = state.v.data();
  Braked sum;  // for now with twice the kinetic energy
  const auto slow = [&](size_t c) APOTHEM_LAMBDA {
    const double p = w[c] > 0 ? mass[c] * v[c] : 0;
    sum.energy += p * v[c];
    if (w[c] > 0) v[c] *= rest;
    return p;
  };
  const size_t rigid = std::min(end, layout_.node(0));
  size_t c = first;
  for (; c < rigid; c += 3) {
    const double px = slow(c), py = slow(c + 1), spin = slow(c + 2);
    sum.impulse.add({px, py, spin + (x[c] * py - x[c + 1] * px)});
  }
  const size_t whole = end - (end - c) % kLanes;
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    using Pack = PackOf<kLanes>;
    Pack energy(0.), momentum(0.), turned(0.);
    for (; c < whole; c += kLanes) {
      const Pack before = Pack::load(v + c);
      const MaskOf<kLanes> free = Pack::load(w + c) > Pack(0.);
      const Pack p = select(free, Pack::load(mass + c) * before, Pack(0.));
      const auto place = (Pack::load(start + c) + Pack::load(x + c)).v;
      energy += p * before;
      momentum += p;
      turned += Pack(__builtin_shufflevector(place, place, 1, 0, 3, 2, 5, 4, 7, 6)) * p;
      select(free, Pack(rest) * before, before).store(v + c);
    }
    for (int k = 0; k < kLanes; k += 2) {
      sum.energy += energy.v[k] + energy.v[k + 1];
      sum.impulse.add({momentum.v[k], momentum.v[k + 1], turned.v[k + 1] - turned.v[k]});
    }
    return 0.;
  });
  for (; c < end; c += 2) {
    const double px = slow(c), py = slow(c + 1);
    sum.impulse.add({px, py, (start[c] + x[c]) * py - (start[c + 1] + x[c + 1]) * px});
  }
  return {
      sum.energy / 2 * (1 - rest * rest),
      {(rest - 1) * sum.impulse.x, (rest - 1) * sum.impulse.y, (rest - 1) * sum.impulse.angular}};
}

Impulse DegreesOfFreedom::weight_sum(const State& state) const {
  Impulse sum = weight_at_start_;
  const size_t rigid = layout_.node(0), n = weight_.size();
  if (n == 0) return sum;
  const double* x = state.x.data();
  std::array<double, kParts> torques{};
  const auto begin = [&](int part) {
    return layout_.rigid(
        static_cast<RigidIndex>(std::int64_t{layout_.rigid_bodies} * part / kParts));
  };
  threads_.chunks(kParts, kTorqueTime / kParts * layout_.rigid_bodies,
                  [&](int first, int end, int) {
                    for (int part = first; part < end; ++part) {
                      double torque = 0;
                      for (size_t c = begin(part); c < begin(part + 1); c += 3) {
                        torque += x[c] * weight_[c + 1] - x[c + 1] * weight_[c];
                      }
                      torques[static_cast<size_t>(part)] = torque;
                    }
                  });
  for (const double torque : torques) sum.angular += torque;
  if (n == rigid) return sum;
  // What displacements add, in many sums, so that none waits for the one before.
  constexpr size_t kNumbers = 16;
  const double* weight = weight_.data();
  const size_t whole = n - (n - rigid) % kNumbers;
  sum.angular += with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    using Pack = PackOf<kLanes>;
    std::array<Pack, 2> part{Pack(0.), Pack(0.)};
    const auto product = [&](size_t c) APOTHEM_LAMBDA {
      const auto w = Pack::load(weight + c).v;
      return Pack::load(x + c) * Pack(__builtin_shufflevector(w, w, 1, 0, 3, 2, 5, 4, 7, 6));
    };
    for (size_t c = rigid; c < whole; c += kNumbers) {
      part[0] += product(c);
      part[1] += product(c + kLanes);
    }
    const Pack both = part[0] + part[1];
    double torque = 0;
    for (int k = 0; k < kLanes; k += 2) torque += both.v[k] - both.v[k + 1];
    for (size_t i = whole; i < n; i += 2) torque += x[i] * weight[i + 1] - x[i + 1] * weight[i];
    return torque;
  });
  return sum;
}

}  // namespace apothem
