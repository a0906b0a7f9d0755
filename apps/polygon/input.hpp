// Private header of the sub-commands about polygons: what several of them read and write.
#pragma once

#include <string>
#include <vector>

#include "apps/commands.hpp"
#include "geometry/potential/potential.hpp"
#include "lib/output/shape_file.hpp"

namespace apothem {

/// Sets the reference length from the argument of --reference: roof, inscribed_circle or a length
/// in m. Throws UsageError for anything else.
void set_reference(PotentialChoice& choice, const std::string& text);

/// The format of a file of shapes that is the argument of -o. Throws UsageError if its extension is
/// of no such format.
ShapeFormat shape_format_of(const std::string& file);

/// `apothem polygon --at` and `--points`.
int evaluate_points(const PolygonOptions& options, const PotentialChoice& choice);

/// `apothem polygon --repair`.
int repair_outlines(const PolygonOptions& options);

/// Rings of holes as the text of JSON: [[[x,y],...], ...].
std::string holes_json(const std::vector<std::vector<Vec2>>& holes);

/// Polygons with holes as the text of JSON: [{"polygon": [[x,y],...], "holes": [...]}, ...].
std::string polygons_json(const std::vector<PolygonWithHoles>& polygons);

/// The shapes of polygons, in their order.
std::vector<Shape> shapes_of(const std::vector<PolygonWithHoles>& polygons);

}  // namespace apothem
