// Meshes in gmsh's text format (C. Geuzaine, J.-F. Remacle, Int. J. Numer. Meth. Eng. 79 (2009);
// versions 4.1 and 2.2 as in the gmsh reference manual, "MSH file format").
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/check.hpp"
#include "mesh/mesh.hpp"

namespace apothem {

/// What is wrong with the text, and in which line (from 1; 0 if in none).
class BadMeshText : public std::invalid_argument {
 public:
  BadMeshText(const std::string& reason, int line) : std::invalid_argument(reason), line_(line) {}
  [[nodiscard]] int line() const { return line_; }

 private:
  int line_;
};

/// The mesh of a .msh text: triangles and quadrilaterals of first order in the plane z = 0, in the
/// order of the file; clockwise ones are turned over. Physical groups of surfaces, curves and
/// points become groups (named surface-TAG, curve-TAG, point-TAG if they have no name); other lines
/// and points are left out, and so are nodes that only belong to geometry points, like the centre
/// of an arc. Throws BadMeshText, which names the tag, also for a mesh that check_mesh refuses.
Mesh parse_gmsh(std::string_view text, const MeshRules& rules = {});

}  // namespace apothem
