// How a scene asks to be run and recorded.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apothem/model/deformable.hpp"

namespace apothem {

struct TimeSettings {
  double end = 0;                         ///< s
  std::optional<double> fixed_step = {};  ///< s; empty: automatic
  /// Energy error allowed per impact, of its energy: chooses an automatic step.
  double accuracy = 1e-4;
  /// Automatic step over the stability limit of contacts, and of finite elements; empty: from the
  /// accuracy.
  std::optional<double> safety = {}, element_safety = {};
  /// Corrects steps in which a contact begins or ends (contact/onset_rule.hpp).
  bool onsets = true;
  bool settled = false;         ///< start in equilibrium (dynamics/settle.cpp)
  bool statics = false;         ///< a sequence of equilibria (dynamics/equilibrium.cpp)
  int load_steps = 10;          ///< of a static run
  double tolerance = 1e-6;      ///< of its forces out of balance, parts of the loads
  double longest_step = 1e300;  ///< s; of an automatic step: the interval of the history
};

struct OutputSettings {
  int frames = 100;                                ///< besides the one at time 0
  std::optional<double> history_interval;          ///< s; empty: end / 1000
  std::vector<RigidIndex> track;                   ///< rigid bodies in history.csv
  std::vector<DeformableIndex> track_deformables;  ///< deformable bodies as a whole
  std::vector<DeformableIndex> track_surfaces;  ///< deformable bodies whose contact pressure counts
  std::vector<TrackedPoint> points;
  /// Wall-clock s; empty: only when stopped.
  std::optional<double> checkpoint_interval = 600;
};

/// Ways to reduce a column to one number, by the names in scenes; in the order of
/// Expectation::Take.
inline constexpr std::array kTakes{"first", "last", "min", "max", "max_abs"};

/// A result the scene promises: a column of a history, reduced to one number.
struct Expectation {
  enum class Take { first, last, minimum, maximum, largest };  ///< largest: of the absolute value
  std::string quantity;  ///< column of history.csv, energy.csv or momentum.csv, no unit
  Take take = Take::last;
  std::optional<double> from, until;  ///< time window, s
  double value = 0;
  double tolerance = 0;    ///< absolute, in the quantity's unit
  std::string label = {};  ///< what it is in words; may be empty
};

}  // namespace apothem
