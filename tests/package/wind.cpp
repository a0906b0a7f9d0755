// A scene in a program of one's own: read it, add a force, step, look at positions.
#include <apothem/run/run.hpp>
#include <cmath>
#include <cstdio>

int main(int argc, char** argv) {
  using namespace apothem;
  if (argc != 2) return std::fprintf(stderr, "usage: wind SCENE.json\n"), 2;
  Run run(read_scene(argv[1]), {.folder = ""});  // without a folder no files are written

  // A wind along x that pushes every rigid body with 100 N.
  run.add_force("wind", [](const State& state, std::span<double> force) {
    for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) force[state.layout.rigid(i)] += 100;
  });

  const Model& model = run.scene().model;
  int most = 0;
  while (run.step()) {
    most = std::max(most, run.simulation().counts().touching_now);
    if (run.state().step % 50000 != 0) continue;
    std::printf("t = %.3f s:", run.state().time);
    for (RigidIndex i = 0; i < run.state().layout.rigid_bodies; ++i) {
      const auto pose = run.state().pose(i);  // x, y in m, angle in rad
      std::printf("  %s (%.4f, %.4f)", model.bodies[i].name.c_str(), pose[0], pose[1]);
    }
    std::printf("\n");
  }
  const Energies energies = run.simulation().energies();
  std::printf("contacts at once: %d; work of the wind %.6g J, unaccounted for %.2g J\n", most,
              energies.external_work, energies.total_error);
  return most > 0 && std::abs(energies.total_error) < 1e-3 * energies.kinetic ? 0 : 1;
}
