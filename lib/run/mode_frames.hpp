// The motion of a mode as frames, in a folder that has the format of a run's results.
#pragma once

#include <string>
#include <vector>

#include "lib/dynamics/modes.hpp"
#include "lib/output/file_list.hpp"

namespace apothem {

/// Largest displacement of a point in frames of modes, of the size of the scene; and the largest
/// angle of a rigid body, rad, which may make it smaller.
inline constexpr double kModeAmplitude = 0.05, kModeAngle = 0.5;
/// Frames of one period, besides the first one.
inline constexpr int kModePhases = 16;

/// The factor by which frames show the shape of a mode.
double shown_amplitude(const Simulation& simulation, const SceneMode& mode);

/// Writes the frames of one period into a folder, which is created: displacements from the places
/// of the simulation, times cos(2 pi t / T), with their velocities, and the stresses that belong to
/// them in the first order. Modes without a period have T = 1 s. Throws SystemFailure.
void write_mode_frames(const std::string& folder, const Simulation& simulation,
                       const SceneMode& mode, int threads, FileList* list);

}  // namespace apothem
