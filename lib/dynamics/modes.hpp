// Modes of a scene: small undamped vibrations about the places where its bodies are, and linear
// buckling under its loads.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lib/dynamics/simulation.hpp"
#include "lib/dynamics/touching.hpp"
#include "lib/solver/modes.hpp"

namespace apothem {

enum class ModeKind { unstable, rigid, vibration, buckling };
/// Their names in tables and JSON, in this order.
inline constexpr std::array kModeKinds{"unstable", "rigid", "vibration", "buckling"};

struct SceneMode {
  ModeKind kind = ModeKind::vibration;
  double eigenvalue = 0;  ///< w^2, 1/s^2; of buckling the factor of the loads
  /// Participating mass along x and along y, as parts of the mass that is free in that direction.
  /// The parts of all modes of vibration together are 1.
  std::array<double, 2> share{};
  std::vector<double> shape;  ///< laid out like State::x, with phi^T M phi = 1

  /// Of an unstable mode 0, Hz.
  [[nodiscard]] double frequency() const;
  /// s; infinite where the frequency is 0.
  [[nodiscard]] double period() const;
  /// By which factor exp(rate t) an unstable mode grows, 1/s; else 0.
  [[nodiscard]] double growth_rate() const;
};

/// The forces of a scene at the places where its bodies are, in their first order.
struct Linearised {
  Tangent tangent;
  ModalSystem system;
  double unbalanced = 0;  ///< norm of the forces out of balance over that of the loads; 0 if none
  int contacts = 0;       ///< contact patches that press
  std::vector<TouchingBodies> touching;  ///< bodies that touch and do not press on each other
  int overlapping = 0;    ///< contact patches of those that rounding alone has closed
  bool friction = false;  ///< contacts press, and the scene has friction
};

/// Empty if a term does not know its tangent: friction per edge, and element potentials. Friction
/// springs stick, also those at their limit. What remembers is afterwards as it was before.
std::optional<Linearised> linearised(Simulation& simulation);

struct SceneModes {
  int coordinates = 0;
  int unstable = 0, rigid = 0;   ///< numbers of such modes of the whole scene
  std::array<double, 2> mass{};  ///< free along x, and along y, kg
  double skew = 0;               ///< see VibrationModes
  std::vector<SceneMode> modes;
};

/// See vibration_modes(). Throws NoModes.
SceneModes modes_of(const Linearised& scene, int count);
/// See buckling_modes(). Both must be of the same simulation. Throws NoModes.
SceneModes buckling_of(const Linearised& unloaded, const Linearised& loaded, int count);

}  // namespace apothem
