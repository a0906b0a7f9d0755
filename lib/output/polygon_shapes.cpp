#include "lib/output/polygon_shapes.hpp"

#include <map>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "geometry/skeleton/node_places.hpp"
#include "lib/output/canvas.hpp"

namespace apothem {
namespace {

Rings in_world(const Polygon& polygon, Rings rings) {
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v += polygon.origin();
  }
  return rings;
}

}  // namespace

std::vector<Shape> skeleton_shapes(const Polygon& polygon, const Skeleton& skeleton) {
  const NodePlaces places(polygon, skeleton.nodes);
  std::vector<Shape> shapes;
  for (const Skeleton::Arc& arc : skeleton.arcs) {
    if (arc.left < 0 || arc.right < 0) continue;
    const Vec2 start = places[arc.start], end = places[arc.end];
    if (start == end) continue;  // where more than three faces meet
    shapes.push_back({Shape::Kind::line,
                      {{start, end}},
                      {{"left_edge", polygon.input_edge(arc.left)},
                       {"right_edge", polygon.input_edge(arc.right)},
                       {"start_height", skeleton.nodes[arc.start].height},
                       {"end_height", skeleton.nodes[arc.end].height}}});
  }
  return shapes;
}

std::vector<Shape> face_shapes(const Polygon& polygon, const Skeleton& skeleton) {
  const NodePlaces places(polygon, skeleton.nodes);
  std::map<int, Shape> faces;  // in the order of the edges as they were given
  for (int e = 0; e < polygon.size(); ++e) {
    std::vector<Vec2> ring;
    for (const int node : skeleton.faces[e]) {
      const Vec2 p = places[node];
      if (ring.empty() || ring.back() != p) ring.push_back(p);
    }
    const int edge = polygon.input_edge(e);
    faces[edge] = {Shape::Kind::polygon, {std::move(ring)}, {{"edge", edge}}};
  }
  std::vector<Shape> shapes;
  for (auto& [edge, face] : faces) shapes.push_back(std::move(face));
  return shapes;
}

std::vector<Shape> offset_shapes(const Polygon& polygon, const Skeleton& skeleton, double depth) {
  std::vector<Shape> shapes;
  for (const PolygonWithHoles& part : singular_area(skeleton, depth).polygons) {
    shapes.push_back({Shape::Kind::polygon, in_world(polygon, rings_of(part)), {{"depth", depth}}});
  }
  return shapes;
}

std::vector<Shape> singular_shapes(const Polygon& polygon, const SingularArea& singular) {
  const PlaceGrid grid(polygon);
  std::vector<Shape> shapes;
  for (const PolygonWithHoles& part : singular.polygons) {
    shapes.push_back({Shape::Kind::polygon, in_world(polygon, rings_of(part))});
  }
  for (const std::array<Vec2, 2>& ends : singular.segments) {
    shapes.push_back({Shape::Kind::line, {{grid.world(ends[0]), grid.world(ends[1])}}});
  }
  for (const Vec2& point : singular.points) {
    shapes.push_back({Shape::Kind::point, {{grid.world(point)}}});
  }
  return shapes;
}

std::vector<Shape> circle_shapes(const Polygon& polygon, const InscribedCircle& circle) {
  const PlaceGrid grid(polygon);
  std::vector<Shape> shapes;
  for (const Vec2& local : circle.centres) {
    const Vec2 centre = grid.world(local);
    shapes.push_back(
        {Shape::Kind::polygon,
         {circle_ring(centre, circle.radius)},
         {{"radius", circle.radius}, {"centre_x", centre.x()}, {"centre_y", centre.y()}}});
  }
  return shapes;
}

}  // namespace apothem
