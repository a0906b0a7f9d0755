#include "lib/sweep/tables.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "lib/output/files.hpp"
#include "lib/sweep/summary_picture.hpp"
#include "lib/text/csv.hpp"

namespace apothem {
namespace {

namespace fs = std::filesystem;

std::string cell_of(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string cell_of(const std::optional<double>& value) { return value ? cell_of(*value) : ""; }

std::string cell_of(const MeasuredValue& value) {
  if (const auto* yes = std::get_if<bool>(&value)) return *yes ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value)) return cell_of(*number);
  return "";
}

// Strings without their quotes, as in a table of variations.
std::vector<std::string> cells_of(const std::vector<std::string>& values) {
  std::vector<std::string> cells;
  cells.reserve(values.size());
  for (const std::string& value : values) cells.push_back(without_quotes(value));
  return cells;
}

// The names of the columns of one SummaryColumn, after the name of the measure.
std::array<const char*, 6> parts_of_column(SummaryColumn::Kind kind) {
  switch (kind) {
    case SummaryColumn::Kind::mean:
      return {"n", "missing", "mean", "standard_error", "low", "high"};
    case SummaryColumn::Kind::proportion:
      return {"n", "missing", "count", "proportion", "low", "high"};
    case SummaryColumn::Kind::rate:
      break;
  }
  return {"rate_n", "rate_missing", "events", "rate", "rate_low", "rate_high"};
}

// A folder of this process alone, gone at the end. Files become those of the study when they are
// complete, by a rename.
class PrivateFolder {
 public:
  explicit PrivateFolder(std::string study) : study_(std::move(study)) {
    std::array<char, 256> host{};
    gethostname(host.data(), host.size() - 1);
    path_ = fmt::format("{}/tables-{}-{}", study_, host.data(), getpid());
    create_folder(path_);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  ~PrivateFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::string& path() const { return path_; }

  void publish(const std::string& name, const std::string& text) const {
    write_file(path_ + "/" + name, text);
    publish_file(name, name);
  }
  void publish_file(const std::string& name, const std::string& as) const {
    std::error_code error;
    fs::rename(path_ + "/" + name, study_ + "/" + as, error);
    if (error) throw SystemFailure(study_ + "/" + as, error.value());
  }

 private:
  std::string study_, path_;
};

}  // namespace

std::string runs_csv(const Plan& plan, const std::vector<RunRecord>& records) {
  const std::vector<MeasureName> measures = measure_names(records);
  std::vector<std::string> header{"run"};
  header.insert(header.end(), plan.paths.begin(), plan.paths.end());
  for (const char* name : {"status", "stopped_by", "time [s]", "wall_time [s]",
                           "processor_time [s]", "scene_hash", "final_state_hash"}) {
    header.emplace_back(name);
  }
  for (const MeasureName& m : measures) header.push_back(m.name);
  header.emplace_back("message");
  std::string text = csv_row(header);
  for (size_t i = 0; i < records.size(); ++i) {
    const RunRecord& r = records[i];
    std::vector<std::string> row{plan.runs[i].key};
    const std::vector<std::string> values = cells_of(plan.runs[i].values);
    row.insert(row.end(), values.begin(), values.end());
    row.insert(row.end(), {name_of(r.state), r.stopped_by, cell_of(r.time), cell_of(r.wall_time),
                           cell_of(r.processor_time), r.scene_hash, r.final_state_hash});
    for (const MeasureName& m : measures) {
      MeasuredValue found;
      for (const auto& [name, value] : r.measures) {
        if (name == m.name) found = value;
      }
      row.push_back(cell_of(found));
    }
    row.push_back(r.message);
    text += csv_row(row);
  }
  return text;
}

std::string summary_csv(const SummaryTable& table) {
  std::vector<std::string> header = table.paths;
  header.insert(header.end(), {"runs", "done"});
  for (const SummaryColumn& column : table.columns) {
    for (const char* part : parts_of_column(column.kind)) {
      header.push_back(column.measure + " " + part);
    }
  }
  std::string text = csv_row(header);
  for (const SummaryRow& row : table.rows) {
    std::vector<std::string> cells = cells_of(row.values);
    cells.insert(cells.end(), {std::to_string(row.runs), std::to_string(row.done)});
    for (size_t c = 0; c < row.cells.size(); ++c) {
      const SummaryCell& cell = row.cells[c];
      cells.insert(cells.end(), {std::to_string(cell.n), std::to_string(cell.missing)});
      if (table.columns[c].kind == SummaryColumn::Kind::mean) {
        cells.insert(cells.end(), {cell_of(cell.value), cell_of(cell.standard_error)});
      } else {
        cells.insert(cells.end(), {std::to_string(cell.count), cell_of(cell.value)});
      }
      cells.insert(cells.end(), {cell_of(cell.interval.low), cell_of(cell.interval.high)});
    }
    text += csv_row(cells);
  }
  return text;
}

std::optional<Plotted> write_tables(const Study& study, const std::vector<RunRecord>& records,
                                    const std::optional<SurvivalChoice>& survival) {
  create_folder(study.settings().folder);
  const PrivateFolder folder(study.settings().folder);
  folder.publish("runs.csv", runs_csv(study.plan(), records));
  const SummaryTable table = summarise(study.plan(), records, survival);
  folder.publish("summary.csv", summary_csv(table));
  const CurveFigure figure = summary_figure(table);
  if (figure.panels.empty()) return {};
  std::vector<std::string> files;
  const Plotted plotted = write_curves(folder.path(), figure, files);
  if (plotted == Plotted::yes) {
    folder.publish_file("picture.png", "summary.png");
    folder.publish_file("picture.svg", "summary.svg");
  }
  return plotted;
}

}  // namespace apothem
