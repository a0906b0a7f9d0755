// The text of a .msh file as lists, without any judgement of its geometry. This header is private
// to gmsh.cpp.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem {

/// What a .msh text of version 2.2 or 4.1 says, in the order of the file.
struct GmshFile {
  /// Gmsh's number of a node, element or entity.
  using Tag = long long;
  /// Dimension and tag of an entity or a physical group.
  using Key = std::pair<int, Tag>;

  struct Node {
    Tag tag;
    Vec2 place;     ///< m
    double z;       ///< m
    int line;       ///< where it stands, counted from 1
    bool at_point;  ///< its entity is a point of the geometry (version 4.1)
  };

  /// An element of the file, of any dimension.
  struct Part {
    Tag tag;
    int line;                  ///< where it stands, counted from 1
    int dimension;             ///< 0 to 2
    std::array<int, 4> nodes;  ///< indices into `nodes`, -1 behind the last one
    int size;                  ///< number of nodes
  };

  std::vector<Node> nodes;                  ///< at least one
  std::vector<Part> parts;                  ///< points, lines, triangles and quadrilaterals
  std::map<Key, std::string> names;         ///< of physical groups; not every group has one
  std::map<Key, std::vector<int>> members;  ///< indices of the parts in each physical group
};

/// Reads a .msh text. Throws BadMeshText for a malformed text, another version, and elements of
/// other types.
GmshFile read_gmsh_file(std::string_view text);

/// What messages call a node, element or line.
std::string gmsh_name(const char* kind, GmshFile::Tag tag);

}  // namespace apothem
