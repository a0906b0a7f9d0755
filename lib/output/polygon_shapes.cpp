#include "lib/output/polygon_shapes.hpp"

#include <map>

#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "lib/output/canvas.hpp"

namespace apothem {
namespace {

std::vector<Vec2> in_world(const Polygon& polygon, std::vector<Vec2> points) {
  for (Vec2& p : points) p += polygon.origin();
  return points;
}
Rings in_world(const Polygon& polygon, Rings rings) {
  for (std::vector<Vec2>& ring : rings) ring = in_world(polygon, std::move(ring));
  return rings;
}

}  // namespace

std::vector<Shape> skeleton_shapes(const Polygon& polygon, const Skeleton& skeleton) {
  std::vector<Shape> shapes;
  for (const Skeleton::Arc& arc : skeleton.arcs) {
    if (arc.left < 0 || arc.right < 0) continue;
    const Vec2 start = world_point(polygon, skeleton.nodes, arc.start);
    const Vec2 end = world_point(polygon, skeleton.nodes, arc.end);
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
  std::map<int, Shape> faces;  // in the order of the edges as they were given
  for (int e = 0; e < polygon.size(); ++e) {
    std::vector<Vec2> ring;
    for (const int node : skeleton.faces[e]) {
      const Vec2 p = world_point(polygon, skeleton.nodes, node);
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
  std::vector<Shape> shapes;
  for (const PolygonWithHoles& part : singular.polygons) {
    shapes.push_back({Shape::Kind::polygon, in_world(polygon, rings_of(part))});
  }
  for (const std::array<Vec2, 2>& ends : singular.segments) {
    shapes.push_back({Shape::Kind::line, {in_world(polygon, {ends[0], ends[1]})}});
  }
  for (const Vec2& point : singular.points) {
    shapes.push_back({Shape::Kind::point, {in_world(polygon, {point})}});
  }
  return shapes;
}

std::vector<Shape> circle_shapes(const Polygon& polygon, const InscribedCircle& circle) {
  std::vector<Shape> shapes;
  for (const Vec2& centre : in_world(polygon, circle.centres)) {
    shapes.push_back(
        {Shape::Kind::polygon,
         {circle_ring(centre, circle.radius)},
         {{"radius", circle.radius}, {"centre_x", centre.x()}, {"centre_y", centre.y()}}});
  }
  return shapes;
}

}  // namespace apothem
