#include "geometry/regions/boolean.hpp"

#include <CGAL/Arr_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <iterator>
#include <map>
#include <stdexcept>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"

namespace apothem {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Rational = Kernel::Exact_kernel::FT;

// The edges of the rings that a part of the arrangement lies on, by number, ascending.
using Sources = std::vector<int>;
struct Merge {
  Sources operator()(const Sources& a, const Sources& b) const {
    Sources both;
    std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
    return both;
  }
};

struct VertexMark {
  int boundaries = 0;  // boundary edges that end there
  int place = -1;      // in the line that is being followed
};
struct EdgeMark {
  bool boundary = false, followed = false;
};
struct FaceMark {
  bool found = false, in_a = false, in_b = false, kept = false;
  int part = -1;  // connected part of what is kept
};

using Segments = CGAL::Arr_segment_traits_2<Kernel>;
using Traits = CGAL::Arr_curve_data_traits_2<Segments, Sources, Merge>;
using Dcel = CGAL::Arr_extended_dcel<Traits, VertexMark, EdgeMark, FaceMark>;
using Arrangement = CGAL::Arrangement_2<Traits, Dcel>;
using Vertex = Arrangement::Vertex_handle;
using Edge = Arrangement::Halfedge_handle;
using Face = Arrangement::Face_handle;

bool meet(const Sources& a, const Sources& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int i) { return std::binary_search(b.begin(), b.end(), i); });
}

// The double nearest to a number. CGAL's own conversion rounds towards zero.
double nearest(const Kernel::FT& number) {
  const std::pair<double, double> bounds = CGAL::to_interval(number);
  if (bounds.first == bounds.second) return bounds.first;
  const Rational exact = CGAL::exact(number);
  const double low = CGAL::to_double(exact);
  const Rational rest = exact - Rational(low);
  if (rest == 0) return low;
  const double other = std::nextafter(low, rest > 0 ? HUGE_VAL : -HUGE_VAL);
  return 2 * CGAL::abs(rest) <= CGAL::abs(Rational(other) - Rational(low)) ? low : other;
}

bool is_double(const Kernel::FT& number) {
  const std::pair<double, double> bounds = CGAL::to_interval(number);
  return bounds.first == bounds.second;
}

// The numbers of the vertices of rings, by their places: of several at a place, the first one.
using Numbers =
    std::map<Vec2, int, decltype([](const Vec2& p, const Vec2& q) { return precedes(p, q); })>;

Numbers numbers_of_vertices(const Rings& a, const Rings& b) {
  Numbers numbers;
  int number = 0;
  for (const Rings* rings : {&a, &b}) {
    for (const std::vector<Vec2>& ring : *rings) {
      for (const Vec2& v : ring) numbers.emplace(v, number++);
    }
  }
  return numbers;
}

// Calls visit(edge) for all halfedges around a face.
template <class Visit>
void around(const Face& face, const Visit& visit) {
  const auto circulate = [&](Arrangement::Ccb_halfedge_circulator start) {
    auto edge = start;
    do {
      visit(Edge(edge));
    } while (++edge != start);
  };
  for (auto ccb = face->outer_ccbs_begin(); ccb != face->outer_ccbs_end(); ++ccb) circulate(*ccb);
  for (auto ccb = face->inner_ccbs_begin(); ccb != face->inner_ccbs_end(); ++ccb) circulate(*ccb);
}

// The arrangement of the edges of two lists of rings, and the polygons that a choice of its faces
// makes.
class Overlay {
 public:
  Overlay(const Rings& a, const Rings& b) {
    std::vector<Traits::Curve_2> curves;
    add(a, curves);
    edges_of_a_ = static_cast<int>(curves.size());
    add(b, curves);
    CGAL::insert(arrangement_, curves.begin(), curves.end());
    find_faces();
  }

  template <class Keep>
  std::vector<PolygonWithHoles> polygons(const Keep& keep) {
    for (const Face face : arrangement_.face_handles()) {
      face->data().kept = keep(face->data().in_a, face->data().in_b);
    }
    find_parts();
    for (const Edge edge : arrangement_.halfedge_handles()) {
      edge->data().boundary = edge->face()->data().kept && !edge->twin()->face()->data().kept;
      if (edge->data().boundary) ++edge->target()->data().boundaries;
    }
    polygons_.assign(parts_, {});
    for (const Edge edge : arrangement_.halfedge_handles()) {
      if (edge->data().boundary && !edge->data().followed) follow(edge);
    }
    std::vector<PolygonWithHoles> result;
    for (PolygonWithHoles& polygon : polygons_) {
      if (!polygon.outer.empty()) result.push_back(std::move(polygon));
    }
    return result;
  }

  /// Whether a vertex of polygons() is no point of double precision.
  [[nodiscard]] bool rounded() const { return rounded_; }

 private:
  void add(const Rings& rings, std::vector<Traits::Curve_2>& curves) {
    for (const std::vector<Vec2>& ring : rings) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Vec2 &p = ring[i], &q = after(ring, i);
        if (p == q) continue;
        curves.emplace_back(
            Segments::Curve_2(Kernel::Point_2(p.x(), p.y()), Kernel::Point_2(q.x(), q.y())),
            Sources{static_cast<int>(curves.size())});
      }
    }
  }

  // Every edge of a ring that is crossed changes whether its rings surround the face.
  void find_faces() {
    std::vector<Face> open{arrangement_.unbounded_face()};
    open.back()->data().found = true;
    while (!open.empty()) {
      const Face face = open.back();
      open.pop_back();
      around(face, [&](const Edge& edge) {
        const Face other = edge->twin()->face();
        FaceMark& mark = other->data();
        if (mark.found) return;
        mark = face->data();
        for (const int source : edge->curve().data()) {
          bool& inside = source < edges_of_a_ ? mark.in_a : mark.in_b;
          inside = !inside;
        }
        open.push_back(other);
      });
    }
  }

  // Numbers the connected parts of what is kept. Faces are connected across common edges.
  void find_parts() {
    std::vector<Face> open;
    for (const Face first : arrangement_.face_handles()) {
      if (!first->data().kept || first->data().part >= 0) continue;
      first->data().part = static_cast<int>(parts_);
      open.push_back(first);
      while (!open.empty()) {
        const Face face = open.back();
        open.pop_back();
        around(face, [&](const Edge& edge) {
          FaceMark& other = edge->twin()->face()->data();
          if (!other.kept || other.part >= 0) return;
          other.part = static_cast<int>(parts_);
          open.push_back(edge->twin()->face());
        });
      }
      ++parts_;
    }
  }

  // The boundary edge behind this one, around the same corner of what is kept.
  static Edge next_on_boundary(const Edge& edge) {
    Edge next = edge->next();
    while (!next->data().boundary) next = next->twin()->next();
    return next;
  }

  // Follows a closed boundary. Where it comes back to a vertex, it is cut into two rings: a hole
  // that touches the outer boundary, or two holes that touch each other.
  void follow(const Edge& first) {
    std::vector<Edge> line;
    PolygonWithHoles& polygon = polygons_[static_cast<size_t>(first->face()->data().part)];
    Edge edge = first;
    do {
      edge->data().followed = true;
      edge->source()->data().place = static_cast<int>(line.size());
      line.push_back(edge);
      const int place = edge->target()->data().place;
      if (place >= 0) {
        add_ring({line.begin() + place, line.end()}, polygon);
        for (auto e = line.begin() + place; e != line.end(); ++e) (*e)->source()->data().place = -1;
        line.resize(static_cast<size_t>(place));
      }
      edge = next_on_boundary(edge);
    } while (edge != first);
  }

  void add_ring(const std::vector<Edge>& edges, PolygonWithHoles& polygon) {
    std::vector<Vec2> ring;
    for (size_t i = 0; i < edges.size(); ++i) {
      // Where an edge of the input goes straight on, it was only divided by an edge that has gone.
      const Vertex vertex = edges[i]->source();
      const bool divided = vertex->data().boundaries == 1 &&
                           meet(before(edges, i)->curve().data(), edges[i]->curve().data());
      if (divided) continue;
      const Kernel::Point_2& p = vertex->point();
      rounded_ = rounded_ || !is_double(p.x()) || !is_double(p.y());
      const Vec2 place(nearest(p.x()), nearest(p.y()));
      if (ring.empty() || ring.back() != place) ring.push_back(place);
    }
    while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) return;
    if (is_counter_clockwise(edges)) {
      polygon.outer = std::move(ring);
    } else {
      polygon.holes.push_back(std::move(ring));
    }
  }

  // The sense of the turn at the leftmost vertex, where the ring cannot go straight on.
  static bool is_counter_clockwise(const std::vector<Edge>& edges) {
    size_t first = 0;
    for (size_t i = 1; i < edges.size(); ++i) {
      if (edges[i]->source()->point() < edges[first]->source()->point()) first = i;
    }
    return CGAL::left_turn(before(edges, first)->source()->point(), edges[first]->source()->point(),
                           edges[first]->target()->point());
  }

  Arrangement arrangement_;
  int edges_of_a_ = 0;
  size_t parts_ = 0;
  bool rounded_ = false;
  std::vector<PolygonWithHoles> polygons_;  // of each part
};

void require_usable(const Rings& rings) {
  constexpr double kLargest = 1e60;  // as of polygons
  for (const std::vector<Vec2>& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      if (ring[i].cwiseAbs().maxCoeff() < kLargest) continue;
      const std::string name = "vertex " + std::to_string(i);
      throw InvalidPolygon(
          is_finite(ring[i]) ? name + " has a coordinate beyond 1e60" : name + " is not finite",
          static_cast<int>(i));
    }
  }
}

// Puts rings and polygons into an order that does not depend on how they were found: by the numbers
// of their first vertices.
class Order {
 public:
  explicit Order(const Numbers& numbers) : numbers_(numbers) {}

  void put(std::vector<PolygonWithHoles>& polygons) const {
    for (PolygonWithHoles& polygon : polygons) {
      turn(polygon.outer);
      for (std::vector<Vec2>& hole : polygon.holes) turn(hole);
      std::sort(polygon.holes.begin(), polygon.holes.end(),
                [&](const auto& a, const auto& b) { return key(a[0]) < key(b[0]); });
    }
    std::sort(polygons.begin(), polygons.end(), [&](const auto& a, const auto& b) {
      return std::pair(key(a.outer[0]), key(after(a.outer, 0))) <
             std::pair(key(b.outer[0]), key(after(b.outer, 0)));
    });
  }

 private:
  using Key = std::tuple<int, double, double>;
  [[nodiscard]] Key key(const Vec2& v) const {
    const auto found = numbers_.find(v);
    return {found == numbers_.end() ? INT_MAX : found->second, v.x(), v.y()};
  }
  void turn(std::vector<Vec2>& ring) const {
    const auto first = std::min_element(
        ring.begin(), ring.end(), [&](const Vec2& a, const Vec2& b) { return key(a) < key(b); });
    std::rotate(ring.begin(), first, ring.end());
  }

  const Numbers& numbers_;
};

bool same(const std::vector<PolygonWithHoles>& a, const std::vector<PolygonWithHoles>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.outer == q.outer && p.holes == q.holes;
  });
}

template <class Keep>
std::vector<PolygonWithHoles> selected(const Rings& a, const Rings& b, const Keep& keep) {
  constexpr int kMostSteps = 100;
  require_usable(a);
  require_usable(b);
  const Numbers numbers = numbers_of_vertices(a, b);
  const Order order(numbers);
  Overlay overlay(a, b);
  std::vector<PolygonWithHoles> polygons = overlay.polygons(keep);
  order.put(polygons);
  if (!overlay.rounded()) return polygons;
  for (int step = 0; step < kMostSteps; ++step) {
    Overlay again(rings_of(polygons), {});
    std::vector<PolygonWithHoles> next = again.polygons([](bool in, bool) { return in; });
    order.put(next);
    if (same(next, polygons)) return polygons;
    polygons = std::move(next);
  }
  throw InvalidPolygon("has crossings that cannot be rounded to double precision", 0);
}

}  // namespace

std::vector<PolygonWithHoles> even_odd_polygons(const Rings& rings) {
  return selected(rings, {}, [](bool in, bool) { return in; });
}

std::vector<PolygonWithHoles> boolean_operation(const Rings& a, const Rings& b,
                                                BooleanOperation operation) {
  return selected(a, b, [&](bool in_a, bool in_b) {
    return operation == BooleanOperation::join           ? in_a || in_b
           : operation == BooleanOperation::intersection ? in_a && in_b
                                                         : in_a && !in_b;
  });
}

}  // namespace apothem
