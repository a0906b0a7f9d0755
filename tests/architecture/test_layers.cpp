// Who may include whom, and which library may appear where: the rooms of the house stay separate.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>

#include "support.hpp"

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

TEST_CASE("each layer includes only what it may", "[architecture]") {
  const std::map<std::string, std::set<std::string>> may{
      {"geometry", {"geometry"}},
      {"lib/mesh", {"geometry", "mesh"}},
      {"lib/contact", {"geometry", "mesh", "contact"}},
      {"lib/model", {"geometry", "mesh", "contact", "model"}},
      {"lib/dynamics", {"geometry", "mesh", "contact", "model", "dynamics"}},
      {"lib/scene", {"geometry", "mesh", "contact", "model", "scene"}},
      {"lib/output", {"geometry", "mesh", "model", "output"}},
  };
  std::set<std::string> rooms{"apps"};
  for (const auto& [layer, allowed] : may) rooms.insert(fs::path(layer).filename().string());
  for (const auto& [layer, allowed] : may) {
    for (const Include& include : includes(layer)) {
      const std::string room = include.what.substr(0, include.what.find('/'));
      INFO(include.file << " includes " << include.what);
      if (include.what.find('/') != std::string::npos && rooms.count(room))
        CHECK(allowed.count(room));
    }
  }
  for (const auto& entry : fs::directory_iterator(fs::path(apothem::test::kSource) / "lib")) {
    INFO(entry.path());
    if (entry.is_directory()) CHECK(may.count("lib/" + entry.path().filename().string()));
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
      {"nlohmann/", {"lib/scene", "apps"}, true},
      {"CLI/", {"apps"}, true},
      // In apps as a peer to measure against, never to rely on.
      {"boost/geometry", {"lib/scene", "apps"}, true},
  };
  for (const char* folder : {"geometry", "lib", "apps"}) {
    for (const Include& include : includes(folder)) {
      for (const Rule& rule : rules) {
        if (!include.what.starts_with(rule.library)) continue;
        const fs::path relative = fs::relative(include.file, apothem::test::kSource);
        const std::string place = relative.parent_path().string();
        INFO(relative << " includes " << include.what);
        CHECK(rule.places.count(place));
        // A header that others include would spread the library; exact_overlap.hpp is private to
        // CGAL's files, vtk_grid.hpp to the writers of VTK files.
        if (rule.sources_only)
          CHECK((relative.extension() == ".cpp" || relative.filename() == "exact_overlap.hpp" ||
                 relative.filename() == "vtk_grid.hpp"));
      }
    }
  }
}
