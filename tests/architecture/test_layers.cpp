// Who may include whom, and which library may appear where: the rooms of the house stay separate.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/support.hpp"

namespace fs = std::filesystem;

namespace {

struct Include {
  std::string file, what;
};

std::vector<Include> includes(const std::string& folder) {
  std::vector<Include> result;
  const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(apothem::test::kSource) / folder)) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
    std::ifstream stream(entry.path());
    std::smatch match;
    for (std::string line; std::getline(stream, line);) {
      if (std::regex_search(line, match, pattern))
        result.push_back({entry.path().string(), match[1]});
    }
  }
  return result;
}

}  // namespace

// As in docs/architecture.md: a room may include itself and these.
const std::map<std::string, std::set<std::string>> kMayInclude{
    {"system", {}},
    {"execution", {}},
    {"solver", {"execution"}},
    {"text", {"system"}},
    {"geometry", {"system", "execution"}},
    {"archive", {"geometry"}},
    {"mesh", {"execution", "text", "geometry"}},
    {"fem", {"execution", "geometry", "mesh", "solver"}},
    {"contact", {"execution", "archive", "geometry", "mesh", "solver"}},
    {"model", {"execution", "archive", "geometry", "mesh", "fem", "contact"}},
    {"dynamics", {"execution", "archive", "geometry", "mesh", "fem", "contact", "model", "solver"}},
    {"scene", {"system", "execution", "text", "geometry", "mesh", "fem", "contact", "model"}},
    {"output", {"system", "execution", "text", "geometry", "mesh", "model"}},
    {"player", {"text", "geometry", "mesh", "model", "output"}},
    {"run",
     {"system", "text", "archive", "geometry", "mesh", "model", "dynamics", "scene", "output"}},
    {"sweep", {"text", "scene", "output", "run"}},
};

// Rooms within geometry.
const std::map<std::string, std::set<std::string>> kGeometryMayInclude{
    {"polygon", {}},
    {"spatial", {"polygon"}},
    {"skeleton", {"polygon", "spatial"}},
    {"potential", {"polygon", "spatial", "skeleton"}},
    {"integrals", {"polygon", "spatial", "skeleton", "potential"}},
    {"exact", {"polygon", "skeleton", "potential", "integrals"}},
    {"meshing", {"polygon", "spatial"}},
    {"packing", {"polygon", "spatial", "skeleton", "meshing"}},
    {"regions", {"polygon", "spatial"}},
};

// Rooms within lib/contact. Kernels see of what is above them only what a kernel is.
const std::map<std::string, std::set<std::string>> kContactMayInclude{
    {"law", {}},
    {"surface", {"law"}},
    {"rigid", {"law", "surface", "kernel.hpp"}},
    {"mesh", {"law", "surface", "kernel.hpp"}},
    {"element", {"law", "surface", "rigid", "kernel.hpp"}},
};

std::string folder_of(const std::string& room) { return room == "geometry" ? room : "lib/" + room; }

// The parts of a path between slashes.
std::vector<std::string> parts(const std::string& path) {
  std::vector<std::string> result;
  std::istringstream stream(path);
  for (std::string part; std::getline(stream, part, '/');) result.push_back(part);
  return result;
}

// The room of a header of this project; empty if it is another one's.
std::string room_of(const std::string& include) {
  const std::vector<std::string> path = parts(include);
  if (path.size() > 2 && path[0] == "lib") return path[1];
  return path.size() > 1 && path[0] == "geometry" ? "geometry" : "";
}

TEST_CASE("each room includes only what it may", "[architecture]") {
  for (const auto& [room, allowed] : kMayInclude) {
    for (const Include& include : includes(folder_of(room))) {
      INFO(include.file << " includes " << include.what);
      const std::string other = room_of(include.what);
      CHECK((other.empty() || other == room || allowed.count(other)));
    }
  }
  for (const auto& entry : fs::directory_iterator(fs::path(apothem::test::kSource) / "lib")) {
    INFO(entry.path());
    if (entry.is_directory()) CHECK(kMayInclude.count(entry.path().filename().string()));
  }
}

TEST_CASE("each room within geometry includes only what it may", "[architecture]") {
  for (const auto& [room, allowed] : kGeometryMayInclude) {
    for (const Include& include : includes("geometry/" + room)) {
      if (room_of(include.what) != "geometry") continue;
      const std::string other = parts(include.what)[1];
      INFO(include.file << " includes " << include.what);
      CHECK((other == room || allowed.count(other)));
    }
  }
  for (const auto& entry : fs::directory_iterator(fs::path(apothem::test::kSource) / "geometry")) {
    INFO(entry.path());
    if (entry.is_directory()) CHECK(kGeometryMayInclude.count(entry.path().filename().string()));
  }
}

TEST_CASE("each room within contact includes only what it may", "[architecture]") {
  const auto check = [](const std::string& room, const std::set<std::string>& allowed,
                        const Include& include) {
    if (room_of(include.what) != "contact") return;
    INFO(include.file << " includes " << include.what);
    const std::string other = parts(include.what)[2];
    CHECK((other == room || allowed.count(other)));
  };
  for (const auto& [room, allowed] : kContactMayInclude) {
    for (const Include& include : includes("lib/contact/" + room)) check(room, allowed, include);
  }
  for (const Include& include : includes("lib/contact")) {
    if (include.file.ends_with("lib/contact/kernel.hpp")) check("", {"law", "surface"}, include);
  }
  for (const auto& entry :
       fs::directory_iterator(fs::path(apothem::test::kSource) / "lib/contact")) {
    INFO(entry.path());
    if (entry.is_directory()) CHECK(kContactMayInclude.count(entry.path().filename().string()));
  }
}

TEST_CASE("public headers include only public headers", "[architecture]") {
  std::ifstream list(fs::path(apothem::test::kSource) / "cmake/public_headers.cmake");
  std::set<std::string> headers;
  const std::regex pattern(R"(^\s+([a-z0-9_/]+\.hpp)\)?$)");
  std::smatch match;
  for (std::string line; std::getline(list, line);) {
    if (std::regex_match(line, match, pattern)) headers.insert(match[1]);
  }
  REQUIRE(headers.size() > 40);
  std::map<std::string, std::vector<std::string>> by_file;
  for (const char* folder : {"geometry", "lib"}) {
    for (const Include& include : includes(folder)) by_file[include.file].push_back(include.what);
  }
  for (const std::string& header : headers) {
    const fs::path file = fs::path(apothem::test::kSource) /
                          (header.starts_with("geometry/") ? header : "lib/" + header);
    INFO(header);
    REQUIRE(fs::exists(file));
    for (const std::string& what : by_file[file.string()]) {
      INFO("includes " << what);
      if (!room_of(what).empty()) {
        CHECK(headers.count(what.starts_with("lib/") ? what.substr(4) : what));
      } else if (what.find('/') != std::string::npos) {
        CHECK(what == "Eigen/Core");  // what the package config finds for every component
      }
    }
  }
}

TEST_CASE("threads and instruction sets are a matter of lib/execution", "[architecture]") {
  for (const char* folder : {"geometry", "lib"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(apothem::test::kSource) / folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
      if (entry.path().parent_path().filename() == "execution") continue;
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) {
        INFO(entry.path() << ": " << line);
        CHECK(line.find("#pragma omp") == std::string::npos);
        CHECK(line.find("gnu::target") == std::string::npos);
      }
    }
  }
}

TEST_CASE("each library has its only places", "[architecture]") {
  struct Rule {
    const char* library;
    std::set<std::string> places;
    bool sources_only;
  };
  const Rule rules[]{
      {"CGAL/", {"geometry"}, true},
      {"vtk", {"lib/output"}, true},
      {"cairo", {"lib/output"}, true},
      {"Spectra/", {"lib/solver"}, true},
      {"nlohmann/", {"lib/scene", "lib/player", "lib/run", "lib/sweep", "apps"}, true},
      {"zlib", {"lib/player", "lib/output"}, true},
      {"CLI/", {"apps"}, true},
      {"gdal", {"lib/scene"}, true},
      {"ogr", {"lib/scene"}, true},
      {"cpl_", {"lib/scene"}, true},
      {"boost/math", {"lib/sweep"}, true},
      {"pybind11/", {"apps/python"}, true},
      // In apps as a peer to measure against, never to rely on.
      {"boost/geometry", {"lib/scene", "apps/peers"}, true},
  };
  for (const char* folder : {"geometry", "lib", "apps"}) {
    for (const Include& include : includes(folder)) {
      for (const Rule& rule : rules) {
        if (!include.what.starts_with(rule.library)) continue;
        const fs::path relative = fs::relative(include.file, apothem::test::kSource);
        const std::string place = relative.parent_path().string();
        INFO(relative << " includes " << include.what);
        CHECK(std::any_of(rule.places.begin(), rule.places.end(), [&](const std::string& p) {
          return place == p || place.starts_with(p + "/");
        }));
        // A header that others include would spread the library; exact_overlap.hpp is private to
        // CGAL's files, vtk_grid.hpp to the writers of VTK files, json_archive.hpp to checkpoints,
        // gdal.hpp to the readers of drawings, bindings.hpp to the Python module.
        if (rule.sources_only)
          CHECK((relative.extension() == ".cpp" || relative.filename() == "exact_overlap.hpp" ||
                 relative.filename() == "vtk_grid.hpp" ||
                 relative.filename() == "json_archive.hpp" || relative.filename() == "gdal.hpp" ||
                 relative.filename() == "bindings.hpp"));
      }
    }
  }
}

TEST_CASE("the user guide shows the example that is built and run", "[architecture]") {
  const auto text = [](const char* file) {
    std::ifstream stream(fs::path(apothem::test::kSource) / file);
    std::ostringstream content;
    content << stream.rdbuf();
    return content.str();
  };
  CHECK(text("docs/how-to/own-force.md").find(text("tests/package/wind.cpp")) != std::string::npos);
}

// CMake cuts such a name off, and what is left selects no test, which passes.
TEST_CASE("no test has a semicolon in its name", "[architecture]") {
  const std::regex pattern(R"re(TEST_CASE\(\s*"[^"]*;)re");
  for (const auto& entry :
       fs::recursive_directory_iterator(fs::path(apothem::test::kSource) / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    std::ifstream stream(entry.path());
    std::stringstream text;
    text << stream.rdbuf();
    INFO(entry.path().string());
    CHECK_FALSE(std::regex_search(text.str(), pattern));
  }
}
