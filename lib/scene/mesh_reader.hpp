// Reads the mesh of a body.
#pragma once

#include "lib/fem/kinds.hpp"
#include "lib/mesh/mesh.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

struct MeshSpec {
  Mesh mesh;
  ElementKind element;
};

/// Reads a mesh: one of the keys rectangle, disc, half_disc, fill, voronoi and file
/// (docs/scene-format.md), with or without an "element" and a "mirror". Without an "element",
/// regions are filled with quadrilaterals, and the element is T3 or Q4 if it fits all of the mesh,
/// and polygon otherwise. The mesh passes check_mesh(). Throws SceneError.
MeshSpec read_mesh(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
