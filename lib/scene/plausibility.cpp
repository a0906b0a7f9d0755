#include "lib/scene/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apothem {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;  // rad

// Numbers of materials and contact laws, and the range in which nobody wonders.
struct Range {
  const char* key;
  double least, most;
  const char* unit;
  const char* hint;
};
constexpr std::array kOfMaterial{
    Range{"young", 1e4, 2e12, "Pa", "rock has about 2e10 Pa, rubber 1e6 Pa"},
    Range{"density", 5, 3e4, "kg/m^3", "rock has about 2500 kg/m^3, water 1000 kg/m^3"},
};
constexpr Range kCoefficient{"coefficient", 0, 2, "",
                             "it is the tangent of the friction angle, not an angle in degrees"};
// Sliding blocks begin to rock above this coefficient unless the damping ratio of their contacts is
// as large as the second number (docs/theory.md, "Sliding blocks that rock").
constexpr double kRocks = .65, kCalms = .3;
constexpr double kFastest = 1000;          // m/s
constexpr double kStrongestGravity = 1e3;  // m/s^2
constexpr double kLargest = 100;           // extent of the smallest body that is not fixed, m
constexpr double kSoftest = 2e-3, kStiffest = 200;  // contact, of Young's modulus

class Inspection {
 public:
  explicit Inspection(const Scene& scene) : scene_(scene) {}

  std::vector<std::string> run() {
    materials();
    contact();
    motion();
    sizes();
    stops();
    return std::move(found_);
  }

 private:
  void say(const JsonValue& at, const std::string& what) {
    found_.emplace_back(SceneError(scene_.file, at.line(), at.pointer(), what).what());
  }

  void judge(const JsonValue& object, const Range& range) {
    const JsonValue* value = object.find(range.key);
    if (value == nullptr) return;
    const double x = value->number();
    if (x >= range.least && x <= range.most) return;
    say(*value, fmt::format("{:g}{}{} is unusually {}: {}", x, *range.unit ? " " : "", range.unit,
                            x < range.least ? "small" : "large", range.hint));
  }

  void materials() {
    const JsonValue* materials = scene_.document.find("materials");
    for (const JsonValue& material : materials->items()) {
      for (const Range& range : kOfMaterial) judge(material, range);
    }
  }

  void contact() {
    const JsonValue* law = scene_.document.find("contact");
    if (law == nullptr) return;
    if (const JsonValue* friction = law->find("friction")) {
      judge(*friction, kCoefficient);
      rocking(*friction);
    }
    if (const JsonValue* pairs = law->find("pairs")) {
      for (const JsonValue& pair : pairs->items()) {
        if (const JsonValue* friction = pair.find("friction")) judge(*friction, kCoefficient);
      }
    }
    const double stiffness = scene_.model.contact.normal_stiffness;
    for (const JsonValue& material : scene_.document.find("materials")->items()) {
      const JsonValue* young = material.find("young");
      if (young == nullptr) continue;
      const double ratio = stiffness / young->number();
      if (ratio >= kSoftest && ratio <= kStiffest) continue;
      say(*law->find(scene_.model.contact.penetration ? "penetration" : "normal_stiffness"),
          fmt::format("{:g} Pa is {:.2g} times Young's modulus of {:g} Pa at {}: contacts that are "
                      "{}; between 0.1 and 10 times is usual",
                      stiffness, ratio, young->number(), young->pointer(),
                      ratio < 1 ? "so soft let bodies sink into each other"
                                : "so stiff shorten the time step and make nothing more exact"));
    }
  }

  void rocking(const JsonValue& friction) {
    const ContactLaw& law = scene_.model.contact;
    const bool slides = std::ranges::any_of(
        scene_.model.bodies, [](const RigidBody& body) { return body.motion == Motion::free; });
    const double mu = law.friction.coefficient;
    if (scene_.time.statics || !slides || mu <= kRocks || mu > kCoefficient.most ||
        law.damping.normal >= kCalms)
      return;
    say(friction,
        fmt::format("rigid blocks that slide with a coefficient above {:g} may begin to rock "
                    "and lift off; a contact damping of the ratio {:g} prevents it",
                    kRocks, kCalms));
  }

  void motion() {
    if (scene_.model.strongest_gravity() > kStrongestGravity) {
      say(*scene_.document.find("gravity"),
          fmt::format("{:g} m/s^2 is unusually large: lengths are in m, and gravity on Earth is "
                      "9.81 m/s^2",
                      scene_.model.strongest_gravity()));
    }
    for (const char* key : {"bodies", "fill"}) {
      const JsonValue* list = scene_.document.find(key);
      if (list) velocities(*list);
    }
  }

  void velocities(const JsonValue& bodies) {
    for (const JsonValue& body : bodies.items()) {
      const JsonValue* angle = body.find("angle");
      if (angle && std::abs(angle->number()) > kFullTurn) {
        say(*angle,
            fmt::format("{:g} rad is more than a full turn: angles are in radians; {:g} "
                        "degrees are {:.6g} rad",
                        angle->number(), angle->number(), angle->number() * kFullTurn / 360));
      }
      const JsonValue* velocity = body.find("velocity");
      if (velocity == nullptr || velocity->items().size() != 2) continue;
      const double speed = std::hypot(velocity->items()[0].number(), velocity->items()[1].number());
      if (speed > kFastest) {
        say(*velocity, fmt::format("{:g} m/s is unusually fast: velocities are in m/s", speed));
      }
    }
  }

  // A scene in millimetres has not one body of the size of a house.
  void sizes() {
    double smallest = HUGE_VAL;
    std::string name;
    const auto compare = [&](const Box& box, const std::string& body) {
      if (!(box.extent() < smallest)) return;
      smallest = box.extent();
      name = body;
    };
    for (const RigidBody& body : scene_.model.bodies) {
      if (body.can_move()) compare(box_of(body.potential.vertices), body.name);
    }
    for (const DeformableBody& body : scene_.model.deformables) {
      compare(box_of(body.mesh.nodes), body.name);
    }
    if (!std::isfinite(smallest) || smallest < kLargest) return;
    const JsonValue* bodies = scene_.document.find("bodies");
    say(bodies ? *bodies : *scene_.document.find("fill"),
        fmt::format("even the smallest body that can move, \"{}\", is {:g} m across: lengths are "
                    "in m, not in mm",
                    name, smallest));
  }

  // Rules by which the run can never end.
  void stops() {
    const JsonValue* list = scene_.document.find("stop");
    if (list == nullptr) return;
    const Model& model = scene_.model;
    const auto free =
        static_cast<size_t>(std::ranges::count(model.bodies, Motion::free, &RigidBody::motion)) +
        model.deformables.size();
    for (size_t i = 0; i < std::min(scene_.stops.size(), list->items().size()); ++i) {
      const StopRule& rule = scene_.stops[i];
      const JsonValue& at = list->items()[i];
      const char* const start = "the rule can never end the run: ";
      if (rule.count_above && static_cast<size_t>(*rule.count_above) > free) {
        say(at, fmt::format("{}it waits for {} free bodies, and there are {}; check "
                            "\"count_above\"",
                            start, *rule.count_above, free));
      }
      if (rule.count_below && *rule.count_below == 0) {
        say(at, std::string(start) + "there are never fewer than 0 bodies; check \"count_below\"");
      }
      if (rule.hold > scene_.time.end || rule.after > scene_.time.end ||
          rule.no_exit_for.value_or(0) > scene_.time.end) {
        say(at, fmt::format("{}it needs more than the {:g} s of the run; check \"for\", \"after\" "
                            "and \"no_exit_for\"",
                            start, scene_.time.end));
      }
    }
  }

  const Scene& scene_;
  std::vector<std::string> found_;
};

}  // namespace

std::vector<std::string> unlikely_values(const Scene& scene) { return Inspection(scene).run(); }

}  // namespace apothem
