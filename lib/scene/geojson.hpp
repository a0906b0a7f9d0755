// Polygons in GeoJSON (RFC 7946), as geographical programs write it.
#pragma once

#include "lib/scene/json.hpp"
#include "lib/scene/ring_text.hpp"

namespace apothem {

/// The rings of an object of type Polygon, or of one that holds a single polygon: a Feature, a
/// FeatureCollection, a GeometryCollection or a MultiPolygon. Properties and coordinate systems are
/// not used. Throws SceneError for anything else: further polygons, empty ones.
PolygonText polygon_of_geojson(const JsonReader& in, const JsonValue& object);

/// A ring [[x, y], ...] with the lines of its vertices. Throws SceneError.
RingText ring_text(const JsonReader& in, const JsonValue& ring);

/// A polygon whose rings are these values; `holes`, an array of them, may be null. Throws
/// SceneError.
PolygonText polygon_text(const JsonReader& in, const JsonValue& outer, const JsonValue* holes);

}  // namespace apothem
