// Private header: the runs that figures are made from. A run that is there already, of the same
// scene by the same program, is not done again; one that was interrupted goes on.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/reproduce/studies.hpp"

namespace apothem {

class FigureRuns {
 public:
  /// Runs of scenes in `data`/scenes, with results in `folder`/SCENE; studies in
  /// `studies`/NAME.
  FigureRuns(std::string data, std::string folder, std::string studies, int threads);

  /// Announces what will be asked for, so that the time left can be told.
  void plan(const std::vector<std::string>& scenes);
  void plan(const FigureStudy& study, bool quick);
  /// Does the run of a scene, unless its results are there. `figure` is named in the lines that
  /// tell of it. Returns an exit code. Throws what a run throws.
  int run(const std::string& figure, const std::string& scene);
  /// Does the commands of a study, unless its results are there. Returns an exit code: `missed` if
  /// a command has failed, which is printed.
  int run(const std::string& figure, const FigureStudy& study, bool quick);

  /// The text of run.json of a scene that was run.
  [[nodiscard]] const std::string& outcome(const std::string& scene) const {
    return outcomes_.at(scene);
  }
  /// Whether a run has become unstable.
  [[nodiscard]] bool unstable() const { return unstable_; }

 private:
  // What is known of a run before it is done.
  struct Planned {
    std::string folder;
    std::string key;  // of the scene or the commands, and the program
    bool ended = false, begun = false;
    bool over = false;   // in this process
    double seconds = 0;  // expected
  };
  // What `folder`/reproduced.json says of the run or study `name` there.
  [[nodiscard]] Planned look(const std::string& name, const std::string& folder,
                             const std::string& key) const;
  void begin(const std::string& name) const;
  void end(const std::string& figure, const std::string& name, const std::string& status,
           double seconds);
  void keep(const std::string& figure, const std::string& name, const std::string& status);
  [[nodiscard]] std::string time_left() const;

  std::string data_, folder_, studies_;
  int threads_;
  std::map<std::string, double> usual_;  // seconds of scenes, from data/figures/seconds.csv
  std::map<std::string, Planned> planned_;
  std::map<std::string, std::string> outcomes_;  // run.json of scenes
  double expected_ = 0, taken_ = 0;              // seconds of the runs that were done
  bool unstable_ = false;
};

}  // namespace apothem
