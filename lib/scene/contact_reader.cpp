#include "apothem/scene/contact_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apothem {

void ContactReader::read(const JsonValue& value) {
  JsonObject object(in_, value);
  ContactLaw& law = model_.contact;
  if (const JsonValue* v = object.optional("potential")) {
    std::vector<std::string> names;
    for (const NamedPotential& p : kPotentials) names.emplace_back(p.name);
    law.potential.kind = kPotentials[in_.choice(*v, names)].kind;
    potential_ = v;
  }
  law.normal_stiffness =
      in_.positive(object.required("normal_stiffness", "k_n in Pa (there is no default)"), "Pa");
  if (const JsonValue* v = object.optional("field")) field(*v);
  if (const JsonValue* v = object.optional("reference")) reference(*v);
  if (const JsonValue* v = object.optional("friction")) law.friction = friction(*v, true);
  damping_ = object.optional("damping");
  if (damping_) damping(*damping_);
  pairs_ = object.optional("pairs");
  surface(object);
  object.finish();
}

// Of bodies with a mesh, and how its forces reach their nodes.
void ContactReader::surface(JsonObject& object) {
  ContactLaw& law = model_.contact;
  const JsonValue* surface = object.optional("surface");
  if (surface) {
    std::vector<std::string> names;
    for (const NamedSurface& n : kSurfaces) names.emplace_back(n.name);
    law.surface = kSurfaces[in_.choice(*surface, names)].surface;
  }
  const auto fits = [&](const NamedDistribution& d) { return d.surface == law.surface; };
  const NamedDistribution* known = std::find_if(kDistributions.begin(), kDistributions.end(), fits);
  if (const JsonValue* v = object.optional("distribution")) {
    std::vector<std::string> names;
    for (const NamedDistribution& d : kDistributions) names.emplace_back(d.name);
    known = &kDistributions[in_.choice(*v, names)];
    if (!fits(*known)) {
      const bool body = known->surface == ContactSurface::body;
      in_.fail(*v, fmt::format("\"{}\" needs \"surface\": \"{}\"; {}", known->name,
                               body ? "body" : "element",
                               body ? "with elements use \"resultant\" or \"integrated\""
                                    : "the body's own surface has \"variational\" only"));
    }
  }
  law.distribution = known->distribution;
  if (law.surface == ContactSurface::element) element_surface_ = surface;
}

// Of the whole scene, or of a pair, which may leave the stiffness to the scene.
Friction ContactReader::friction(const JsonValue& value, bool of_scene) {
  ContactLaw& law = model_.contact;
  JsonObject object(in_, value);
  Friction friction = law.friction;
  const JsonValue& mu = object.required("coefficient", "mu, 0 or more");
  friction.coefficient = in_.number(mu, "");
  if (!(friction.coefficient >= 0)) in_.fail(mu, "must be 0 or more");
  if (const JsonValue* v = object.optional("tangential_stiffness")) {
    friction.tangential_stiffness = in_.positive(*v, "Pa");
  } else if (friction.coefficient > 0 && !(friction.tangential_stiffness > 0)) {
    object.required("tangential_stiffness", "k_s in Pa");
  }
  if (of_scene) {
    if (const JsonValue* v = object.optional("law")) {
      std::vector<std::string> names;
      for (const NamedFrictionLaw& l : kFrictionLaws) names.emplace_back(l.name);
      law.friction_law = kFrictionLaws[in_.choice(*v, names)].law;
      friction_law_ = v;
    }
  }
  object.finish();
  return friction;
}

void ContactReader::damping(const JsonValue& value) {
  JsonObject object(in_, value);
  std::vector<std::string> names;
  for (const NamedDamping& d : kDampingModels) names.emplace_back(d.name);
  const NamedDamping& model =
      kDampingModels[in_.choice(object.required("model", "normal_viscous or mass"), names)];
  const std::string key(model.key);
  const std::string unit(model.unit);
  model_.contact.*model.value =
      in_.positive(object.required(key, "a positive number " + unit), unit);
  object.finish();
}

// After the bodies, whose names it may use.
void ContactReader::pairs() {
  if (pairs_ == nullptr) return;
  for (const JsonValue& value : in_.array(*pairs_)) {
    JsonObject object(in_, value);
    const JsonValue& between = object.required("between", "two names of materials or bodies");
    const std::vector<JsonValue>& names = in_.array(between);
    if (names.size() != 2) in_.fail(between, "must hold two names of materials or bodies");
    const ContactRule::Party a = party(names[0]);
    const ContactRule::Party b = party(names[1]);
    const Friction rule = friction(object.required("friction", "{\"coefficient\": ...}"), false);
    model_.contact.rules.push_back({{a, b}, rule});
    object.finish();
  }
}

// What bodies with a mesh cannot take.
void ContactReader::refuse_with_meshes() const {
  const ContactLaw& law = model_.contact;
  // What is for rigid bodies only may stand where two of them can meet.
  if (model_.deformables.empty() || model_.bodies.size() > 1) return;
  if (law.friction_law == FrictionLaw::per_edge) {
    in_.fail(*friction_law_,
             "\"per_edge\" is for rigid bodies only; bodies with a mesh have a spring per boundary "
             "edge, or per pair of elements with \"surface\": \"element\": leave it out");
  }
  if (law.normal_damping > 0) {
    in_.fail(*damping_,
             "acts between rigid bodies only, and there are no two of them; leave it out, and give "
             "the material of the mesh \"damping\"");
  }
  if (law.potential.kind == PotentialChoice::Kind::area && law.surface == ContactSurface::body) {
    in_.fail(*potential_,
             "\"area\" is for triangles; the surface of a body with a mesh has the depth below it: "
             "use \"distance\", or \"surface\": \"element\" with triangles");
  }
}

// A name that is both a body's and a material's means the body.
ContactRule::Party ContactReader::party(const JsonValue& value) const {
  const std::string& name = in_.string(value);
  const int bodies = static_cast<int>(model_.bodies.size() + model_.deformables.size());
  for (int i = 0; i < bodies; ++i) {
    if (model_.name_of(i) == name) return {true, i};
  }
  for (size_t i = 0; i < model_.materials.size(); ++i) {
    if (model_.materials[i].name == name) return {false, static_cast<int>(i)};
  }
  in_.fail(value, fmt::format("\"{}\" is neither a body nor a material", name));
}

void ContactReader::field(const JsonValue& value) {
  PotentialChoice& choice = model_.contact.potential;
  if (choice.kind == PotentialChoice::Kind::area) {
    in_.fail(value, "the area potential has one field only; leave it out");
  }
  std::vector<std::string> names;
  for (const NamedField& f : kFields) names.emplace_back(f.name);
  choice.field = kFields[in_.choice(value, names)].field;
}

void ContactReader::reference(const JsonValue& value) {
  PotentialChoice& choice = model_.contact.potential;
  if (choice.kind == PotentialChoice::Kind::area) {
    in_.fail(value, "the area potential has no reference length; leave it out");
  }
  if (value.type == JsonValue::Type::number) {
    choice.reference = PotentialChoice::Reference::length;
    choice.length = in_.positive(value, "m");
    if (!std::isfinite(1 / choice.length)) in_.fail(value, "is too small for double precision");
    return;
  }
  std::vector<std::string> names;
  for (const NamedReference& r : kReferences) names.emplace_back(r.name);
  choice.reference = kReferences[in_.choice(value, names)].reference;
}

}  // namespace apothem
