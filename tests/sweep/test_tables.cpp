// What run.json holds, and the tables made of it.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "lib/sweep/summary_picture.hpp"
#include "lib/sweep/tables.hpp"
#include "lib/text/csv.hpp"
#include "tests/folder.hpp"

using namespace apothem;
using test::Folder;
using Words = std::vector<std::string>;

namespace {

std::string run_json(const std::string& more, const std::string& expectations = "[]") {
  return R"({ "status": "done", "time": 0.5, "wall_time": { "total": 1.25 },
              "processor_time": 2.25, "scene_hash": "s",
              "final_state_hash": "f", )" +
         more + R"( "expectations": )" + expectations + " }";
}

RunRecord parsed_record(const std::string& text) {
  RunRecord record;
  record.state = RunState::done;
  parse_record(text, record);
  return record;
}

// Two diameters with three seeds each; of the first, one run has crashed.
struct Discharge {
  Plan plan = make_plan({}, {parse_variation("fill.0.diameter=0.5,0.6", "--vary"),
                             parse_variation("fill.0.seed=1..3", "--vary")});
  std::vector<RunRecord> records;

  Discharge() {
    const char* const measures[]{R"("discharged": 10, "jam": true)",
                                 R"("discharged": 20, "jam": true)",
                                 "",
                                 R"("discharged": 30, "jam": true)",
                                 R"("discharged": 50, "jam": false)",
                                 R"("discharged": null, "jam": null)"};
    for (const char* text : measures) {
      if (*text == 0) {
        RunRecord& record = records.emplace_back();
        record.state = RunState::crashed;
        record.message = "ended by signal 11, \"quoted\"";
      } else {
        records.push_back(parsed_record(
            run_json(std::string(R"("stopped_by": "jammed", "measures": { )") + text + " },")));
      }
    }
  }
};

}  // namespace

TEST_CASE("run.json may have measures, and has the values of expectations", "[sweep]") {
  const RunRecord bare = parsed_record(run_json(""));
  CHECK(bare.time == 0.5);
  CHECK(bare.wall_time == 1.25);
  CHECK(bare.processor_time == 2.25);
  CHECK(bare.stopped_by.empty());
  CHECK(bare.measures.empty());
  const RunRecord full = parsed_record(
      run_json(R"("stopped_by": null, "measures": { "count": 3, "jam": false, "a.x": null },)",
               R"([ { "quantity": "a.x", "take": "last", "value": 7 },
           { "quantity": "b.y", "take": "min", "value": 1.5 },
           { "quantity": "b.y", "take": "min", "value": 2.5 },
           { "quantity": "b.y", "take": "min", "value": null } ])"));
  REQUIRE(full.measures.size() == 7);
  CHECK(full.measures[0] == std::pair<std::string, MeasuredValue>("count", 3.));
  CHECK(full.measures[1] == std::pair<std::string, MeasuredValue>("jam", false));
  CHECK(full.measures[2] == std::pair<std::string, MeasuredValue>("a.x", std::monostate()));
  CHECK(full.measures[3] == std::pair<std::string, MeasuredValue>("a.x last", 7.));
  CHECK(full.measures[4] == std::pair<std::string, MeasuredValue>("b.y", 1.5));
  CHECK(full.measures[5] == std::pair<std::string, MeasuredValue>("b.y min", 2.5));
  CHECK(full.measures[6] == std::pair<std::string, MeasuredValue>("b.y min 2", std::monostate()));
  CHECK_THROWS_AS(parsed_record("{}"), std::runtime_error);
  CHECK_THROWS_AS(parsed_record("{"), std::runtime_error);
}

TEST_CASE("runs.csv has a row for every run", "[sweep]") {
  const Discharge study;
  const Folder folder;
  const std::vector<CsvRow> rows =
      read_csv(folder.write("runs.csv", runs_csv(study.plan, study.records)));
  REQUIRE(rows.size() == 7);
  CHECK(rows[0].cells == Words{"run", "fill.0.diameter", "fill.0.seed", "status", "stopped_by",
                               "time [s]", "wall_time [s]", "processor_time [s]", "scene_hash",
                               "final_state_hash", "discharged", "jam", "message"});
  CHECK(rows[1].cells == Words{"diameter=0.5,seed=1", "0.5", "1", "done", "jammed", "0.5", "1.25",
                               "2.25", "s", "f", "10", "true", ""});
  CHECK(rows[3].cells == Words{"diameter=0.5,seed=3", "0.5", "3", "crashed", "", "", "", "", "", "",
                               "", "", "ended by signal 11, \"quoted\""});
  CHECK(rows[6].cells[10].empty());
}

TEST_CASE("the summary takes seeds together and counts what is missing", "[sweep]") {
  const Discharge study;
  const SummaryTable table =
      summarise(study.plan, study.records, SurvivalChoice{"discharged", "jam"});
  CHECK(table.paths == Words{"fill.0.diameter"});
  REQUIRE(table.columns.size() == 3);
  REQUIRE(table.rows.size() == 2);
  const SummaryRow& first = table.rows[0];
  CHECK(first.values == Words{"0.5"});
  CHECK(first.runs == 3);
  CHECK(first.done == 2);
  CHECK(first.cells[0].n == 2);
  CHECK(first.cells[0].missing == 1);
  CHECK(first.cells[0].value == 15);
  CHECK(first.cells[0].standard_error == Approx(5));
  CHECK(first.cells[1].count == 2);
  CHECK(first.cells[2].value == Approx(2. / 30));
  const SummaryRow& second = table.rows[1];
  CHECK(second.done == 3);
  CHECK(second.cells[0].missing == 1);
  CHECK(second.cells[1].value == Approx(0.5));
  CHECK(second.cells[2].count == 1);
  CHECK(second.cells[2].value == Approx(1. / 80));

  const Folder folder;
  const std::vector<CsvRow> rows = read_csv(folder.write("summary.csv", summary_csv(table)));
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].cells == Words{"fill.0.diameter",
                               "runs",
                               "done",
                               "discharged n",
                               "discharged missing",
                               "discharged mean",
                               "discharged standard_error",
                               "discharged low",
                               "discharged high",
                               "jam n",
                               "jam missing",
                               "jam count",
                               "jam proportion",
                               "jam low",
                               "jam high",
                               "discharged rate_n",
                               "discharged rate_missing",
                               "discharged events",
                               "discharged rate",
                               "discharged rate_low",
                               "discharged rate_high"});
  CHECK(rows[1].cells[5] == "15");
  CHECK(rows[1].cells[12] == "1");
  CHECK(rows[2].cells[11] == "1");
}

TEST_CASE("a survival needs measures that are there, and exposures of 0 or more", "[sweep]") {
  Discharge study;
  const auto error_of = [&](const SurvivalChoice& survival) -> std::string {
    try {
      summarise(study.plan, study.records, survival);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(error_of({"discharged", ""}).empty());
  CHECK(error_of({"discharge", "jam"}) ==
        "--survival: no run has a number measure \"discharge\"; did you mean \"discharged\"? "
        "(known: discharged)");
  CHECK(error_of({"discharged", "discharged"}).find("no run has a yes/no measure") !=
        std::string::npos);
  study.records[0].measures[0].second = -1.;
  CHECK(error_of({"discharged", "jam"}).find("\"discharged\" is -1") != std::string::npos);
}

TEST_CASE("the picture has a panel for each measure and a line for each other value", "[sweep]") {
  Discharge study;
  const CurveFigure figure = summary_figure(summarise(study.plan, study.records, {}));
  REQUIRE(figure.panels.size() == 2);
  CHECK(figure.panels[0].x_label == "fill.0.diameter");
  CHECK(figure.panels[0].y_label == "mean of discharged");
  CHECK(figure.panels[1].y_label == "proportion of jam");
  REQUIRE(figure.panels[0].curves.size() == 1);
  const Curve& curve = figure.panels[0].curves[0];
  CHECK(curve.x == std::vector<double>{0.5, 0.6});
  CHECK(curve.y == std::vector<double>{15, 40});
  CHECK(curve.low[0] == Approx(15 - 12.7062 * 5).epsilon(1e-5));

  // Words on the x axis, and lines that are labelled; values in any order are sorted.
  study.plan = make_plan({}, {parse_variation("shape=cross,disc", "--vary"),
                              parse_variation("mu=0.3,0.1,0.2", "--vary")});
  const CurveFigure words = summary_figure(summarise(study.plan, study.records, {}));
  CHECK(words.panels[0].x_names == Words{"cross", "disc"});
  REQUIRE(words.panels[0].curves.size() == 2);  // mu = 0.2 has no values
  CHECK(words.panels[0].curves[0].label == "mu = 0.3");
  CHECK(words.panels[0].curves[1].label == "mu = 0.1");
  CHECK(words.panels[0].curves[0].x == std::vector<double>{1, 2});
  study.plan = make_plan({}, {parse_variation("mu=0.3,0.1,0.2,0.5,0.4,0.6", "--vary")});
  CHECK(summary_figure(summarise(study.plan, study.records, {})).panels[0].curves[0].x ==
        std::vector<double>{0.1, 0.3, 0.4, 0.5});

  // A single place needs limits, and so do equal values.
  CHECK_FALSE(figure.panels[0].x_range);
  CHECK_FALSE(figure.panels[0].y_range);
  study.plan =
      make_plan({}, {parse_variation("mu=0.5", "--vary"), parse_variation("seed=1..6", "--vary")});
  for (RunRecord& record : study.records) {
    for (auto& [name, value] : record.measures) value = 2.;
  }
  const CurvePanel single = summary_figure(summarise(study.plan, study.records, {})).panels[0];
  REQUIRE(single.x_range);
  CHECK(*single.x_range == Vec2(0.45, 0.55));
  REQUIRE(single.y_range);
  CHECK(*single.y_range == Vec2(1.8, 2.2));

  study.plan = make_plan({}, {parse_variation("seed=1..6", "--vary")});
  CHECK(summary_figure(summarise(study.plan, study.records, {})).panels.empty());
}
