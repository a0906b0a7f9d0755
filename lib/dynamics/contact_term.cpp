#include "lib/dynamics/contact_term.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/dynamics/unstable.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/model/inradius.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {
namespace {

std::string too_soft(const ContactLaw& law) {
  return fmt::format("the contact is too soft for this load; {}", stiffening(law));
}

constexpr double kPolygonSkin = 0.1;  // of the size of a rigid body
constexpr double kMeshSkin = 0.25;    // of the shortest reference length
// Of the smaller inradius of two bodies. The middle of a body, an inradius from its boundary,
// cannot be inside another one before they are so deep in each other; elements stretch.
constexpr double kPassage = 0.5;
// A corner that has closed may open again before the run fails for it.
constexpr int kLooksKept = 8;

// How far the boundary of a body may move between two searches, twice over, m. Small bodies have
// small boxes. One that stays in its place needs no room.
double own_skin(const RigidBody& body) {
  return body.can_move() ? kPolygonSkin * std::sqrt(body.area) : 0;
}

// The harmonic mean of these. The boxes of large bodies have no more room, so that they do not meet
// those of small ones that are far from them.
double common_skin(const Model& model) {
  double sum = 0;
  int count = 0;
  for (const RigidBody& body : model.bodies) {
    if (!body.can_move()) continue;
    sum += 1 / own_skin(body);
    ++count;
  }
  return count > 0 ? count / sum : 0;
}

std::vector<double> inradii_of(const Model& model) {
  std::vector<double> inradii(model.bodies.size() + model.deformables.size());
  for (size_t i = 0; i < inradii.size(); ++i) {
    inradii[i] = inradius_of(model, static_cast<BodyIndex>(i));
  }
  return inradii;
}

// Of a body with a mesh as if it were rigid: what a support holds does not give way.
MeshInertia inertia_of(const DeformableBody& body, const DegreesOfFreedom& dofs) {
  const std::vector<Vec2>& nodes = body.mesh.nodes;
  MeshInertia inertia{{1, 1, 1}, {}};
  double mass = 0, moment = 0;
  Vec2 centre = Vec2::Zero();
  for (size_t i = 0; i < nodes.size(); ++i) {
    const size_t c = dofs.layout().node(body.first_node + static_cast<NodeIndex>(i));
    for (const size_t axis : {0, 1}) {
      if (dofs.is_held(c + axis)) inertia.inverse_mass[axis] = inertia.inverse_mass[2] = 0;
    }
    inertia.mass_fractions.push_back(dofs.mass(c));
    mass += dofs.mass(c);
    centre += dofs.mass(c) * nodes[i];
  }
  centre /= mass;
  for (size_t i = 0; i < nodes.size(); ++i) {
    moment += inertia.mass_fractions[i] * (nodes[i] - centre).squaredNorm();
    inertia.mass_fractions[i] /= mass;
  }
  for (const size_t axis : {0, 1}) inertia.inverse_mass[axis] /= mass;
  inertia.inverse_mass[2] /= moment;
  return inertia;
}

}  // namespace

double shortest_inradius(const Model& model) {
  double shortest = HUGE_VAL;
  for (const DeformableBody& body : model.deformables) {
    shortest = std::min(shortest, boundary_inradius(body.mesh, boundary(body.mesh)));
  }
  return shortest;
}

bool ContactTerm::needed(const Model& model) {
  return model.bodies.size() + model.deformables.size() > 1 || touches_itself(model);
}

bool ContactTerm::touches_itself(const Model& model) {
  return !model.deformables.empty() && model.contact.self;
}

bool ContactTerm::touches_meshes(const Model& model) {
  return !model.deformables.empty() && needed(model);
}

Surfaces ContactTerm::surfaces_of(const Model& model, const DegreesOfFreedom& dofs) {
  const bool meshes = !model.deformables.empty();
  const bool outlines = meshes && model.contact.surface == ContactSurface::body;
  Surfaces surfaces(common_skin(model), meshes ? kMeshSkin * shortest_inradius(model) : 0,
                    outlines);
  size_t vertices = 0;
  for (const RigidBody& body : model.bodies) vertices += body.potential.vertices.size();
  surfaces.reserve_polygons(model.bodies.size(), vertices);
  for (const RigidBody& body : model.bodies) {
    surfaces.add_polygon(body.potential, {.inverse_mass = body.inverse_mass(),
                                          .inradius = body.inradius,
                                          .moves = body.can_move(),
                                          .skin = own_skin(body)});
  }
  const PotentialChoice& choice = model.contact.potential;
  std::optional<double> reference;
  if (choice.reference == PotentialChoice::Reference::length) reference = choice.length;
  for (const DeformableBody& body : model.deformables) {
    if (outlines) {
      surfaces.add_outline(body.mesh, body.first_node, reference, inertia_of(body, dofs));
      continue;
    }
    try {
      surfaces.add_elements(body.mesh, body.first_node, choice, inertia_of(body, dofs));
    } catch (const InvalidPolygon& error) {
      throw Unrunnable(fmt::format("elements of \"{}\" cannot have potentials of their own: {}; "
                                   "use another mesh or \"surface\": \"body\"",
                                   body.name, error.what()),
                       "contact/surface", -1);
    }
  }
  return surfaces;
}

ContactTerm::ContactTerm(const Model& model, const DegreesOfFreedom& dofs, const State& state,
                         int threads)
    : model_(model),
      dofs_(dofs),
      contacts_(model.contact, model.thickness, surfaces_of(model, dofs), pair_table(model),
                threads),
      inradius_(inradii_of(model)),
      strides_(model, inradius_, threads) {
  shortest_inradius_ = *std::ranges::min_element(inradius_);
  if (!state.absent.empty()) contacts_.set_absent(state.absent);
  try {
    contacts_.place_all(state.kinematics(state.v));
  } catch (const NotFinite& error) {
    throw Unrunnable(error.what(), "bodies", -1);
  }
  if (touches_meshes(model)) refuse_engulfed(state);
}

// Contact of meshes is felt near surfaces only: a body deep inside another one would feel nothing.
void ContactTerm::refuse_engulfed(const State& state) const {
  OutlineSurfaces outlines;
  for (RigidIndex i = 0; i < static_cast<RigidIndex>(model_.bodies.size()); ++i) {
    const Potential& potential = model_.bodies[i].potential;
    outlines.add_rigid(potential.rings(), i, 1 / potential.steepest);
  }
  for (const DeformableBody& body : model_.deformables) {
    outlines.add_mesh(body.mesh, boundary(body.mesh), body.first_node);
  }
  outlines.place(state.kinematics(state.v), contacts_.surfaces().shapes());
  const std::optional<EngulfedBody> found = find_engulfed(outlines, state.absent);
  if (!found) return;
  const Vec2 world = found->place + model_.origin;
  throw Unrunnable(
      fmt::format("\"{}\" is inside \"{}\" at ({:.6g}, {:.6g}) m, {}, deeper than contact reaches: "
                  "move them apart",
                  name(found->inner), name(found->outer), world.x(), world.y(), at_time(state)),
      "bodies", -1);
}

std::string ContactTerm::describe_shallow_collars() const {
  std::string text;
  const OutlineSurfaces& outlines = contacts_.surfaces().outlines();
  for (const auto& [body, corner] : outlines.shallow) {
    const Vec2 world = corner.place + model_.origin;
    text += fmt::format(
        "; \"{}\" only {:.3g} m deep, because of its inner corner of {:.2g} degrees at ({:.6g}, "
        "{:.6g}) m: two vertices there allow more",
        name(body), outlines.bodies[body].depth, corner.angle * 180 / std::numbers::pi, world.x(),
        world.y());
  }
  return text;
}

std::string ContactTerm::describe() const {
  const ContactLaw& law = model_.contact;
  std::string text = fmt::format(
      "contact of {} surfaces, {} potential, k_n = {:g} Pa", contacts_.surfaces().size(),
      law.potential.kind == PotentialChoice::Kind::area ? "area" : "distance",
      law.normal_stiffness);
  if (touches_meshes(model_)) {
    text += law.surface == ContactSurface::body ? "; meshes by the potentials of their boundaries"
                                                : "; meshes by the potentials of their elements";
    if (touches_itself(model_)) text += ", also with themselves";
    text += describe_shallow_collars();
  }
  text += contacts_.table().rough() ? fmt::format("; friction, mu = {:g}", law.friction.coefficient)
                                    : "; no friction";
  if (contacts_.damped()) {
    text += fmt::format("; viscous damping, {} {:g} and {:g}",
                        law.damping.are_times ? "times" : "ratios", law.damping.normal,
                        law.damping.tangential);
  }
  if (!law.rules.empty()) text += fmt::format("; {} rules by pair", law.rules.size());
  return text;
}

void ContactTerm::check_drift(const State& state, double dt) {
  const auto fault = strides_.look(state, contacts_.surfaces(), dt);
  if (!fault) return;
  throw Unstable(
      fmt::format(
          "body \"{}\" moves {:.3g} m in one step where \"{}\" is in its way, {}, more than a "
          "quarter of {:.3g} m, the smaller inradius of the two: contacts would be missed; "
          "reduce the time step",
          name(fault->fast), fault->stride, name(fault->other), at_time(state), fault->length),
      fault->fast < static_cast<BodyIndex>(model_.bodies.size()) ? fault->fast : -1);
}

void ContactTerm::watch(const State& state) {
  if (!touches_itself(model_)) return;
  const OutlineSurfaces& outlines = contacts_.surfaces().outlines();
  const std::optional<OutlineSurfaces::Notch> notch = outlines.closed_notch();
  if (!notch) {
    if (++looks_without_notch_ >= kLooksKept) closed_notch_.clear();
    return;
  }
  looks_without_notch_ = 0;
  const Vec2 world = outlines.point(notch->vertex) + model_.origin;
  closed_notch_ = fmt::format(
      "the inner corner at ({:.6g}, {:.6g}) m of \"{}\" had closed to {:.2g} degrees {}, where "
      "contact of a body with itself is wrong; give the corner two vertices, reduce the load, or "
      "take a stiffer material",
      world.x(), world.y(), name(outlines.body[notch->vertex]),
      notch->angle * 180 / std::numbers::pi, at_time(state));
}

void ContactTerm::add_forces(const Evaluation& now) {
  State& state = now.state;
  Kinematics kinematics = state.kinematics(now.velocity);
  kinematics.finite = now.trial;
  kinematics.still = now.still;
  if (!now.slip.empty()) kinematics.slip = now.slip.first(state.layout.node(0));
  try {
    contacts_.place(kinematics);
  } catch (const NotFinite& error) {
    const bool rigid = error.body() < static_cast<BodyIndex>(model_.bodies.size());
    refuse_infinite(state, (rigid ? "body \"" : "a node of \"") + name(error.body()) + '"',
                    rigid ? error.body() : -1);
  }
  now.clock.lap(Phase::place);
  if (contacts_.search_if_stale() && !now.trial) ++counts_.searches;
  now.clock.lap(Phase::search);
  contacts_.evaluate();
  if (const auto fault = contacts_.fault()) refuse(*fault, state);
  if (now.trial) {
    contacts_.try_friction(kinematics, now.dt);
  } else {
    contacts_.update_friction(kinematics, now.dt);
  }
  now.clock.lap(Phase::contact);
  contacts_.add_forces({state.layout.of_rigid(state.f), state.layout.of_nodes(state.f), now.lambda,
                        now.lambda_limit});
  now.clock.lap(Phase::gather);
  if (now.trial) return;
  counts_.candidate_pairs += static_cast<std::int64_t>(contacts_.candidates());
  counts_.touching_now = contacts_.count();
  counts_.touching_pairs += counts_.touching_now;
  note_peaks(state);
  refuse_passage(state);
}

void ContactTerm::add_dashpots(State& state, double dt, bool onsets, bool first) {
  std::span<const double> kicked = state.f;
  if (onsets) {
    with_event_impulses_ = state.f;
    add_event_impulses(state.layout, with_event_impulses_);
    kicked = with_event_impulses_;
  }
  rails_.clear();
  for (const DegreesOfFreedom::Driven& d : dofs_.driven()) {
    if (!d.servo || d.axis != 0) continue;
    const double mass = dofs_.mass(d.coordinate);
    const double before = Vec2(&state.v[d.coordinate]).dot(d.servo->direction);
    const double rate = d.servo->rate(state.time, Vec2(&state.f[d.coordinate]), before, mass, dt);
    rails_.push_back(
        {static_cast<RigidIndex>(d.coordinate / 3), d.servo->direction, 1 / mass, rate - before});
  }
  contacts_.add_dashpots(state.kinematics(state.v),
                         {dofs_.inverse_mass(), state.v, kicked, state.f, dofs_.weight(), rails_},
                         dt, first, state.f);
}

void ContactTerm::note_peaks(const State& state) {
  if (contacts_.count() == 0) return;
  const auto note = [&](const PairPeak& found, Peak& peak) {
    if (found.value > peak.value) peak = {found.value, state.time, found.a, found.b};
  };
  const Penetrations floors{{penetration_.value}, {relative_penetration_.value}};
  if (!contacts_.may_be_deeper(floors, shortest_inradius_)) {
    note(contacts_.largest_force(), force_);
    return;
  }
  const Penetrations found = contacts_.penetrations(inradius_, floors);
  note(found.largest, penetration_);
  note(found.relative, relative_penetration_);
  note(contacts_.largest_force(), force_);
}

// Contact of meshes resists up to any depth, but with no more than a constant pressure: bodies that
// press harder pass through each other. Rigid ones have the guard of their potentials.
void ContactTerm::refuse_passage(const State& state) {
  if (!touches_meshes(model_) || !(relative_penetration_.value > kPassage)) return;
  std::pair<BodyIndex, BodyIndex> last(-1, -1);
  for (const Contact& contact : contacts_.contacts()) {
    const auto pair = contacts_.bodies(contact);
    const auto [a, b] = pair;
    const bool meshed = std::max(a, b) >= static_cast<BodyIndex>(model_.bodies.size());
    if (pair == last || a == b || !meshed) continue;
    last = pair;
    if (!strides_.are_passing(state, contacts_.surfaces(), a, b)) continue;
    throw Unstable(fmt::format(
        "bodies \"{}\" and \"{}\" overlap as deep as the middle of one of them {} and are about to "
        "pass "
        "through each other: {}",
        name(a), name(b), at_time(state),
        state.step == 0 ? "move them apart" : too_soft(model_.contact)));
  }
}

void ContactTerm::refuse(const ContactFault& fault, const State& state) const {
  using Kind = ContactFault::Kind;
  const Vec2 world = fault.place + model_.origin;
  const std::string& a = name(fault.a);
  const std::string& b = name(fault.b);
  std::string what = fmt::format("bodies \"{}\" and \"{}\" overlap ", a, b);
  std::string advice = too_soft(model_.contact);
  switch (fault.kind) {
    case Kind::singular_area:
      what += "up to the singular area of one of them (phi = 1)";
      break;
    case Kind::centre:
      what += "as deep as the centre of one of them";
      break;
    case Kind::element:
      what += "as deep as the potential of an element or body reaches";
      break;
    case Kind::not_convex:
      what += "at an element that is no longer convex and cannot keep its potential";
      advice = "reduce the load or the time step, or use \"surface\": \"body\"";
      break;
  }
  if (state.step == 0) advice = "move them apart";
  const BodyIndex last = std::max(fault.a, fault.b);
  throw Unstable(fmt::format("{} at ({:.6g}, {:.6g}) m, t = {:.9g} s (step {}): {}", what,
                             world.x(), world.y(), state.time, state.step, advice),
                 last < static_cast<BodyIndex>(model_.bodies.size()) ? last : -1);
}

void ContactTerm::start_ledger() {
  contacts_.start_ledger();
  penetration_ = relative_penetration_ = force_ = {};
  counts_ = {};
}

void ContactTerm::bound_step(StepBounds& bounds) {
  bounds.bodies = contact_step_limit(model_);
  if (!touches_meshes(model_)) return;
  const std::vector<double> slope = contacts_.surfaces().slopes();
  const double steepest = *std::max_element(slope.begin() + contacts_.surfaces().rigid_count(),
                                            slope.end());  // of meshes, 1/m
  double rigid = 0;
  for (const RigidBody& body : model_.bodies) {
    if (!body.can_move()) continue;
    rigid = std::max(rigid, flat_mobility(body) * (body.potential.steepest + steepest));
  }
  const double of_nodes = contacts_.node_rate(dofs_.free_node_mass());
  const double stiffest = contacts_.table().stiffest() * model_.thickness;
  const double rate = std::sqrt(of_nodes + stiffest * rigid);
  bounds.nodes = {2 / hypotenuse(2 / bounds.nodes.step, rate), "elements and their contacts"};
}

void ContactTerm::fields(Archive& archive) {
  archive("contacts", contacts_)("penetration", penetration_)(
      "relative_penetration", relative_penetration_)("force", force_)("counts", counts_);
  archive("closed_notch", closed_notch_)("looks_without_notch", looks_without_notch_);
}

}  // namespace apothem
