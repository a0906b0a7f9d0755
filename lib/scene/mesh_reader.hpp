// The mesh of a body as a scene gives it.
#pragma once

#include "apothem/fem/element.hpp"
#include "apothem/mesh/mesh.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

struct MeshSpec {
  Mesh mesh;
  ElementKind element;
};

/// Reads one of
///   { "rectangle": { "size": [x, y], "cells": [nx, ny], "origin": [x, y] } }
///   { "disc": { "radius": r, "centre": [x, y], "cells": n, "grading": g } }
///   { "fill": { "polygon": [[x,y],...], "holes": [[[x,y],...],...], "size": h } }
///   { "voronoi": { "polygon": [[x,y],...], "cells": n, "seed": i, "lloyd": i, "shortest_edge": s }
///   } { "file": "NAME.msh" }
/// each with "element": a name of kElements. In place of a polygon's ring there may be the name of
/// a file or the key "file"; "voronoi" also takes the "size" and "origin" of a rectangle. Without
/// an "element", rectangles, discs and polygons are filled with quadrilaterals, and the element is
/// T3 or Q4 if it fits, otherwise polygon. The mesh passes check_mesh. Throws SceneError.
MeshSpec read_mesh(const JsonReader& in, const JsonValue& value);

}  // namespace apothem
