#include "geometry/exact/overlap.hpp"

#include <CGAL/Boolean_set_operations_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <iterator>
#include <limits>

#include "geometry/exact/exact_overlap.hpp"
#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

using namespace overlap_detail;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Inexact = CGAL::Exact_predicates_inexact_constructions_kernel;
using Rational = Exact::Exact_kernel::FT;

template <class Kernel>
CGAL::Polygon_2<Kernel> cgal(const Polygon& polygon) {
  CGAL::Polygon_2<Kernel> result;
  for (const Vec2& v : polygon.vertices()) result.push_back({v.x(), v.y()});
  return result;
}

// The outer boundaries of the overlap. The overlap of two simple polygons has no holes. CGAL's
// result is regularised: it contains no isolated common points and no common edges without area.
template <class Kernel>
std::vector<CGAL::Polygon_2<Kernel>> intersection(const CGAL::Polygon_2<Kernel>& a,
                                                  const CGAL::Polygon_2<Kernel>& b) {
  std::vector<CGAL::Polygon_with_holes_2<Kernel>> parts;
  CGAL::intersection(a, b, std::back_inserter(parts), CGAL::Tag_false());
  std::vector<CGAL::Polygon_2<Kernel>> outlines;
  for (auto& part : parts) outlines.push_back(std::move(part.outer_boundary()));
  return outlines;
}

// Finds the edge of one input polygon that an edge of the overlap lies on.
class Owner {
 public:
  Owner(const Polygon& polygon, const CGAL::Polygon_2<Exact>& exact)
      : polygon_(polygon), exact_(exact) {}

  // Finds the edges that interval arithmetic cannot exclude.
  void find_candidates(const Exact::Point_2& p, const Exact::Point_2& q) {
    candidates_.clear();
    const CGAL::Bbox_2 p_box = p.bbox();
    const CGAL::Bbox_2 q_box = q.bbox();
    for (int i = 0; i < polygon_.size(); ++i) {
      const Box box = box_of(polygon_[i], polygon_.after(i));
      if (meets(box, p_box) && meets(box, q_box) && perhaps_on_line(i, p) &&
          perhaps_on_line(i, q)) {
        candidates_.push_back(i);
      }
    }
  }
  [[nodiscard]] size_t candidates() const { return candidates_.size(); }

  // Returns the only candidate if it is certain to be right, otherwise the one that exact
  // arithmetic confirms, or -1.
  [[nodiscard]] int choose(const Exact::Point_2& p, const Exact::Point_2& q, bool certain) const {
    for (const int i : candidates_) {
      if (certain || contains(i, p, q)) return i;
    }
    return -1;
  }

 private:
  static bool meets(const Box& box, const CGAL::Bbox_2& point) {
    return point.xmax() >= box.x0 && point.xmin() <= box.x1 && point.ymax() >= box.y0 &&
           point.ymin() <= box.y1;
  }
  [[nodiscard]] const Exact::Point_2& start(int i) const { return exact_[i]; }
  [[nodiscard]] const Exact::Point_2& end(int i) const { return exact_[next(i, polygon_.size())]; }
  [[nodiscard]] bool perhaps_on_line(int i, const Exact::Point_2& p) const {
    const CGAL::Protect_FPU_rounding<> upward;
    return CGAL::possibly(Exact::Approximate_kernel().orientation_2_object()(
                              CGAL::approx(start(i)), CGAL::approx(end(i)), CGAL::approx(p)) ==
                          CGAL::COLLINEAR);
  }
  [[nodiscard]] bool contains(int i, const Exact::Point_2& p, const Exact::Point_2& q) const {
    return CGAL::collinear(start(i), end(i), p) && CGAL::collinear(start(i), end(i), q) &&
           CGAL::collinear_are_ordered_along_line(start(i), p, q) &&
           CGAL::collinear_are_ordered_along_line(p, q, end(i));
  }

  const Polygon& polygon_;
  const CGAL::Polygon_2<Exact>& exact_;
  std::vector<int> candidates_;
};

struct ExactRegion {
  CGAL::Polygon_2<Exact> outline;
  std::vector<OverlapEdge> edges;
};

std::vector<ExactRegion> exact_overlap(const Polygon& a, const Polygon& b) {
  std::vector<ExactRegion> regions;
  if (apart(bounding_box(a), bounding_box(b))) return regions;
  const CGAL::Polygon_2<Exact> exact_a = cgal<Exact>(a);
  const CGAL::Polygon_2<Exact> exact_b = cgal<Exact>(b);
  Owner of_a(a, exact_a);
  Owner of_b(b, exact_b);
  for (CGAL::Polygon_2<Exact>& outline : intersection(exact_a, exact_b)) {
    std::vector<OverlapEdge> edges;
    for (size_t i = 0; i < outline.size(); ++i) {
      const Exact::Point_2& p = outline[i];
      const Exact::Point_2& q = after(outline, i);
      of_a.find_candidates(p, q);
      of_b.find_candidates(p, q);
      // Every edge of the overlap lies on an input edge, so a single candidate needs no proof.
      const bool certain = of_a.candidates() + of_b.candidates() == 1;
      edges.push_back({of_a.choose(p, q, certain), of_b.choose(p, q, certain)});
    }
    regions.push_back({std::move(outline), std::move(edges)});
  }
  return regions;
}

// Rounds a rational number to Real. The result is a sum of doubles, each of which is the rounded
// remainder that the preceding ones leave.
template <class Real>
Real rounded(Rational x) {
  constexpr int kTerms = (std::numeric_limits<Real>::digits + 52) / 53;
  Real sum = CGAL::to_double(x);
  double last = static_cast<double>(sum);
  for (int term = 1; term < kTerms && last != 0; ++term) {
    x -= Rational(last);
    last = CGAL::to_double(x);
    sum += last;
  }
  return sum;
}

template <class Real>
std::vector<Region<Real>> rounded(std::vector<ExactRegion> exact, const Vec2& origin) {
  const Rational x0(origin.x());
  const Rational y0(origin.y());
  std::vector<Region<Real>> regions;
  for (ExactRegion& region : exact) {
    std::vector<Vec<Real>> vertices;
    for (const Exact::Point_2& point : region.outline) {
      const auto& p = CGAL::exact(point);
      vertices.emplace_back(rounded<Real>(p.x() - x0), rounded<Real>(p.y() - y0));
    }
    regions.push_back({std::move(vertices), std::move(region.edges)});
  }
  return regions;
}

// The overlap with inexact constructions, as it is usually written: in world coordinates, and with
// no protection against errors except this exception handler.
std::vector<Region<double>> inexact_regions(const Polygon& a, const Polygon& b,
                                            const Vec2& origin) {
  std::vector<Region<double>> regions;
  try {
    for (const auto& outline : intersection(cgal<Inexact>(a), cgal<Inexact>(b))) {
      if (outline.size() < 3 || !(outline.area() > 0)) continue;
      std::vector<Vec2> vertices;
      for (const auto& p : outline) vertices.emplace_back(p.x() - origin.x(), p.y() - origin.y());
      regions.push_back({std::move(vertices), {}});
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("inexact overlap: ") + error.what());
  }
  return regions;
}

Envelope<double> envelope(const Polygon& polygon, const Potential& potential, const Vec2& origin) {
  Envelope<double> phi{{}, potential.capped(), area_moments(polygon).centroid};
  phi.reference += polygon.origin() - origin;
  for (int i = 0; i < potential.size(); ++i) {
    const Vec2& gradient = potential.gradients[i];
    phi.lines.push_back({gradient, -gradient.dot(polygon[i] - origin)});
  }
  if (potential.distance) {
    std::vector<Vec2> vertices;
    for (const Vec2& v : polygon.vertices()) vertices.emplace_back(v - origin);
    phi.set_distance(*potential.distance, vertices, potential.distance->slope);
  }
  if (!potential.roof) return phi;
  // Boundary nodes are the vertices exactly as given. Inner nodes are shifted from the coordinates
  // of the polygon.
  phi.roof = &*potential.roof;
  phi.values = potential.roof->values;
  const Vec2 shift = polygon.origin() - origin;
  for (size_t i = 0; i < phi.values.size(); ++i) {
    const bool given = static_cast<int>(i) < polygon.size();
    const Vec2 p = given ? Vec2(polygon[static_cast<int>(i)] - origin)
                         : Vec2(potential.roof->points[i] + shift);
    phi.x.push_back(p.x());
    phi.y.push_back(p.y());
  }
  return phi;
}

}  // namespace

template <class Real>
std::vector<Region<Real>> overlap_detail::exact_regions(const Polygon& a, const Polygon& b,
                                                        const Vec2& origin) {
  return rounded<Real>(exact_overlap(a, b), origin);
}
template std::vector<Region<boost::multiprecision::cpp_bin_float_100>>
overlap_detail::exact_regions(const Polygon&, const Polygon&, const Vec2&);

std::vector<OverlapPolygon> overlap_polygons(const Polygon& a, const Polygon& b, const Vec2& origin,
                                             Arithmetic arithmetic) {
  std::vector<OverlapPolygon> polygons;
  for (Region<double>& region : arithmetic == Arithmetic::exact
                                    ? exact_regions<double>(a, b, origin)
                                    : inexact_regions(a, b, origin)) {
    polygons.push_back({std::move(region.vertices), std::move(region.edges)});
  }
  return polygons;
}

PairResult overlap_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                          const Potential& potential_b, Arithmetic arithmetic) {
  std::vector<Region<double>> regions;
  Vec2 origin = a.origin();
  if (arithmetic == Arithmetic::exact) {
    std::vector<ExactRegion> exact = exact_overlap(a, b);
    if (exact.empty()) return {};
    // The origin is a corner of the overlap, so that the terms of the sums are as small as it.
    const Exact::Point_2& corner = exact[0].outline[0];
    origin = {CGAL::to_double(corner.x()), CGAL::to_double(corner.y())};
    regions = rounded<double>(std::move(exact), origin);
  } else {
    regions = inexact_regions(a, b, origin);
  }
  return integrate(regions, envelope(a, potential_a, origin), envelope(b, potential_b, origin));
}

PairIntegral overlap_integral(const std::vector<OverlapPolygon>& overlap, const Vec2& origin,
                              const Polygon& a, const Potential& potential_a, const Polygon& b,
                              const Potential& potential_b) {
  std::vector<Region<double>> regions;
  for (const OverlapPolygon& polygon : overlap) {
    regions.push_back({polygon.vertices, polygon.edges});
  }
  return integrate(regions, envelope(a, potential_a, origin), envelope(b, potential_b, origin),
                   false)
      .integral;
}

}  // namespace apothem
