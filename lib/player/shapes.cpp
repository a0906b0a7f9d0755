#include "lib/player/shapes.hpp"

#include <algorithm>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/ring_moments.hpp"
#include "lib/mesh/edges.hpp"
#include "lib/model/rotation.hpp"
#include "lib/output/convex_cells.hpp"

namespace apothem {
namespace {

// Convex parts of a polygon as fans of triangles.
std::vector<std::array<int, 3>> triangles_of(const Rings& rings) {
  std::vector<std::array<int, 3>> triangles;
  for (const std::vector<int>& cell : convex_cells(rings)) {
    for (size_t i = 1; i + 1 < cell.size(); ++i) {
      triangles.push_back({cell[0], cell[i], cell[i + 1]});
    }
  }
  return triangles;
}

void add_rigid(const Frame& frame, int element, Shapes::Body& body) {
  const Rings rings = rings_of(frame, element);
  const RingMeasure whole = measure(rings);
  body.area = whole.area;
  body.triangles = triangles_of(rings);
  for (const std::vector<Vec2>& ring : rings) {
    if (!body.ring.empty()) body.holes.push_back(static_cast<int>(body.ring.size()));
    for (const Vec2& v : ring) {
      const Vec2 p = turned(Vec2(v - whole.centroid), -frame.body_of(element).rotation());
      body.radius = std::max(body.radius, p.norm());
      body.ring.push_back(p);
    }
  }
}

void add_meshed(const Frame& frame, int b, const FramePart& part, Shapes& shapes) {
  Shapes::Body& body = shapes.bodies[b];
  body.first_node = shapes.nodes;
  body.first_element = static_cast<int>(shapes.elements.size());
  Mesh mesh;  // of this body alone, for its edges
  Vec2 moment = Vec2::Zero();
  for (int e = part.element; e < part.element + part.elements; ++e) {
    const RingMeasure of_element = measure(rings_of(frame, e));
    body.area += of_element.area;
    moment += of_element.area * of_element.centroid;
    std::vector<int> nodes;
    std::vector<Vec2> ring;
    for (const int node : frame.mesh.element(e)) {
      nodes.push_back(node - part.node);
      ring.push_back(frame.mesh.nodes[node]);
      shapes.nodes = std::max(shapes.nodes, body.first_node + nodes.back() + 1);
    }
    mesh.add_element(nodes);
    Shapes::Element& added = shapes.elements.emplace_back();
    added.body = b;
    added.material = frame.material[e];
    added.triangles = triangles_of({ring});
    for (int& node : nodes) node += body.first_node;
    for (auto& triangle : added.triangles) {
      for (int& corner : triangle) corner = nodes[corner];
    }
    added.nodes = std::move(nodes);
  }
  const Vec2 centroid = moment / body.area;
  for (int n = 0; n < shapes.nodes - body.first_node; ++n) {
    body.radius = std::max(body.radius, (frame.position[part.node + n] - centroid).norm());
  }
  mesh.nodes.resize(static_cast<size_t>(shapes.nodes - body.first_node));
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    (edge.on_boundary() ? shapes.boundary : shapes.inner)
        .push_back({b, {body.first_node + edge.nodes[0], body.first_node + edge.nodes[1]}});
  }
}

}  // namespace

Rings rings_of(const Frame& frame, int element) {
  return rings_of(frame.position, frame.mesh.element(element), frame.holes, element);
}

RingMeasure measure(const Rings& rings) {
  const Vec2& base = rings[0][0];
  RingMoments m = ring_moments(rings[0], base);
  for (size_t k = 1; k < rings.size(); ++k) {
    const RingMoments hole = ring_moments(rings[k], base);
    m.area += hole.area;
    m.first += hole.first;
  }
  return {base + (m.area != 0 ? Vec2(m.first / m.area) : Vec2(0, 0)), m.area};
}

std::vector<FramePart> parts_of(const Frame& frame) {
  std::vector<FramePart> parts(frame.bodies.size());
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    FramePart& part = parts[static_cast<size_t>(frame.body[e])];
    if (part.element < 0) part.element = e;
    ++part.elements;
    for (const int node : frame.mesh.element(e)) {
      if (part.node < 0 || node < part.node) part.node = node;
    }
  }
  return parts;
}

Shapes read_shapes(const RunFolder& run) {
  Shapes shapes;
  size_t known = 0;
  for (size_t k = 0; k < run.times().size(); ++k) {
    const Frame frame = run.frame(k);
    shapes.bodies.resize(frame.bodies.size());
    const std::vector<FramePart> parts = parts_of(frame);
    for (size_t b = 0; b < parts.size(); ++b) {
      Shapes::Body& body = shapes.bodies[b];
      if (body.known || parts[b].element < 0) continue;
      body.known = true;
      body.meshed = frame.bodies[b].meshed;
      body.material = frame.material[parts[b].element];
      if (body.meshed) {
        add_meshed(frame, static_cast<int>(b), parts[b], shapes);
      } else {
        add_rigid(frame, parts[b].element, body);
      }
      ++known;
    }
    if (known == shapes.bodies.size()) break;
  }
  return shapes;
}

}  // namespace apothem
