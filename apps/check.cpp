#include <fmt/format.h>

#include "commands.hpp"
#include "plan.hpp"

namespace apothem {

int check_command(const CheckOptions& options) {
  const Scene scene = read_scene(options.scene);
  const Simulation simulation = make_simulation(scene, 1);
  const Model& model = scene.model;

  int free = 0, fixed = 0, prescribed = 0, held = 0, vertices = 0, roofs = 0, fields = 0;
  for (const RigidBody& body : model.bodies) {
    (body.motion == Motion::free ? free : body.motion == Motion::fixed ? fixed : prescribed)++;
    held += body.held[0] || body.held[1] || body.held[2];
    vertices += body.potential.size();
    roofs += body.potential.roof.has_value();
    fields += body.potential.distance.has_value();
  }
  int elements = 0, supports = 0, loads = 0;
  bool damped = false;
  std::string kinds;
  for (const DeformableBody& body : model.deformables) {
    elements += body.mesh.element_count();
    supports += static_cast<int>(body.supports.size());
    loads += static_cast<int>(body.dead_loads.size() + body.pressures.size());
    const Material& m = model.materials[body.material];
    damped = damped || m.mass_damping > 0 || m.stiffness_damping > 0;
    const ElementName& element = kElements[static_cast<size_t>(body.element)];
    const std::string kind = fmt::format("{} ({}, plane {})", element.name,
                                         kElasticLaws[static_cast<size_t>(m.elastic.law)],
                                         kPlanes[static_cast<size_t>(m.elastic.plane)]);
    if (kinds.find(kind) == std::string::npos) kinds += (kinds.empty() ? "" : ", ") + kind;
  }
  const bool contact = model.bodies.size() > 1 && fixed < static_cast<int>(model.bodies.size());
  const bool meshes = SurfaceContact::needed(model);
  const double steps = std::ceil(scene.time.end / simulation.step_size());
  const auto say = [](const char* what, const std::string& text) {
    fmt::print("{:<12} {}\n", what, text);
  };
  const auto uses = [](const char* what, bool yes, const std::string& why) {
    fmt::print("  {} {:<20} {}\n", yes ? "+" : "-", what, why);
  };
  fmt::print("{}: a valid scene\n", scene.file);
  say("name", model.name);
  say("bodies",
      fmt::format("{} rigid ({} free, {} fixed, {} prescribed), {} vertices; {} deformable",
                  model.bodies.size(), free, fixed, prescribed, vertices,
                  model.deformables.size()));
  say("elements", fmt::format("{}, {} nodes", elements, model.node_count()));
  say("run", fmt::format("{:g} s in {:.0f} steps", scene.time.end, steps));
  if (scene.time.statics) {
    say("static",
        fmt::format("{} load steps, tolerance {:g}", scene.time.load_steps, scene.time.tolerance));
  } else {
    say("time step",
        fmt::format("{} s ({}); limited by: {}; stability limit {:.6g} s", simulation.step_size(),
                    scene.time.fixed_step ? "fixed"
                    : simulation.limit().reason.starts_with("elements")
                        ? fmt::format("auto, safety {:g}", simulation.element_safety())
                        : fmt::format("auto, safety {:g}", scene.time.safety),
                    simulation.limit().reason, simulation.stability_limit()));
  }
  say("output", fmt::format("{} frames, histories of {} bodies and {} points every {:g} s",
                            scene.output.frames + 1,
                            scene.output.track.size() + scene.output.track_deformables.size(),
                            scene.output.points.size(),
                            scene.output.history_interval.value_or(scene.time.end / 1000)));
  say("expects", fmt::format("{} results", scene.expectations.size()));
  say("at t = 0", fmt::format("{} touching pairs", simulation.counts().touching_now));
  fmt::print("machinery\n");
  uses("contact", contact,
       contact
           ? fmt::format(
                 "{} potential, k_n = {:g} Pa",
                 model.contact.potential.kind == PotentialChoice::Kind::area ? "area" : "distance",
                 model.contact.normal_stiffness)
       : meshes ? "no two rigid bodies can touch"
                : "nothing can touch");
  uses("contact of meshes", meshes,
       !meshes ? ""
       : model.contact.surface == ContactSurface::body
           ? fmt::format("potentials of their surfaces, k_n = {:g} Pa",
                         model.contact.normal_stiffness)
           : fmt::format("potentials of their elements, k_n = {:g} Pa",
                         model.contact.normal_stiffness));
  const bool height =
      fields > 0 && model.contact.potential.reference == PotentialChoice::Reference::roof;
  uses("straight skeleton", roofs > 0 || height,
       roofs > 0 ? fmt::format("depth in {} bodies that are not convex", roofs)
       : height  ? "reference length of the distance field"
                 : "");
  uses("distance field", fields > 0,
       fields > 0 ? fmt::format("depth in {} bodies that are not convex", fields) : "");
  uses("pair search", contact, contact ? "hierarchical grid with a skin" : "");
  uses("gravity", model.gravity != Vec2::Zero(),
       fmt::format("[{:g}, {:g}] m/s^2", model.gravity.x(), model.gravity.y()));
  uses("prescribed motion", prescribed > 0, "");
  uses("held coordinates", held > 0, "");
  const ContactLaw& law = model.contact;
  const bool rough = law.friction.coefficient > 0 || !law.rules.empty();
  uses("friction", rough,
       rough
           ? fmt::format("mu = {:g}, {} rules by pair", law.friction.coefficient, law.rules.size())
           : "no tangential state is kept");
  uses("damping", law.normal_damping > 0 || law.mass_damping > 0,
       law.normal_damping > 0
           ? fmt::format("normal viscous, ratio {:g}{}", law.normal_damping,
                         model.deformables.empty() ? "" : ", between rigid bodies")
       : law.mass_damping > 0 ? fmt::format("mass, {:g} 1/s", law.mass_damping)
                              : "");
  uses("finite elements", elements > 0, elements > 0 ? kinds : "all bodies are rigid");
  uses("supports", supports > 0, supports > 0 ? fmt::format("{}", supports) : "");
  uses("loads", loads > 0, loads > 0 ? fmt::format("{}", loads) : "");
  uses("Rayleigh damping", damped, "");
  return exit_code::done;
}

}  // namespace apothem
