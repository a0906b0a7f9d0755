// A run that begins where another one has stopped, with the scene of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/dynamics/inheritance.hpp"
#include "lib/run/checkpoint.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// The last state of another run: final.json in its folder, or checkpoint.json if it was stopped.
class OtherRun {
 public:
  /// `time` in s: of the state that is wanted. Throws SceneError if there is no state, or none of
  /// that time: only the last state of a run is kept whole.
  OtherRun(const std::string& folder, std::optional<double> time);

  /// Gives bodies of the same name and shape place and velocity of this run. Throws SceneError if
  /// there is none, or if the scene finds its start otherwise.
  Beginning move_into(Scene& scene);
  /// After move_into(): hands over what contacts remember.
  void hand_contacts_to(Simulation& simulation) const;

 private:
  void load(const std::string& file);

  Beginning beginning_;
  ModelRecord record_;
  State state_;
  FrictionMemory memory_;
  std::vector<BodyIndex> heirs_;
};

/// The names of the bodies that begin where the scene puts them.
std::vector<std::string> not_moved(const Model& model, const Beginning& beginning);

}  // namespace apothem
