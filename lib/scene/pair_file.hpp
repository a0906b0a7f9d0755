// Files of pairs of polygons, with or without the forces they should give.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apothem/geometry/polygon/point.hpp"

namespace apothem {

/// What the contact of a pair should be: distance potential, reference `roof`, unit stiffness;
/// moments about the centroids. `tolerance` is for the force, as a share of own_length.
struct ExpectedContact {
  Vec2 force;           ///< on a, m
  double moment_a;      ///< m^2
  double moment_b;      ///< m^2
  double weight;        ///< W, m
  double energy;        ///< m^2
  double overlap_area;  ///< m^2
  double own_length;    ///< boundary of either polygon inside the other, m
  double tolerance;
};

/// Rings as they stand in the file; not yet checked for being simple.
struct PolygonPair {
  std::string name;
  std::string kind;  ///< empty if the file does not say
  std::vector<Vec2> a, b;
  std::optional<ExpectedContact> expected;
};

/// A line that is not a pair: what is wrong, in which polygon ("a", "b", or "" behind both) and at
/// which vertex.
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

/// First word of a line; empty for a blank line.
std::string pair_name(const std::string& line);

/// "name n x y ... m x y ...". Throws BadPairLine.
PolygonPair parse_pair(const std::string& line);

/// Either one pair per line, or JSON as in data/polygons/hard-pairs.json. Throws SceneError.
std::vector<PolygonPair> read_pair_file(const std::string& file);

}  // namespace apothem
