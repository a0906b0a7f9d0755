// The plan of a study: which values of a scene are varied, and the list of runs that follows.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/setting.hpp"

namespace apothem {

/// The values that one path of a scene takes, one after the other.
struct Variation {
  std::string path;
  std::vector<std::string> values;  ///< JSON
};

/// Reads "PATH=A,B,C" or "PATH=FROM..TO[:STEP]", or a mixture of both. Values are read as those of
/// parse_setting(); commas within brackets and quotes do not divide them. Throws SceneError, with
/// `where` as its place: the option that the text comes from.
Variation parse_variation(const std::string& text, const std::string& where);

/// Rows of values that go together. A column whose name begins with # is a label: it sets nothing
/// in the scene but names its row. Where there are labels, results are listed by them alone.
struct VariationTable {
  std::vector<std::string> paths;              ///< of the columns; or labels, with their #
  std::vector<std::vector<std::string>> rows;  ///< JSON
};

/// Reads a CSV file whose header holds paths. Throws SceneError.
VariationTable read_variation_table(const std::string& file);

/// One run of a study.
struct PlannedRun {
  std::string key;                  ///< name of its folder, unique in the plan
  std::vector<std::string> values;  ///< JSON, one for each path of the plan
  std::vector<Setting> settings;    ///< of the scene
};

struct Plan {
  std::vector<std::string>
      paths;  ///< by which results are listed: labels, or paths of the table; others
  std::vector<PlannedRun> runs;
};

/// The largest number of runs in a plan.
inline constexpr size_t kMostRuns = 1'000'000;

/// All rows of the table (none if it has no paths) with all combinations of the other values: the
/// last variation changes fastest. Throws SceneError if nothing varies, if a path is there twice,
/// or if there are more than kMostRuns.
Plan make_plan(const VariationTable& table, const std::vector<Variation>& variations);

/// A value as people read it: a string without its quotes, all else as JSON.
std::string without_quotes(const std::string& value);

/// Whether a path is that of a seed: its last key is "seed". Runs that differ only in seeds repeat
/// each other.
bool is_seed(const std::string& path);

/// The shortest ends of paths that tell them from each other, like "coefficient" for
/// contact.friction.coefficient.
std::vector<std::string> short_names(const std::vector<std::string>& paths);

}  // namespace apothem
