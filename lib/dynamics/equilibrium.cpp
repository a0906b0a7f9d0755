// What Newton's method (newton.cpp) and dynamic relaxation (relaxation.cpp) share: the forces of a
// state that is tried, and when they are in balance.

#include "lib/dynamics/equilibrium.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "geometry/polygon/cyclic.hpp"
#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/inradius.hpp"
#include "lib/model/statistics.hpp"

namespace apothem {
namespace {

constexpr double kNoise =
    4 * std::numeric_limits<double>::epsilon();  // of places and displacements
constexpr double kRigidNoise = 8;                // times that: corners are turned and moved
constexpr double kFar = 100;                     // of the scene's size: there a body is lost
// At a settled start the fastest body has slipped by this multiple of the scene's size, slower ones
// by less in proportion to their speeds. That saturates every friction spring.
constexpr double kSlide = 1e5;

}  // namespace

Equilibrium::Equilibrium(const Model& model, const DegreesOfFreedom& dofs, const Terms& terms,
                         ContactTerm* contact, double tolerance)
    : model_(model),
      dofs_(dofs),
      terms_(terms),
      contact_(contact),
      tolerance_(tolerance),
      first_(dofs.layout().node(0)),
      lengths_(model, dofs.layout()),
      lambda_(model.bodies.size()),
      body_loads_(model.bodies.size() + model.deformables.size()),
      body_loads_now_(body_loads_.size()) {
  const size_t n = dofs.layout().size();
  for (std::vector<double>* v : {&mass_, &inverse_, &rest_, &last_, &drive_, &velocity_,
                                 &displacement_, &step_, &moves_, &shift_}) {
    v->assign(n, 0);
  }
  free_.assign(n, 0);
  pushed_.assign(n, 0);
  spins_.assign(n, 0);
  stiffness_.elastic.assign(n - first_, 0);
  stiffness_.contact.assign((n - first_) / 2, 0);
  stiffness_.rigid.assign(first_, 0);
  outside_.assign(n - first_, 0);
  Box scene;
  for (const DeformableBody& body : model.deformables) {
    scene.include(box_of(body.mesh.nodes));
  }
  for (const RigidBody& body : model.bodies) {
    double longest = 0;
    const Potential& shape = body.potential;
    for (int i = 0; i < shape.size(); ++i) {
      const Vec2& vertex = shape.vertices[i];
      longest = std::max(longest, (shape.vertices[shape.next(i)] - vertex).norm());
      scene.include(body.position + vertex);
    }
    flat_.push_back(2 * model.stiffness() * body.potential.steepest * longest);
    if (body.servo) {
      const auto wall = static_cast<RigidIndex>(flat_.size()) - 1;
      walls_.push_back(wall);
      rails_.push_back({wall, body.servo->direction});
      for (const size_t axis : {0, 1}) pushed_[dofs.layout().rigid(wall) + axis] = 1;
    }
  }
  extent_ = scene.extent();
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(body_loads_.size()); ++b) {
    inradius_.push_back(is_free(model, b) ? inradius_of(model, b) : 0);
  }
}

// Friction follows the displacements since `slips_from_`, in one step of 1 s.
void Equilibrium::find_forces(State& state) {
  std::ranges::fill(state.layout.of_rigid(state.f), 0.);
  std::ranges::fill(lambda_, 0.);
  for (size_t c = 0; c < displacement_.size(); ++c) {
    displacement_[c] = state.x[c] - slips_from_[c] + (slip_.empty() ? 0 : slip_[c]);
  }
  for (size_t c = first_; span_ > 0 && c < moved_.size(); ++c) moved_[c] = displacement_[c] / span_;
  PhaseTimer off;
  for (const auto& term : terms_) {
    term->add_forces(
        {state, displacement_, 1, lambda_, off, 0, true, true, slip_, {span_, moved_}});
  }
  for (size_t c = 0; c < rest_.size(); ++c) rest_[c] = held(c) ? 0 : state.f[c] + weight(c);
  push_walls(state);
}

// Bodies on rails feel what acts along these.
void Equilibrium::push_walls(const State& state) {
  for (const RigidIndex wall : walls_) {
    const Servo& servo = *model_.bodies[wall].servo;
    const size_t c = state.layout.rigid(wall);
    const double push = servo.excess(state.time, Vec2(&state.f[c]));
    rest_[c] = push * servo.direction.x();
    rest_[c + 1] = push * servo.direction.y();
  }
  for (size_t i = walls_.size(); i < rails_.size(); ++i) {
    const size_t c = state.layout.rigid(rails_[i].body);
    const double push = rails_[i].along.dot(Vec2(&rest_[c]));
    rest_[c] = push * rails_[i].along.x();
    rest_[c + 1] = push * rails_[i].along.y();
  }
}

// Free rigid bodies that have a velocity slide in equilibrium: only what it leaves free comes to
// rest.
void Equilibrium::let_slide(const State& state) {
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    if (model_.bodies[i].motion != Motion::free) continue;
    const size_t c = state.layout.rigid(i);
    const Vec2 way(&state.v[c]);
    if (way != Vec2::Zero()) rails_.push_back({i, Vec2(-way.y(), way.x()).normalized()});
    if (state.v[c + 2] != 0) spins_[c + 2] = 1;
  }
}

// What moves at a settled start has slipped along its velocity.
void Equilibrium::find_slip(const State& state) {
  double fastest = 0;
  for (size_t c = 0; c < state.v.size(); ++c) {
    const bool turns = c < first_ && c % 3 == 2;
    fastest = std::max(fastest, std::abs(state.v[c]) * (turns ? radius()[c / 3] : 1));
  }
  slip_.clear();
  if (fastest == 0) return;
  const double time = kSlide * extent_ / fastest;
  for (const double v : state.v) slip_.push_back(time * v);
}

std::int64_t Equilibrium::searches() const { return contact_ ? contact_->searches() : 0; }

void Equilibrium::refuse_diverged(const State& state, const std::string& body) const {
  throw Unstable(
      fmt::format("the relaxation of \"{}\" diverges at t = {:.9g} s (load step {}): the load of "
                  "one step is too much for it; {}",
                  body, state.time, state.step,
                  settling_ ? "leave out time.start, or let gravity and loads grow by a history"
                            : "raise time.load_steps or reduce the load"));
}

void Equilibrium::check_shapes(const State& state) const {
  const auto check = [&](const Vec2& u, const std::string& name) {
    if (!is_finite(u)) refuse_diverged(state, name);
    if (std::max(std::abs(u.x()), std::abs(u.y())) < kFar * extent_) return;
    throw Unstable(
        fmt::format("\"{}\" has moved {:.3g} m at t = {:.9g} s (load step {}) and finds no "
                    "equilibrium: nothing holds it against its loads{}; support it, or press it "
                    "against another body{}",
                    name, u.norm(), state.time, state.step,
                    slip_.empty() ? "" : " and the friction of bodies that move at time 0",
                    settling_ && !slip_.empty() ? ", or let prescribed velocities begin at 0"
                    : settling_                 ? ", or leave out time.start"
                                                : ""));
  };
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    const RigidBody& body = model_.bodies[i];
    check(state.pose(i).head<2>() - body.position, body.name);
  }
  for (const DeformableBody& body : model_.deformables) {
    for (NodeIndex i = 0; i < static_cast<NodeIndex>(body.mesh.nodes.size()); ++i) {
      check(state.node(body.first_node + i), body.name);
    }
  }
  for (const auto& term : terms_) term->watch(state);
}

// On nodes, N.
std::vector<double> Equilibrium::loads() const {
  std::vector<double> forces(rest_.size() - first_, 0);
  for (const auto& term : terms_) term->add_given_forces(forces);
  return forces;
}

// Loads on nodes, and the reactions of supports with prescribed motion, N.
std::vector<double> Equilibrium::given_forces(const State& state) const {
  std::vector<double> forces = loads();
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    if (d.coordinate >= first_) forces[d.coordinate - first_] -= state.f[d.coordinate];
  }
  return forces;
}

// Whether the sum of the forces on a body is small against `loads`; adds to the sums of a look.
bool Equilibrium::note_balance(BodyIndex b, double off, double loads, double residual, double noise,
                               LoadStep& result) {
  sum_noise_ += noise;
  sum_residual_ += residual;
  if (residual > most_) {
    most_ = residual;
    result.unbalanced = b;
  }
  result.off[b] = off;
  if (off > result.imbalance * loads) {
    result.imbalance = off / loads;
    result.worst = b;
  }
  return off <= tolerance_ * loads + kNoise * std::sqrt(noise);
}

bool Equilibrium::body_balanced(const State& state, DeformableIndex b,
                                const std::vector<double>& outside, LoadStep& result) {
  const DeformableBody& body = model_.deformables[b];
  Vec2 sum = Vec2::Zero();
  double sizes = 0, noise = 0, residual = 0;
  for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      const size_t of_nodes =
          2 * (static_cast<size_t>(body.first_node) + i) + static_cast<size_t>(axis);
      const size_t c = first_ + of_nodes;
      // What acts from outside; at supports their reaction.
      const double f = held(c) ? -state.f[c] : outside[of_nodes] + weight(c);
      sum_loads_ += f * f;
      sizes += std::abs(f);
      residual += rest_[c] * rest_[c];
      sum[axis] += rest_[c];
      const double rounded = stiffness_.elastic[of_nodes] * std::abs(state.x[c]) +
                             stiffness_.contact[of_nodes / 2] * std::abs(body.mesh.nodes[i][axis]);
      noise += rounded * rounded;
    }
  }
  result.load += sizes;
  if (contact_) {
    const Vec2 force = contact_->force_on(b);
    sizes += hypotenuse(force.x(), force.y());
  }
  const BodyIndex number = static_cast<BodyIndex>(model_.bodies.size()) + b;
  const double loads = body_loads_now_[number] = std::max(body_loads_[number], sizes);
  return note_balance(number, sum.norm(), loads, residual, noise, result);
}

// `contact`: the sum of the sizes of the contact forces on it, N.
bool Equilibrium::rigid_balanced(const State& state, RigidIndex b, double contact,
                                 LoadStep& result) {
  const size_t c = state.layout.rigid(b);
  const double force = hypotenuse(rest_[c], rest_[c + 1]), moment = rest_[c + 2] / radius()[b];
  const RigidBody& body = model_.bodies[b];
  const double own = body.servo ? std::abs(body.servo->force * body.servo->history.at(state.time))
                                : hypotenuse(weight(c), weight(c + 1));
  result.load += own;
  sum_loads_ += own * own;
  const double place = std::abs(state.x[c]) + std::abs(state.x[c + 1]) + radius()[b];
  const double noise = kRigidNoise * place * (stiffness_.rigid[c] + lambda_[b] * body.mass);
  return note_balance(b, force + std::abs(moment), own + contact, force * force + moment * moment,
                      noise * noise, result);
}

// Whether the residual, and the sum of the forces on each body, are small against the loads.
bool Equilibrium::reached(const State& state, LoadStep& result) {
  const std::vector<double> outside = given_forces(state);
  sum_loads_ = sum_residual_ = sum_noise_ = 0;
  most_ = -1;
  result.imbalance = result.load = 0;
  result.worst = 0;
  result.off.assign(body_loads_.size(), 0);
  bool balanced = true;
  for (DeformableIndex b = 0; b < static_cast<DeformableIndex>(model_.deformables.size()); ++b) {
    balanced = body_balanced(state, b, outside, result) && balanced;
  }
  std::vector<double> contact(body_loads_.size(), 0);
  if (contact_) contact_->add_force_sizes(contact);
  for (RigidIndex b = 0; b < state.layout.rigid_bodies; ++b) {
    if (model_.bodies[b].motion != Motion::free && !model_.bodies[b].servo) continue;
    balanced = rigid_balanced(state, b, contact[b], result) && balanced;
  }
  for (size_t c = 0; c < first_; ++c) {  // of contact on rigid bodies
    if (c % 3 < 2) sum_loads_ += state.f[c] * state.f[c];
  }
  // Of equilibria and this state, not of what came on the way to it.
  loads_now_ = std::max(loads_, std::sqrt(sum_loads_));
  const double residual = std::sqrt(sum_residual_);
  result.residual = loads_now_ > 0 ? residual / loads_now_ : 0;
  return balanced && residual <= tolerance_ * loads_now_ + kNoise * std::sqrt(sum_noise_);
}

// By Newton's method; by relaxation where a term does not know its tangent.
LoadStep Equilibrium::solve(State& state, const State& before, double time,
                            const std::function<bool()>& stop) {
  LoadStep result{time};
  if (!pause_ || pause_->until != time) {
    ++state.step;
    const Verdict verdict = search(state, before, time, stop, result);
    if (verdict != Verdict::failed) {
      keep(verdict == Verdict::found, result);
      return result;
    }
    // Where bodies of finite elements stick and slip on stiff contacts the method may go round in
    // circles at an equilibrium.
    const bool circles = !settling_ && departed_ < 0 && contact_ && !model_.deformables.empty();
    if (tangent_known_ && !circles) refuse(state, result);
    after_newton_ = tangent_known_;
    state = before;
  }
  return relax(state, before, time, stop);
}

void Equilibrium::keep(bool complete, LoadStep& result) {
  result.complete = complete;
  if (!complete) return;
  loads_ = loads_now_;
  std::ranges::copy(body_loads_now_, body_loads_.begin());
}

LoadStep Equilibrium::find(State& state, Ledger& ledger, double time,
                           const std::function<bool()>& stop) {
  const State before = state;
  driven_way_ = driven_way(before.time, time);
  LoadStep result = solve(state, before, time, stop);
  if (result.complete) {
    note_move(state, before, result);
    book(before, state, ledger);
  } else {
    go_back(state, before);
  }
  return result;
}

LoadStep Equilibrium::find_near(State& state, Ledger& ledger, double time,
                                const std::function<bool()>& stop, std::vector<double>& motion) {
  const State before = state;
  LoadStep result{time};
  near_ = true;
  driven_way_ = driven_way(before.time, time);
  ++state.step;
  const Verdict verdict = newton(state, before, time, stop, result);
  near_ = false;
  result.found = verdict != Verdict::failed;
  keep(verdict == Verdict::found, result);
  if (verdict == Verdict::found) {
    book(before, state, ledger);
    return result;
  }
  if (!result.found) {
    result.complete = true;
    motion.resize(state.x.size());
    for (size_t c = 0; c < motion.size(); ++c) motion[c] = state.x[c] - before.x[c];
  }
  go_back(state, before);
  return result;
}

// The state before a search that was stopped, or has found nothing.
void Equilibrium::go_back(State& state, const State& before) {
  state = before;
  if (contact_) contact_->drop_trial();
  for (const auto& term : terms_) term->refresh(state);
}

void Equilibrium::book(const State& before, const State& state, Ledger& ledger) {
  // The ledger itself knows the work of prescribed motion, and terms know that of gravity.
  const std::vector<double> now = loads();
  double work = 0;
  for (size_t c = 0; c < now.size(); ++c) {
    work += (outside_[c] + now[c]) / 2 * (state.x[first_ + c] - before.x[first_ + c]);
  }
  ledger.add_work(work);
  outside_ = now;
}

void Equilibrium::fields(Archive& archive) {
  archive.sized("outside", outside_);
  archive("loads", loads_);
  archive.sized("body_loads", body_loads_);
  bool on_the_way = newton_pause_.has_value();
  archive("newton", on_the_way);
  if (!on_the_way) {
    newton_pause_.reset();
  } else {
    // Vectors of this size, which a checkpoint fills.
    if (!newton_pause_) newton_pause_ = {.x_done = mass_, .base = mass_, .x = mass_};
    archive("path", *newton_pause_);
  }
  bool paused = pause_.has_value();
  archive("paused", paused);
  if (!paused) {
    pause_.reset();
    return;
  }
  if (!pause_) pause_ = {0, 0, 0, mass_, mass_};
  archive("time", pause_->time)("until", pause_->until)("steps", pause_->steps);
  archive("after_newton", after_newton_)("at_end", at_end_.words);
  archive.sized("x", pause_->x).sized("v", pause_->v);
  archive("kinetic", kinetic_);
  archive.sized("mass", mass_).sized("inverse", inverse_).sized("velocity", velocity_);
  archive.sized("last", last_).sized("elastic", stiffness_.elastic);
  archive.sized("contact", stiffness_.contact).sized("rigid", stiffness_.rigid);
}

void Equilibrium::begin_settling(const State& state) {
  settling_ = true;
  find_slip(state);
  let_slide(state);
}

void Equilibrium::settle(State& state, const std::function<bool()>& stop) {
  const State before = state;
  driven_way_ = 0;
  begin_settling(state);
  if (!solve(state, before, state.time, stop).complete) throw Stopped();
  state.step = before.step;
  state.v = before.v;
}

}  // namespace apothem
