#include "geometry/skeleton/wavefront.hpp"

#include <algorithm>
#include <array>

#include "geometry/skeleton/event_queue.hpp"
#include "geometry/skeleton/front_triangle.hpp"
#include "geometry/skeleton/moving_front.hpp"

namespace apothem {
namespace {

using Real = DoubleDouble;

constexpr int kNone = -1;
// The construction is given up after so many changes of triangles per vertex and in addition. Usual
// polygons need 10 to 30 per vertex.
constexpr double kMostChanges = 500;
constexpr double kMoreChanges = 1e5;

class Wavefront {
 public:
  Wavefront(const Polygon& polygon, unsigned seed, double movement)
      : polygon_(polygon),
        size_(polygon.size()),
        count_(size_ - 2 + 2 * (polygon.rings() - 1)),
        queue_(count_),
        borders_(size_) {
    const std::vector<Triangle> corners = triangulate(polygon);
    const std::vector<FineVec> points = moved_vertices(polygon, corners, movement, seed);
    for (int e = 0; e < size_; ++e) {
      front_.add_line(points[e], points[polygon.next(e)]);
      nodes_.push_back({polygon[e], 0});
    }
    for (int v = 0; v < size_; ++v) {
      front_.add_vertex(points[v], 0, polygon.previous(v), v, v);
    }
    triangles_ = front_triangles(corners, polygon);
    sound_ = !triangles_.empty();
    for (int t = 0; t < count_ && sound_; ++t) {
      const auto [a, b, c] = triangles_[t].corners;
      if (!(twice_area(points[a], points[b], points[c]) > 0)) sound_ = false;
      schedule(t, 0);
    }
  }

  std::optional<SkeletonParts> run(const Progress& progress) {
    const int total = size_ + count_;
    int report_at = size_;
    while (sound_ && !queue_.empty()) {
      const int t = queue_.first();
      now_ = std::max(now_, queue_.first_time());
      queue_.remove(t);
      collapse(t);
      if (static_cast<int>(nodes_.size()) >= report_at) {
        const int done = static_cast<int>(nodes_.size()) - size_;
        if (progress) progress({"straight skeleton", static_cast<double>(done) / count_});
        report_at = static_cast<int>(nodes_.size()) + std::max(1, size_ / 100);
      }
      if (++changes_ > kMostChanges * size_ + kMoreChanges) return std::nullopt;
    }
    if (!sound_ || static_cast<int>(nodes_.size()) != total) return std::nullopt;
    return joined(std::move(nodes_), borders_, polygon_);
  }

 private:
  void schedule(int triangle, const Real& now) {
    const MovingFront::Time time = front_.collapse_time(triangles_[triangle], now);
    ++changes_;
    time ? queue_.set(triangle, *time) : queue_.remove(triangle);
  }

  // ----------------------------------------------------------------------------------------------
  // What happens when it collapses

  void collapse(int triangle) {
    const FrontTriangle& t = triangles_[triangle];
    const int count = t.front_sides();
    if (count == 3) return end(triangle);
    if (count == 0) return flip(triangle, longest_side(t));
    int first = kNone;
    std::optional<Real> first_time;
    for (int k = 0; k < 3; ++k) {
      if (t.sides[k] >= 0) continue;
      const std::optional<Real> time = front_.shrink_time(t, k, now_);
      if (time && (!first_time || *time < *first_time)) first = k, first_time = time;
    }
    if (count == 1) {
      const int k = t.side_to(*std::min_element(t.sides.begin(), t.sides.end()));
      const std::optional<Real> reach = front_.reach_time(t, k, now_);
      if (reach && (!first_time || *reach < *first_time)) return hit(triangle, k);
    }
    if (first == kNone) {
      sound_ = false;
      return;
    }
    shrink(triangle, first);
  }

  [[nodiscard]] int longest_side(const FrontTriangle& t) const {
    std::array<double, 3> lengths{};
    for (int k = 0; k < 3; ++k) {
      const FineVec side =
          front_.place(t.corners[(k + 2) % 3], now_) - front_.place(t.corners[(k + 1) % 3], now_);
      lengths[k] = static_cast<double>(side.dot(side));
    }
    return static_cast<int>(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
  }

  // The corner opposite to the front edge on side k has reached the edge's line. It divides the
  // edge if it lies on it; otherwise an end of the edge crosses another side.
  void hit(int triangle, int k) {
    const FrontTriangle& t = triangles_[triangle];
    const FineVec& tangent = front_.line(~t.sides[k]).tangent;
    const FineVec c = front_.place(t.corners[k], now_);
    const int after_start = (k + 1) % 3;
    const int after_end = (k + 2) % 3;
    if (!(tangent.dot(c - front_.place(t.corners[after_start], now_)) > 0)) {
      flip(triangle, after_start);
    } else if (!(tangent.dot(front_.place(t.corners[after_end], now_) - c) > 0)) {
      flip(triangle, after_end);
    } else {
      divide(triangle, k);
    }
  }

  // Corner k crosses the opposite side.
  void flip(int triangle, int k) {
    const int other = triangles_[triangle].sides[k];
    if (other < 0) {
      sound_ = false;
      return;
    }
    exchange_diagonal(triangles_, triangle, k);
    schedule(triangle, now_);
    schedule(other, now_);
  }

  // Adds the node at which the lines of three edges meet now.
  int add_node(int e, int f, int g, FineVec& where) {
    where = front_.meeting_point(e, f, g, now_);
    const Vec2 point(static_cast<double>(where.x), static_cast<double>(where.y));
    if (!is_finite(point)) sound_ = false;
    nodes_.push_back({point, static_cast<double>(now_)});
    return static_cast<int>(nodes_.size()) - 1;
  }

  // Adds the arc on which a vertex has moved to a node to the borders of the faces on its sides.
  void add_arc(int vertex, int node) {
    const FrontVertex& v = front_.vertex(vertex);
    borders_[v.before].push_back({v.node, node});
    borders_[v.after].push_back({node, v.node});
  }

  void end(int triangle) {
    const FrontTriangle& t = triangles_[triangle];
    FineVec where;
    const int node = add_node(~t.sides[0], ~t.sides[1], ~t.sides[2], where);
    for (const int corner : t.corners) add_arc(corner, node);
  }

  // The front edge on side k has shrunk to nothing: its two ends become one vertex.
  void shrink(int triangle, int k) {
    const FrontTriangle t = triangles_[triangle];
    const int a = t.corners[(k + 1) % 3];
    const int b = t.corners[(k + 2) % 3];
    const int beside_a = t.sides[(k + 2) % 3];
    const int beside_b = t.sides[(k + 1) % 3];
    const int before = front_.vertex(a).before;
    const int after = front_.vertex(b).after;
    FineVec where;
    const int node = add_node(before, ~t.sides[k], after, where);
    add_arc(a, node);
    add_arc(b, node);
    const int vertex = front_.add_vertex(where, now_, before, after, node);
    if (beside_a >= 0)
      triangles_[beside_a].sides[triangles_[beside_a].side_to(triangle)] = beside_b;
    if (beside_b >= 0)
      triangles_[beside_b].sides[triangles_[beside_b].side_to(triangle)] = beside_a;
    replace(beside_a, beside_b, a, vertex);
    replace(beside_b, beside_a, b, vertex);
    reschedule();
  }

  // The corner opposite to the front edge on side k divides the edge, and with it the front.
  void divide(int triangle, int k) {
    const FrontTriangle t = triangles_[triangle];
    const int edge = ~t.sides[k];
    const int c = t.corners[k];
    const int beside_a = t.sides[(k + 2) % 3];  // side c a
    const int beside_b = t.sides[(k + 1) % 3];  // side b c
    const int before = front_.vertex(c).before;
    const int after = front_.vertex(c).after;
    FineVec where;
    const int node = add_node(before, edge, after, where);
    add_arc(c, node);
    const int first = front_.add_vertex(where, now_, edge, after, node);
    const int second = front_.add_vertex(where, now_, before, edge, node);
    triangles_[beside_a].sides[triangles_[beside_a].side_to(triangle)] = ~edge;
    triangles_[beside_b].sides[triangles_[beside_b].side_to(triangle)] = ~edge;
    replace(beside_a, ~edge, c, first);
    replace(beside_b, ~edge, c, second);
    reschedule();
  }

  // Replaces a corner of all triangles around it, from a triangle on, away from its side `from`.
  void replace(int triangle, int from, int corner, int by) {
    while (triangle >= 0) {
      FrontTriangle& t = triangles_[triangle];
      const int at = t.place_of(corner);
      const int entry = t.sides[(at + 1) % 3] == from ? (at + 1) % 3 : (at + 2) % 3;
      t.corners[at] = by;
      changed_.push_back(triangle);
      from = triangle;
      triangle = t.sides[3 - at - entry];
    }
  }

  void reschedule() {
    for (const int triangle : changed_) schedule(triangle, now_);
    changed_.clear();
  }

  const Polygon& polygon_;
  int size_;
  int count_;          // of triangles, and of the nodes inside
  bool sound_ = true;  // false once something has happened that cannot be
  Real now_;
  double changes_ = 0;
  MovingFront front_;
  std::vector<FrontTriangle> triangles_;
  EventQueue<Real> queue_;    // of triangles
  std::vector<int> changed_;  // triangles that have to be scheduled anew
  std::vector<Skeleton::Node> nodes_;
  std::vector<std::vector<FaceBorder>> borders_;  // per face
};

}  // namespace

std::optional<SkeletonParts> trace_wavefront(const Polygon& polygon, unsigned seed,
                                             const Progress& progress) {
  return Wavefront(polygon, seed, kWavefrontMovement).run(progress);
}

}  // namespace apothem
