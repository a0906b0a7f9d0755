#include "lib/scene/contact_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Blocks that stick rest with it; with a third of it some creep (docs/verification.md, Rest).
constexpr double kBulkDamping = .1;

// The entry of a table of names that a scene chooses.
template <class Table>
const auto& chosen(const JsonReader& in, const JsonValue& value, const Table& table) {
  return table[in.choice(value, names_of(table))];
}

Feature feature_of(ForceDistribution distribution) {
  using enum ForceDistribution;
  return distribution == variational  ? Feature::variational_distribution
         : distribution == integrated ? Feature::integrated_distribution
                                      : Feature::resultant_distribution;
}

class ContactReader {
 public:
  ContactReader(const JsonReader& in, Model& model, UsedFeatures& features)
      : in_(in), model_(model), features_(features) {}

  void read(const JsonValue& value) {
    JsonObject object(in_, value);
    ContactLaw& law = model_.contact;
    if (const JsonValue* v = object.optional("potential")) potential(*v);
    stiffness(value, object);
    if (const JsonValue* v = object.optional("field")) field(*v);
    if (const JsonValue* v = object.optional("reference")) reference(*v);
    if (const JsonValue* v = object.optional("friction")) {
      law.friction = friction(*v, true);
    }
    if (const JsonValue* v = object.optional("damping")) damping(*v);
    if (const JsonValue* v = object.optional("rigid"); v && in_.boolean(*v)) {
      features_.add(Feature::rigid_limit, v);
    }
    law.penetration_warning = law.penetration.value_or(law.penetration_warning);
    object.read("penetration_warning", law.penetration_warning, &JsonReader::positive, "");
    object.optional("pairs");  // read by read_rules()
    const JsonValue* surface_value = object.optional("surface");
    surface(surface_value, object.optional("distribution"));
    if (const JsonValue* v = object.optional("overlaps")) {
      law.accepts_overlaps = in_.choice(*v, {"refuse", "accept"}) == 1;
    }
    if (const JsonValue* v = object.optional("self_contact")) {
      law.self = in_.choice(*v, {"refuse", "compute"}) == 1;
      if (law.self) features_.add(Feature::self_contact, v);
    }
    object.finish();
  }

  void read_rules(const JsonValue& contact) {
    const JsonValue* pairs = contact.find("pairs");
    if (pairs == nullptr) return;
    for (const JsonValue& value : in_.array(*pairs)) {
      JsonObject object(in_, value);
      const JsonValue& between = object.required("between", "two names of materials or bodies");
      const std::vector<JsonValue>& names = in_.array(between);
      if (names.size() != 2) in_.fail(between, "must hold two names of materials or bodies");
      const ContactRule::Party a = party(names[0]);
      const ContactRule::Party b = party(names[1]);
      ContactRule rule{{a, b}};
      if (const JsonValue* v = object.optional("friction")) rule.friction = friction(*v, false);
      if (const JsonValue* v = object.optional("damping")) {
        features_.add(Feature::contact_damping, v);
        JsonObject dashpot(in_, *v);
        const size_t model = in_.choice(dashpot.required("model", "viscous or normal_viscous"),
                                        {"viscous", "normal_viscous"});
        rule.damping = dashpots(dashpot, model == 0);
        dashpot.finish();
      }
      object.read("normal_stiffness", rule.normal_stiffness, &JsonReader::positive, "Pa");
      if (!rule.friction && !rule.damping && !rule.normal_stiffness) {
        in_.fail(value, "must give \"friction\", \"damping\" or \"normal_stiffness\"");
      }
      model_.contact.rules.push_back(rule);
      object.finish();
    }
  }

 private:
  // k_n, or the penetration from which it follows when all bodies are known.
  void stiffness(const JsonValue& value, JsonObject& object) {
    ContactLaw& law = model_.contact;
    const JsonValue* const given =
        value.find("penetration")
            ? object.optional("normal_stiffness")
            : &object.required(
                  "normal_stiffness",
                  "k_n in Pa (there is no default), or \"penetration\", from which it follows");
    const JsonValue* const wish = object.optional("penetration");
    if (given && wish) {
      in_.fail(*wish, "cannot stand beside \"normal_stiffness\": give one of the two");
    }
    if (given) {
      law.normal_stiffness = in_.positive(*given, "Pa");
      return;
    }
    law.penetration = in_.positive(*wish, "");
    if (!(*law.penetration < 1)) {
      in_.fail(*wish,
               "must be below 1: it is the share of the smallest inradius that bodies may "
               "press into each other, such as 0.01");
    }
    features_.add(Feature::contact_penetration, wish);
  }

  void potential(const JsonValue& value) {
    model_.contact.potential.kind = chosen(in_, value, kPotentials).kind;
    if (model_.contact.potential.kind == PotentialChoice::Kind::area) {
      features_.add(Feature::area_potential, &value);
    }
  }

  void field(const JsonValue& value) {
    features_.add(Feature::field, &value);
    model_.contact.potential.field = chosen(in_, value, kFields).field;
  }

  void reference(const JsonValue& value) {
    features_.add(Feature::reference, &value);
    PotentialChoice& choice = model_.contact.potential;
    if (value.type() == JsonValue::Type::number) {
      choice.reference = PotentialChoice::Reference::length;
      choice.length = in_.positive(value, "m");
      if (!std::isfinite(1 / choice.length)) in_.fail(value, "is too small for double precision");
      return;
    }
    choice.reference = chosen(in_, value, kReferences).reference;
  }

  // The friction of the whole scene, or of one rule for a pair. A rule takes the stiffness of
  // springs of the scene unless it gives its own, and it cannot choose the friction law.
  Friction friction(const JsonValue& value, bool of_scene) {
    JsonObject object(in_, value);
    Friction friction = model_.contact.friction;
    const JsonValue& mu = object.required("coefficient", "mu, 0 or more");
    friction.coefficient = in_.number(mu, "");
    if (!(friction.coefficient >= 0)) in_.fail(mu, "must be 0 or more");
    const JsonValue* const ratio = object.optional("stiffness_ratio");
    const JsonValue* const constant = object.optional("tangential_stiffness");
    if (ratio && constant) {
      in_.fail(*constant, "cannot stand beside \"stiffness_ratio\": give one of the two");
    }
    if (ratio)
      friction.stiffness_ratio = in_.positive(*ratio, ""), friction.tangential_stiffness = 0;
    if (constant) friction.tangential_stiffness = in_.positive(*constant, "Pa");
    if (of_scene) {
      if (const JsonValue* v = object.optional("law")) friction_law(*v);
    }
    object.finish();
    return friction;
  }

  void friction_law(const JsonValue& value) {
    model_.contact.friction_law = chosen(in_, value, kFrictionLaws).law;
    if (model_.contact.friction_law == FrictionLaw::per_edge) {
      features_.add(Feature::per_edge_friction, &value);
    }
  }

  // One model, or a list of them.
  void damping(const JsonValue& value) {
    features_.add(Feature::contact_damping, &value);
    if (value.type() != JsonValue::Type::array) return damping_model(value);
    for (const JsonValue& model : in_.array(value)) damping_model(model);
  }

  void damping_model(const JsonValue& value) {
    JsonObject object(in_, value);
    ContactLaw& law = model_.contact;
    const JsonValue& name = object.required("model", "viscous, normal_viscous or mass");
    const size_t model = in_.choice(name, {"viscous", "normal_viscous", "mass"});
    bool& known = model == 2 ? mass_damped_ : damped_;
    if (known) in_.fail(name, "is damping of a kind that is given already");
    known = true;
    if (model == 2) {
      law.mass_damping = in_.positive(object.required("rate", "a positive number in 1/s"), "1/s");
    } else {
      law.damping = dashpots(object, model == 0);
      if (model == 0) {
        const JsonValue* bulk = object.optional("bulk");
        law.damping.bulk = bulk ? in_.number(*bulk, "") : kBulkDamping;
        if (!(law.damping.bulk >= 0)) in_.fail(*bulk, "must be 0 or more");
      }
    }
    object.finish();
  }

  // A ratio of critical damping or a time constant, of which `viscous` takes one for both
  // directions, or [normal, tangential]. 0 says that there is none.
  ContactDamping dashpots(JsonObject& object, bool tangential) {
    const JsonValue* const time = object.optional("time");
    const JsonValue* const ratio = object.optional("ratio");
    if (time && ratio) in_.fail(*time, "cannot stand beside \"ratio\": give one of the two");
    const std::string needed = fmt::format("a ratio of critical damping{}, or \"time\" in s",
                                           tangential ? ", or [normal, tangential]" : "");
    const JsonValue& value = time ? *time : object.required("ratio", needed);
    const auto number_of = [&](const JsonValue& v) {
      const double number = in_.number(v, time ? "s" : "");
      if (!(number >= 0)) in_.fail(v, "must be 0 or more");
      return number;
    };
    ContactDamping damping{.are_times = time != nullptr};
    if (!tangential) {
      damping.normal = number_of(value);
      return damping;
    }
    features_.add(Feature::viscous_damping, &value);
    if (value.type() != JsonValue::Type::array) {
      damping.normal = damping.tangential = number_of(value);
      return damping;
    }
    const std::vector<JsonValue>& both = in_.array(value);
    if (both.size() != 2) in_.fail(value, "must be a number or [normal, tangential]");
    damping.normal = number_of(both[0]), damping.tangential = number_of(both[1]);
    return damping;
  }

  // With which surface bodies with a mesh touch, and how the contact forces reach their nodes.
  // Either value may be absent. A surface has its first distribution in kDistributions by default.
  void surface(const JsonValue* surface, const JsonValue* distribution) {
    ContactLaw& law = model_.contact;
    if (surface) law.surface = chosen(in_, *surface, kSurfaces).surface;
    const bool by_element = law.surface == ContactSurface::element;
    features_.add(by_element ? Feature::element_surface : Feature::body_surface, surface);
    if (distribution) {
      law.distribution = chosen(in_, *distribution, kDistributions).distribution;
      features_.add(feature_of(law.distribution), distribution);
      return;
    }
    law.distribution = std::ranges::find_if(kDistributions, [&](const NamedDistribution& d) {
                         return d.surface == law.surface;
                       })->distribution;
  }

  // A name that is both a body's and a material's means the body.
  ContactRule::Party party(const JsonValue& value) const {
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

  const JsonReader& in_;
  Model& model_;
  UsedFeatures& features_;
  bool damped_ = false, mass_damped_ = false;  // kinds of damping that have been given
};

}  // namespace

void read_contact(const JsonReader& in, const JsonValue& value, Model& model,
                  UsedFeatures& features) {
  ContactReader(in, model, features).read(value);
}

void read_contact_rules(const JsonReader& in, const JsonValue& value, Model& model,
                        UsedFeatures& features) {
  ContactReader(in, model, features).read_rules(value);
}

}  // namespace apothem
