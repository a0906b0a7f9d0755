// Reads a scene file, checks it and turns it into a model.
#pragma once

#include <string>
#include <vector>

#include "lib/model/frame_format.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/scene/import_report.hpp"
#include "lib/scene/json.hpp"
#include "lib/scene/setting.hpp"

namespace apothem {

struct Scene {
  std::string file;
  std::string text;               ///< contents of the file
  std::vector<Setting> settings;  ///< that replace values of the file
  Model model;
  TimeSettings time;
  bool automatic_scheme = false;  ///< whether "scheme": "auto" goes with all that the scene uses
  OutputSettings output;
  FrameFormat frame_format = FrameFormat::vtu;
  bool rigid = false;  ///< results are those of rigid bodies (run/rigid_limit.hpp)
  std::vector<Expectation> expectations;
  std::vector<StopRule> stops;
  std::vector<Measure> measures;
  std::vector<ImportReport> imports;        ///< what was read of each drawing
  std::vector<std::string> warnings;        ///< of how it was made, one sentence each
  std::vector<std::string> rigid_pointers;  ///< of each rigid body, its JSON pointer
  JsonValue document;                       ///< what the file says; a run frees it

  /// An error at a JSON pointer of this scene, or at the innermost enclosing value that exists.
  [[nodiscard]] SceneError error_at(const std::string& pointer, const std::string& what) const;
  /// Frees the coordinates of the bodies' polygons in the document, most of its memory. The model
  /// has them.
  void drop_rings();
};

/// Reads a scene, with settings in place of values of the file. Throws SceneError if it cannot be
/// read or is not a valid scene.
Scene read_scene(const std::string& file, const std::vector<Setting>& settings = {});
/// The same with a text in place of the contents of the file, which need not exist: it names the
/// place of errors, and the files that the scene names are relative to its folder.
Scene read_scene_text(std::string text, const std::string& file,
                      const std::vector<Setting>& settings = {});

}  // namespace apothem
