#include "geometry/polygon/similar_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

// Units in the last place of the largest coordinate by which vertices of copies may differ: those
// of both polygons are rounded, after a rotation of a few roundings.
constexpr double kUlps = 16;
// Vertices that differ by more than this share of the polygon's size are never similar, however
// coarse the coordinates are.
constexpr double kMostDistant = 1e-11;
// Intervals of the logarithm of perimeter / size, and its error.
constexpr double kInterval = 1e-6, kError = 1e-9;
// Comparisons of vertices, per vertex, after which a polygon counts as an original. Only polygons
// that are nearly periodic need more than a few.
constexpr std::int64_t kMostComparisons = 256;

// a conj(b), as complex numbers.
Vec2 times_conjugate(const Vec2& a, const Vec2& b) {
  return {a.x() * b.x() + a.y() * b.y(), a.y() * b.x() - a.x() * b.y()};
}

Vec2 mirrored_if(bool mirrored, const Vec2& p) { return {p.x(), mirrored ? -p.y() : p.y()}; }

}  // namespace

SimilarShapes::Shape SimilarShapes::shape_of(const Polygon& polygon) {
  const Box box = bounding_box(polygon);
  double largest = 0;
  for (const double x : {box.x0, box.y0, box.x1, box.y1}) largest = std::max(largest, std::abs(x));
  Shape shape{-1,           polygon.local_vertices(),  Vec2::Zero(), 0, 0,
              box.extent(), kUlps * 0x1p-52 * largest, {},           {}};
  const int outer = polygon.ring_start(1);
  for (int i = outer; i < polygon.size(); ++i) {
    shape.hole_arms.push_back(shape.arms[i]);
    shape.hole_next.push_back(polygon.next(i) - outer);
    shape.perimeter += (shape.arms[i] - shape.arms[polygon.next(i)]).norm();
  }
  shape.arms.resize(static_cast<size_t>(outer));
  const double n = outer;
  for (const Vec2& v : shape.arms) shape.mean += v / n;
  double squares = 0;
  for (size_t i = 0; i < shape.arms.size(); ++i) {
    shape.perimeter += (shape.arms[i] - before(shape.arms, i)).norm();
  }
  for (Vec2& v : shape.arms) {
    v -= shape.mean;
    squares += v.squaredNorm();
  }
  for (Vec2& v : shape.hole_arms) v -= shape.mean;
  shape.size = std::sqrt(squares);
  return shape;
}

std::optional<Similarity> SimilarShapes::aligned(const Shape& from, const Shape& to, int first,
                                                 bool mirrored, double tolerance) {
  const int n = static_cast<int>(from.arms.size());
  const auto original = [&](int k) {
    const int i = mirrored ? first - k : first + k;
    return mirrored_if(mirrored, from.arms[i < 0 ? i + n : i >= n ? i - n : i]);
  };
  // The rotation that fits best in the sense of least squares.
  Vec2 turn = Vec2::Zero();
  double squares = 0;
  for (int k = 0; k < n; ++k) {
    const Vec2 p = original(k);
    turn += times_conjugate(to.arms[k], p);
    squares += p.squaredNorm();
  }
  turn /= squares;
  for (int k = 0; k < n; ++k) {
    const Vec2 p = original(k);
    const Vec2 image(turn.x() * p.x() - turn.y() * p.y(), turn.y() * p.x() + turn.x() * p.y());
    if (!((image - to.arms[k]).norm() <= tolerance)) return std::nullopt;
  }
  const int vertices = n + static_cast<int>(from.hole_arms.size());
  Similarity map{vertices, n, first, mirrored, turn, Vec2::Zero()};
  if (!from.hole_arms.empty() && !align_holes(from, to, tolerance, map)) return std::nullopt;
  map.shift = to.mean - map(from.mean);
  return map;
}

// Finds the images of the vertices of holes among those of the copy, and of the edges between them.
bool SimilarShapes::align_holes(const Shape& from, const Shape& to, double tolerance,
                                Similarity& map) {
  const int n = static_cast<int>(from.hole_arms.size());
  std::vector<int> order(to.hole_arms.size());  // of the copy's vertices, from left to right
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return to.hole_arms[i].x() < to.hole_arms[j].x(); });
  std::vector<int> images;
  std::vector<bool> taken(order.size());
  for (const Vec2& arm : from.hole_arms) {
    const Vec2 place = map(arm);
    auto found = std::partition_point(order.begin(), order.end(), [&](int i) {
      return to.hole_arms[i].x() < place.x() - tolerance;
    });
    while (found != order.end() && !((to.hole_arms[*found] - place).norm() <= tolerance)) {
      if (to.hole_arms[*found].x() > place.x() + tolerance) return false;
      ++found;
    }
    if (found == order.end() || taken[*found]) return false;
    taken[*found] = true;
    images.push_back(*found);
  }
  for (int i = 0; i < n; ++i) {
    const int end = from.hole_next[i];
    const int edge = map.mirrored ? images[end] : images[i];
    if (to.hole_next[edge] != (map.mirrored ? images[i] : images[end])) return false;
    map.hole_vertices.push_back(map.outer + images[i]);
    map.hole_edges.push_back(map.outer + edge);
  }
  return true;
}

std::optional<Similarity> SimilarShapes::similarity(const Shape& from, const Shape& to) {
  const double scale = to.size / from.size;
  const double tolerance = std::min(to.noise + scale * from.noise, kMostDistant * to.extent);
  const int n = static_cast<int>(from.arms.size());
  if (to.arms.size() != from.arms.size()) return std::nullopt;
  // The lengths of the arms tell soon that two polygons are not aligned.
  std::int64_t left = kMostComparisons * n;
  for (const bool mirrored : {false, true}) {
    for (int first = 0; first < n && left > 0; ++first) {
      int same = 0;
      for (int i = first; same < n; ++same, --left) {
        const double length = scale * from.arms[i].norm();
        if (!(std::abs(to.arms[same].norm() - length) <= 2 * tolerance)) break;
        i = mirrored ? (i == 0 ? n : i) - 1 : next(i, n);
      }
      --left;
      if (same < n) continue;
      if (auto map = aligned(from, to, first, mirrored, tolerance)) return map;
    }
  }
  return std::nullopt;
}

std::optional<SimilarShapes::Original> SimilarShapes::add(const Polygon& polygon) {
  Shape shape = shape_of(polygon);
  shape.index = count_++;
  const double kind = natural_logarithm(shape.perimeter / shape.size) / kInterval;
  const double error = kError / kInterval;
  const auto key = [&](double x) {
    return std::pair(polygon.size(), static_cast<std::int64_t>(std::floor(x)));
  };
  std::optional<std::pair<int, Similarity>> found;
  for (const auto& k : {key(kind - error), key(kind + error)}) {
    const auto members = by_kind_.find(k);
    if (members == by_kind_.end()) continue;
    for (const int i : members->second) {
      if (found && found->first <= i) break;
      if (auto map = similarity(originals_[i], shape)) {
        found = {i, *map};
        break;
      }
    }
  }
  if (found) return Original{originals_[found->first].index, found->second};
  const int number = static_cast<int>(originals_.size());
  by_kind_[key(kind)].push_back(number);
  originals_.push_back(std::move(shape));
  return std::nullopt;
}

}  // namespace apothem
