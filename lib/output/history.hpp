// history.csv, energy.csv and momentum.csv: one row per interval, numbers that read back to the
// same double.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "model/model.hpp"
#include "model/settings.hpp"
#include "model/state.hpp"
#include "output/files.hpp"

namespace apothem {

/// What histories record besides the state and the ledgers.
struct Observed {
  std::vector<double> friction;           ///< of each rigid body, summed sizes, N
  std::vector<BodyForce> contact;         ///< on each deformable body
  std::vector<double> node_mass;          ///< kg
  std::vector<CauchyStress> stress;       ///< of the element of each tracked point
  std::vector<SurfaceRecord> surfaces{};  ///< needed only where surfaces are tracked
};

class HistoryWriter {
 public:
  /// Sizes of the three files, to continue them later.
  using Sizes = std::array<std::int64_t, 3>;

  /// Writes the headers, or continues files of the given sizes. Throws SystemFailure.
  HistoryWriter(const std::string& folder, const Model& model, const OutputSettings& settings,
                const Sizes& sizes = {});

  /// Rows are kept in memory until there are enough of them, or flush().
  void add(const State& state, const Energies& energies, const Momenta& momenta,
           const Observed& observed);
  void flush();

  /// After flush().
  [[nodiscard]] Sizes sizes() const {
    return {history_.file.size(), energy_.file.size(), momentum_.file.size()};
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

/// A history file read back: column names without units.
struct HistoryTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  /// nullptr if there is no such column.
  [[nodiscard]] const std::vector<double>* column(const std::string& name) const;
};

/// Throws std::runtime_error naming the file and line if it is not such a table.
HistoryTable read_history(const std::string& file);

/// Files with a row per interval, in a folder of results.
inline constexpr std::array kHistoryFiles{"history.csv", "energy.csv", "momentum.csv"};

/// The first of the folder's histories with that column. Throws std::runtime_error if none has.
HistoryTable read_history_of(const std::string& folder, const std::string& column);

/// An expectation held against what was recorded.
struct Outcome {
  double value;
  bool met;
};

/// Minima and maxima are refined by the parabola through the neighbouring rows: exact in free
/// flight. Throws std::runtime_error if no row lies in the window.
Outcome evaluate(const Expectation& expectation, const std::string& folder);

}  // namespace apothem
