// Reads files of pairs of polygons, with or without the contact forces that are expected.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/polygon_with_holes.hpp"

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
  PolygonWithHoles a, b;
  std::optional<ExpectedContact> expected;
};

/// The error for a line that is not a pair. It says what is wrong, in which polygon ("a" or "b", or
/// "" for what stands behind both), in which of its holes, and at which vertex.
class BadPairLine : public InvalidPolygon {
 public:
  BadPairLine(const InvalidPolygon& error, std::string polygon)
      : InvalidPolygon(error), polygon_(std::move(polygon)) {}
  [[nodiscard]] const std::string& polygon() const { return polygon_; }

 private:
  std::string polygon_;
};

/// What a line of a pair must hold.
inline constexpr const char* kPairForm =
    "name n x y ... m x y ..., or POLYGON ((x y, ...), ...) for either";

/// Reads a line as kPairForm describes it, where n and m are the numbers of vertices, see
/// read_line_polygon(). Throws BadPairLine.
PolygonPair parse_pair(const std::string& line);

/// Reads a file with one pair per line, or with JSON as in data/polygons/hard-pairs.json, where a
/// polygon is [[x,y],...] or {"polygon": [[x,y],...], "holes": [[[x,y],...],...]}. Throws
/// SceneError.
std::vector<PolygonPair> read_pair_file(const std::string& file);

}  // namespace apothem
