// Finds the largest inscribed circle by branch and bound over a triangulation of the polygon.
//
// The distance f to the boundary is the minimum of the distances f_i to the edges, and each f_i is
// a convex function. In a triangle T inside the polygon this gives an upper and a lower bound of
// the maximum of f. Each is found by a linear programme, which computes the highest point of a
// lower envelope of planes over T:
// - Upper bound: f_i is nowhere above its linear interpolation between the corners of T. The gap is
//   zero where the points of edge i that are nearest to T lie inside the edge, otherwise it is
//   quadratic in the size of T.
// - Lower bound: f_i is nowhere below its tangent plane at any point. A step to the highest point
//   of the tangent planes is not taken if it would make f smaller; the steps converge quadratically
//   to a centre.
// The result is a value of f at a point inside the polygon, so neither round-off nor a degenerate
// position can make the radius too large. The upper bound ends the search only when no larger
// circle can be left. A long corridor, which would be costly with the cells of a grid, consists of
// a few long triangles.
//
// In a polygon with many vertices, the triangles may be long slivers that cross each other's wide
// places. The search then starts with two triangles that cover the bounding box. Those that turn
// out to lie outside are dropped, and a point counts only if it is inside. Triangles with long
// lists of edges are halved without a linear programme. A long bounding box is first halved into
// boxes that are not, because halving long triangles leaves needles. If the search takes too many
// triangles, as it does in a needle, it starts anew with the triangulation.
#include "geometry/potential/inscribed_circle.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <span>

#include "geometry/polygon/canonical_pose.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/triangulation.hpp"
#include "geometry/potential/corridors.hpp"
#include "geometry/potential/edge_distance.hpp"
#include "geometry/potential/highest_point.hpp"
#include "geometry/spatial/ring_tree.hpp"

namespace apothem {
namespace {

// All lengths below are divided by the polygon's size, rounded up to a power of two, so that the
// division is exact.
constexpr double kNoise = 0x1p-50;     // larger than the round-off of a distance
constexpr double kSameRadius = 1e-13;  // relative tolerance for equal radii, as in potential.cpp
constexpr double kSmallest = 0x1p-49;  // smallest resolved radius, as in potential.cpp
constexpr double kSamePlace = 1e-6;    // centres closer than this fraction of the radius are one
constexpr size_t kManyEdges = 200;     // a search for a polygon with more edges starts with its box
constexpr size_t kCellsPerReport = 100;
constexpr size_t kMostCells = 2000;  // per edge; then that search is given up
constexpr size_t kLongList = 64;     // with more edges in its list, a triangle is usually halved
constexpr double kSimilar = .7;      // unless halving leaves more than this fraction of the list
constexpr double kSameSide = 1e-9;   // relative difference of distances that counts as zero
constexpr double kAlongside = 1e-6;  // cosine of an angle that counts as a right one
constexpr double kLong = 8;          // a box longer than so many times its width is halved first

// A triangle inside the polygon.
struct Cell {
  std::array<Vec2, 3> corners;
  double bound;                 // upper bound of f in the triangle
  Vec2 point = Vec2::Zero();    // the best point that is known in the triangle
  double height = 0;            // value of f at `point`
  std::vector<int> edges = {};  // edges that may be nearest to a point; empty until examined

  [[nodiscard]] Vec2 at(const Heights& place) const {
    return place[0] * corners[0] + place[1] * corners[1] + place[2] * corners[2];
  }
  // Length of the side opposite to corner k.
  [[nodiscard]] double side(int k) const {
    return (corners[(k + 2) % 3] - corners[(k + 1) % 3]).norm();
  }
  // The corner that is opposite to the longest side.
  [[nodiscard]] int longest() const {
    const std::array<double, 3> sides{side(0), side(1), side(2)};
    return static_cast<int>(std::ranges::max_element(sides) - sides.begin());
  }
};

// An upper bound of the distance of any point of a triangle from the nearest corner. It bounds f,
// as the corners of the first triangles are vertices of the polygon.
double corner_bound(const Cell& cell) {
  const int k = cell.longest();
  const double a = cell.side(k), b = cell.side((k + 1) % 3), c = cell.side((k + 2) % 3);
  if (a * a >= b * b + c * c) return a / 2;
  const double twice_area =
      std::abs(cross(cell.corners[1] - cell.corners[0], cell.corners[2] - cell.corners[0]));
  return std::min(a / std::sqrt(3.0), a * b * c / (2 * twice_area)) + kNoise;
}

class Search {
 public:
  /// Where a search starts: with a triangulation, or with two triangles around the polygon.
  enum class Start { triangles, box };

  Search(const Polygon& polygon, double unit, Start start) : beyond_(start == Start::box) {
    vertices_ = polygon.local_vertices();
    for (Vec2& v : vertices_) v /= unit;
    for (int k = 0; k < polygon.rings(); ++k) {
      const size_t first = edges_.size();
      for (int i = polygon.ring_start(k); i < polygon.ring_start(k + 1); ++i) {
        const Vec2& end = vertices_[polygon.next(i)];
        // Two vertices that are equal in local coordinates have no edge between them.
        if (vertices_[i] != end) edges_.emplace_back(vertices_[i], end);
      }
      if (polygon.has_holes()) links_.add(static_cast<int>(edges_.size() - first));
      std::vector<Vec2> starts;
      for (size_t e = first; e < edges_.size(); ++e) starts.push_back(edges_[e].start);
      trees_.emplace_back(std::move(starts));
      ends_.push_back(polygon.ring_start(k + 1));
    }
    if (!beyond_) {
      for (const Triangle& t : triangulate(polygon)) {
        Cell cell{{vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]}, 0};
        cell.bound = corner_bound(cell);
        queue_.push_back(std::move(cell));
      }
      std::ranges::make_heap(queue_, lower);
    }
  }

  /// Returns false if the search was given up.
  bool run(const Progress& progress) {
    const size_t most = beyond_ ? kMostCells * edges_.size() : std::numeric_limits<size_t>::max();
    size_t report_at = 0;
    // The edges are shuffled, because highest_point is fast only if their order is random.
    std::vector<int> all(edges_.size());
    std::iota(all.begin(), all.end(), 0);
    std::mt19937 random;  // std::shuffle differs between standard libraries
    for (size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);

    if (beyond_) cover(box_of(vertices_), all);
    while (!queue_.empty() && queue_.front().bound >= radius_ - tolerance()) {
      std::ranges::pop_heap(queue_, lower);
      Cell cell = std::move(queue_.back());
      queue_.pop_back();
      if (cell.edges.empty()) {
        examine(std::move(cell), all);
      } else if (cell.bound - cell.height <= tolerance()) {
        found_.push_back({cell.point, cell.height});
      } else {
        split(cell);
      }
      if (examined_ > most) return false;
      if (progress && examined_ >= report_at) {
        progress({"inscribed circle", std::nullopt});
        report_at = examined_ + kCellsPerReport;
      }
    }
    return true;
  }

  [[nodiscard]] double radius() const { return radius_; }

  [[nodiscard]] std::vector<Centre> centres() {
    std::ranges::stable_sort(found_,
                             [](const Found& a, const Found& b) { return a.height > b.height; });
    const double same = kSamePlace * radius_ + 16 * tolerance();
    const Corridors corridors(edges_, trees_, 4 * tolerance());
    std::vector<Centre> centres;
    std::multimap<double, Vec2> isolated;  // by x
    std::vector<PolygonEdge> segments;
    const auto is_known = [&](const Vec2& p) {
      for (auto c = isolated.lower_bound(p.x() - same);
           c != isolated.end() && c->first <= p.x() + same; ++c) {
        if ((p - c->second).norm() <= same) return true;
      }
      return std::ranges::any_of(segments,
                                 [&](const PolygonEdge& s) { return s.distance(p) <= same; });
    };
    for (const Found& found : found_) {
      if (found.height < radius_ - tolerance()) break;
      if (is_known(found.point)) continue;
      Centre centre = corridors.longest(found.point, found.height - tolerance(), radius_);
      if ((centre.last - centre.first).norm() <= same) {
        centre = {found.point, found.point};
        isolated.emplace(found.point.x(), found.point);
      } else {
        segments.emplace_back(centre.first, centre.last);
      }
      centres.push_back(centre);
    }
    return centres;
  }

 private:
  struct Found {
    Vec2 point;
    double height;
  };

  static bool lower(const Cell& a, const Cell& b) { return a.bound < b.bound; }
  [[nodiscard]] double tolerance() const { return kSameRadius * radius_ + 4 * kNoise; }

  // Value of f at a point of the cell.
  [[nodiscard]] double height(const Cell& cell, const Vec2& point) const {
    double least = HUGE_VAL;
    for (const int e : cell.edges) least = std::min(least, edges_[e].distance(point));
    return least;
  }

  // Queues two triangles that cover a box, or its halves if it is long. `edges` include all that
  // are nearest to a point of the box.
  void cover(const Box& box, const std::vector<int>& edges) {
    const Vec2 a(box.x0, box.y0), b(box.x1, box.y0), c(box.x1, box.y1), d(box.x0, box.y1);
    const Vec2 sides = c - a;
    if (!(sides.maxCoeff() > kLong * sides.minCoeff())) {
      examine({{a, b, c}, HUGE_VAL}, edges);
      examine({{a, c, d}, HUGE_VAL}, edges);
      return;
    }
    const Vec2 middle = (a + c) / 2;
    const double reach = sides.norm() / 2 + kNoise;
    double least = HUGE_VAL;
    for (const int e : edges) least = std::min(least, edges_[e].distance(middle));
    std::vector<int> near;
    for (const int e : edges) {
      if (edges_[e].distance(middle) <= least + 2 * reach) near.push_back(e);
    }
    Box first = box, second = box;
    if (sides.x() > sides.y()) {
      first.x1 = second.x0 = middle.x();
    } else {
      first.y1 = second.y0 = middle.y();
    }
    cover(first, near);
    cover(second, near);
  }

  // Tells on which side of the edge, or of the vertex at its nearer end, a point lies: 1 inside, -1
  // outside, 0 if that cannot be told.
  [[nodiscard]] int side(int e, const Vec2& p) const {
    const PolygonEdge& edge = edges_[e];
    const Vec2 d = p - edge.start;
    const double along = edge.direction.dot(d);
    if (along > 0 && along < edge.length) return cross(edge.direction, d) > 0 ? 1 : -1;
    const int count = static_cast<int>(edges_.size());
    const RingLinks* const links = links_.after.empty() ? nullptr : &links_;
    const PolygonEdge& other =
        edges_[along <= 0 ? previous(links, e, count) : next(links, e, count)];
    const Vec2 arm = along <= 0 ? d : p - edge.end;
    const Vec2 sum = (edge.direction + other.direction).normalized();
    const double above = cross(sum, arm);
    return !(std::abs(above) > kAlongside * arm.norm()) ? 0 : above > 0 ? 1 : -1;
  }

  // True if a point is inside the polygon, where `edges` include all nearest ones, and `least` is
  // their distance. The nearest edge tells. If it does not, as at the two sides of a crack, the
  // whole outline is asked.
  [[nodiscard]] bool inside(const Vec2& p, const std::vector<int>& edges, double least) const {
    int sides = 0;
    int count = 0;
    for (const int e : edges) {
      if (edges_[e].distance(p) > least * (1 + kSameSide) + kNoise) continue;
      const int s = side(e, p);
      if (s == 0) return inside(p);
      sides += s;
      ++count;
    }
    return std::abs(sides) == count ? sides > 0 : inside(p);
  }

  // The same without knowledge of what is near.
  [[nodiscard]] bool inside(const Vec2& p) const {
    int first = 0;
    for (const int end : ends_) {
      const int side = side_of_ring(std::span(vertices_).subspan(first, end - first), p);
      if (first == 0 ? side <= 0 : side >= 0) return false;
      first = end;
    }
    return true;
  }

  // Bounds f in the cell from above and below, and queues the cell unless it is too low.
  void examine(Cell cell, const std::vector<int>& edges) {
    const Vec2 middle = (cell.corners[0] + cell.corners[1] + cell.corners[2]) / 3;
    double reach = 0;
    for (const Vec2& corner : cell.corners) reach = std::max(reach, (corner - middle).norm());
    reach += kNoise;
    distances_.clear();
    for (const int e : edges) distances_.push_back(edges_[e].distance(middle));
    const double least = *std::ranges::min_element(distances_);
    cell.bound = std::min(cell.bound, least + reach);
    ++examined_;
    if (cell.bound < radius_ - tolerance()) return;
    const bool clear = !beyond_ || least > reach;  // of the boundary
    const bool middle_inside = !beyond_ || inside(middle, edges, least);
    if (clear && !middle_inside) return;
    for (size_t i = 0; i < edges.size(); ++i) {
      if (distances_[i] <= cell.bound + reach) cell.edges.push_back(edges[i]);
    }
    if (beyond_ && cell.edges.size() > kLongList &&
        static_cast<double>(cell.edges.size()) < kSimilar * static_cast<double>(edges.size())) {
      cell.point = middle;
      cell.height = middle_inside ? least : 0;
      queue(std::move(cell));
      return;
    }

    planes_.clear();
    for (const int e : cell.edges) {
      planes_.emplace_back(edges_[e].distance(cell.corners[0]) - least,
                           edges_[e].distance(cell.corners[1]) - least,
                           edges_[e].distance(cell.corners[2]) - least);
    }
    const Summit summit = highest_point(planes_);
    cell.bound = std::min(cell.bound, least + summit.height + kNoise);
    if (cell.bound < radius_ - tolerance()) return;
    cell.point = cell.at(summit.place);
    cell.height = height(cell, cell.point);
    if (clear || inside(cell.point, cell.edges, cell.height)) {
      climb(cell, clear);
    } else {
      cell.height = 0;
    }
    queue(std::move(cell));
  }

  void queue(Cell cell) {
    radius_ = std::max(radius_, cell.height);
    queue_.push_back(std::move(cell));
    std::ranges::push_heap(queue_, lower);
  }

  // Improves the lower bound of a cell: moves its point upwards with the tangent planes. The cell
  // is `clear` if it lies inside the polygon.
  void climb(Cell& cell, bool clear) {
    constexpr int kSteps = 10;
    for (int step = 0; step < kSteps && cell.bound - cell.height > kNoise; ++step) {
      planes_.clear();
      for (const int e : cell.edges) {
        const auto [value, gradient] = edges_[e].distance_and_gradient(cell.point);
        const double above = value - cell.height;
        planes_.emplace_back(above + gradient.dot(cell.corners[0] - cell.point),
                             above + gradient.dot(cell.corners[1] - cell.point),
                             above + gradient.dot(cell.corners[2] - cell.point));
      }
      const Vec2 next = cell.at(highest_point(planes_).place);
      const double next_height = height(cell, next);
      if (!(next_height > cell.height)) return;
      if (!clear && !inside(next, cell.edges, next_height)) return;
      cell.point = next;
      cell.height = next_height;
    }
  }

  void split(const Cell& cell) {
    const int k = cell.longest();
    const Vec2& p = cell.corners[(k + 1) % 3];
    const Vec2& q = cell.corners[(k + 2) % 3];
    const Vec2 middle = (p + q) / 2;
    examine({{cell.corners[k], p, middle}, cell.bound}, cell.edges);
    examine({{cell.corners[k], middle, q}, cell.bound}, cell.edges);
  }

  bool beyond_;          // the cells may reach beyond the polygon
  size_t examined_ = 0;  // number of cells
  std::vector<Vec2> vertices_;
  std::vector<int> ends_;  // of the rings, in the list of vertices
  RingLinks links_;        // between the edges of a polygon with holes
  std::vector<PolygonEdge> edges_;
  std::vector<RingTree> trees_;  // of the edges of each ring
  std::vector<Cell> queue_;
  std::vector<Found> found_;
  double radius_ = 0;

  // Memory of examine and climb, kept between calls.
  std::vector<double> distances_;
  std::vector<Heights> planes_;
};

// The largest radius, and both ends of each segment of centres, which are equal for single ones.
struct FoundCircle {
  double radius;
  std::vector<Vec2> ends;
};

FoundCircle circle_of_few_edges(const Polygon& convex) {
  InscribedCircle circle = inscribed_circle(convex);
  if (circle.centres.size() == 1) circle.centres.push_back(circle.centres.front());
  return {circle.radius, std::move(circle.centres)};
}

FoundCircle searched_circle(const Polygon& polygon, const Progress& progress) {
  const double extent = bounding_box(polygon).extent();
  const double unit = std::exp2(std::ilogb(extent) + (std::ldexp(extent, -std::ilogb(extent)) > 1));
  using Start = Search::Start;
  Search search(polygon, unit,
                polygon.vertices().size() > kManyEdges ? Start::box : Start::triangles);
  if (!search.run(progress)) {
    search = Search(polygon, unit, Start::triangles);
    search.run(progress);
  }
  if (!(search.radius() > kSmallest)) {
    throw InvalidPolygon("is thinner than double precision resolves", 0);
  }
  FoundCircle found{search.radius() * unit, {}};
  for (const Centre& c : search.centres()) {
    found.ends.insert(found.ends.end(), {c.first * unit, c.last * unit});
  }
  return found;
}

}  // namespace

InscribedCircle largest_inscribed_circle(const Polygon& polygon, const Progress& progress) {
  const CanonicalPose pose(polygon);
  const bool few = polygon.size() <= kFewEdges && polygon.is_convex();
  FoundCircle found =
      few ? circle_of_few_edges(pose.polygon()) : searched_circle(pose.polygon(), progress);
  const std::vector<Vec2> ends = pose.back(std::move(found.ends));
  std::vector<Centre> placed;
  for (size_t i = 0; i < ends.size(); i += 2) {
    placed.push_back({ends[i], ends[i + 1]});
    if (precedes(placed.back().last, placed.back().first)) {
      std::swap(placed.back().first, placed.back().last);
    }
  }
  std::sort(placed.begin(), placed.end(),
            [](const Centre& a, const Centre& b) { return precedes(a.first, b.first); });
  InscribedCircle circle{found.radius, {}};
  for (const Centre& c : placed) {
    circle.centres.push_back(c.first);
    if (c.last != c.first) circle.centres.push_back(c.last);
  }
  return circle;
}

}  // namespace apothem
