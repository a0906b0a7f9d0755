// Reads meshes in gmsh's text format (C. Geuzaine, J.-F. Remacle, Int. J. Numer. Meth. Eng. 79
// (2009); versions 4.1 and 2.2, see "MSH file format" in the gmsh reference manual).
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "lib/mesh/check.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

/// Thrown for a .msh text that cannot be used: what is wrong, and in which line (counted from 1; 0
/// if in no particular line).
class BadMeshText : public std::invalid_argument {
 public:
  BadMeshText(const std::string& reason, int line) : std::invalid_argument(reason), line_(line) {}
  [[nodiscard]] int line() const { return line_; }

 private:
  int line_;
};

/// The mesh of a .msh text: triangles and quadrilaterals of first order in the plane z = 0, with
/// coordinates in m, in the order of the file. Clockwise elements are reversed. Physical groups of
/// surfaces, curves and points become groups (without a name: surface-TAG, curve-TAG, point-TAG);
/// those of surfaces name their elements.
/// Other lines and points are left out, and so are nodes that belong to geometry points only, like
/// the centre of an arc. Throws BadMeshText, which names gmsh's tag, for a malformed text and for a
/// mesh that check_mesh refuses.
Mesh parse_gmsh(std::string_view text, const MeshRules& rules = {});

}  // namespace apothem
