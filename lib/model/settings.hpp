// How a scene asks to be run and recorded.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lib/model/deformable.hpp"

namespace apothem {

/// How motion is integrated over time: by velocity Verlet, by long implicit steps
/// (dynamics/implicit.hpp), or by whichever of them suits the moment.
enum class TimeScheme { verlet, implicit, automatic };

struct TimeSettings {
  double end = 0;                         ///< s
  std::optional<double> fixed_step = {};  ///< s; empty: automatic
  TimeScheme scheme = TimeScheme::verlet;
  /// Energy error allowed per impact, of its energy: chooses an automatic step.
  double accuracy = 1e-4;
  /// Automatic step over the stability limit of contacts, and of finite elements; empty: from the
  /// accuracy.
  std::optional<double> safety = {}, element_safety = {};
  /// Corrects steps in which a contact begins or ends (contact/law/event_impulse.hpp).
  bool onsets = true;
  bool settled = false;               ///< start in equilibrium (dynamics/equilibrium.hpp)
  bool statics = false;               ///< a sequence of equilibria (dynamics/equilibrium.cpp)
  int load_steps = 10;                ///< of a static run
  bool automatic_load_steps = false;  ///< their number follows from the path (run/load_path.hpp)
  double tolerance = 1e-6;            ///< of its forces out of balance, parts of the loads
  double longest_step = 1e300;        ///< s; of an automatic step: the interval of the history
};

struct OutputSettings {
  int frames = 100;                                ///< besides the one at time 0
  double history_interval = 1e300;                 ///< s
  std::vector<RigidIndex> track;                   ///< rigid bodies in history.csv
  std::vector<DeformableIndex> track_deformables;  ///< deformable bodies as a whole
  std::vector<DeformableIndex> track_surfaces;  ///< deformable bodies whose contact pressure counts
  std::vector<TrackedPoint> points;
  /// Wall-clock s; empty: only when stopped.
  std::optional<double> checkpoint_interval = 600;
};

/// When a run ends before its time: all conditions that are given hold, for as long as is asked.
struct StopRule {
  std::string name;
  int region = -1;                              ///< of the model, or -1: everywhere
  std::optional<double> kinetic_per_body;       ///< below it, mean of the free bodies, J
  std::optional<int> count_below, count_above;  ///< of free bodies; "above" includes the number
  std::optional<double> no_exit_for;            ///< s; none has left the region for so long
  double hold = 0;                              ///< s
  double after = 0;                             ///< s; before, it is not looked at
  std::optional<double> wall_clock;             ///< s of real time
};
/// What a run is stopped by where a body leaves a world that stops it.
inline constexpr const char* kStoppedOutside = "outside";
/// What a static run is stopped by whose loads cannot be carried any more.
inline constexpr const char* kStoppedCollapse = "collapse";
/// The load factor at which it collapses, as a quantity of expectations and measures.
inline constexpr const char* kCollapseFactor = "collapse.factor";

/// Ways to reduce a column to one number, by the names in scenes; in the order of Reduction::Take.
inline constexpr std::array kTakes{"first", "last",     "min",      "max",  "max_abs",
                                   "mean",  "increase", "decrease", "slope"};
/// The same in words, before the name of the column.
inline constexpr std::array kTakesInWords{"first",           "last", "smallest",    "largest",
                                          "largest size of", "mean", "increase of", "decrease of",
                                          "slope of"};

/// A column of a history, reduced to one number.
struct Reduction {
  /// largest: of the absolute value; mean: over time; increase and decrease: from the first row to
  /// the last; slope: per s, of the straight line of least squares.
  enum class Take { first, last, minimum, maximum, largest, mean, increase, decrease, slope };
  std::string quantity;  ///< column of history.csv, energy.csv or momentum.csv, no unit
  Take take = Take::last;
  std::optional<double> from, until;  ///< time window, s
  std::string unit = {};              ///< of the number; "1" if it has none
  bool jumps = false;                 ///< the column does, so that nothing is known between rows
};

/// A result of a run that studies compare: a number, or whether a rule has stopped the run.
struct Measure {
  std::string name;
  Reduction of;            ///< if `stopped_by` is empty
  std::string stopped_by;  ///< name of a rule
};

/// What the value of an expectation rests on, by the names in scenes; in the order of Basis.
inline constexpr std::array kBases{"theory", "code", "law", "this_program", "paper"};

/// A closed form; an independent code; a law that every run obeys (conservation, balance of forces,
/// symmetry); a run of this program, kept to notice changes; or what the paper states.
enum class Basis { theory, code, law, this_program, paper };

/// A result the scene promises.
struct Expectation : Reduction {
  double value = 0;
  double tolerance = 0;    ///< absolute, in the quantity's unit
  std::string label = {};  ///< what it is in words; may be empty
  std::optional<Basis> basis = {};
  std::string source = {};  ///< where the value comes from, in words; may be empty
};

}  // namespace apothem
