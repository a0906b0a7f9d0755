#include "geometry/skeleton/skeleton.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/random_numbers.hpp"
#include "geometry/skeleton/convex_skeleton.hpp"
#include "geometry/skeleton/exact_front.hpp"
#include "geometry/skeleton/exact_nodes.hpp"
#include "geometry/skeleton/near_ties.hpp"
#include "geometry/skeleton/polish.hpp"
#include "geometry/skeleton/skeleton_search.hpp"
#include "geometry/skeleton/wavefront.hpp"

namespace apothem {
namespace {

using Node = Skeleton::Node;

// The rings as a polygon, if they are those of one, each in the right sense.
std::optional<Polygon> simple_polygon(const Rings& rings) {
  try {
    Polygon polygon(polygon_of_rings(rings));
    if (rings_of(polygon) == rings) return polygon;
  } catch (const InvalidPolygon&) {
  }
  return std::nullopt;
}

// The coordinates of the construction, with the polygon centred and scaled to the size 1. The scale
// is a power of two and the centre has few digits, so that the transformation is exact where
// possible.
struct Frame {
  Vec2 centre;
  double scale;
  std::optional<Polygon> outline;  // the polygon in these coordinates, if it is simple in them

  explicit Frame(const Polygon& polygon) {
    const Box box = bounding_box(polygon);
    scale = std::exp2(-std::ilogb(box.extent()));
    const double grid = std::ldexp(1 / scale, -8);
    centre = {grid * std::round((box.x0 + box.x1) / 2 / grid),
              grid * std::round((box.y0 + box.y1) / 2 / grid)};
    outline = simple_polygon(inward(polygon));
    if (outline) return;
    centre.setZero();
    outline = simple_polygon(inward(polygon));
  }

  [[nodiscard]] Rings inward(const Polygon& polygon) const {
    Rings rings = rings_of(polygon);
    for (std::vector<Vec2>& ring : rings) {
      for (Vec2& v : ring) v = (v - centre) * scale;
    }
    return rings;
  }

  void outward(Skeleton& skeleton, const Polygon& polygon) const {
    const Vec2 shift = centre - polygon.origin();
    for (Node& node : skeleton.nodes) {
      node.point = node.point / scale + shift;
      node.height /= scale;
    }
    const std::vector<Vec2> vertices = polygon.local_vertices();
    for (size_t i = 0; i < vertices.size(); ++i) skeleton.nodes[i] = {vertices[i], 0};
  }
};

// Polygons with more vertices than this start with the trace of a wavefront. It takes about n log n
// steps instead of CGAL's n^2. But where several arcs of a symmetric polygon meet in one point, it
// makes several nodes, and CGAL makes one.
constexpr int kMany = 64;
constexpr int kWavefrontAttempts = 3;

// Round-off of a construction without moved vertices, as a movement of them.
constexpr double kConstruction = 1e-13;

struct Attempt {
  double jitter;  // largest movement of a vertex, as a share of the polygon's size
  bool exact;     // whether CGAL uses exact constructions
};
constexpr Attempt kAttempts[] = {{0, false},     {1e-13, false}, {1e-12, false}, {0, true},
                                 {1e-11, false}, {1e-13, false}, {1e-12, false}, {1e-11, false},
                                 {1e-10, false}, {1e-12, true},  {1e-10, false}, {1e-9, false}};
// Simultaneous events, such as those of a regular star, cost CGAL 10 to 30 times as much time as
// others. It therefore gets polygons with more than kMany vertices with a jitter first, whose error
// the correction of the nodes removes.
constexpr Attempt kManySides = {1e-11, false};

Rings jittered(Rings rings, double amplitude, unsigned seed) {
  RandomNumbers numbers(seed);
  const auto random = [&] { return numbers.uniform(-1, 1); };
  for (std::vector<Vec2>& ring : rings) {
    const std::vector<Vec2> original = ring;
    for (size_t i = 0; i < ring.size(); ++i) {
      const double nearest = std::min((original[i] - before(original, i)).norm(),
                                      (original[i] - after(original, i)).norm());
      const double step = std::min(amplitude, nearest / 1000);
      ring[i] += step * Vec2(random(), random());
    }
  }
  return rings;
}

// Limit of processor time for CGAL, s. For a polygon without symmetry CGAL needs about n^2 steps.
// The limit is for loops without an end: it is hundreds of times what the construction takes, so
// that a slow machine finds no other skeleton.
double time_limit(size_t n, bool exact) {
  constexpr double kLongest = 600;
  const double thousands = static_cast<double>(n) / 1000;
  return (exact ? 4 : 1) * std::min(kLongest, 4 + 60 * thousands * thousands);
}

std::string describe(const std::vector<std::string>& failures) {
  std::map<std::string, int> counts;
  for (const std::string& failure : failures) ++counts[failure];
  std::string text;
  for (const auto& [failure, count] : counts) {
    text += (text.empty() ? "" : "; ") + failure + " (" + std::to_string(count) + " times)";
  }
  return text;
}

// The search for a skeleton that passes the laws.
class Search {
 public:
  Search(const Polygon& polygon, std::optional<CgalAnswer> first_answer, const Progress& progress)
      : polygon_(polygon),
        progress_(progress),
        frame_(polygon),
        rings_(frame_.inward(polygon)),
        first_answer_(std::move(first_answer)) {}

  // What CGAL is asked first, if the search begins with CGAL.
  [[nodiscard]] std::optional<FirstQuestion> first_question() const {
    if (polygon_.size() > kMany || polygon_.is_convex() || !simple_polygon(rings_)) {
      return std::nullopt;
    }
    return FirstQuestion{rings_, time_limit(polygon_.vertices().size(), kAttempts[0].exact)};
  }

  Skeleton run() {
    if (polygon_.is_convex() && try_convex()) return std::move(found_);
    if (polygon_.size() > kMany) {
      for (int i = 0; i < kWavefrontAttempts; ++i) {
        if (try_wavefront(i)) return std::move(found_);
      }
      if (try_cgal(kManySides)) return std::move(found_);
    }
    for (const Attempt& attempt : kAttempts) {
      if (try_cgal(attempt)) return std::move(found_);
    }
    throw SkeletonFailure("no valid straight skeleton of this polygon with " +
                          std::to_string(polygon_.size()) + " vertices in " +
                          std::to_string(failures_.size()) + " attempts: " + describe(failures_) +
                          ". Remove details smaller than 1e-9 of the polygon's size, or choose the "
                          "field 'distance', which needs no skeleton");
  }

 private:
  bool try_convex() {
    found_ = assemble(shrink_convex(polygon_), polygon_);
    movement_ = kConstruction;
    return passes() && settled();
  }

  // Each attempt moves the vertices in other directions.
  bool try_wavefront(int attempt) {
    if (!frame_.outline) return fail("the outline is not simple in scaled coordinates");
    std::optional<SkeletonParts> parts = trace_wavefront(*frame_.outline, attempt + 1, progress_);
    if (!parts) return fail("the wavefront was not traced to its end");
    found_ = assemble(std::move(*parts), polygon_);
    movement_ = kWavefrontMovement;
    return corrected();
  }

  bool try_cgal(const Attempt& attempt) {
    const Rings input = jittered(rings_, attempt.jitter, ++seed_);
    if (!simple_polygon(input)) return fail("the outline is not simple in scaled coordinates");
    CgalAnswer answer =
        first_answer_ ? std::move(*first_answer_)
                      : ask_cgal(input, attempt.exact,
                                 time_limit(polygon_.vertices().size(), attempt.exact), progress_);
    first_answer_.reset();
    if (!answer.parts) return fail(answer.failure);
    found_ = assemble(std::move(*answer.parts), polygon_);
    found_.exact = attempt.exact;
    movement_ = std::max(attempt.jitter, kConstruction);
    return corrected();
  }

  bool corrected() {
    frame_.outward(found_, polygon_);
    polish(found_, polygon_);
    return passes() && settled();
  }

  // Gives the nodes the places that follow from the polygon as it is, rounded once. Where events
  // may have coincided, the skeleton is constructed once more, exactly; there the one that was
  // found may depend on how the edges are numbered. If neither obeys the laws, the one that was
  // found is kept.
  bool settled() {
    Skeleton found = found_;
    if (!has_near_ties(found_, polygon_, movement_) && place_exactly(found_, polygon_) &&
        !broken_law(found_, polygon_)) {
      return true;
    }
    if (std::optional<SkeletonParts> parts = exact_skeleton(polygon_, progress_)) {
      found_ = assemble(std::move(*parts), polygon_);
      found_.attempts = found.attempts;
      found_.exact = true;
      if (!broken_law(found_, polygon_)) return true;
    }
    found_ = std::move(found);
    return true;
  }

  bool passes() {
    found_.attempts = static_cast<int>(failures_.size()) + 1;
    if (progress_) progress_({"check of the skeleton", 0});
    const std::optional<std::string> broken = broken_law(found_, polygon_);
    return !broken || fail(*broken);
  }

  bool fail(const std::string& reason) {
    failures_.push_back(reason);
    return false;
  }

  const Polygon& polygon_;
  const Progress& progress_;
  Frame frame_;
  Rings rings_;  // in the frame's coordinates
  std::optional<CgalAnswer> first_answer_;
  unsigned seed_ = 0;
  double movement_ = 0;  // of the vertices when found_ was made, as a share of the polygon's size
  std::vector<std::string> failures_;
  Skeleton found_;
};

}  // namespace

void require_few_vertices(std::size_t vertices) {
  if (vertices <= static_cast<std::size_t>(kMostVertices)) return;
  throw InvalidPolygon(
      "has " + std::to_string(vertices) + " vertices, and straight skeletons are limited to " +
          std::to_string(kMostVertices) + ": simplify the outline, or divide the polygon",
      kMostVertices);
}

Skeleton straight_skeleton(const Polygon& polygon, const Progress& progress) {
  return straight_skeleton(polygon, std::nullopt, progress);
}

std::optional<FirstQuestion> first_question(const Polygon& polygon) {
  if (polygon.size() > kMany) return std::nullopt;
  return Search(polygon, std::nullopt, {}).first_question();
}

Skeleton straight_skeleton(const Polygon& polygon, std::optional<CgalAnswer> first_answer,
                           const Progress& progress) {
  require_few_vertices(polygon.vertices().size());
  return Search(polygon, std::move(first_answer), progress).run();
}

}  // namespace apothem
