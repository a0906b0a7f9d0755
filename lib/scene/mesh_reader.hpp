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

/// Reads one of these:
///   { "rectangle": { "size": [x, y], "cells": [nx, ny], "origin": [x, y] } }
///   { "disc": { "radius": r, "centre": [x, y], "cells": n, "grading": g } }
///   { "fill": { "polygon": [[x,y],...], "holes": [[[x,y],...],...], "size": h } }
///   { "half_disc": { "radius": r, "pole": [x, y], "fine": l, "cells": n, "growth": g } }
///   { "voronoi": { "polygon": [[x,y],...], "cells": n, "seed": i, "lloyd": i,
///                  "shortest_edge": s } }
///   { "file": "NAME.msh" }
/// Each may have an "element", a name of kElements, and a "mirror". A polygon may also be the name
/// of a file, or stand in the file of the key "file". "voronoi" also takes the "size" and "origin"
/// of a rectangle. Without an "element", regions are filled with quadrilaterals, and the element is
/// T3 or Q4 if it fits all of the mesh, and polygon otherwise. The mesh passes check_mesh(). Throws
/// SceneError.
MeshSpec read_mesh(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
