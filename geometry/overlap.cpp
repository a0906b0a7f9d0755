#include "geometry/overlap.hpp"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_with_holes_2.h>

#include <stdexcept>

#include "geometry/exact_overlap.hpp"

namespace apothem {
namespace {

template <class Kernel>
CGAL::Polygon_2<Kernel> cgal(const Polygon& polygon) {
  CGAL::Polygon_2<Kernel> result;
  for (const Vec2& v : polygon.vertices()) result.push_back({v.x(), v.y()});
  return result;
}

template <class Kernel>
std::vector<CGAL::Polygon_2<Kernel>> intersection(const Polygon& a, const Polygon& b) {
  std::vector<CGAL::Polygon_with_holes_2<Kernel>> components;
  CGAL::intersection(cgal<Kernel>(a), cgal<Kernel>(b), std::back_inserter(components));
  std::vector<CGAL::Polygon_2<Kernel>> result;
  for (const auto& component : components) {
    // Two simple polygons overlap without holes, except where boundaries merely touch; a hole of
    // that kind is an overlap seen twice and cannot occur between simply connected regions.
    if (component.outer_boundary().size() >= 3) result.push_back(component.outer_boundary());
  }
  return result;
}

// Edges of a polygon, to be asked which of them another segment lies on.
class EdgeFinder {
 public:
  explicit EdgeFinder(const Polygon& polygon) {
    for (int i = 0; i < polygon.size(); ++i) {
      points_.emplace_back(polygon[i].x(), polygon[i].y());
      Box box;
      box.include(polygon[i].x(), polygon[i].y());
      box.include(polygon.after(i).x(), polygon.after(i).y());
      const double reach =
          std::max({std::abs(box.x0), std::abs(box.x1), std::abs(box.y0), std::abs(box.y1)});
      boxes_.push_back(box.grown(1e-12 * reach));
    }
  }

  // The edge that the segment from p to q (in the same sense) is a part of, or -1. Boxes in double
  // leave few candidates; collinearity is decided exactly.
  [[nodiscard]] int find(const detail::ExactKernel::Point_2& p,
                         const detail::ExactKernel::Point_2& q) const {
    const Vec2 approximate((CGAL::to_double(p.x()) + CGAL::to_double(q.x())) / 2,
                           (CGAL::to_double(p.y()) + CGAL::to_double(q.y())) / 2);
    const Box middle{approximate.x(), approximate.y(), approximate.x(), approximate.y()};
    for (size_t i = 0; i < points_.size(); ++i) {
      if (apart(boxes_[i], middle)) continue;
      const auto& start = points_[i];
      const auto& end = points_[i + 1 == points_.size() ? 0 : i + 1];
      if (CGAL::collinear(start, end, p) && CGAL::collinear(start, end, q) &&
          CGAL::angle(end - start, q - p) == CGAL::ACUTE) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }

 private:
  std::vector<detail::ExactKernel::Point_2> points_;
  std::vector<Box> boxes_;
};

detail::Lines<double> lines(const Potential& potential, const Vec2& shift) {
  detail::Lines<double> result;
  for (int i = 0; i < potential.size(); ++i) {
    const Vec2 p = potential.vertices[i] + shift;
    result.p.push_back({p.x(), p.y()});
    result.g.push_back({potential.gradients[i].x(), potential.gradients[i].y()});
  }
  result.capped = potential.capped();
  return result;
}

}  // namespace

namespace detail {

std::vector<ExactOverlap> exact_overlaps(const Polygon& a, const Polygon& b) {
  std::vector<ExactOverlap> result;
  const EdgeFinder edges_of_a(a);
  const EdgeFinder edges_of_b(b);
  for (ExactPolygon& polygon : intersection<ExactKernel>(a, b)) {
    ExactOverlap overlap;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const auto& p = polygon[i];
      const auto& q = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      overlap.edges.push_back({edges_of_a.find(p, q), edges_of_b.find(p, q)});
    }
    overlap.polygon = std::move(polygon);
    result.push_back(std::move(overlap));
  }
  return result;
}

}  // namespace detail

std::vector<OverlapPolygon> overlap_polygons(const Polygon& a, const Polygon& b, const Vec2& origin,
                                             Arithmetic arithmetic) {
  std::vector<OverlapPolygon> result;
  if (arithmetic == Arithmetic::inexact) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    try {
      for (const auto& polygon : intersection<Kernel>(a, b)) {
        OverlapPolygon rounded;
        for (const auto& p : polygon)
          rounded.vertices.emplace_back(p.x() - origin.x(), p.y() - origin.y());
        result.push_back(std::move(rounded));
      }
    } catch (const std::exception& error) {
      throw std::runtime_error(std::string("CGAL with inexact constructions: ") + error.what());
    }
    return result;
  }
  for (const detail::ExactOverlap& overlap : detail::exact_overlaps(a, b)) {
    OverlapPolygon rounded;
    rounded.edges = overlap.edges;
    for (const auto& p : overlap.polygon) {
      // Without exact() a lazy number rounds from its interval, which is 1e-8 off for shallow
      // overlaps.
      rounded.vertices.emplace_back(CGAL::to_double(CGAL::exact(p.x() - origin.x())),
                                    CGAL::to_double(CGAL::exact(p.y() - origin.y())));
    }
    result.push_back(std::move(rounded));
  }
  return result;
}

PairResult overlap_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                          const Potential& potential_b, Arithmetic arithmetic) {
  // Frame: a's origin.
  const Vec2 shift = b.origin() - a.origin();
  const Vec2 centroid_a = area_moments(a).centroid;
  const Vec2 centroid_b = area_moments(b).centroid + shift;
  const detail::Side<double> side_a{lines(potential_a, Vec2::Zero()),
                                    {centroid_a.x(), centroid_a.y()}};
  const detail::Side<double> side_b{lines(potential_b, shift), {centroid_b.x(), centroid_b.y()}};
  std::vector<detail::Ring<double>> rings;
  for (OverlapPolygon& overlap : overlap_polygons(a, b, a.origin(), arithmetic)) {
    detail::Ring<double> ring;
    for (const Vec2& v : overlap.vertices) ring.vertices.push_back({v.x(), v.y()});
    ring.edges = std::move(overlap.edges);
    rings.push_back(std::move(ring));
  }
  return detail::Eq8<double>(side_a, side_b, rings).result();
}

}  // namespace apothem
