#include "apps/peers/peers.hpp"

#include <algorithm>
#include <boost/geometry/algorithms/intersection.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <stdexcept>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;

OverlapPolygon relative(Ring ring, const Vec2& origin) {
  for (Vec2& v : ring) v -= origin;
  return {std::move(ring), {}};
}

// Twice the signed area of the triangle p, q, x: positive if x is on the left of the line from p to
// q.
double side(const Vec2& p, const Vec2& q, const Vec2& x) { return cross(q - p, x - p); }

Ring sutherland_hodgman(Ring subject, const Ring& window) {
  Ring clipped;
  for (size_t e = 0; e < window.size() && !subject.empty(); ++e) {
    const Vec2& p = window[e];
    const Vec2& q = after(window, e);
    clipped.clear();
    Vec2 last = subject.back();
    double last_side = side(p, q, last);
    for (const Vec2& v : subject) {
      const double now = side(p, q, v);
      if ((now >= 0) != (last_side >= 0)) {
        clipped.push_back(last + (v - last) * (last_side / (last_side - now)));
      }
      if (now >= 0) clipped.push_back(v);
      last = v;
      last_side = now;
    }
    std::swap(subject, clipped);
  }
  return subject;
}

bool contains(const Ring& ring, const Vec2& x) {
  bool inside = false;
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Vec2 &p = ring[j], &q = ring[i];
    if ((p.y() > x.y()) == (q.y() > x.y())) continue;
    if ((side(p, q, x) > 0) == (q.y() > p.y())) inside = !inside;
  }
  return inside;
}

class GreinerHormann {
 public:
  GreinerHormann(const Ring& a, const Ring& b) : a_(a), b_(b) { find_crossings(); }

  std::vector<Ring> overlap() {
    if (crossings_ == 0) {
      if (contains(b_, a_[0])) return {a_};
      if (contains(a_, b_[0])) return {b_};
      return {};
    }
    mark_entries(first_of_a_, b_);
    mark_entries(first_of_b_, a_);
    std::vector<Ring> rings;
    for (size_t i = 0; i < nodes_.size(); ++i) {
      // A ring that starts where a polygon enters the other one is counter-clockwise.
      if (nodes_[i].entry && !nodes_[i].visited) rings.push_back(walk(static_cast<int>(i)));
    }
    return rings;
  }

 private:
  struct Node {
    Vec2 point;
    double along = 0;  // of a crossing: position on its edge, from 0 to 1
    int partner = -1;  // of a crossing: index of the same one in the other polygon's list
    int next = -1, previous = -1;
    bool entry = false, visited = false;
  };

  // Writes both polygons as circular lists of vertices, and inserts every crossing into both.
  void find_crossings() {
    std::vector<std::vector<int>> on_a(a_.size()), on_b(b_.size());
    for (size_t i = 0; i < a_.size(); ++i) {
      for (size_t j = 0; j < b_.size(); ++j) {
        const Vec2 &p = a_[i], &q = after(a_, i);
        const Vec2 &r = b_[j], &s = after(b_, j);
        const double pr = side(r, s, p), qr = side(r, s, q);
        const double rp = side(p, q, r), sp = side(p, q, s);
        if ((pr > 0) == (qr > 0) || (rp > 0) == (sp > 0)) continue;
        const double along_a = pr / (pr - qr);
        const Vec2 point = p + along_a * (q - p);
        const int first = static_cast<int>(nodes_.size());
        nodes_.push_back({point, along_a, first + 1});
        nodes_.push_back({point, rp / (rp - sp), first});
        on_a[i].push_back(first);
        on_b[j].push_back(first + 1);
        ++crossings_;
      }
    }
    first_of_a_ = link(a_, on_a);
    first_of_b_ = link(b_, on_b);
  }

  int link(const Ring& ring, std::vector<std::vector<int>>& on) {
    std::vector<int> order;
    for (size_t i = 0; i < ring.size(); ++i) {
      order.push_back(static_cast<int>(nodes_.size()));
      nodes_.push_back({ring[i]});
      std::ranges::sort(on[i], [&](int m, int n) { return nodes_[m].along < nodes_[n].along; });
      order.insert(order.end(), on[i].begin(), on[i].end());
    }
    for (size_t k = 0; k < order.size(); ++k) {
      const int next = after(order, k);
      nodes_[order[k]].next = next;
      nodes_[next].previous = order[k];
    }
    return order[0];
  }

  void mark_entries(int first, const Ring& other) {
    bool inside = contains(other, nodes_[first].point);
    int i = first;
    do {
      if (nodes_[i].partner >= 0) {
        nodes_[i].entry = !inside;
        inside = !inside;
      }
      i = nodes_[i].next;
    } while (i != first);
  }

  Ring walk(int start) {
    Ring ring;
    int i = start;
    size_t steps = 0;
    do {
      nodes_[i].visited = nodes_[nodes_[i].partner].visited = true;
      const bool forwards = nodes_[i].entry;
      do {
        ring.push_back(nodes_[i].point);
        i = forwards ? nodes_[i].next : nodes_[i].previous;
        if (++steps > 2 * nodes_.size()) {
          throw std::runtime_error("Greiner-Hormann: the crossings do not fit together");
        }
      } while (nodes_[i].partner < 0);
      i = nodes_[i].partner;
    } while (i != start && nodes_[i].partner != start);
    return ring;
  }

  const Ring& a_;
  const Ring& b_;
  std::vector<Node> nodes_;
  int crossings_ = 0;
  int first_of_a_ = 0, first_of_b_ = 0;
};

}  // namespace

std::vector<OverlapPolygon> boost_overlap(const Polygon& a, const Polygon& b) {
  using Point = boost::geometry::model::d2::point_xy<double>;
  // Counter-clockwise; the first point is not repeated.
  using Area = boost::geometry::model::polygon<Point, false, false>;
  const auto area = [](const Polygon& polygon) {
    Area result;
    for (const Vec2& v : polygon.vertices()) result.outer().emplace_back(v.x(), v.y());
    return result;
  };
  boost::geometry::model::multi_polygon<Area> overlap;
  boost::geometry::intersection(area(a), area(b), overlap);
  std::vector<OverlapPolygon> polygons;
  for (const Area& part : overlap) {
    Ring ring;
    for (const Point& p : part.outer()) ring.emplace_back(p.x(), p.y());
    polygons.push_back(relative(std::move(ring), a.origin()));
  }
  return polygons;
}

std::vector<OverlapPolygon> clip_overlap(const Polygon& a, const Polygon& b, bool convex) {
  std::vector<OverlapPolygon> polygons;
  if (convex) {
    Ring ring = sutherland_hodgman(a.vertices(), b.vertices());
    if (ring.size() >= 3) polygons.push_back(relative(std::move(ring), a.origin()));
    return polygons;
  }
  for (Ring& ring : GreinerHormann(a.vertices(), b.vertices()).overlap()) {
    polygons.push_back(relative(std::move(ring), a.origin()));
  }
  return polygons;
}

}  // namespace apothem
