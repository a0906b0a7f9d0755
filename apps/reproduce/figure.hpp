// Private header: figures as data. A file in data/figures says which columns of which scenes make
// the curves and fields of a figure of the paper, and with which references they are compared.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/reproduce/potentials.hpp"
#include "apps/reproduce/studies.hpp"
#include "apps/reproduce/tables.hpp"
#include "lib/output/curves.hpp"
#include "lib/output/field_picture.hpp"
#include "lib/output/report.hpp"
#include "lib/scene/scene.hpp"

namespace apothem {

/// The time window in which the wanted frame of a scene lies, s.
struct FrameTime {
  double from = 0, latest = 0;
};

/// Where results and data are.
struct FigureFolders {
  std::string data;     ///< figures, scenes, references, studies
  std::string runs;     ///< results of scenes
  std::string studies;  ///< results of studies
};

/// The origin of a curve, one of five: columns of a scene's histories, columns of a table in
/// data/reference, the contact on a body's surface in one frame of a scene, rows of a table of
/// text, or given points.
struct CurveSource {
  /// A column and how its values are shown: as (value + offset) scale.
  struct Axis {
    std::string column;
    double offset = 0, scale = 1;
    [[nodiscard]] double shown(double value) const { return (value + offset) * scale; }
  };
  std::string scene;         ///< name of a scene, if the curve comes from one
  std::string reference;     ///< file of a table, if the curve comes from one
  std::vector<Vec2> points;  ///< the points themselves, if they are given
  Axis x{"time"}, y;
  int surface = -1;  ///< number of the body (rigid ones first) whose surface is shown; -1: none
  FrameTime frame;   ///< frame whose surface is shown
  std::optional<TableSource> rows;  ///< rows of a table of text
  /// Tolerances of the differences to the panel's reference curve, over its largest value.
  struct Tolerance {
    double rms, largest;
    Basis basis;
  };
  std::optional<Tolerance> compared;  ///< empty: not compared
};

/// The origin of a field: a frame of a scene or of a run of a study, or a table of cells in
/// data/reference.
struct FieldSource {
  std::string scene;  ///< name of a scene, if the field comes from one
  std::string study;  ///< folder of a run of a study; shown is the frame nearest to frame.from
  FrameTime frame;
  bool statics = false;      ///< whether the scene is static
  std::string reference;     ///< file of a table, if the field comes from one
  std::string column;        ///< column of the table
  Vec2 cell = Vec2::Zero();  ///< size of the table's cells, m
  /// Tolerances of the differences to the panel's first table, over the table's largest value.
  struct Tolerance {
    double rms, largest;  ///< of the root of the mean square, and of the largest difference
  };
  std::optional<Tolerance> compared;  ///< empty: not compared
};

/// Fields ready to be drawn, and how far they are from their references.
struct DrawnFields {
  FieldFigure figure;
  std::vector<ReportNumber> numbers;
};

/// A run of a study that readers can play.
struct StudyPlayer {
  std::string run;    ///< its folder, relative to the folder of studies
  std::string label;  ///< what the report calls it
};

/// A figure as its file describes it.
struct Figure {
  std::string name;                                     ///< name of the file, without extension
  FigureText text;                                      ///< what it says in words
  CurveFigure shown;                                    ///< panels and curves, still without points
  std::vector<std::vector<CurveSource>> sources;        ///< of each curve of each panel
  FieldFigure shown_fields;                             ///< panels of fields, still without fields
  std::vector<std::vector<FieldSource>> field_sources;  ///< of each field of each panel
  std::vector<PotentialPanelSource> potentials;         ///< panels of potentials
  /// Scenes whose expectations the report states, with their quantities; all of them if there are
  /// none.
  std::map<std::string, std::vector<std::string>> numbers;
  std::vector<FigureStudy> studies;          ///< studies to make
  std::vector<TableComparison> comparisons;  ///< of tables, stated as numbers
  std::vector<std::string> scenes;           ///< scenes to run, each listed once
  /// Runs that the report lets readers play: some of the scenes, and runs of studies.
  std::vector<std::string> players;
  std::vector<StudyPlayer> study_players;

  /// The curves with their points. Throws std::runtime_error, which names a table that cannot be
  /// read.
  [[nodiscard]] CurveFigure drawn(const FigureFolders& folders) const;

  /// The fields with their values. Throws std::runtime_error, which names what cannot be read or
  /// compared.
  [[nodiscard]] DrawnFields drawn_fields(const FigureFolders& folders) const;
};

/// Names of the figures in a data folder, in reading order: those of the paper first, fig-4 before
/// fig-13. Throws SceneError if there are none.
std::vector<std::string> figure_names(const std::string& data);

/// Reads a figure and makes all checks that are possible before a run: its scenes are valid and
/// record the columns that it needs, and its tables have the columns. Throws SceneError.
Figure read_figure(const std::string& data, const std::string& name);

}  // namespace apothem
