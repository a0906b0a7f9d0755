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

SurfaceContact::Contact SurfaceContact::make_contact(const Model& model, int threads) {
  const double skin = kSkin * shortest_reference(model);
  const double stiffness = model.contact.normal_stiffness;
  const int rigid = static_cast<int>(model.bodies.size());
  if (model.contact.surface == ContactSurface::body) {
    DeformableContact contact(stiffness, model.thickness, skin, threads);
    for (int i = 0; i < rigid; ++i) {
      const Potential& p = model.bodies[i].potential;
      contact.add_rigid(p.vertices, i, 1 / p.steepest);
    }
    for (const DeformableBody& body : model.deformables) {
      contact.add_deformable(body.mesh, boundary(body.mesh), body.first_node);
    }
    return contact;
  }
  ElementContact contact(stiffness, model.thickness, skin, model.contact.distribution, threads);
  for (int i = 0; i < rigid; ++i) contact.add_rigid(model.bodies[i].potential, i);
  for (const DeformableBody& body : model.deformables) {
    try {
      contact.add_deformable(body.mesh, boundary(body.mesh), body.first_node,
                             model.contact.potential);
    } catch (const InvalidPolygon& error) {
      throw Unrunnable(fmt::format("elements of \"{}\" cannot have potentials of their own: {}; "
                                   "use another mesh or \"surface\": \"body\"",
                                   body.name, error.what()),
                       "contact/surface", -1);
    }
  }
  return contact;
}

SurfaceContact::SurfaceContact(const Model& model, const State& state, int threads)
    : model_(model), contact_(make_contact(model, threads)) {
  if (std::holds_alternative<DeformableContact>(contact_)) add_friction();
  refresh(state);
}

void SurfaceContact::add_friction() {
  const int bodies = static_cast<int>(model_.bodies.size() + model_.deformables.size());
  bool rough = false;
  std::vector<int> kind(bodies);
  std::vector<Friction> table;
  for (int a = 0; a < bodies; ++a) {
    kind[a] = a;
    for (int b = 0; b < bodies; ++b) {
      table.push_back(
          friction_between(model_.contact, a, model_.material_of(a), b, model_.material_of(b)));
      rough = rough || (a != b && table.back().coefficient > 0);
    }
  }
  if (rough) friction_.emplace(std::move(kind), bodies, std::move(table));
}

double SurfaceContact::rate(std::span<const double> node_mass) const {
  const auto bound = [&](const auto& contact) {
    double steepest = 0;  // of the meshes, 1/m
    for (size_t i = 0; i < model_.deformables.size(); ++i) {
      const int body = static_cast<int>(model_.bodies.size() + i);
      steepest = std::max(steepest, contact.slope(body));
    }
    double rigid = 0;
    for (const RigidBody& body : model_.bodies) {
      if (!body.can_move()) continue;
      rigid = std::max(rigid, flat_mobility(body) * (body.potential.steepest + steepest));
    }
    return std::sqrt(contact.rate(node_mass).value + model_.stiffness() * rigid);
  };
  return std::visit(bound, contact_);
}

void SurfaceContact::evaluate(const State& state) {
  const auto evaluate_one = [&](auto& contact) {
    try {
      contact.update(state.displacement, state.position);
    } catch (const std::domain_error&) {
      throw Unstable(
          fmt::format("a node is not at a finite place at t = {:.9g} s (step {}): the run "
                      "has become unstable; reduce time.step or time.safety",
                      state.time, state.step));
    }
    contact.evaluate();
    guard(contact, state);
  };
  std::visit(evaluate_one, contact_);
}

std::string SurfaceContact::at(const Vec2& place, const State& state) const {
  const Vec2 world = place + model_.origin;
  return fmt::format("at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {})", world.x(), world.y(),
                     state.time, state.step);
}

void SurfaceContact::guard(const DeformableContact& contact, const State& state) const {
  const DeformableContact::Depth& depth = contact.depth();
  if (depth.ratio >= 1) {
    throw Unstable(fmt::format(
        "\"{}\" is {:.3g} m deep in \"{}\" {}, where its potential near the surface ends at {:.3g} "
        "m: {}",
        name(depth.other), depth.largest, name(depth.body), at(depth.place, state), depth.limit,
        state.step == 0 ? "move them apart"
                        : "the contact is too soft for this load or the part too thin; raise "
                          "contact.normal_stiffness"));
  }
  if (const auto& self = contact.self_contact()) {
    throw Unstable(
        fmt::format("\"{}\" folds onto itself {}: contact of a body with itself is not "
                    "modelled; divide it into two bodies",
                    name(self->body), at(self->place, state)));
  }
}

void SurfaceContact::guard(const ElementContact& contact, const State& state) const {
  const auto& fault = contact.fault();
  if (!fault) return;
  if (fault->kind == ElementContact::Fault::Kind::not_convex) {
    throw Unstable(
        fmt::format("an element in the contact of \"{}\" and \"{}\" is no longer convex {}: it "
                    "cannot keep its potential; reduce the load or time.safety, or use "
                    "\"surface\": \"body\"",
                    name(fault->body), name(fault->other), at(fault->place, state)));
  }
  throw Unstable(fmt::format(
      "\"{}\" and \"{}\" overlap as deep as the potential of an element or body reaches {}: {}",
      name(fault->body), name(fault->other), at(fault->place, state),
      state.step == 0 ? "move them apart"
                      : "the contact is too soft for this load; raise contact.normal_stiffness"));
}

void SurfaceContact::slide(const State& state, double dt) {
  if (!friction_) return;
  friction_->update(std::get<DeformableContact>(contact_), state.node_velocity, state.velocity, dt);
}

void SurfaceContact::add_to_nodes(std::vector<double>& node_force) const {
  std::visit([&](const auto& contact) { contact.add_forces(node_force); }, contact_);
  if (friction_) friction_->add_forces(std::get<DeformableContact>(contact_), node_force);
}

DeformableContact::Resultant SurfaceContact::friction_sum(int body) const {
  if (!friction_) return {Vec2::Zero(), 0};
  return std::get<DeformableContact>(contact_).resultant(body, friction_->fx(), friction_->fy());
}

void SurfaceContact::add_to_bodies(std::vector<double>& force) const {
  for (int i = 0; i < static_cast<int>(model_.bodies.size()); ++i) {
    DeformableContact::Resultant sum =
        std::visit([&](const auto& contact) { return contact.resultant(i); }, contact_);
    const DeformableContact::Resultant rubbing = friction_sum(i);
    sum.force += rubbing.force;
    sum.moment += rubbing.moment;
    double* f = &force[3 * static_cast<size_t>(i)];
    f[0] += sum.force.x();
    f[1] += sum.force.y();
    f[2] += sum.moment;
  }
}

double SurfaceContact::energy() const {
  return std::visit([](const auto& contact) { return contact.energy(); }, contact_) +
         (friction_ ? friction_->memory().energy : 0);
}

double SurfaceContact::penetration() const {
  return std::visit([](const auto& contact) { return contact.depth().largest; }, contact_);
}

int SurfaceContact::searches() const {
  return std::visit([](const auto& contact) { return contact.searches(); }, contact_);
}

size_t SurfaceContact::candidates() const {
  return std::visit([](const auto& contact) { return contact.candidates().size(); }, contact_);
}

size_t SurfaceContact::touching() const {
  return std::visit([](const auto& contact) { return contact.touching(); }, contact_);
}

double SurfaceContact::friction_loss() const {
  return friction_ ? friction_->memory().friction_loss : 0;
}

std::pair<int, int> SurfaceContact::deepest() const {
  const auto bodies = [](const auto& contact) -> std::pair<int, int> {
    return std::minmax(contact.depth().body, contact.depth().other);
  };
  return std::visit(bodies, contact_);
}

double SurfaceContact::friction_on(int body) const {
  double sum = 0;
  if (!friction_) return sum;
  const Outlines& o = std::get<DeformableContact>(contact_).outlines();
  for (const EdgeSlip& slip : friction_->memory().slips) {
    const int other = o.bodies[o.body[slip.edge]].rigid() ? o.body[slip.partner] : slip.partner;
    if (o.body[slip.edge] == body || other == body) sum += std::abs(slip.spring);
  }
  return sum;
}

BodyForce SurfaceContact::on_deformable(int deformable) const {
  const int body = static_cast<int>(model_.bodies.size()) + deformable;
  const Vec2 force =
      std::visit([&](const auto& contact) -> Vec2 { return contact.resultant(body).force; },
                 contact_) +
      friction_sum(body).force;
  return {force.x(), force.y(), friction_on(body)};
}

std::vector<ContactRecord> SurfaceContact::records() const {
  std::vector<ContactRecord> records;
  const auto add_all = [&](const auto& contact) {
    for (const BodyContact& c : contact.body_contacts()) {
      const double slope = std::max(contact.slope(c.a), contact.slope(c.b));
      records.push_back(
          {c.a, c.b, c.point, c.force, Vec2::Zero(), c.penetration, c.penetration * slope});
    }
  };
  std::visit(add_all, contact_);
  return records;
}

std::vector<SurfaceRecord> SurfaceContact::surfaces() const {
  const auto* contact = std::get_if<DeformableContact>(&contact_);
  if (contact == nullptr) return {};
  const Outlines& o = contact->outlines();
  std::vector<double> pressure, traction;
  contact->pressures(pressure);
  if (friction_) {
    friction_->tractions(*contact, traction);
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
  if (friction_) friction_->restore(memory);
  refresh(state);
}

// Contacts and friction as they are, without a step.
void SurfaceContact::refresh(const State& state) {
  const auto place = [&](auto& contact) {
    contact.update(state.displacement, state.position);
    contact.evaluate();
  };
  std::visit(place, contact_);
  slide(state, 0);
}

const std::string& SurfaceContact::name(int body) const { return model_.name_of(body); }

}  // namespace apothem
