// apothem reproduce: runs the scenes of the figures in data/figures, and writes curves, pictures
// and one report.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>

#include "apps/commands.hpp"
#include "apps/data_folder.hpp"
#include "apps/reproduce/comparison.hpp"
#include "apps/reproduce/figure.hpp"
#include "apps/reproduce/runs.hpp"
#include "lib/output/files.hpp"
#include "lib/output/report.hpp"
#include "lib/player/player.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"
#include "version.hpp"

namespace apothem {
namespace {

// People write "24", "fig24" or "Fig. 24" for "fig-24".
std::string figure_name(const std::string& text) {
  static const std::regex form("(?:fig(?:ure)?)?[-_. ]*([0-9].*)", std::regex::icase);
  std::smatch parts;
  return std::regex_match(text, parts, form) ? "fig-" + parts[1].str() : text;
}

std::vector<std::string> chosen(const ReproduceOptions& options,
                                const std::vector<std::string>& known) {
  if (options.figures == std::vector<std::string>{"all"}) return known;
  std::vector<std::string> names;
  for (const std::string& text : options.figures) {
    const std::string name = figure_name(text);
    if (std::ranges::find(known, name) == known.end()) {
      throw UsageError("reproduce", fmt::format("there is no figure {} (known: all, {})",
                                                suggest(name, known), fmt::join(known, ", ")));
    }
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::optional<Basis> basis_of(const nlohmann::json& expectation) {
  const nlohmann::json& name = expectation.at("basis");
  for (size_t i = 0; i < kBases.size(); ++i) {
    if (name == kBases[i]) return static_cast<Basis>(i);
  }
  return std::nullopt;
}

// The label and the column of the history, such as "energy error (largest size of total_error)".
std::string in_words(const nlohmann::json& expectation) {
  const auto take = std::ranges::find(kTakes, expectation.at("take").get<std::string>());
  const std::string label = expectation.at("label");
  const std::string column =
      fmt::format("{} {}", kTakesInWords.at(static_cast<size_t>(take - kTakes.begin())),
                  expectation.at("quantity").get<std::string>());
  return label.empty() ? column : fmt::format("{} ({})", label, column);
}

// All numbers of a report as a table for other programs, with all digits.
std::string numbers_table(const std::vector<ReportFigure>& figures) {
  std::string text = csv_row({"figure", "run", "number", "unit", "value", "reference", "tolerance",
                              "within", "basis", "source"});
  for (const ReportFigure& figure : figures) {
    for (const ReportNumber& n : figure.numbers) {
      const std::string_view basis = n.basis ? kBases[static_cast<size_t>(*n.basis)] : "";
      text += csv_row({figure.name, n.scene, n.what, n.unit, fmt::format("{}", n.value),
                       fmt::format("{}", n.reference), fmt::format("{}", n.tolerance),
                       n.met ? "true" : "false", std::string(basis), n.source});
    }
  }
  return text;
}

class Reproduction {
 public:
  Reproduction(const ReproduceOptions& options, std::string data)
      : options_(options),
        data_(std::move(data)),
        folders_{data_, options.folder + "/runs", options.folder + "/studies"},
        runs_(data_, folders_.runs, folders_.studies, options.threads) {}

  int execute(const std::vector<std::string>& names) {
    std::vector<Figure> figures;
    figures.reserve(names.size());
    for (const std::string& name : names) figures.push_back(read_figure(data_, name));
    create_folder(options_.folder);
    for (const Figure& figure : figures) {
      runs_.plan(figure.scenes);
      for (const FigureStudy& study : figure.studies) runs_.plan(study, options_.quick);
    }
    bool interrupted = false;
    for (const Figure& figure : figures) {
      interrupted = !make_runs(figure);
      if (interrupted) break;
      draw(figure);
    }
    // After an interruption it holds the figures that are complete.
    const std::string report = options_.folder + "/report.html";
    write_report(
        report,
        {"Figures of the distance-potential FEM-DEM paper",
         find_text(data_ + "/figures/about.html"), fmt::format("apothem {} reproduce", kVersion),
         find_text(data_ + "/figures/left-out.html")},
        reports_);
    write_file(options_.folder + "/numbers.csv", numbers_table(reports_));
    fmt::print("{} of {} numbers within their tolerance; {}\n", numbers_ - missed_, numbers_,
               report);
    if (interrupted) return exit_code::interrupted;
    if (no_gnuplot_) {
      fmt::print("no pictures: install gnuplot-nox; the curves are there as CSV\n");
    }
    if (!broken_.empty()) {
      throw std::runtime_error(broken_ + "/picture.gnuplot: gnuplot failed, see its message");
    }
    if (runs_.unstable()) return exit_code::unstable;
    return study_failed_ || (options_.verify && missed_ > 0) ? exit_code::missed : exit_code::done;
  }

 private:
  // False after an interruption.
  bool make_runs(const Figure& figure) {
    for (const std::string& scene : figure.scenes) {
      if (runs_.run(figure.name, scene) == exit_code::interrupted) return false;
    }
    for (const FigureStudy& study : figure.studies) {
      const int code = runs_.run(figure.name, study, options_.quick);
      if (code == exit_code::interrupted) return false;
      study_failed_ = study_failed_ || code != exit_code::done;
    }
    return true;
  }

  void draw(const Figure& figure) {
    ReportFigure& report = reports_.emplace_back();
    report.name = figure.name;
    report.title = figure.shown.title;
    report.text = figure.text;
    for (const FigureStudy& study : figure.studies) {
      for (const std::vector<std::string>& command : study.of(options_.quick)) {
        report.commands.push_back(command_line(words_of(command, "data", "studies/" + study.name)));
      }
    }
    const std::string folder = options_.folder + "/" + figure.name;
    const auto unless_cut_short =
        [&](void (Reproduction::*part)(const Figure&, const std::string&, ReportFigure&),
            const char* lost = "picture") {
          try {
            (this->*part)(figure, folder, report);
          } catch (const SystemFailure&) {
            throw;
          } catch (const std::runtime_error& error) {  // a run ended before the time of a frame
            report.faults.push_back(fmt::format("No {}: {}.", lost, error.what()));
            fmt::print("  {}: no {}: {}\n", figure.name, lost, error.what());
          }
        };
    if (!figure.sources.empty()) unless_cut_short(&Reproduction::draw_curves);
    for (const std::string& scene : figure.scenes) add_numbers(figure, scene, report);
    if (!figure.field_sources.empty()) unless_cut_short(&Reproduction::draw_fields);
    if (!figure.comparisons.empty()) unless_cut_short(&Reproduction::compare_tables, "comparison");
    if (!figure.potentials.empty()) draw_potentials(figure, folder, report);
    if (!figure.players.empty() || !figure.study_players.empty()) {
      unless_cut_short(&Reproduction::write_players, "player");
    }
  }

  void draw_curves(const Figure& figure, const std::string& folder, ReportFigure& report) {
    const CurveFigure drawn = figure.drawn(folders_);
    for (const ReportNumber& number : curve_numbers(figure, drawn)) add_number(number, report);
    std::vector<std::string> files;
    switch (write_curves(folder, drawn, files)) {
      case Plotted::yes:
        report.pictures.push_back(folder + "/picture.png");
        files.insert(files.begin(), {"picture.png", "picture.svg"});
        break;
      case Plotted::no_gnuplot:
        no_gnuplot_ = true;
        report.faults.emplace_back("No picture: there was no gnuplot.");
        break;
      case Plotted::failed:
        broken_ = folder;
        report.faults.emplace_back("No picture: gnuplot failed.");
        break;
    }
    for (const std::string& file : files) report.links.push_back(figure.name + "/" + file);
  }

  void draw_fields(const Figure& figure, const std::string& folder, ReportFigure& report) {
    const DrawnFields drawn = figure.drawn_fields(folders_);
    write_fields(folder, drawn.figure);
    report.pictures.push_back(folder + "/fields.png");
    for (const char* file : {"fields.png", "fields.svg"}) {
      report.links.push_back(figure.name + "/" + file);
    }
    for (const ReportNumber& number : drawn.numbers) add_number(number, report);
  }

  void draw_potentials(const Figure& figure, const std::string& folder, ReportFigure& report) {
    write_potentials(folder, potential_figure(figure.shown.title, figure.potentials));
    report.pictures.push_back(folder + "/potentials.png");
    for (const char* file : {"potentials.png", "potentials.svg"}) {
      report.links.push_back(figure.name + "/" + file);
    }
    for (const ReportNumber& number : potential_numbers(figure.potentials))
      add_number(number, report);
  }

  void compare_tables(const Figure& figure, const std::string& /*folder*/, ReportFigure& report) {
    for (const TableComparison& comparison : figure.comparisons) {
      for (const ReportNumber& number : numbers_of(comparison, data_, folders_.studies)) {
        add_number(number, report);
      }
    }
  }

  void write_players(const Figure& figure, const std::string& /*folder*/, ReportFigure& report) {
    create_folder(options_.folder + "/players");
    for (const std::string& scene : figure.players) {
      write_player(folders_.runs + "/" + scene, scene, scene, report);
    }
    for (const StudyPlayer& player : figure.study_players) {
      std::string name = player.run;
      std::ranges::replace(name, '/', '-');
      write_player(folders_.studies + "/" + player.run, player.label, name, report);
    }
  }

  void write_player(const std::string& run, const std::string& title, const std::string& name,
                    ReportFigure& report) const {
    const std::string file = "players/" + name + ".html";
    write_file(options_.folder + "/" + file,
               player_page(RunFolder(run), title, fmt::format("apothem {}", kVersion)));
    report.players.push_back({title, file});
  }

  void add_number(const ReportNumber& number, ReportFigure& report) {
    report.numbers.push_back(number);
    ++numbers_;
    if (number.met) return;
    ++missed_;
    fmt::print("  MISSED {}: {}\n", number.scene, number.what);
  }

  void add_numbers(const Figure& figure, const std::string& scene, ReportFigure& report) {
    const auto outcome = nlohmann::json::parse(runs_.outcome(scene));
    report.links.push_back(fmt::format("runs/{}/run.json", scene));
    if (outcome.contains("message")) {
      report.faults.push_back(scene + ": " + outcome["message"].get<std::string>());
    }
    const std::vector<std::string>& quantities = figure.numbers.at(scene);
    for (const nlohmann::json& e : outcome.at("expectations")) {
      const std::string quantity = e.at("quantity");
      if (!quantities.empty() && std::ranges::find(quantities, quantity) == quantities.end()) {
        continue;
      }
      const nlohmann::json& value = e.at("value");  // null if the run has no row in its time window
      add_number({scene, in_words(e), e.at("unit"), e.at("expected"),
                  value.is_null() ? std::nan("") : value.get<double>(), e.at("tolerance"),
                  e.at("met"), basis_of(e), e.at("source")},
                 report);
    }
  }

  const ReproduceOptions& options_;
  std::string data_;
  FigureFolders folders_;
  FigureRuns runs_;
  std::vector<ReportFigure> reports_;
  int numbers_ = 0, missed_ = 0;
  bool no_gnuplot_ = false, study_failed_ = false;
  std::string broken_;  // folder in which gnuplot failed
};

}  // namespace

int reproduce_command(const ReproduceOptions& options) {
  const std::string data = options.data.empty() ? data_folder() : options.data;
  const std::vector<std::string> known = figure_names(data);
  if (!options.figures.empty()) {
    return Reproduction(options, data).execute(chosen(options, known));
  }
  size_t width = 0;
  for (const std::string& name : known) width = std::max(width, name.size());
  for (const std::string& name : known) {
    fmt::print("{:<{}} {}\n", name, width, read_figure(data, name).shown.title);
  }
  return exit_code::done;
}

}  // namespace apothem
