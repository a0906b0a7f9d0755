// The wavefront of a polygon in rational numbers, by brute force: every event is found by trying
// every vertex on every edge, and after every event the border of what is left is found by cutting
// every edge at every vertex on it. Edges need normals of rational length. The loops of a polygon
// with holes move together, because an event may join them.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/polygon/polygon.hpp"

namespace apothem::test {

class ExactWavefront {
 public:
  using Rational = boost::multiprecision::cpp_rational;
  using Point = std::pair<Rational, Rational>;
  using Node = std::tuple<Rational, Rational, Rational>;  // x, y and time

  explicit ExactWavefront(const Polygon& polygon) : faces_(polygon.size()) {
    Loops loops;
    for (int e = 0; e < polygon.size(); ++e) {
      const Vec2 side = polygon.after(e) - polygon[e];
      const double length = side.norm();  // whole
      tangents_.push_back({Rational(side.x()) / length, Rational(side.y()) / length});
      const Point start{polygon[e].x(), polygon[e].y()};
      offsets_.push_back(normal(e, start));
      loops.pieces.push_back({e, start});
      loops.next.push_back(polygon.next(e));
      loops.previous.push_back(polygon.previous(e));
      add_node(start, 0, {e, polygon.previous(e)});
    }
    together_ = polygon.has_holes();
    fronts_.emplace_back(loops, 0);
    while (!fronts_.empty()) {
      const auto [front, time] = fronts_.back();
      fronts_.pop_back();
      advance(front, time);
    }
  }

  /// The nodes of the face of each edge.
  [[nodiscard]] const std::vector<std::set<Node>>& faces() const { return faces_; }

 private:
  struct Piece {
    int edge;
    Point start;
  };
  // What moves on its own: one loop or several, with the neighbours of their pieces.
  struct Loops {
    std::vector<Piece> pieces;
    std::vector<size_t> next, previous;
  };
  using Parts = std::map<std::pair<Point, Point>, int>;  // by their ends: the edges they lie on

  [[nodiscard]] Rational along(int e, const Point& p) const {
    return tangents_[e].first * p.first + tangents_[e].second * p.second;
  }
  [[nodiscard]] Rational normal(int e, const Point& p) const {
    return tangents_[e].first * p.second - tangents_[e].second * p.first;
  }
  void add_node(const Point& p, const Rational& time, const std::set<int>& edges) {
    for (const int e : edges) faces_[e].insert({p.first, p.second, time});
  }
  [[nodiscard]] Point speed(const Loops& loops, size_t i) const {
    const auto& [px, py] = tangents_[loops.pieces[loops.previous[i]].edge];
    const auto& [qx, qy] = tangents_[loops.pieces[i].edge];
    const Rational nx = -py - qy, ny = px + qx, half = (nx * nx + ny * ny) / 2;
    return {nx / half, ny / half};
  }
  static Point moved(const Point& p, const Point& speed, const Rational& time) {
    return {p.first + time * speed.first, p.second + time * speed.second};
  }
  static Point difference(const Point& p, const Point& q) {
    return {p.first - q.first, p.second - q.second};
  }

  // The first time after `now` at which a piece vanishes or a vertex is on another piece.
  [[nodiscard]] Rational first_event(const Loops& loops, const std::vector<Point>& speeds,
                                     const Rational& now) const {
    const std::vector<Piece>& loop = loops.pieces;
    const size_t m = loop.size();
    Rational first = -1;
    const auto offer = [&](const Rational& step) {
      if (step > 0 && (first < 0 || step < first)) first = step;
    };
    for (size_t i = 0; i < m; ++i) {
      const int e = loop[i].edge;
      const size_t j = loops.next[i];
      const Rational rate = along(e, difference(speeds[j], speeds[i]));
      if (rate < 0) offer(-along(e, difference(loop[j].start, loop[i].start)) / rate);
      for (size_t k = 0; k < m; ++k) {
        if (k == i || k == j) continue;
        const Rational approach = normal(e, speeds[k]) - 1;
        if (approach == 0) continue;
        const Rational step = (offsets_[e] + now - normal(e, loop[k].start)) / approach;
        if (step <= 0 || (first >= 0 && step >= first)) continue;
        const Rational s = along(e, moved(loop[k].start, speeds[k], step));
        if (s >= along(e, moved(loop[i].start, speeds[i], step)) &&
            s <= along(e, moved(loop[j].start, speeds[j], step))) {
          offer(step);
        }
      }
    }
    return first;
  }

  void advance(const Loops& loops, const Rational& now) {
    const std::vector<Piece>& loop = loops.pieces;
    const size_t m = loop.size();
    std::vector<Point> speeds, places;
    for (size_t i = 0; i < m; ++i) speeds.push_back(speed(loops, i));
    const Rational step = first_event(loops, speeds, now);
    if (step < 0) throw std::logic_error("a loop has no event");
    for (size_t i = 0; i < m; ++i) places.push_back(moved(loop[i].start, speeds[i], step));
    Parts parts;
    std::map<Point, std::set<int>> edges_at;
    std::map<Point, int> vertices_at;
    std::set<Point> changed;
    for (size_t i = 0; i < m; ++i) {
      const Point &a = places[i], &b = places[loops.next[i]];
      if (++vertices_at[a] > 1) changed.insert(a);
      edges_at[a].insert(loop[i].edge);
      edges_at[b].insert(loop[i].edge);
      cut(loop[i].edge, a, b, places, parts, edges_at, changed);
    }
    cancel(parts, changed);
    for (const Point& p : changed) add_node(p, now + step, edges_at[p]);
    join(parts, now + step);
  }

  void cut(int e, const Point& a, const Point& b, const std::vector<Point>& places, Parts& parts,
           std::map<Point, std::set<int>>& edges_at, std::set<Point>& changed) const {
    std::map<Rational, Point> cuts{{along(e, a), a}, {along(e, b), b}};
    for (const Point& p : places) {
      if (normal(e, p) != normal(e, a) || along(e, p) <= along(e, a) ||
          along(e, p) >= along(e, b)) {
        continue;
      }
      cuts.emplace(along(e, p), p);
      edges_at[p].insert(e);
      changed.insert(p);
    }
    for (auto p = cuts.begin(), q = std::next(p); q != cuts.end(); ++p, ++q) {
      parts.emplace(std::pair(p->second, q->second), e);
    }
  }

  // Takes out parts that lie on each other.
  static void cancel(Parts& parts, std::set<Point>& changed) {
    for (auto p = parts.begin(); p != parts.end();) {
      const auto other = parts.find({p->first.second, p->first.first});
      if (other == parts.end()) {
        ++p;
        continue;
      }
      changed.insert(p->first.first);
      changed.insert(p->first.second);
      parts.erase(other);
      p = parts.erase(p);
    }
  }

  // The next part turns furthest to the left, which keeps the touching interiors apart.
  [[nodiscard]] bool more_left(int p, int q, int in) const {
    const auto sine = [&](int a, int b) -> Rational {
      return tangents_[a].first * tangents_[b].second - tangents_[a].second * tangents_[b].first;
    };
    const bool right_p = sine(in, p) < 0, right_q = sine(in, q) < 0;
    return right_p != right_q ? right_q : sine(q, p) > 0;
  }

  void join(Parts& parts, const Rational& now) {
    Loops loops;
    while (!parts.empty()) {
      auto part = parts.begin();
      std::vector<Parts::iterator> used;
      const size_t first = loops.pieces.size();
      do {
        loops.previous.push_back(loops.pieces.size() - 1);
        loops.pieces.push_back({part->second, part->first.first});
        loops.next.push_back(loops.pieces.size());
        used.push_back(part);
        part = follower(parts, part);
      } while (part != used.front());
      loops.previous[first] = loops.pieces.size() - 1;
      loops.next.back() = first;
      for (const auto& p : used) parts.erase(p);
      if (!together_) fronts_.emplace_back(std::exchange(loops, {}), now);
    }
    if (!loops.pieces.empty()) fronts_.emplace_back(std::move(loops), now);
  }
  Parts::iterator follower(Parts& parts, Parts::iterator part) const {
    auto best = parts.end();
    for (auto q = parts.begin(); q != parts.end(); ++q) {
      if (q->first.first != part->first.second) continue;
      if (best == parts.end() || more_left(q->second, best->second, part->second)) best = q;
    }
    if (best == parts.end()) throw std::logic_error("a loop is open");
    return best;
  }

  std::vector<Point> tangents_;
  std::vector<Rational> offsets_;
  std::vector<std::pair<Loops, Rational>> fronts_;
  bool together_ = false;  // all loops are one front
  std::vector<std::set<Node>> faces_;
};

}  // namespace apothem::test
