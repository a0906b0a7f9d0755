#include "dynamics/surface_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dynamics/unstable.hpp"

namespace apothem {
namespace {

constexpr double kSkin = 0.25;  // of the shortest reference length

double shortest_reference(const Model& model) {
  double shortest = HUGE_VAL;
  for (const DeformableBody& body : model.deformables) {
    shortest = std::min(shortest, boundary_inradius(body.mesh, boundary(body.mesh)));
  }
  return shortest;
}

}  // namespace

bool SurfaceContact::needed(const Model& model) {
  return !model.deformables.empty() && model.bodies.size() + model.deformables.size() > 1;
}

SurfaceContact::SurfaceContact(const Model& model, const State& state, int threads)
    : model_(model),
      contact_(model.contact.normal_stiffness, model.thickness, kSkin * shortest_reference(model),
               threads) {
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    const Potential& p = model.bodies[i].potential;
    contact_.add_rigid(p.vertices, static_cast<int>(i), 1 / p.steepest);
  }
  for (const DeformableBody& body : model.deformables) {
    contact_.add_deformable(body.mesh, boundary(body.mesh), body.first_node);
  }
  const int bodies = static_cast<int>(model.bodies.size() + model.deformables.size());
  bool rough = false;
  std::vector<int> kind(bodies);
  std::vector<Friction> table;
  for (int a = 0; a < bodies; ++a) {
    kind[a] = a;
    for (int b = 0; b < bodies; ++b) {
      table.push_back(
          friction_between(model.contact, a, model.material_of(a), b, model.material_of(b)));
      rough = rough || (a != b && table.back().coefficient > 0);
    }
  }
  if (rough) friction_.emplace(std::move(kind), bodies, std::move(table));
  contact_.update(state.displacement, state.position);
  contact_.evaluate();
  slide(state, 0);
}

double SurfaceContact::rate(std::span<const double> node_mass) const {
  double squared = contact_.rate(node_mass).value;
  double steepest = 0;  // of the meshes, 1/m
  for (const Outlines::Body& body : contact_.outlines().bodies) {
    if (!body.rigid()) steepest = std::max(steepest, 1 / body.reference);
  }
  double rigid = 0;
  for (const RigidBody& body : model_.bodies) {
    if (!body.can_move()) continue;
    rigid = std::max(rigid, flat_mobility(body) * (body.potential.steepest + steepest));
  }
  return std::sqrt(squared + model_.stiffness() * rigid);
}

void SurfaceContact::evaluate(const State& state) {
  try {
    contact_.update(state.displacement, state.position);
  } catch (const std::domain_error&) {
    throw Unstable(
        fmt::format("a node is not at a finite place at t = {:.9g} s (step {}): the run "
                    "has become unstable; reduce time.step or time.safety",
                    state.time, state.step));
  }
  contact_.evaluate();
  guard(state);
}

void SurfaceContact::guard(const State& state) const {
  const auto place = [&](const Vec2& p) {
    const Vec2 world = p + model_.origin;
    return fmt::format("at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {})", world.x(), world.y(),
                       state.time, state.step);
  };
  const DeformableContact::Depth& depth = contact_.depth();
  if (depth.ratio >= 1) {
    throw Unstable(fmt::format(
        "\"{}\" is {:.3g} m deep in \"{}\" {}, where its potential near the surface ends at {:.3g} "
        "m: {}",
        name(depth.other), depth.largest, name(depth.body), place(depth.place), depth.limit,
        state.step == 0 ? "move them apart"
                        : "the contact is too soft for this load or the part too thin; raise "
                          "contact.normal_stiffness"));
  }
  if (const auto& self = contact_.self_contact()) {
    throw Unstable(
        fmt::format("\"{}\" folds onto itself {}: contact of a body with itself is not "
                    "modelled; divide it into two bodies",
                    name(self->body), place(self->place)));
  }
}

void SurfaceContact::slide(const State& state, double dt) {
  if (friction_) friction_->update(contact_, state.node_velocity, state.velocity, dt);
}

void SurfaceContact::add_to_nodes(std::vector<double>& node_force) const {
  contact_.add_forces(node_force);
  if (friction_) friction_->add_forces(contact_, node_force);
}

void SurfaceContact::add_to_bodies(std::vector<double>& force) const {
  for (int i = 0; i < static_cast<int>(model_.bodies.size()); ++i) {
    DeformableContact::Resultant sum = contact_.resultant(i);
    if (friction_) {
      const auto rubbing = contact_.resultant(i, friction_->fx(), friction_->fy());
      sum.force += rubbing.force;
      sum.moment += rubbing.moment;
    }
    double* f = &force[3 * static_cast<size_t>(i)];
    f[0] += sum.force.x();
    f[1] += sum.force.y();
    f[2] += sum.moment;
  }
}

double SurfaceContact::energy() const {
  return contact_.energy() + (friction_ ? friction_->memory().energy : 0);
}

double SurfaceContact::friction_loss() const {
  return friction_ ? friction_->memory().friction_loss : 0;
}

std::pair<int, int> SurfaceContact::deepest() const {
  return std::minmax(contact_.depth().body, contact_.depth().other);
}

double SurfaceContact::friction_on(int body) const {
  double sum = 0;
  if (!friction_) return sum;
  const Outlines& o = contact_.outlines();
  for (const EdgeSlip& slip : friction_->memory().slips) {
    const int other = o.bodies[o.body[slip.edge]].rigid() ? o.body[slip.partner] : slip.partner;
    if (o.body[slip.edge] == body || other == body) sum += std::abs(slip.spring);
  }
  return sum;
}

BodyForce SurfaceContact::on_deformable(int deformable) const {
  const int body = static_cast<int>(model_.bodies.size()) + deformable;
  Vec2 force = contact_.resultant(body).force;
  if (friction_) force += contact_.resultant(body, friction_->fx(), friction_->fy()).force;
  return {force.x(), force.y(), friction_on(body)};
}

std::vector<ContactRecord> SurfaceContact::records() const {
  std::vector<ContactRecord> records;
  for (const BodyContact& c : contact_.body_contacts()) {
    const double reference = std::min(contact_.outlines().bodies[c.a].reference,
                                      contact_.outlines().bodies[c.b].reference);
    records.push_back(
        {c.a, c.b, c.point, c.force, Vec2::Zero(), c.penetration, c.penetration / reference});
  }
  return records;
}

std::vector<SurfaceRecord> SurfaceContact::surfaces() const {
  const Outlines& o = contact_.outlines();
  std::vector<double> pressure, traction;
  contact_.pressures(pressure);
  if (friction_) {
    friction_->tractions(contact_, traction);
  } else {
    traction.assign(pressure.size(), 0);
  }
  std::vector<SurfaceRecord> records;
  for (int i = 0; i < o.size(); ++i) {
    const int j = o.next[i];
    records.push_back({o.body[i], {o.x[i], o.y[i]}, {o.x[j], o.y[j]}, pressure[i], traction[i]});
  }
  return records;
}

void SurfaceContact::restore(const SlipMemory& memory, const State& state) {
  contact_.update(state.displacement, state.position);
  contact_.evaluate();
  if (!friction_) return;
  friction_->restore(memory);
  friction_->update(contact_, state.node_velocity, state.velocity, 0);
}

const std::string& SurfaceContact::name(int body) const { return model_.name_of(body); }

}  // namespace apothem
