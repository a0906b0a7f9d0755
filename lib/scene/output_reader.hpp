// Reads the part of a scene about results: frames, histories, checkpoints and expectations.
#pragma once

#include <string>
#include <vector>

#include "lib/model/columns.hpp"
#include "lib/model/frame_format.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/scene/compatibility.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// Rows of the histories of a scene that does not choose an interval: fewer where they are sums
/// over many bodies only, each of which costs about half of a step.
int default_rows(const Model& model, const OutputSettings& output);

/// Frames of a scene that does not choose their number: fewer where each costs several steps.
int default_frames(const Model& model);

class OutputReader {
 public:
  /// The model is complete. `bodies` are the names of its bodies in the order of the scene. Both
  /// must outlive this object.
  OutputReader(const JsonReader& in, const Model& model, const std::vector<std::string>& bodies,
               OutputSettings& output, UsedFeatures& features)
      : in_(in), model_(model), bodies_(bodies), output_(output), features_(features) {}

  /// Tracks all bodies that can move, if there are not too many of them.
  void track_by_default();

  /// Reads "output". Throws SceneError.
  void read(const JsonValue& value);
  /// How frames are written.
  [[nodiscard]] FrameFormat frame_format() const { return format_; }

  /// Expectations and measures may name this quantity besides the columns of the histories.
  void know(HistoryColumn quantity) { besides_.push_back(std::move(quantity)); }
  /// Reads "expect". Called last, because expectations name the columns of the histories. `end` is
  /// the end of the run in s. Throws SceneError.
  [[nodiscard]] std::vector<Expectation> expectations(const JsonValue& value, double end) const;
  /// Reads "measure". `stops`: names of what can end the run. Throws SceneError.
  [[nodiscard]] std::vector<Measure> measures(const JsonValue& value, double end,
                                              const std::vector<std::string>& stops) const;

 private:
  void history(const JsonValue& value);
  void checkpoint(const JsonValue& value);
  void tracked(const JsonValue& item);
  void track_once(std::vector<int>& list, int body, const JsonValue& value) const;
  void tracked_point(int deformable, const JsonValue& point, const JsonValue* label);
  [[nodiscard]] std::vector<HistoryColumn> columns() const;
  void reduction(JsonObject& object, const JsonValue& quantity,
                 const std::vector<HistoryColumn>& columns, double end, Reduction& result) const;
  [[nodiscard]] Expectation expectation(const JsonValue& item,
                                        const std::vector<HistoryColumn>& columns,
                                        double end) const;

  const JsonReader& in_;
  const Model& model_;
  const std::vector<std::string>& bodies_;
  OutputSettings& output_;
  UsedFeatures& features_;
  std::vector<HistoryColumn> besides_;
  FrameFormat format_ = FrameFormat::vtu;
};

/// Throws SceneError for a name that cannot head the columns of a CSV file.
void refuse_as_column(const JsonReader& in, const JsonValue& name);
[[nodiscard]] bool has_control_character(const std::string& name);

}  // namespace apothem
