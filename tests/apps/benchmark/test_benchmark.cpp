// apothem benchmark as its users meet it. Nothing here depends on how long anything takes.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "lib/text/csv.hpp"
#include "tests/program.hpp"

using namespace apothem;
using test::content;
using test::Folder;
using test::Result;
using test::run;
using Json = nlohmann::json;

namespace {

// The rows of a table by the first cell, each by the titles of the columns.
std::map<std::string, std::map<std::string, std::string>> table(const std::string& file) {
  const std::vector<CsvRow> rows = read_csv(file);
  REQUIRE(!rows.empty());
  std::map<std::string, std::map<std::string, std::string>> named;
  for (size_t i = 1; i < rows.size(); ++i) {
    REQUIRE(rows[i].cells.size() == rows[0].cells.size());
    for (size_t k = 0; k < rows[0].cells.size(); ++k) {
      named[rows[i].cells[0]][rows[0].cells[k]] = rows[i].cells[k];
    }
  }
  return named;
}

// What the program prints of two cases: one run, as each measures the limits of the machine first.
const Json& printed() {
  static const Json json = [] {
    const Folder folder;
    const Result r = run({"benchmark", "--quick", "--repeat", "2", "--filter",
                          "^(collar_edge_face|quads/300)$", "--json"},
                         folder);
    REQUIRE(r.code == 0);
    return Json::parse(r.out);
  }();
  return json;
}

bool is_positive(const std::string& cell) {
  const double value = std::stod(cell);
  return std::isfinite(value) && value > 0;
}

}  // namespace

TEST_CASE("benchmark lists its cases, each once, and times none", "[benchmark]") {
  const Folder folder;
  const Result r = run({"benchmark", "--list", "--json"}, folder);
  CHECK(r.code == 0);
  CHECK(r.err.empty());
  std::set<std::string> names;
  size_t count = 0;
  const Json list = Json::parse(r.out);
  for (const Json& entry : list.at("cases")) {
    names.insert(entry.at("name").get<std::string>());
    CHECK(!entry.at("item").get<std::string>().empty());
    CHECK(!entry.at("about").get<std::string>().empty());
    ++count;
  }
  CHECK(names.size() == count);
  for (const char* name : {"machine_memory", "quad_pair_edge", "force/Q4/1000000", "quads/3000",
                           "crosses/3000", "start/quads/30000", "work/gas/plain/50"}) {
    CHECK(names.count(name) == 1);
  }
  const Result text = run({"benchmark", "--list"}, folder);
  CHECK(test::lines(text.out) == static_cast<int>(count));
  const Result some = run({"benchmark", "--list", "--filter", "^quad_pair_edge$|^work/"}, folder);
  CHECK(some.code == 0);
  CHECK(some.out.find("quad_pair_edge ") != std::string::npos);
  CHECK(some.out.find("quad_pair_near_miss") == std::string::npos);
}

TEST_CASE("a filtered benchmark prints a table and leaves CSV and picture", "[benchmark]") {
  const Folder folder;
  const Result r =
      run({"benchmark", "--quick", "--repeat", "2", "--filter",
           "^(quad_pair_near_miss|force/T3/1000|force/T3/100000)$", "-o", folder / "out"},
          folder);
  INFO(r.out << r.err);
  CHECK(r.code == 0);
  CHECK(r.out.find("force/T3: the whole time grows with the power ") != std::string::npos);
  CHECK(r.out.find("GB/s") != std::string::npos);
  CHECK(test::lines(r.err) == 3);  // the cases, as they begin
  auto rows = table(folder / "out/benchmark.csv");
  CHECK(rows.size() == 3);
  for (auto& [name, row] : rows) {
    INFO(name);
    CHECK(row.at("repetitions") == "2");
    CHECK(row.at("threads") == "1");
    for (const char* column : {"median [ns]", "least [ns]", "largest [ns]", "rate [1/s]"}) {
      CHECK(is_positive(row.at(column)));
    }
    CHECK(std::stod(row.at("least [ns]")) <= std::stod(row.at("median [ns]")));
    CHECK(std::stod(row.at("median [ns]")) <= std::stod(row.at("largest [ns]")));
  }
  auto& elements = rows.at("force/T3/1000");
  CHECK(elements.at("item") == "element");
  CHECK(elements.at("size") == "1000");
  for (const char* column : {"bytes per item", "operations per item", "bandwidth [GB/s]",
                             "arithmetic [GFlop/s]", "of bandwidth limit", "of arithmetic limit"}) {
    CHECK(is_positive(elements.at(column)));
  }
  auto& pairs = rows.at("quad_pair_near_miss");
  CHECK(pairs.at("bytes per item").empty());
  CHECK(pairs.at("failures") == "0");
  // Gnuplot may be missing.
  const bool picture = std::filesystem::exists(folder / "out/picture.png");
  CHECK(picture == (r.out.find("no picture") == std::string::npos));
}

TEST_CASE("benchmark prints JSON with the time of every repetition", "[benchmark]") {
  const Json& json = printed();
  CHECK(json.at("limits").at("bandwidth").get<double>() > 0);
  CHECK(json.at("limits").at("arithmetic").get<double>() > 0);
  REQUIRE(json.at("cases").size() == 2);
  const Json& c = json.at("cases").at(0);
  CHECK(c.at("name") == "collar_edge_face");
  CHECK(c.at("times").size() == 2);
  CHECK(c.at("median").get<double>() > 0);
  CHECK(c.at("operations").get<double>() > 1);
}

TEST_CASE("the pile of a benchmark is dense, and the time is divided among the phases",
          "[benchmark][slow]") {
  const Json& pile = printed().at("cases").at(1);
  CHECK(pile.at("name") == "quads/300");
  const Json& extras = pile.at("extras");
  const double touching = extras.at("touching");
  CHECK(touching > 1.3);
  CHECK(extras.at("candidates").get<double>() >= touching);
  // A block of 0.1 m that falls by its own size reaches 1.4 m/s.
  CHECK(extras.at("speed").get<double>() < .05);
  double shares = 0;
  for (const char* phase : {"integrate", "elements", "place", "search", "contact", "gather"}) {
    CHECK(extras.at(phase).get<double>() >= 0);
    shares += extras.at(phase).get<double>();
  }
  CHECK(shares == Approx(1));
}

TEST_CASE("benchmark compares two programs case by case", "[benchmark][slow]") {
  const Folder folder;
  // With two threads the limits of the machine are not measured again for each case and program.
  const Result r = run(
      {"benchmark", "--quick", "--repeat", "2", "--filter", "^(quad_pair_near_miss|force/T3/1000)$",
       "--threads", "2", "--compare", test::kProgram, "-o", folder / "out"},
      folder);
  INFO(r.out << r.err);
  CHECK(r.code == 0);
  auto rows = table(folder / "out/compare.csv");
  CHECK(rows.size() == 2);
  for (auto& [name, row] : rows) {
    INFO(name);
    CHECK(row.at("turns") == "2");
    for (const char* column :
         {"median here [ns]", "median other [ns]", "ratio", "least ratio", "largest ratio"}) {
      CHECK(is_positive(row.at(column)));
    }
    CHECK(std::stod(row.at("least ratio")) <= std::stod(row.at("largest ratio")));
  }
}

TEST_CASE("a benchmark that cannot be done ends with exit code 2 and one line", "[benchmark]") {
  const Folder folder;
  const std::string other = folder.write("other", "#!/bin/sh\necho unknown command >&2\nexit 2\n");
  std::filesystem::permissions(other, std::filesystem::perms::owner_all);
  for (const auto& [arguments, message] :
       {std::pair(std::vector<std::string>{"--filter", "("}, "is no regular expression"),
        std::pair(std::vector<std::string>{"--filter", "no such case"}, "finds no case"),
        std::pair(std::vector<std::string>{"--compare", folder / "nothing"}, "cannot be run"),
        std::pair(std::vector<std::string>{"--compare", other}, "has no command benchmark"),
        std::pair(std::vector<std::string>{"--repeat", "0"}, "Value 0 not in range"),
        std::pair(std::vector<std::string>{"--list", "-o", "x"}, "excludes")}) {
    std::vector<std::string> words{"benchmark"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const Result r = run(words, folder);
    INFO(r.err);
    CHECK(r.code == 2);
    CHECK(r.out.empty());
    CHECK(test::lines(r.err) == 1);
    CHECK(r.err.find(message) != std::string::npos);
  }
}
