// Expands the fills of a scene into bodies: draws shapes, sizes and angles, and arranges the blocks
// so that nothing overlaps.
#pragma once

#include <vector>

#include "geometry/packing/arrange.hpp"
#include "geometry/polygon/polygon.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

/// The bodies of one fill, batch after batch: bodies with meshes, or rigid ones.
struct Filled {
  std::vector<JsonValue> bodies;  ///< with meshes: as they would stand in the scene
  JsonValue alike;                ///< rigid: what all of them have in common
  std::vector<Polygon> polygons;  ///< rigid: their polygons
  int count = 0;                  ///< number of bodies
  int batch = 0;                  ///< number of bodies in a batch
  int batches = 1;                ///< the first is there from the start
  double every = 0;               ///< s, least time between two batches
};

/// Reads the scene's list of fills, each of which stays clear of those before it and of the
/// `obstacles`: the bodies that the scene has already (m). Blocks may lie in holes of these, but
/// not in those of other blocks. Throws SceneError.
std::vector<Filled> read_fills(const JsonReader& in, const JsonValue& list,
                               std::vector<PolygonWithHoles> obstacles);

}  // namespace apothem
