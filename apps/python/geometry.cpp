// Geometry on its own: polygons, their potentials, contact, overlaps and Voronoi meshes.
#include <algorithm>
#include <cmath>

#include "apps/python/bindings.hpp"
#include "geometry/exact/overlap.hpp"
#include "geometry/exact/pair_methods.hpp"
#include "geometry/meshing/voronoi.hpp"
#include "geometry/polygon/place_grid.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/potential/point_values.hpp"
#include "geometry/regions/boolean.hpp"
#include "geometry/regions/repair.hpp"
#include "geometry/skeleton/node_places.hpp"
#include "geometry/skeleton/singular_area.hpp"

namespace apothem::python {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<Vec2> points_of(const Array& points) {
  if (points.ndim() != 2 || points.shape(1) != 2) {
    throw std::invalid_argument("points must have the shape (n, 2)");
  }
  const auto at = points.unchecked<2>();
  std::vector<Vec2> list;
  for (py::ssize_t i = 0; i < points.shape(0); ++i) list.emplace_back(at(i, 0), at(i, 1));
  return list;
}

Polygon polygon_of(const Array& points, const py::sequence& holes) {
  Rings rings;
  for (const py::handle hole : holes) rings.push_back(points_of(hole.cast<Array>()));
  return {points_of(points), rings};
}

py::tuple pair(const Vec2& v) { return py::make_tuple(v.x(), v.y()); }

py::list rings_of(const std::vector<std::vector<Vec2>>& rings, const Vec2& shift) {
  py::list list;
  for (const std::vector<Vec2>& ring : rings) list.append(array_of(ring, shift));
  return list;
}

Skeleton skeleton_of(const Polygon& polygon) {
  const py::gil_scoped_release release;
  return straight_skeleton(polygon, [](const Stage& /*stage*/) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  });
}

// Nodes of a skeleton and centres of circles in the coordinates of the vertices.
std::vector<Vec2> in_world(const Polygon& polygon, std::vector<Vec2> points) {
  const PlaceGrid grid(polygon);
  for (Vec2& p : points) p = grid.world(p);
  return points;
}

py::object inscribed_circle_of(const Polygon& polygon) {
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  return result("InscribedCircle", circle.radius, array_of(in_world(polygon, circle.centres)));
}

py::object roof_of(const Polygon& polygon) {
  const Skeleton skeleton = skeleton_of(polygon);
  const NodePlaces places(polygon, skeleton.nodes);
  py::array_t<double> nodes({static_cast<py::ssize_t>(skeleton.nodes.size()), py::ssize_t{3}});
  auto node = nodes.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < nodes.shape(0); ++i) {
    const Vec2 p = places[static_cast<int>(i)];
    node(i, 0) = p.x();
    node(i, 1) = p.y();
    node(i, 2) = skeleton.nodes[static_cast<size_t>(i)].height;
  }
  py::array_t<int> arcs({static_cast<py::ssize_t>(skeleton.arcs.size()), py::ssize_t{2}});
  auto arc = arcs.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < arcs.shape(0); ++i) {
    arc(i, 0) = skeleton.arcs[static_cast<size_t>(i)].start;
    arc(i, 1) = skeleton.arcs[static_cast<size_t>(i)].end;
  }
  return result("Roof", skeleton.roof_height, nodes, arcs, index_lists(skeleton.faces));
}

py::object singular_area_of(const Polygon& polygon, std::optional<double> depth) {
  const Skeleton skeleton = skeleton_of(polygon);
  const SingularArea area = singular_area(skeleton, depth.value_or(skeleton.roof_height));
  py::list segments;
  for (const std::array<Vec2, 2>& ends : area.segments) {
    segments.append(array_of(in_world(polygon, {ends[0], ends[1]})));
  }
  return result("SingularArea", kind_name(area.kind()), area.area(),
                array_of(in_world(polygon, area.points)), segments,
                rings_of(apothem::rings_of(area.polygons), polygon.origin()));
}

py::object skeleton_object(const Polygon& polygon) {
  const Skeleton skeleton = skeleton_of(polygon);
  const NodePlaces places(polygon, skeleton.nodes);
  py::list lines, edges;
  for (const Skeleton::Arc& arc : skeleton.arcs) {
    if (arc.left < 0 || arc.right < 0) continue;
    const Vec2 start = places[arc.start], end = places[arc.end];
    if (start == end) continue;  // where more than three faces meet
    lines.append(array_of({start, end}));
    edges.append(py::make_tuple(arc.left, arc.right));
  }
  return result("Skeleton", lines, edges);
}

py::list offset_of(const Polygon& polygon, double depth) {
  const SingularArea area = singular_area(skeleton_of(polygon), depth);
  py::list polygons;
  for (const PolygonWithHoles& part : area.polygons) {
    Rings rings = apothem::rings_of(part);
    for (std::vector<Vec2>& ring : rings) {
      for (Vec2& v : ring) v += polygon.origin();
    }
    polygons.append(Polygon(polygon_of_rings(rings)));
  }
  return polygons;
}

py::list polygons_with_holes(const std::vector<PolygonWithHoles>& polygons) {
  py::list list;
  for (const PolygonWithHoles& polygon : polygons) {
    list.append(result("PolygonWithHoles", array_of(polygon.outer),
                       rings_of(polygon.holes, Vec2(Vec2::Zero()))));
  }
  return list;
}

template <class Table>
auto& named(const Table& table, const std::string& name, const char* what) {
  std::string names;
  for (const auto& entry : table) {
    if (entry.name == name) return entry;
    names += (names.empty() ? "\"" : ", \"") + std::string(entry.name) + "\"";
  }
  throw std::invalid_argument(std::string(what) + " must be one of " + names);
}

PotentialChoice choice_of(const std::string& potential, const std::string& field,
                          const py::object& reference) {
  PotentialChoice choice;
  choice.kind = named(kPotentials, potential, "potential").kind;
  choice.field = named(kFields, field, "field").field;
  if (py::isinstance<py::str>(reference)) {
    choice.reference = named(kReferences, reference.cast<std::string>(), "reference").reference;
    return choice;
  }
  choice.reference = PotentialChoice::Reference::length;
  try {
    choice.length = reference.cast<double>();
  } catch (const py::cast_error&) {
    throw py::type_error("reference must be \"roof\", \"inscribed_circle\" or a length in m");
  }
  if (!(choice.length > 0 && std::isfinite(choice.length)))
    throw std::invalid_argument("reference must be a positive length in m");
  return choice;
}

py::object contact(const Polygon& a, const Polygon& b, const std::string& method, double stiffness,
                   const std::string& potential, const std::string& field,
                   const py::object& reference) {
  if (std::ranges::find(kPairMethods, method) == kPairMethods.end()) {
    throw std::invalid_argument("method must be one of \"edge\", \"overlap\", \"exact\"");
  }
  if (!(stiffness > 0 && std::isfinite(stiffness))) {
    throw std::invalid_argument("stiffness must be positive, in Pa");
  }
  const PotentialChoice choice = choice_of(potential, field, reference);
  const auto [p, deepest] = [&] {
    const py::gil_scoped_release release;
    const PosedPair posed(a, b);
    return std::pair(posed.contact(method, choice), posed.penetration());
  }();
  const double k = stiffness;
  return result("PairContact", method, pair(k * p.force), k * p.moment_a, k * p.moment_b,
                pair(p.loading_point), k * p.energy, p.overlap_area, p.own_length_a, p.own_length_b,
                k * p.weight, deepest, p.largest_phi);
}

// What a polygon and a potential of it are at points.
std::vector<PointValues> values_at(const Polygon& polygon, const Array& array,
                                   const std::string& potential, const std::string& field,
                                   const py::object& reference) {
  const PotentialChoice choice = choice_of(potential, field, reference);
  const std::vector<Vec2> points = points_of(array);
  const py::gil_scoped_release release;
  const Potential made = make_potential(polygon, choice);
  const PointEvaluator evaluate(polygon, made);
  std::vector<PointValues> values;
  values.reserve(points.size());
  for (const Vec2& point : points) values.push_back(evaluate(point));
  return values;
}

py::array_t<double> potential_at(const Polygon& polygon, const Array& points,
                                 const std::string& potential, const std::string& field,
                                 const py::object& reference) {
  std::vector<double> phi;
  for (const PointValues& v : values_at(polygon, points, potential, field, reference)) {
    phi.push_back(v.phi);
  }
  return py::array_t<double>(static_cast<py::ssize_t>(phi.size()), phi.data());
}

py::array_t<double> gradient_at(const Polygon& polygon, const Array& points,
                                const std::string& potential, const std::string& field,
                                const py::object& reference) {
  std::vector<Vec2> gradients;
  for (const PointValues& v : values_at(polygon, points, potential, field, reference)) {
    gradients.push_back(v.gradient);
  }
  return array_of(gradients);
}

py::array_t<bool> contains(const Polygon& polygon, const Array& array) {
  const std::vector<Vec2> points = points_of(array);
  py::array_t<bool> inside(static_cast<py::ssize_t>(points.size()));
  auto at = inside.mutable_unchecked<1>();
  for (size_t i = 0; i < points.size(); ++i) {
    at(static_cast<py::ssize_t>(i)) = side_of(polygon, points[i]) > 0;
  }
  return inside;
}

py::list boolean(const Polygon& a, const Polygon& b, const std::string& op) {
  const BooleanOperation operation = named(kBooleanOperations, op, "op").operation;
  return polygons_with_holes(boolean_operation(a, b, operation));
}

py::object repair_rings(const py::sequence& rings, double tolerance) {
  if (!(tolerance >= 0 && std::isfinite(tolerance))) {
    throw std::invalid_argument("tolerance must be 0 or more, in m");
  }
  Rings list;
  for (const py::handle ring : rings) list.push_back(points_of(ring.cast<Array>()));
  const Repaired repaired = repair(list, tolerance);
  py::list faults;
  for (const RingFault& fault : repaired.faults) faults.append(describe(fault));
  return result("Repaired", polygons_with_holes(repaired.polygons), faults,
                repaired.hausdorff_distance);
}

py::list overlap(const Polygon& a, const Polygon& b) {
  py::list list;
  for (const OverlapPolygon& part : overlap_polygons(a, b, a.origin())) {
    list.append(array_of(part.vertices, a.origin()));
    for (const OverlapRing& hole : part.holes) list.append(array_of(hole.vertices, a.origin()));
  }
  return list;
}

py::object voronoi(const Polygon& region, int n, std::uint64_t seed, int lloyd,
                   double shortest_edge, bool convex, double smallest_angle) {
  const auto [mesh, sites] = [&] {
    const py::gil_scoped_release release;
    const VoronoiMesh found =
        voronoi_mesh(region, {n, seed, lloyd, shortest_edge, convex, smallest_angle});
    return std::pair(in_world(region, found.mesh), found.sites);
  }();
  return result("VoronoiCells", array_of(mesh.points), index_lists(mesh.cells),
                array_of(sites, region.origin()));
}

void bind_values(py::class_<Polygon>& polygon) {
  polygon
      .def(
          "potential", &potential_at, py::arg("points"), py::arg("potential") = "distance",
          py::arg("field") = "roof", py::arg("reference") = "roof",
          "The contact potential phi at points (k, 2), m: array (k), zero outside. The options are "
          "those of contact().")
      .def("gradient", &gradient_at, py::arg("points"), py::arg("potential") = "distance",
           py::arg("field") = "roof", py::arg("reference") = "roof",
           "The gradient of the potential at points (k, 2), m: array (k, 2), 1/m. It is zero "
           "outside and where phi is limited to 1, and on the boundary that of the inside.");
}

void bind_polygon(py::module_& module) {
  py::class_<Polygon> polygon(module, "Polygon", R"(A polygon, with or without holes.

Polygon(points, holes=[])
    points: array (n, 2) of at least three vertices in either sense, m. Points that repeat the one
    before, or at the end the first one, are left out.
    holes: list of such arrays, which lie inside the outline and apart from each other.

Raises SceneError, with the numbers of the vertex and of the hole, if a ring crosses or touches itself
or another one, or has no area.)");
  polygon.def(py::init(&polygon_of), py::arg("points"), py::arg("holes") = py::list())
      .def_property_readonly(
          "points",
          [](const Polygon& p) {
            return array_of({p.outer_ring().begin(), p.outer_ring().end()});
          },
          "Copy (n, 2): vertices of the outer ring, counter-clockwise, m.")
      .def_property_readonly(
          "holes",
          [](const Polygon& p) {
            py::list holes;
            for (int k = 1; k < p.rings(); ++k) {
              holes.append(array_of({p.ring(k).begin(), p.ring(k).end()}));
            }
            return holes;
          },
          "List of copies (k, 2): vertices of the holes, clockwise, m.")
      .def_property_readonly(
          "area", [](const Polygon& p) { return area_moments(p).area; }, "Area, m^2.")
      .def_property_readonly(
          "centroid", [](const Polygon& p) { return pair(p.origin() + area_moments(p).centroid); },
          "Centroid (x, y), m.")
      .def_property_readonly(
          "polar_moment", [](const Polygon& p) { return area_moments(p).polar; },
          "Polar second moment of area about the centroid, m^4.")
      .def_property_readonly("is_convex", &Polygon::is_convex, "Whether the polygon is convex.")
      .def("inscribed_circle", &inscribed_circle_of,
           "The largest inscribed circle: an InscribedCircle.")
      .def("roof", &roof_of,
           "The roof over the straight skeleton: a Roof. Raises SceneError if none is found.")
      .def("singular_area", &singular_area_of, py::arg("r") = py::none(),
           "Where the distance potential with the reference length r, m, by default the height of "
           "the roof, is 1: a SingularArea. Raises ValueError unless r > 0.")
      .def("skeleton", &skeleton_object,
           "The straight skeleton: a Skeleton. Raises SceneError if none is found.")
      .def("offset", &offset_of, py::arg("d"),
           "The polygon with its sides moved inwards by d, m, along its straight skeleton: a list "
           "of polygons, which may be empty. Raises ValueError unless d > 0.")
      .def("contains", &contains, py::arg("points"),
           "Whether points (k, 2) lie inside, neither on the boundary nor in a hole, decided "
           "exactly: "
           "array (k) of bool.")
      .def("__len__", &Polygon::size);
  bind_values(polygon);
}

}  // namespace

void bind_geometry(py::module_& module) {
  bind_polygon(module);
  module.def(
      "contact", &contact, py::arg("a"), py::arg("b"), py::arg("method") = "edge",
      py::arg("stiffness") = 1., py::arg("potential") = "distance", py::arg("field") = "roof",
      py::arg("reference") = "roof",
      R"(The contact of two polygons that overlap, as `apothem contact` computes it: a PairContact.

method: "edge", integrals along the edges; "overlap", Eq. 8 of the paper (doi:10.1007/s00466-020-01913-2)
on the overlap polygon; or "exact", the same with 100 digits, which takes long.
stiffness: k_n, Pa. potential: "distance", or "area" for triangles. field: "roof" or "distance", what
measures the depth in a polygon that is not convex. reference: "roof", "inscribed_circle" or a length, m.

Raises SceneError if a polygon has no such potential, ValueError for a wrong option.)");
  module.def(
      "overlap", &overlap, py::arg("a"), py::arg("b"),
      "The components of the overlap of two polygons, exact up to the rounding of their "
      "vertices: list of arrays (k, 2), m, counter-clockwise. Holes of a component follow it, "
      "clockwise. Empty if they do not overlap.");
  module.def(
      "boolean", &boolean, py::arg("a"), py::arg("b"), py::arg("op"),
      R"(The "union", "intersection" or "difference" (a without b) of two polygons, decided exactly: a
list of PolygonWithHoles, which may be empty. Coordinates of crossings are rounded once.)");
  module.def("repair", &repair_rings, py::arg("rings"), py::arg("tolerance") = 0.,
             R"(Makes valid polygons out of an outline: a Repaired.

rings: list of arrays (k, 2), m: the outer ring and holes, which may cross, touch and repeat themselves.
What they surround an odd number of times (the even-odd rule) is kept, exactly. tolerance: vertices are
left out as long as the Hausdorff distance between the boundaries stays below it, m.)");
  module.def("voronoi", &voronoi, py::arg("region"), py::arg("n"), py::arg("seed") = 1,
             py::arg("lloyd") = 50, py::arg("shortest_edge") = .1, py::arg("convex") = false,
             py::arg("smallest_angle") = 0.,
             R"(Cuts a polygon into n Voronoi cells that tile it exactly: a VoronoiCells.

A cell that would go round a hole of the polygon is divided, so there may be more than n.

seed: of the random sites. lloyd: largest number of steps of Lloyd's iteration, which evens the cells
out. shortest_edge: length below which edges are collapsed, over the size of a cell, 0 to 0.5.
convex: cuts cells that are not convex until all are. smallest_angle: nodes move until no angle of a
cell is below it, as far as the shape of the polygon lets them, rad, 0 to pi/3.

Raises SceneError if the region is too thin, ValueError for a wrong option.)");
}

}  // namespace apothem::python
