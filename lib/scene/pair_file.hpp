// Reads files of pairs of polygons, with or without the contact forces that are expected.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// The expected contact of a pair, by the distance potential with the reference `roof` and a unit
/// stiffness. Moments are about the centroids.
struct ExpectedContact {
  Vec2 force;           ///< on a, m
  double moment_a;      ///< m^2
  double moment_b;      ///< m^2
  double weight;        ///< W, m
  double energy;        ///< m^2
  double overlap_area;  ///< m^2
  double own_length;    ///< lengths of both boundaries inside the other polygon, summed, m
  double tolerance;     ///< of the force, as a share of own_length
};

/// A pair as it stands in the file. Whether its rings are simple polygons is not checked yet.
struct PolygonPair {
  std::string name;
  std::string kind;  ///< empty if the file does not give it
  std::vector<Vec2> a, b;
  std::optional<ExpectedContact> expected;
};

/// The error for a line that is not a pair. It says what is wrong, in which polygon ("a" or "b", or
/// "" for what stands behind both) and at which vertex.
class BadPairLine : public std::invalid_argument {
 public:
  BadPairLine(const std::string& reason, std::string polygon, int vertex)
      : std::invalid_argument(reason), polygon_(std::move(polygon)), vertex_(vertex) {}
  [[nodiscard]] const std::string& polygon() const { return polygon_; }
  [[nodiscard]] int vertex() const { return vertex_; }

 private:
  std::string polygon_;
  int vertex_;
};

/// What a line of a pair must hold.
inline constexpr const char* kPairForm = "name n x y ... m x y ...";

/// Reads the line "name n x y ... m x y ...", where n and m are the numbers of vertices. Throws
/// BadPairLine.
PolygonPair parse_pair(const std::string& line);

/// Reads a file with one pair per line, or with JSON as in data/polygons/hard-pairs.json. Throws
/// SceneError.
std::vector<PolygonPair> read_pair_file(const std::string& file);

}  // namespace apothem
