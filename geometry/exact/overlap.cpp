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
CGAL::Polygon_2<Kernel> cgal(std::span<const Vec2> ring) {
  CGAL::Polygon_2<Kernel> result;
  for (const Vec2& v : ring) result.push_back({v.x(), v.y()});
  return result;
}
template <class Kernel>
CGAL::Polygon_with_holes_2<Kernel> cgal_with_holes(const Polygon& polygon) {
  CGAL::Polygon_with_holes_2<Kernel> result(cgal<Kernel>(polygon.outer_ring()));
  for (int k = 1; k < polygon.rings(); ++k) result.add_hole(cgal<Kernel>(polygon.ring(k)));
  return result;
}

// The components of the overlap. CGAL's result is regularised: it contains no isolated common
// points and no common edges without area.
template <class Kernel>
std::vector<CGAL::Polygon_with_holes_2<Kernel>> intersection(const Polygon& a, const Polygon& b) {
  std::vector<CGAL::Polygon_with_holes_2<Kernel>> parts;
  if (a.has_holes() || b.has_holes()) {
    CGAL::intersection(cgal_with_holes<Kernel>(a), cgal_with_holes<Kernel>(b),
                       std::back_inserter(parts), CGAL::Tag_false());
  } else {
    CGAL::intersection(cgal<Kernel>(a.outer_ring()), cgal<Kernel>(b.outer_ring()),
                       std::back_inserter(parts), CGAL::Tag_false());
  }
  return parts;
}

// Finds the edge of one input polygon that an edge of the overlap lies on.
class Owner {
 public:
  explicit Owner(const Polygon& polygon) : polygon_(polygon) {
    for (const Vec2& v : polygon.vertices()) exact_.emplace_back(v.x(), v.y());
  }

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
  [[nodiscard]] const Exact::Point_2& end(int i) const { return exact_[polygon_.next(i)]; }
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
  std::vector<Exact::Point_2> exact_;
  std::vector<int> candidates_;
};

struct ExactRing {
  CGAL::Polygon_2<Exact> outline;
  std::vector<OverlapEdge> edges;
};
// A component of the overlap: its outer ring, and then its holes.
using ExactRegion = std::vector<ExactRing>;

std::vector<ExactRegion> exact_overlap(const Polygon& a, const Polygon& b) {
  std::vector<ExactRegion> regions;
  if (apart(bounding_box(a), bounding_box(b))) return regions;
  Owner of_a(a);
  Owner of_b(b);
  const auto owned = [&](const CGAL::Polygon_2<Exact>& outline) -> ExactRing {
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
    return {outline, std::move(edges)};
  };
  for (const CGAL::Polygon_with_holes_2<Exact>& part : intersection<Exact>(a, b)) {
    ExactRegion& region = regions.emplace_back();
    region.push_back(owned(part.outer_boundary()));
    for (const CGAL::Polygon_2<Exact>& hole : part.holes()) region.push_back(owned(hole));
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
Region<Real> rounded(ExactRing ring, const Vec2& origin) {
  const Rational x0(origin.x());
  const Rational y0(origin.y());
  std::vector<Vec<Real>> vertices;
  for (const Exact::Point_2& point : ring.outline) {
    const auto& p = CGAL::exact(point);
    vertices.emplace_back(rounded<Real>(p.x() - x0), rounded<Real>(p.y() - y0));
  }
  return {std::move(vertices), std::move(ring.edges)};
}

// The rings of all components.
template <class Real>
std::vector<Region<Real>> rounded(std::vector<ExactRegion> exact, const Vec2& origin) {
  std::vector<Region<Real>> rings;
  for (ExactRegion& region : exact) {
    for (ExactRing& ring : region) rings.push_back(rounded<Real>(std::move(ring), origin));
  }
  return rings;
}

// The overlap with inexact constructions, as it is usually written: in world coordinates, and with
// no protection against errors except this exception handler.
std::vector<OverlapPolygon> inexact_overlap(const Polygon& a, const Polygon& b,
                                            const Vec2& origin) {
  std::vector<OverlapPolygon> polygons;
  const auto relative = [&](const CGAL::Polygon_2<Inexact>& ring) -> OverlapRing {
    std::vector<Vec2> vertices;
    for (const auto& p : ring) vertices.emplace_back(p.x() - origin.x(), p.y() - origin.y());
    return {std::move(vertices), {}};
  };
  try {
    for (const auto& part : intersection<Inexact>(a, b)) {
      const auto& outline = part.outer_boundary();
      if (outline.size() < 3 || !(outline.area() > 0)) continue;
      polygons.push_back({relative(outline)});
      for (const auto& hole : part.holes()) polygons.back().holes.push_back(relative(hole));
    }
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("inexact overlap: ") + error.what());
  }
  return polygons;
}

// The rings of overlap polygons.
std::vector<Region<double>> rings_of(const std::vector<OverlapPolygon>& overlap) {
  std::vector<Region<double>> rings;
  for (const OverlapPolygon& polygon : overlap) {
    rings.push_back({polygon.vertices, polygon.edges});
    for (const OverlapRing& hole : polygon.holes) rings.push_back({hole.vertices, hole.edges});
  }
  return rings;
}

Envelope<double> envelope(const Polygon& polygon, const Potential& potential, const Vec2& origin) {
  Envelope<double> phi{{}, potential.capped(), area_moments(polygon).centroid};
  phi.reference += polygon.origin() - origin;
  phi.links = polygon.links();
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
  if (arithmetic == Arithmetic::inexact) return inexact_overlap(a, b, origin);
  std::vector<OverlapPolygon> polygons;
  const auto ring = [&](ExactRing& exact) -> OverlapRing {
    Region<double> region = rounded<double>(std::move(exact), origin);
    return {std::move(region.vertices), std::move(region.edges)};
  };
  for (ExactRegion& region : exact_overlap(a, b)) {
    polygons.push_back({ring(region.front())});
    for (size_t k = 1; k < region.size(); ++k) polygons.back().holes.push_back(ring(region[k]));
  }
  return polygons;
}

PairResult overlap_method(const Polygon& a, const Potential& potential_a, const Polygon& b,
                          const Potential& potential_b, Arithmetic arithmetic) {
  std::vector<Region<double>> rings;
  Vec2 origin = a.origin();
  if (arithmetic == Arithmetic::exact) {
    std::vector<ExactRegion> exact = exact_overlap(a, b);
    if (exact.empty()) return {};
    // The origin is a corner of the overlap, so that the terms of the sums are as small as it.
    const Exact::Point_2& corner = exact[0][0].outline[0];
    origin = {CGAL::to_double(corner.x()), CGAL::to_double(corner.y())};
    rings = rounded<double>(std::move(exact), origin);
  } else {
    rings = rings_of(inexact_overlap(a, b, origin));
  }
  return integrate(rings, envelope(a, potential_a, origin), envelope(b, potential_b, origin));
}

PairIntegral overlap_integral(const std::vector<OverlapPolygon>& overlap, const Vec2& origin,
                              const Polygon& a, const Potential& potential_a, const Polygon& b,
                              const Potential& potential_b) {
  return integrate(rings_of(overlap), envelope(a, potential_a, origin),
                   envelope(b, potential_b, origin), false)
      .integral;
}

}  // namespace apothem
