// Rings that nobody here wrote, read in place: `rings.txt` (`name n x y ...` per line) of the
// folder that the environment variable APOTHEM_POLYGONS names.
#pragma once

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "lib/scene/ring_line.hpp"

namespace apothem::test {

struct PublicRing {
  std::string name;
  std::string line;
  std::vector<Vec2> ring;
};

/// Those of at most so many vertices; none, with a warning, if there is no such folder.
inline std::vector<PublicRing> public_rings(size_t most) {
  std::vector<PublicRing> rings;
  const char* folder = std::getenv("APOTHEM_POLYGONS");
  if (folder == nullptr) {
    WARN("skipped: the environment variable APOTHEM_POLYGONS names no folder with rings.txt");
    return rings;
  }
  std::ifstream file(std::string(folder) + "/rings.txt");
  REQUIRE(file);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    std::vector<Vec2> ring = read_ring(words);
    if (ring.size() <= most) rings.push_back({name, line, std::move(ring)});
  }
  REQUIRE(!rings.empty());
  return rings;
}

}  // namespace apothem::test
