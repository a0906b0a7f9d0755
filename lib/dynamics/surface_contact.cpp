#include "apothem/dynamics/surface_contact.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "apothem/dynamics/fold_watch.hpp"
#include "apothem/dynamics/unstable.hpp"
#include "apothem/geometry/polygon/predicates.hpp"

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

// Closed lines around a body as it is given, with what is inside on the left.
struct Outline {
  std::vector<std::vector<Vec2>> loops;
  double reach;  // of its potentials, m
  Box box;
};

Outline outline_of(const RigidBody& body) {
  Outline outline{{{}}, 1 / body.potential.steepest, {}};
  const Eigen::Rotation2Dd rotation(body.angle);
  for (const Vec2& v : body.potential.vertices) {
    outline.loops[0].emplace_back(body.position + rotation * v);
  }
  return outline;
}

Outline outline_of(const DeformableBody& body) {
  Outline outline{{}, 0, {}};
  for (const BoundaryLoop& loop : boundary(body.mesh).loops) {
    std::vector<Vec2>& ring = outline.loops.emplace_back();
    for (const int n : loop.nodes) ring.push_back(body.mesh.nodes[n]);
    const std::vector<double> radii = inradii(body.mesh, loop);
    outline.reach = std::max(outline.reach, *std::max_element(radii.begin(), radii.end()));
  }
  return outline;
}

double distance(const Outline& outline, const Vec2& p) {
  double least = HUGE_VAL;
  for (const std::vector<Vec2>& ring : outline.loops) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 edge = ring[(i + 1) % ring.size()] - ring[i];
      const double along = std::clamp((p - ring[i]).dot(edge) / edge.squaredNorm(), 0., 1.);
      least = std::min(least, (ring[i] + along * edge - p).norm());
    }
  }
  return least;
}

// A vertex of a that is farther inside b than potentials reach.
std::optional<Vec2> buried(const Outline& a, const Outline& b) {
  if (apart(a.box, b.box)) return {};
  for (const std::vector<Vec2>& ring : a.loops) {
    for (const Vec2& p : ring) {
      if (apart({p.x(), p.y(), p.x(), p.y()}, b.box)) continue;
      bool inside = false;
      for (const std::vector<Vec2>& other : b.loops) inside ^= strictly_inside(other, p);
      if (inside && distance(b, p) > b.reach) return p;
    }
  }
  return {};
}

}  // namespace

bool SurfaceContact::needed(const Model& model) {
  return !model.deformables.empty() && model.bodies.size() + model.deformables.size() > 1;
}

SurfaceContact::Surface SurfaceContact::make_surface(const Model& model, int threads) {
  const double skin = kSkin * shortest_reference(model);
  const double stiffness = model.contact.normal_stiffness;
  const int rigid = static_cast<int>(model.bodies.size());
  if (model.contact.surface == ContactSurface::body) {
    DeformableContact contact(stiffness, model.thickness, skin, threads);
    for (int i = 0; i < rigid; ++i) {
      const Potential& p = model.bodies[i].potential;
      contact.add_rigid(p.vertices, i, 1 / p.steepest);
    }
    const PotentialChoice& choice = model.contact.potential;
    std::optional<double> reference;
    if (choice.reference == PotentialChoice::Reference::length) reference = choice.length;
    for (const DeformableBody& body : model.deformables) {
      contact.add_deformable(body.mesh, boundary(body.mesh), body.first_node, reference);
    }
    return ByBody{std::move(contact)};
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
  return ByElement{std::move(contact)};
}

SurfaceContact::SurfaceContact(const Model& model, const State& state, int threads)
    : model_(model), surface_(make_surface(model, threads)) {
  add_friction();
  find_buried(state);
  refresh(state);
}

// Contact is felt near surfaces only: a body deep inside another one would feel nothing.
void SurfaceContact::find_buried(const State& state) const {
  std::vector<Outline> outlines;
  for (const RigidBody& body : model_.bodies) outlines.push_back(outline_of(body));
  for (const DeformableBody& body : model_.deformables) outlines.push_back(outline_of(body));
  for (Outline& outline : outlines) {
    for (const std::vector<Vec2>& ring : outline.loops) {
      for (const Vec2& p : ring) outline.box.include(p.x(), p.y());
    }
  }
  const int rigid = static_cast<int>(model_.bodies.size());
  for (int a = 0; a < static_cast<int>(outlines.size()); ++a) {
    for (int b = a < rigid ? rigid : 0; b < static_cast<int>(outlines.size()); ++b) {
      if (a == b) continue;
      if (const std::optional<Vec2> place = buried(outlines[a], outlines[b])) {
        throw Unrunnable(fmt::format("\"{}\" is inside \"{}\" {}, deeper than contact reaches: "
                                     "move them apart",
                                     name(a), name(b), at(*place, state)),
                         "bodies", -1);
      }
    }
  }
}

// Bodies of one material are of one kind, unless a rule names them.
void SurfaceContact::add_friction() {
  const int bodies = static_cast<int>(model_.bodies.size() + model_.deformables.size());
  std::vector<char> named(bodies);
  for (const ContactRule& rule : model_.contact.rules) {
    for (const ContactRule::Party& party : rule.between) {
      if (party.is_body) named[party.index] = 1;
    }
  }
  std::vector<int> kind, first;  // of each body; the first body of each kind
  std::vector<int> of_material(model_.materials.size(), -1);
  for (int a = 0; a < bodies; ++a) {
    int& known = of_material[model_.material_of(a)];
    kind.push_back(named[a] || known < 0 ? static_cast<int>(first.size()) : known);
    if (!named[a]) known = kind.back();
    if (kind.back() == static_cast<int>(first.size())) first.push_back(a);
  }
  bool rough = false;
  std::vector<Friction> table;
  for (const int a : first) {
    for (const int b : first) {
      table.push_back(
          friction_between(model_.contact, a, model_.material_of(a), b, model_.material_of(b)));
      rough = rough || table.back().coefficient > 0;
    }
  }
  if (!rough) return;
  FrictionTable friction(std::move(kind), static_cast<int>(first.size()), std::move(table));
  std::visit([&](auto& s) { s.friction.emplace(std::move(friction)); }, surface_);
}

double SurfaceContact::rate(std::span<const double> node_mass) const {
  const auto bound = [&](const auto& surface) {
    const auto& contact = surface.contact;
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
  return std::visit(bound, surface_);
}

void SurfaceContact::evaluate(const State& state) {
  const auto evaluate_one = [&](auto& surface) {
    try {
      surface.contact.update(state.displacement, state.position);
    } catch (const std::domain_error&) {
      throw Unstable(
          fmt::format("a node is not at a finite place at t = {:.9g} s (step {}): the run "
                      "has become unstable; reduce time.step or time.safety",
                      state.time, state.step));
    }
    surface.contact.evaluate();
    guard(surface.contact, state);
  };
  std::visit(evaluate_one, surface_);
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
    refuse_fold(model_, state, self->body, self->place);
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
  const auto slide_one = [&](auto& s) {
    if (s.friction) s.friction->update(s.contact, state.node_velocity, state.velocity, dt);
  };
  std::visit(slide_one, surface_);
}

void SurfaceContact::add_to_nodes(std::vector<double>& node_force) const {
  const auto add = [&](const auto& s) {
    s.contact.add_forces(node_force);
    if (s.friction) s.friction->add_forces(s.contact, node_force);
  };
  std::visit(add, surface_);
}

DeformableContact::Resultant SurfaceContact::sum(int body) const {
  const auto both = [&](const auto& s) {
    DeformableContact::Resultant sum = s.contact.resultant(body);
    if (!s.friction) return sum;
    const DeformableContact::Resultant rubbing = s.friction->resultant(s.contact, body);
    sum.force += rubbing.force;
    sum.moment += rubbing.moment;
    return sum;
  };
  return std::visit(both, surface_);
}

void SurfaceContact::add_to_bodies(std::vector<double>& force) const {
  for (int i = 0; i < static_cast<int>(model_.bodies.size()); ++i) {
    const DeformableContact::Resultant on = sum(i);
    double* f = &force[3 * static_cast<size_t>(i)];
    f[0] += on.force.x();
    f[1] += on.force.y();
    f[2] += on.moment;
  }
}

double SurfaceContact::energy() const {
  return std::visit([](const auto& s) { return s.contact.energy(); }, surface_) +
         remembered(&SlipMemory::energy);
}

double SurfaceContact::remembered(double SlipMemory::*value) const {
  return std::visit([&](const auto& s) { return s.friction ? s.friction->memory().*value : 0; },
                    surface_);
}

double SurfaceContact::penetration() const {
  return std::visit([](const auto& s) { return s.contact.depth().largest; }, surface_);
}

int SurfaceContact::searches() const {
  return std::visit([](const auto& s) { return s.contact.searches(); }, surface_);
}

size_t SurfaceContact::candidates() const {
  return std::visit([](const auto& s) { return s.contact.candidates().size(); }, surface_);
}

size_t SurfaceContact::touching() const {
  return std::visit([](const auto& s) { return s.contact.touching(); }, surface_);
}

double SurfaceContact::friction_loss() const { return remembered(&SlipMemory::friction_loss); }

std::pair<int, int> SurfaceContact::deepest() const {
  const auto bodies = [](const auto& s) -> std::pair<int, int> {
    return std::minmax(s.contact.depth().body, s.contact.depth().other);
  };
  return std::visit(bodies, surface_);
}

BodyForce SurfaceContact::on_deformable(int deformable) const {
  const int body = static_cast<int>(model_.bodies.size()) + deformable;
  const Vec2 force = sum(body).force;
  const double friction = std::visit(
      [&](const auto& s) { return s.friction ? s.friction->size(s.contact, body) : 0; }, surface_);
  return {force.x(), force.y(), friction};
}

std::vector<ContactRecord> SurfaceContact::records() const {
  std::vector<ContactRecord> records;
  const auto add_all = [&](const auto& s) {
    std::vector<BodyContact> contacts = s.contact.body_contacts();
    if (s.friction) s.friction->add_to(s.contact, contacts);
    for (const BodyContact& c : contacts) {
      const double slope = std::max(s.contact.slope(c.a), s.contact.slope(c.b));
      records.push_back(
          {c.a, c.b, c.point, c.force, c.friction, c.penetration, c.penetration * slope});
    }
  };
  std::visit(add_all, surface_);
  return records;
}

std::vector<SurfaceRecord> SurfaceContact::surfaces() const {
  std::vector<SurfaceRecord> records;
  if (const auto* s = std::get_if<ByBody>(&surface_)) {
    const Outlines& o = s->contact.outlines();
    std::vector<double> pressure, traction(o.size());
    s->contact.pressures(pressure);
    if (s->friction) s->friction->tractions(s->contact, traction);
    for (int i = 0; i < o.size(); ++i) {
      const int j = o.next[i];
      records.push_back({o.body[i], {o.x[i], o.y[i]}, {o.x[j], o.y[j]}, pressure[i], traction[i]});
    }
    return records;
  }
  const auto& s = std::get<ByElement>(surface_);
  const std::vector<ElementContact::SurfaceEdge> edges = s.contact.surface();
  const std::vector<double> pressure = s.contact.pressures(edges);
  std::vector<double> traction(edges.size());
  if (s.friction) traction = s.friction->tractions(s.contact, edges);
  for (size_t i = 0; i < edges.size(); ++i) {
    records.push_back(
        {s.contact.body(edges[i].polygon), edges[i].from, edges[i].to, pressure[i], traction[i]});
  }
  return records;
}

SlipMemory SurfaceContact::memory() const {
  return std::visit([](const auto& s) { return s.friction ? s.friction->memory() : SlipMemory{}; },
                    surface_);
}

void SurfaceContact::restore(const SlipMemory& memory, const State& state) {
  const auto restore_one = [&](auto& s) {
    if (s.friction) s.friction->restore(memory);
  };
  std::visit(restore_one, surface_);
  refresh(state);
}

// Contacts and friction as they are, without a step.
void SurfaceContact::refresh(const State& state) {
  const auto place = [&](auto& s) {
    s.contact.update(state.displacement, state.position);
    s.contact.evaluate();
  };
  std::visit(place, surface_);
  slide(state, 0);
}

const std::string& SurfaceContact::name(int body) const { return model_.name_of(body); }

}  // namespace apothem
