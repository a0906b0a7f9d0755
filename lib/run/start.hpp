// The start of a run: a simulation from a scene, and what the user should know before it begins.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lib/dynamics/simulation.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// Where a simulation begins: as its scene says, with bodies of another run, whose overlaps are
/// those of their contacts, or from a checkpoint that follows (it need not settle).
enum class Start { scene, other_run, checkpoint };

/// Throws SceneError, with the place in the scene, instead of Unrunnable; also if bodies overlap by
/// more than kSmallOverlap at the start, unless the scene accepts that or starts settled. The scene
/// must outlive the simulation. `stop`: see Simulation.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, int threads,
                                            Start start = Start::scene,
                                            const std::function<bool()>& stop = {});

/// Lets the bodies of a scene settle that begin where another run has left them. Throws SceneError.
void settle(const Scene& scene, Simulation& simulation, const std::function<bool()>& stop);

/// If the settled start has moved a body by more than its inradius: which, and how far.
std::string describe_settling(const Scene& scene, const Simulation& simulation);

/// Overlaps of bodies at the start that pass for touching, of the smaller inradius of the two.
inline constexpr double kSmallOverlap = 1e-3;

/// The pairs that overlap now, with depth and energy, in one line; empty if no bodies overlap.
std::string describe_overlaps(const Simulation& simulation);

/// The probable depths of contact in one line: see Forecast.
std::string describe_forecast(const Simulation& simulation);

/// The steps of a trial and what they took.
struct Trial {
  std::int64_t steps = 0;    ///< of velocity Verlet, or in place of which longer ones were taken
  double seconds = 0;        ///< of all steps
  std::string message = {};  ///< why the trial became unstable, else empty
};

/// Steps through a scene without files, as a run does that writes histories, for about `seconds` of
/// wall-clock time, or to its end. Not for static scenes.
Trial try_steps(const Scene& scene, int threads, double seconds);

}  // namespace apothem
