// A figure of the paper as data: a file in data/figures says which columns of which scenes make its
// curves, and what stands beside them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apothem/output/curves.hpp"
#include "apothem/output/field_picture.hpp"
#include "apothem/output/report.hpp"
#include "apothem/scene/scene.hpp"

namespace apothem {

/// When a frame of a scene is, s.
struct FrameTime {
  double from = 0, latest = 0;
};

/// Where a curve comes from: columns of a scene's histories, of a table in data/reference, contact
/// on a body's surface in a frame, or points. Shown is (value + offset) scale.
struct CurveSource {
  struct Axis {
    std::string column;
    double offset = 0, scale = 1;
    [[nodiscard]] double shown(double value) const { return (value + offset) * scale; }
  };
  std::string scene;      ///< name; or
  std::string reference;  ///< file; or
  std::vector<Vec2> points;
  Axis x{"time"}, y;
  int surface = -1;  ///< the body (rigid ones first) whose pressed edges are shown, at
  FrameTime frame;
};

/// Where a field comes from: a frame of a scene, or a table of cells in data/reference.
struct FieldSource {
  std::string scene;  ///< name; or
  FrameTime frame;
  int rigid = 0;  ///< rigid bodies of the scene
  bool statics = false;
  std::string reference;  ///< file
  std::string column;
  Vec2 cell = Vec2::Zero();  ///< m
  /// Of the differences to the panel's first reference, as parts of its largest value.
  struct Tolerance {
    double rms, largest;
  };
  std::optional<Tolerance> compared;
};

/// Fields as drawn, and how far they are from their references.
struct DrawnFields {
  FieldFigure figure;
  std::vector<ReportNumber> numbers;
};

struct Figure {
  std::string name;                                     ///< of its file
  std::string about;                                    ///< may be empty
  CurveFigure shown;                                    ///< its curves still without points
  std::vector<std::vector<CurveSource>> sources;        ///< by panel and curve
  FieldFigure shown_fields;                             ///< its panels still without fields
  std::vector<std::vector<FieldSource>> field_sources;  ///< by panel and field
  /// Scenes whose expectations are stated, with the quantities; without any, all of them.
  std::map<std::string, std::vector<std::string>> numbers;
  std::vector<std::string> scenes;  ///< to run, each once

  /// The curves with the points of the runs in `runs`/SCENE and of the tables in `data`/reference.
  /// Throws std::runtime_error naming a table that cannot be read.
  [[nodiscard]] CurveFigure drawn(const std::string& data, const std::string& runs) const;

  /// The same for fields. Throws std::runtime_error naming what cannot be read, or compared.
  [[nodiscard]] DrawnFields drawn_fields(const std::string& data, const std::string& runs) const;
};

/// Names of the figures in a data folder, in reading order (fig-4 before fig-13). Throws SceneError
/// if there is none.
std::vector<std::string> figure_names(const std::string& data);

/// Checks all there is to check before a run: that its scenes are valid and record the columns, and
/// that its tables have theirs. Throws SceneError.
Figure read_figure(const std::string& data, const std::string& name);

}  // namespace apothem
