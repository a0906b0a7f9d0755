// Writes and reads history.csv, energy.csv and momentum.csv, which have one row per output
// interval. Numbers have as many digits as are needed to read the same double again.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"
#include "lib/model/state.hpp"
#include "lib/model/statistics.hpp"
#include "lib/output/files.hpp"

namespace apothem {

/// What histories record in addition to the state and the energy and momentum ledgers.
struct Observed {
  std::vector<BodyForce> contact = {};  ///< contact force on each body, rigid ones first
  /// Of each body; needed only if bodies are tracked.
  std::vector<BodyStatistics> bodies = {};
  std::vector<double> node_mass = {};     ///< lumped mass of each node, kg
  std::vector<CauchyStress> stress = {};  ///< of the element that holds each tracked point, Pa
  /// Boundary pressures; needed only if surfaces are tracked.
  std::vector<SurfaceRecord> surfaces = {};
  std::vector<RegionSums> regions = {};  ///< of the model
};

/// The first line of history.csv, with its end.
std::string history_header(const Model& model, const OutputSettings& settings);

/// Writes the three files of a run.
class HistoryWriter {
 public:
  /// The three files up to now, behind which a later run can continue them.
  using Parts = std::array<FilePart, 3>;

  /// Starts the three files with their headers or, if `parts` are given, continues them behind
  /// those. `model` and `settings` must outlive the writer. Throws SystemFailure.
  HistoryWriter(const std::string& folder, const Model& model, const OutputSettings& settings,
                const Parts& parts = {});

  /// Adds one row to each file. Rows stay in memory until there are enough of them, or until
  /// flush(). Throws SystemFailure, also if a file has been deleted or cut meanwhile.
  void add(const State& state, const Energies& energies, const Momenta& momenta,
           const Observed& observed);
  /// Writes the rows that are still in memory. Throws SystemFailure.
  void flush();

  /// Flushes, and sees to it that the files outlast a machine that stops. Throws SystemFailure.
  void make_last();
  /// The files. Valid after flush().
  [[nodiscard]] Parts parts() const {
    return {history_.file.part(), energy_.file.part(), momentum_.file.part()};
  }

 private:
  struct Table {
    AppendedFile file;
    std::string rows;
  };

  const Model& model_;
  const OutputSettings& settings_;
  Table history_, energy_, momentum_;
};

/// A column OWNER.quantity of a history, or a column of a ledger, which has no owner.
struct ColumnName {
  std::string owner, quantity;
  explicit ColumnName(const std::string& column);
};

/// A history file that has been read.
struct HistoryTable {
  std::vector<std::string> names;            ///< column names, without units
  std::vector<std::vector<double>> columns;  ///< one per name
  std::vector<std::string> units = {};       ///< one per name; empty where the header has none
  /// The column with that name, or null if there is none.
  [[nodiscard]] const std::vector<double>* column(const std::string& name) const;
  /// The names of the regions, which no body has: bodies are not counted.
  [[nodiscard]] std::set<std::string> regions() const;
};

/// Reads a history file. A last row that is still being written, and so has no line break, is left
/// out. Throws std::runtime_error, which names the file and line, if it is not such a table.
HistoryTable read_history(const std::string& file);

/// The history files in a folder of results.
inline constexpr std::array kHistoryFiles{"history.csv", "energy.csv", "momentum.csv"};

/// The first of the folder's history files that has the column. Throws std::runtime_error if none
/// has it.
HistoryTable read_history_of(const std::string& folder, const std::string& column);

/// The value of an expectation's quantity in a run, and whether it meets the expectation.
struct Outcome {
  double value;
  bool met;
};

/// A column of the histories in a folder of results, reduced to one number. Minima and maxima are
/// those of the parabola through a row and its neighbours, which is exact in free flight, where the
/// column is smooth; otherwise those of the rows. Throws std::runtime_error if no row lies in the
/// time window.
double reduce(const Reduction& reduction, const std::string& folder);

/// Evaluates an expectation, as `reduce` does.
Outcome evaluate(const Expectation& expectation, const std::string& folder);

}  // namespace apothem
