#include "lib/sweep/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "lib/run/hash.hpp"
#include "lib/sweep/decimal_range.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/decimal.hpp"

namespace apothem {
namespace {

constexpr size_t kLongestKey = 100;  // characters

// The parts of a text between commas that do not stand in brackets or quotes.
std::vector<std::string> list_items(const std::string& text) {
  std::vector<std::string> items{""};
  int depth = 0;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ',' && depth == 0 && !quoted) {
      items.emplace_back();
      continue;
    }
    items.back() += c;
    if (quoted && c == '\\' && i + 1 < text.size()) items.back() += text[++i];
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '[' || c == '{')) ++depth;
    if (!quoted && (c == ']' || c == '}')) --depth;
  }
  return items;
}

// The values of FROM..TO[:STEP]; nothing if the item is not one. A name like ../wall.msh is none.
std::optional<std::vector<std::string>> range_values(const std::string& item) {
  const size_t dots = item.find("..");
  if (dots == std::string::npos || !find_decimal(item.substr(0, dots))) return {};
  const std::string rest = item.substr(dots + 2);
  const size_t colon = rest.find(':');
  std::optional<std::string> step;
  if (colon != std::string::npos) step = rest.substr(colon + 1);
  return decimal_range(item.substr(0, dots), rest.substr(0, colon), step, kMostRuns);
}

// Equal numbers are equal however they are written.
void refuse_repeated(const Variation& variation, const std::string& where) {
  std::set<nlohmann::json> known;
  for (const std::string& value : variation.values) {
    if (known.insert(nlohmann::json::parse(value)).second) continue;
    throw SceneError(
        where, fmt::format("\"{}\" has the value {} twice; give it once", variation.path, value));
  }
}

bool is_label(const std::string& column) { return column[0] == '#'; }

bool is_safe(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         std::string_view("._+-=,").find(c) != std::string_view::npos;
}

// A name for a folder. What does not fit a file name is replaced, and a hash tells it from others.
std::string folder_key(const std::vector<std::string>& names,
                       const std::vector<std::string>& values) {
  std::string full, key;
  for (size_t i = 0; i < names.size(); ++i) {
    full += fmt::format("{}{}={}", i == 0 ? "" : ",", names[i], without_quotes(values[i]));
  }
  for (const char c : full) key += is_safe(c) ? c : '_';
  if (key == full && key.size() <= kLongestKey && key[0] != '.') return key;
  const std::string hash = text_hash(full).substr(std::string("fnv1a64:").size());
  key = key.substr(0, kLongestKey - hash.size() - 1);
  if (key[0] == '.') key[0] = '_';
  return key + "-" + hash;
}

// The last `count` parts of a path.
std::string tail(const std::string& path, size_t count) {
  size_t start = path.size();
  for (size_t i = 0; i < count; ++i) {
    const size_t dot = start == 0 ? std::string::npos : path.rfind('.', start - 1);
    if (dot == std::string::npos) return path;
    start = dot;
  }
  return path.substr(start + 1);
}

void refuse_repeated_rows(const VariationTable& table, const std::vector<int>& lines,
                          const std::string& file) {
  std::map<std::vector<std::string>, int> known;
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const auto [first, added] = known.emplace(table.rows[i], lines[i]);
    if (!added) {
      throw SceneError(file, lines[i], "",
                       fmt::format("the row repeats that of line {}; leave it out", first->second));
    }
  }
}

void refuse_repeated_paths(const std::vector<std::string>& paths) {
  std::set<std::string> known;
  for (const std::string& path : paths) {
    if (!known.insert(path).second) {
      throw SceneError("--vary",
                       fmt::format("\"{}\" is varied twice; give all its values at once", path));
    }
  }
}

// The values of each run: every row of the table with every value of each variation.
std::vector<std::vector<std::string>> all_combinations(const VariationTable& table,
                                                       const std::vector<Variation>& variations) {
  std::vector<std::vector<std::string>> combinations = table.rows;
  if (combinations.empty()) combinations.emplace_back();
  for (const Variation& v : variations) {
    std::vector<std::vector<std::string>> longer;
    longer.reserve(combinations.size() * v.values.size());
    for (const std::vector<std::string>& values : combinations) {
      for (const std::string& value : v.values) {
        longer.push_back(values);
        longer.back().push_back(value);
      }
    }
    combinations = std::move(longer);
  }
  return combinations;
}

}  // namespace

Variation parse_variation(const std::string& text, const std::string& where) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size()) {
    throw SceneError(where,
                     fmt::format("\"{}\" varies nothing; write PATH=A,B,C or PATH=FROM..TO[:STEP], "
                                 "like contact.friction.coefficient=0.1..0.5:0.1",
                                 text));
  }
  Variation variation{text.substr(0, equals), {}};
  for (const std::string& item : list_items(text.substr(equals + 1))) {
    if (item.empty()) {
      throw SceneError(where,
                       fmt::format("\"{}\": a value of the list is empty; write PATH=A,B,C", text));
    }
    try {
      if (const auto range = range_values(item)) {
        variation.values.insert(variation.values.end(), range->begin(), range->end());
        continue;
      }
    } catch (const BadNumber& bad) {
      throw SceneError(where, fmt::format("\"{}\": {}", text, bad.what()));
    }
    variation.values.push_back(parse_setting(variation.path + "=" + item, where).value);
  }
  refuse_repeated(variation, where);
  return variation;
}

VariationTable read_variation_table(const std::string& file) {
  const std::vector<CsvRow> rows = read_csv(file);
  if (rows.size() < 2) {
    throw SceneError(file, "has no rows; its first line names paths, each further one a run");
  }
  VariationTable table{rows.front().cells, {}};
  std::vector<int> lines;
  for (const std::string& path : table.paths) {
    if (path.empty()) {
      throw SceneError(file, rows.front().line, "",
                       "a column has no path of the scene as its name");
    }
  }
  for (size_t i = 1; i < rows.size(); ++i) {
    const CsvRow& row = rows[i];
    if (row.cells.size() != table.paths.size()) {
      throw SceneError(file, row.line, "",
                       fmt::format("has {} cells; the header has {}. A value with commas stands in "
                                   "quotes, its own quotes doubled",
                                   row.cells.size(), table.paths.size()));
    }
    lines.push_back(row.line);
    std::vector<std::string>& values = table.rows.emplace_back();
    for (size_t c = 0; c < row.cells.size(); ++c) {
      if (row.cells[c].empty()) {
        throw SceneError(
            file, row.line, "",
            fmt::format("there is no value for \"{}\"; every cell needs one", table.paths[c]));
      }
      try {
        values.push_back(parse_setting(table.paths[c] + "=" + row.cells[c], file).value);
      } catch (const SceneError& error) {
        throw SceneError(file, row.line, "", error.reason());
      }
    }
  }
  refuse_repeated_rows(table, lines, file);
  return table;
}

Plan make_plan(const VariationTable& table, const std::vector<Variation>& variations) {
  Plan plan;
  // Where the table has labels, its other columns follow from them.
  std::vector<size_t> listed;
  const bool labels = std::ranges::any_of(table.paths, is_label);
  for (size_t i = 0; i < table.paths.size(); ++i) {
    if (labels && !is_label(table.paths[i])) continue;
    listed.push_back(i);
    plan.paths.push_back(labels ? table.paths[i].substr(1) : table.paths[i]);
  }
  const size_t labelled = plan.paths.size();
  size_t runs = std::max<size_t>(table.rows.size(), 1);
  for (const Variation& v : variations) {
    plan.paths.push_back(v.path);
    runs *= v.values.size();
    if (runs > kMostRuns) {
      throw SceneError("--vary",
                       fmt::format("the plan has more than {} runs; vary less at once", kMostRuns));
    }
  }
  if (plan.paths.empty()) {
    throw SceneError("sweep", "nothing varies; give --vary PATH=A,B,C or --table FILE.csv");
  }
  std::vector<std::string> all = table.paths;
  all.insert(all.end(), plan.paths.begin() + static_cast<std::ptrdiff_t>(labelled),
             plan.paths.end());
  refuse_repeated_paths(all);
  const std::vector<std::string> names = short_names(plan.paths);
  const std::vector<std::vector<std::string>> combinations = all_combinations(table, variations);
  plan.runs.reserve(combinations.size());
  std::set<std::string> keys;
  for (const std::vector<std::string>& values : combinations) {
    PlannedRun run;
    for (size_t i = 0; i < all.size(); ++i) {
      if (!is_label(all[i])) run.settings.push_back({all[i], values[i]});
    }
    for (const size_t i : listed) run.values.push_back(values[i]);
    run.values.insert(run.values.end(),
                      values.begin() + static_cast<std::ptrdiff_t>(table.paths.size()),
                      values.end());
    run.key = folder_key(names, run.values);
    if (!keys.insert(run.key).second) {
      throw SceneError(
          "--table",
          fmt::format("two rows have the labels of \"{}\"; give each row its own", run.key));
    }
    plan.runs.push_back(std::move(run));
  }
  return plan;
}

std::string without_quotes(const std::string& value) {
  const nlohmann::json parsed = nlohmann::json::parse(value);
  return parsed.is_string() ? parsed.get<std::string>() : value;
}

bool is_seed(const std::string& path) { return tail(path, 1) == "seed"; }

std::vector<std::string> short_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    size_t count = 1;
    const auto shared = [&](const std::string& other) {
      return other != path && tail(other, count) == tail(path, count);
    };
    while (tail(path, count) != path && std::ranges::any_of(paths, shared)) ++count;
    names.push_back(tail(path, count));
  }
  return names;
}

}  // namespace apothem
