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
  time_step,
  fixed_step,
  accuracy,
  safety,
  onsets,
  start,
  settled_start,
  settled_mesh,
  load_steps,
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
  std::string_view where;  ///< "in", "with" or "for" it, behind the verdict on another feature
};

/// In the order of Feature. A text that no row of kIncompatible needs is left empty.
inline constexpr std::array kFeatureTexts{
    FeatureText{Feature::dynamic_run, "", "in a dynamic run"},
    FeatureText{Feature::static_run, "`time.mode`: `static`", "in a static run"},
    FeatureText{Feature::time_step, "`time.step`", ""},
    FeatureText{Feature::fixed_step, "", "with a fixed step"},
    FeatureText{Feature::accuracy, "`time.accuracy`", ""},
    FeatureText{Feature::safety, "`time.safety`", "with `time.safety`"},
    FeatureText{Feature::onsets, "`time.onsets`", ""},
    FeatureText{Feature::start, "`time.start`", ""},
    FeatureText{Feature::settled_start, "", "in a settled start"},
    FeatureText{Feature::settled_mesh, "", "in a settled start of bodies with a mesh"},
    FeatureText{Feature::load_steps, "`time.load_steps`", ""},
    FeatureText{Feature::tolerance, "`time.tolerance`", ""},
    FeatureText{Feature::area_potential, "`contact.potential`: `area`", "with the area potential"},
    FeatureText{Feature::field, "`contact.field`", ""},
    FeatureText{Feature::reference, "`contact.reference`", ""},
    FeatureText{Feature::body_surface, "", "with \"surface\": \"body\""},
    FeatureText{Feature::element_surface, "`contact.surface`: `element`",
                "with \"surface\": \"element\""},
    FeatureText{Feature::variational_distribution, "`contact.distribution`: `variational`", ""},
    FeatureText{Feature::integrated_distribution, "`contact.distribution`: `integrated`", ""},
    FeatureText{Feature::resultant_distribution, "`contact.distribution`: `resultant`", ""},
    FeatureText{Feature::per_edge_friction, "`contact.friction.law`: `per_edge`",
                "with the friction law `per_edge`"},
    FeatureText{Feature::contact_damping, "`contact.damping`", ""},
    FeatureText{Feature::viscous_damping, "`contact.damping.model`: `viscous`", ""},
    FeatureText{Feature::self_contact, "`contact.self_contact`: `compute`", ""},
    FeatureText{Feature::material_damping, "`damping` of a material", ""},
    FeatureText{Feature::rigid_body, "", "for a rigid body"},
    FeatureText{Feature::body_with_mesh, "", "for a body with a mesh"},
    FeatureText{Feature::polygon_beyond_triangle,
                "a rigid body whose `polygon` has more than three vertices", ""},
    FeatureText{Feature::element_materials, "`materials` of a body", ""},
    FeatureText{Feature::fixed_motion, "`motion`: `fixed`", "for a fixed body"},
    FeatureText{Feature::prescribed_motion, "`motion` with histories",
                "for a body of prescribed motion"},
    FeatureText{Feature::servo, "`motion.servo` of a body", ""},
    FeatureText{Feature::held_coordinates, "`fix` of a rigid body", ""},
    FeatureText{Feature::initial_velocity, "`velocity` or `spin` of a body", ""},
    FeatureText{Feature::mesh_in_every_contact, "",
                "where bodies have a mesh and fewer than two are rigid"},
    FeatureText{Feature::outline_in_every_contact, "",
                "where bodies have a mesh, fewer than two are rigid, and \"surface\" is \"body\""},
    FeatureText{Feature::inflow, "`repeat` of a fill", ""},
    FeatureText{Feature::outside, "`world.outside`: `remove` or `stop`", ""},
    FeatureText{Feature::stop_rule, "`stop`", ""},
    FeatureText{Feature::frames, "`output.frames`", ""},
    FeatureText{Feature::history_interval, "`output.history.interval`", ""},
    FeatureText{Feature::tracked_point, "`point` of a tracked body", ""},
    FeatureText{Feature::tracked_surface, "`surface` of a tracked body", ""},
};

constexpr const FeatureText& text_of(Feature feature) {
  return kFeatureTexts[static_cast<size_t>(feature)];
}

/// Whether a combination is refused because nothing could be computed for it, or because the
/// computation has not been written.
enum class Verdict { has_no_meaning, not_supported_yet };

constexpr std::string_view text_of(Verdict verdict) {
  return verdict == Verdict::has_no_meaning ? "has no meaning" : "is not supported yet";
}

/// Two features that a scene must not use together. The error stands at the value of `asked`.
struct Incompatibility {
  Feature asked;
  Feature with;
  Verdict verdict;
  std::string_view why;
  std::string_view instead;  ///< what would be right
};

/// The first row that fits a scene is the one that the user reads.
inline constexpr std::array kIncompatible{
    // The contact law.
    Incompatibility{Feature::field, Feature::area_potential, Verdict::has_no_meaning,
                    "the area potential has one field only", "leave it out"},
    Incompatibility{Feature::reference, Feature::area_potential, Verdict::has_no_meaning,
                    "the area potential has no reference length", "leave it out"},
    Incompatibility{Feature::polygon_beyond_triangle, Feature::area_potential,
                    Verdict::has_no_meaning, "the area potential is defined for triangles only",
                    "use \"potential\": \"distance\""},
    Incompatibility{Feature::resultant_distribution, Feature::body_surface, Verdict::has_no_meaning,
                    "it gives the resultant of two elements to their nodes, and here bodies touch "
                    "as a whole",
                    "leave it out, because \"resultant\" needs \"surface\": \"element\""},
    Incompatibility{Feature::integrated_distribution, Feature::body_surface,
                    Verdict::not_supported_yet,
                    "on the surface of a body the nodal forces are the gradient of the energy",
                    "leave it out, because \"integrated\" needs \"surface\": \"element\""},
    Incompatibility{Feature::variational_distribution, Feature::element_surface,
                    Verdict::not_supported_yet,
                    "the gradient of the energy is computed on the surface of a body only",
                    "use \"resultant\" or \"integrated\", because \"variational\" needs "
                    "\"surface\": \"body\""},
    Incompatibility{Feature::self_contact, Feature::element_surface, Verdict::not_supported_yet,
                    "elements of one body overlap by nature where they share an edge",
                    "use \"surface\": \"body\""},
    // One body.
    Incompatibility{Feature::fixed_motion, Feature::body_with_mesh, Verdict::has_no_meaning,
                    "a body with a mesh is \"free\" to deform",
                    "hold parts of it by \"supports\", or give it a polygon"},
    Incompatibility{Feature::prescribed_motion, Feature::body_with_mesh, Verdict::has_no_meaning,
                    "a body with a mesh is \"free\" to deform",
                    "move parts of it by \"supports\", or give it a polygon"},
    Incompatibility{Feature::initial_velocity, Feature::fixed_motion, Verdict::has_no_meaning,
                    "a fixed body has no initial velocity or spin",
                    "leave it out, or make the motion \"free\""},
    Incompatibility{Feature::initial_velocity, Feature::prescribed_motion, Verdict::has_no_meaning,
                    "the histories of \"motion\" give its velocity and spin", "leave it out"},
    Incompatibility{Feature::held_coordinates, Feature::fixed_motion, Verdict::has_no_meaning,
                    "only a body of \"free\" motion takes \"fix\"", "leave it out"},
    Incompatibility{Feature::held_coordinates, Feature::prescribed_motion, Verdict::has_no_meaning,
                    "only a body of \"free\" motion takes \"fix\"", "leave it out"},
    Incompatibility{Feature::element_materials, Feature::rigid_body, Verdict::has_no_meaning,
                    "a polygon has no groups of elements", "leave it out, or give the body a mesh"},
    // Time.
    Incompatibility{Feature::time_step, Feature::static_run, Verdict::has_no_meaning,
                    "no motion is integrated over time", "leave it out"},
    Incompatibility{Feature::safety, Feature::static_run, Verdict::has_no_meaning,
                    "no motion is integrated over time", "leave it out"},
    Incompatibility{Feature::start, Feature::static_run, Verdict::has_no_meaning,
                    "every load step ends in equilibrium", "leave it out"},
    Incompatibility{Feature::load_steps, Feature::dynamic_run, Verdict::has_no_meaning,
                    "it goes with \"mode\": \"static\"", "leave it out"},
    Incompatibility{Feature::tolerance, Feature::dynamic_run, Verdict::has_no_meaning,
                    "it goes with \"mode\": \"static\"", "leave it out"},
    Incompatibility{Feature::safety, Feature::fixed_step, Verdict::has_no_meaning,
                    "it goes with an automatic step only", "leave it out"},
    Incompatibility{Feature::accuracy, Feature::static_run, Verdict::has_no_meaning,
                    "no motion is integrated over time", "leave it out"},
    Incompatibility{Feature::accuracy, Feature::fixed_step, Verdict::has_no_meaning,
                    "it goes with an automatic step only", "leave it out"},
    Incompatibility{Feature::accuracy, Feature::safety, Verdict::has_no_meaning,
                    "both choose the step", "leave one of them out"},
    Incompatibility{Feature::onsets, Feature::static_run, Verdict::has_no_meaning,
                    "no motion is integrated over time", "leave it out"},
    Incompatibility{Feature::initial_velocity, Feature::settled_mesh, Verdict::not_supported_yet,
                    "a start in steady sliding is found where all bodies are rigid",
                    "leave it out, or leave out \"start\""},
    Incompatibility{Feature::element_surface, Feature::settled_mesh, Verdict::not_supported_yet,
                    "equilibria are sought for forces that are the gradient of an energy, and the "
                    "nodal forces of element potentials are not",
                    "use \"surface\": \"body\", or leave out \"start\""},
    // Static runs.
    Incompatibility{Feature::initial_velocity, Feature::static_run, Verdict::has_no_meaning,
                    "nothing moves in an equilibrium", "leave it out"},
    Incompatibility{Feature::material_damping, Feature::static_run, Verdict::has_no_meaning,
                    "nothing moves in an equilibrium", "leave it out"},
    Incompatibility{Feature::contact_damping, Feature::static_run, Verdict::has_no_meaning,
                    "nothing moves in an equilibrium", "leave it out"},
    Incompatibility{Feature::element_surface, Feature::static_run, Verdict::not_supported_yet,
                    "equilibria are sought for forces that are the gradient of an energy, and the "
                    "nodal forces of element potentials are not",
                    "use \"surface\": \"body\""},
    Incompatibility{Feature::frames, Feature::static_run, Verdict::has_no_meaning,
                    "a static run writes a row and a frame per load step",
                    "leave it out, and choose \"load_steps\""},
    Incompatibility{Feature::history_interval, Feature::static_run, Verdict::has_no_meaning,
                    "a static run writes a row and a frame per load step",
                    "leave it out, and choose \"load_steps\""},
    // Bodies with a mesh.
    Incompatibility{Feature::per_edge_friction, Feature::mesh_in_every_contact,
                    Verdict::not_supported_yet, "\"per_edge\" acts between rigid bodies only",
                    "leave it out; meshes have a spring per boundary edge, or per pair of elements "
                    "with \"surface\": \"element\""},
    Incompatibility{Feature::viscous_damping, Feature::per_edge_friction,
                    Verdict::not_supported_yet,
                    "the tangential dashpot stands beside the spring of a contact patch",
                    "use \"normal_viscous\", or leave out \"law\""},
    Incompatibility{Feature::area_potential, Feature::outline_in_every_contact,
                    Verdict::has_no_meaning,
                    "the area potential is defined for triangles, not for the outline of a mesh",
                    "use \"distance\", or \"surface\": \"element\" with triangles"},
    // Many bodies.
    Incompatibility{Feature::servo, Feature::static_run, Verdict::not_supported_yet,
                    "a wall that holds a force finds its place by moving",
                    "use a dynamic run, or histories"},
    Incompatibility{Feature::inflow, Feature::static_run, Verdict::not_supported_yet,
                    "the equilibria of a static run are of the same bodies",
                    "use a dynamic run, or leave out \"repeat\""},
    Incompatibility{Feature::inflow, Feature::settled_start, Verdict::not_supported_yet,
                    "bodies that come later would settle as well",
                    "leave out \"start\", or \"repeat\""},
    Incompatibility{Feature::outside, Feature::static_run, Verdict::has_no_meaning,
                    "bodies do not fly in an equilibrium", "leave out \"world\""},
    Incompatibility{Feature::stop_rule, Feature::static_run, Verdict::not_supported_yet,
                    "a static run ends with its last load step", "leave out \"stop\""},
    // Output.
    Incompatibility{Feature::tracked_point, Feature::rigid_body, Verdict::has_no_meaning,
                    "the columns of a point hold the stress of its element",
                    "leave it out, because position and angle of the body give every point of it"},
    Incompatibility{Feature::tracked_surface, Feature::rigid_body, Verdict::not_supported_yet,
                    "contact pressure is recorded for bodies with a mesh only", "leave it out"},
    Incompatibility{Feature::tracked_surface, Feature::element_surface, Verdict::not_supported_yet,
                    "contact pressure is recorded for the surface of a body only",
                    "leave it out; surfaces.pvd has the mean pressure on each boundary edge"},
};

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

}  // namespace apothem
