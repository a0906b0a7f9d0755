// Which features of a scene do not go together. The table kIncompatible is the only place where
// that is decided: the readers of the scene collect the features that a scene uses, and
// refuse_incompatible() goes through the table. docs/scene-format.md shows the same table, and a
// test holds the two against each other.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/scene/json.hpp"

namespace apothem {

/// What a scene can ask for, as far as it restricts what else the scene can ask for.
enum class Feature {
  // Time.
  dynamic_run,
  static_run,
  scheme,
  implicit_scheme,
  automatic_scheme,
  implicit_steps,
  time_step,
  fixed_step,
  accuracy,
  safety,
  onsets,
  start,
  settled_start,
  settled_mesh,
  load_steps,
  counted_load_steps,
  tolerance,
  // Contact.
  area_potential,
  field,
  reference,
  body_surface,
  element_surface,
  variational_distribution,
  integrated_distribution,
  resultant_distribution,
  per_edge_friction,
  rigid_limit,
  contact_penetration,
  contact_damping,
  viscous_damping,
  self_contact,
  // Materials.
  material_damping,
  // One body.
  rigid_body,
  body_with_mesh,
  polygon_beyond_triangle,
  element_materials,
  fixed_motion,
  prescribed_motion,
  servo,
  held_coordinates,
  initial_velocity,
  // All bodies together.
  mesh_in_every_contact,
  outline_in_every_contact,
  // Many bodies.
  inflow,
  outside,
  stop_rule,
  // Output.
  frames,
  history_interval,
  tracked_point,
  tracked_surface,
};

/// How messages and the documentation name a feature.
struct FeatureText {
  Feature feature;
  std::string_view what;   ///< the keys that ask for it, in the documentation
  std::string_view where;  ///< "in", "with" or "for" it, behind the refusal on another feature
};

/// In the order of Feature. A text that no row of kIncompatible needs is left empty.
inline constexpr auto kFeatureTexts = [] {
  using enum Feature;
  return std::to_array<FeatureText>(
      {{dynamic_run, "", "in a dynamic run"},
       {static_run, "`time.mode`: `static`", "in a static run"},
       {scheme, "`time.scheme`", ""},
       {implicit_scheme, "", "with \"scheme\": \"implicit\""},
       {automatic_scheme, "`time.scheme`: `auto`", ""},
       {implicit_steps, "", "with implicit steps (\"scheme\": \"implicit\" or \"auto\")"},
       {time_step, "`time.step`", ""},
       {fixed_step, "", "with a fixed step"},
       {accuracy, "`time.accuracy`", ""},
       {safety, "`time.safety`", "with `time.safety`"},
       {onsets, "`time.onsets`", ""},
       {start, "`time.start`", ""},
       {settled_start, "", "in a settled start"},
       {settled_mesh, "", "in a settled start of bodies with a mesh"},
       {load_steps, "`time.load_steps`", ""},
       {counted_load_steps, "", "with a number of load steps"},
       {tolerance, "`time.tolerance`", ""},
       {area_potential, "`contact.potential`: `area`", "with the area potential"},
       {field, "`contact.field`", ""},
       {reference, "`contact.reference`", ""},
       {body_surface, "", "with \"surface\": \"body\""},
       {element_surface, "`contact.surface`: `element`", "with \"surface\": \"element\""},
       {variational_distribution, "`contact.distribution`: `variational`", ""},
       {integrated_distribution, "`contact.distribution`: `integrated`", ""},
       {resultant_distribution, "`contact.distribution`: `resultant`", ""},
       {per_edge_friction, "`contact.friction.law`: `per_edge`",
        "with the friction law `per_edge`"},
       {rigid_limit, "`contact.rigid`", ""},
       {contact_penetration, "`contact.penetration`", ""},
       {contact_damping, "`contact.damping`", ""},
       {viscous_damping, "`contact.damping.model`: `viscous`", ""},
       {self_contact, "`contact.self_contact`: `compute`", ""},
       {material_damping, "`damping` of a material", ""},
       {rigid_body, "", "for a rigid body"},
       {body_with_mesh, "", "for a body with a mesh"},
       {polygon_beyond_triangle, "a rigid body whose `polygon` has more than three vertices", ""},
       {element_materials, "`materials` of a body", ""},
       {fixed_motion, "`motion`: `fixed`", "for a fixed body"},
       {prescribed_motion, "`motion` with histories", "for a body of prescribed motion"},
       {servo, "`motion.servo` of a body", ""},
       {held_coordinates, "`fix` of a rigid body", ""},
       {initial_velocity, "`velocity` or `spin` of a body", ""},
       {mesh_in_every_contact, "", "where bodies have a mesh and fewer than two are rigid"},
       {outline_in_every_contact, "",
        "where bodies have a mesh, fewer than two are rigid, and \"surface\" is \"body\""},
       {inflow, "`repeat` of a fill", ""},
       {outside, "`world.outside`: `remove` or `stop`", ""},
       {stop_rule, "`stop`", ""},
       {frames, "`output.frames`", ""},
       {history_interval, "`output.history.interval`", ""},
       {tracked_point, "`point` of a tracked body", ""},
       {tracked_surface, "`surface` of a tracked body", ""}});
}();

constexpr const FeatureText& text_of(Feature feature) {
  return kFeatureTexts[static_cast<size_t>(feature)];
}

/// Whether a combination is refused because nothing could be computed for it, or because the
/// computation has not been written.
enum class Refusal { has_no_meaning, not_supported_yet };

constexpr std::string_view text_of(Refusal refusal) {
  return refusal == Refusal::has_no_meaning ? "has no meaning" : "is not supported yet";
}

/// Two features that a scene must not use together. The error stands at the value of `asked`.
struct Incompatibility {
  Feature asked;
  Feature with;
  Refusal refusal;
  std::string_view why;
  std::string_view instead;  ///< what would be right
};

/// The first row that fits a scene is the one that the user reads.
inline constexpr auto kIncompatible = [] {
  using enum Feature;
  using enum Refusal;
  return std::to_array<Incompatibility>(
      {// The contact law.
       {field, area_potential, has_no_meaning, "the area potential has one field only",
        "leave it out"},
       {reference, area_potential, has_no_meaning, "the area potential has no reference length",
        "leave it out"},
       {polygon_beyond_triangle, area_potential, has_no_meaning,
        "the area potential is defined for triangles only", "use \"potential\": \"distance\""},
       {resultant_distribution, body_surface, has_no_meaning,
        "it gives the resultant of two elements to their nodes, and here bodies touch "
        "as a whole",
        "leave it out, because \"resultant\" needs \"surface\": \"element\""},
       {integrated_distribution, body_surface, not_supported_yet,
        "on the surface of a body the nodal forces are the gradient of the energy",
        "leave it out, because \"integrated\" needs \"surface\": \"element\""},
       {variational_distribution, element_surface, not_supported_yet,
        "the gradient of the energy is computed on the surface of a body only",
        "use \"resultant\" or \"integrated\", because \"variational\" needs "
        "\"surface\": \"body\""},
       {self_contact, element_surface, not_supported_yet,
        "elements of one body overlap by nature where they share an edge",
        "use \"surface\": \"body\""},
       {rigid_limit, dynamic_run, has_no_meaning,
        "an impact of rigid bodies takes no time, and no time step could follow it",
        "leave it out, or use \"mode\": \"static\""},
       {rigid_limit, counted_load_steps, not_supported_yet,
        "the loads of each stiffness are followed to their own limit",
        "use \"load_steps\": \"auto\", or leave it out"},
       {contact_penetration, static_run, not_supported_yet,
        "what loads press together is known only when their equilibrium is",
        "give \"normal_stiffness\""},
       {contact_penetration, element_surface, not_supported_yet,
        "how deep elements press into each other is not predicted",
        "use \"surface\": \"body\", or give \"normal_stiffness\""},
       // One body.
       {fixed_motion, body_with_mesh, has_no_meaning, "a body with a mesh is \"free\" to deform",
        "hold parts of it by \"supports\", or give it a polygon"},
       {prescribed_motion, body_with_mesh, has_no_meaning,
        "a body with a mesh is \"free\" to deform",
        "move parts of it by \"supports\", or give it a polygon"},
       {initial_velocity, fixed_motion, has_no_meaning,
        "a fixed body has no initial velocity or spin",
        "leave it out, or make the motion \"free\""},
       {initial_velocity, prescribed_motion, has_no_meaning,
        "the histories of \"motion\" give its velocity and spin", "leave it out"},
       {held_coordinates, fixed_motion, has_no_meaning,
        "only a body of \"free\" motion takes \"fix\"", "leave it out"},
       {held_coordinates, prescribed_motion, has_no_meaning,
        "only a body of \"free\" motion takes \"fix\"", "leave it out"},
       {element_materials, rigid_body, has_no_meaning, "a polygon has no groups of elements",
        "leave it out, or give the body a mesh"},
       // Time.
       {scheme, static_run, has_no_meaning, "no motion is integrated over time", "leave it out"},
       {servo, implicit_steps, not_supported_yet,
        "a wall that holds a force moves by steps of velocity Verlet",
        "use \"scheme\": \"verlet\""},
       {element_surface, implicit_steps, not_supported_yet,
        "implicit steps need forces that are the gradient of an energy, and the nodal forces of "
        "element potentials are not",
        "use \"surface\": \"body\", or \"scheme\": \"verlet\""},
       {contact_damping, implicit_scheme, not_supported_yet, "implicit steps do not know dashpots",
        "leave out \"damping\", because implicit steps take the energy of fast vibrations "
        "themselves, or use \"scheme\": \"auto\""},
       {automatic_scheme, fixed_step, has_no_meaning, "the steps follow the motion",
        "use \"step\": \"auto\""},
       {time_step, static_run, has_no_meaning, "no motion is integrated over time", "leave it out"},
       {safety, static_run, has_no_meaning, "no motion is integrated over time", "leave it out"},
       {start, static_run, has_no_meaning, "every load step ends in equilibrium", "leave it out"},
       {load_steps, dynamic_run, has_no_meaning, "it goes with \"mode\": \"static\"",
        "leave it out"},
       {tolerance, dynamic_run, has_no_meaning, "it goes with \"mode\": \"static\"",
        "leave it out"},
       {safety, fixed_step, has_no_meaning, "it goes with an automatic step only", "leave it out"},
       {accuracy, static_run, has_no_meaning, "no motion is integrated over time", "leave it out"},
       {accuracy, fixed_step, has_no_meaning, "it goes with an automatic step only",
        "leave it out"},
       {accuracy, safety, has_no_meaning, "both choose the step", "leave one of them out"},
       {onsets, static_run, has_no_meaning, "no motion is integrated over time", "leave it out"},
       {initial_velocity, settled_mesh, not_supported_yet,
        "a start in steady sliding is found where all bodies are rigid",
        "leave it out, or leave out \"start\""},
       {element_surface, settled_mesh, not_supported_yet,
        "equilibria are sought for forces that are the gradient of an energy, and the "
        "nodal forces of element potentials are not",
        "use \"surface\": \"body\", or leave out \"start\""},
       // Static runs.
       {initial_velocity, static_run, has_no_meaning, "nothing moves in an equilibrium",
        "leave it out"},
       {material_damping, static_run, has_no_meaning, "nothing moves in an equilibrium",
        "leave it out"},
       {contact_damping, static_run, has_no_meaning, "nothing moves in an equilibrium",
        "leave it out"},
       {element_surface, static_run, not_supported_yet,
        "equilibria are sought for forces that are the gradient of an energy, and the "
        "nodal forces of element potentials are not",
        "use \"surface\": \"body\""},
       {frames, static_run, has_no_meaning, "a static run writes a row and a frame per load step",
        "leave it out, and choose \"load_steps\""},
       {history_interval, static_run, has_no_meaning,
        "a static run writes a row and a frame per load step",
        "leave it out, and choose \"load_steps\""},
       // Bodies with a mesh.
       {per_edge_friction, mesh_in_every_contact, not_supported_yet,
        "\"per_edge\" acts between rigid bodies only",
        "leave it out; meshes have a spring per boundary edge, or per pair of elements "
        "with \"surface\": \"element\""},
       {viscous_damping, per_edge_friction, not_supported_yet,
        "the tangential dashpot stands beside the spring of a contact patch",
        "use \"normal_viscous\", or leave out \"law\""},
       {area_potential, outline_in_every_contact, has_no_meaning,
        "the area potential is defined for triangles, not for the outline of a mesh",
        "use \"distance\", or \"surface\": \"element\" with triangles"},
       // Many bodies.
       {servo, static_run, not_supported_yet, "a wall that holds a force finds its place by moving",
        "use a dynamic run, or histories"},
       {inflow, static_run, not_supported_yet,
        "the equilibria of a static run are of the same bodies",
        "use a dynamic run, or leave out \"repeat\""},
       {inflow, settled_start, not_supported_yet, "bodies that come later would settle as well",
        "leave out \"start\", or \"repeat\""},
       {outside, static_run, has_no_meaning, "bodies do not fly in an equilibrium",
        "leave out \"world\""},
       {stop_rule, static_run, not_supported_yet, "a static run ends with its last load step",
        "leave out \"stop\""},
       // Output.
       {tracked_point, rigid_body, has_no_meaning,
        "the columns of a point hold the stress of its element",
        "leave it out, because position and angle of the body give every point of it"},
       {tracked_surface, rigid_body, not_supported_yet,
        "contact pressure is recorded for bodies with a mesh only", "leave it out"},
       {tracked_surface, element_surface, not_supported_yet,
        "contact pressure is recorded for the surface of a body only",
        "leave it out; surfaces.pvd has the mean pressure on each boundary edge"}});
}();

/// The text of the error, without its place in the scene.
std::string message_of(const Incompatibility& pair);

/// The features that a scene uses, each with the value in the scene that asks for it and the body
/// that it belongs to.
class UsedFeatures {
 public:
  static constexpr int kWholeScene = -1;

  /// `at` is the value that asks for the feature, or nullptr if the feature is the default. `body`
  /// is the place in the scene's list of bodies. Of several values that ask for the same feature of
  /// the same body, the first one is kept.
  void add(Feature feature, const JsonValue* at = nullptr, int body = kWholeScene);

  /// The values that ask for a feature, in the order of the bodies.
  using Values = std::vector<std::pair<int, const JsonValue*>>;
  [[nodiscard]] const Values& values(Feature feature) const;

  /// Whether the feature is used by a body, or by the whole scene. For kWholeScene: whether it is
  /// used at all.
  [[nodiscard]] bool uses(Feature feature, int body = kWholeScene) const;

 private:
  std::array<Values, kFeatureTexts.size()> values_;
};

/// Throws SceneError for the first row of kIncompatible of which the scene uses both features. A
/// feature of one body meets features of the same body and of the whole scene.
void refuse_incompatible(const JsonReader& in, const UsedFeatures& features);
/// Whether a scene that goes together would do so with another feature of the whole scene as well.
bool goes_with(const UsedFeatures& features, Feature other);

}  // namespace apothem
