// The check of the laws that every straight skeleton has to obey before it is used.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/skeleton/edge_lines.hpp"
#include "geometry/skeleton/skeleton.hpp"
#include "geometry/spatial/ring_tree.hpp"

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;
using Node = Skeleton::Node;
using Faces = std::vector<std::vector<int>>;

constexpr double kTolerance = 1e-9;  // as a share of the polygon's size

class Laws {
 public:
  Laws(const Skeleton& skeleton, const Polygon& polygon)
      : skeleton_(skeleton),
        polygon_(polygon),
        ring_(polygon.local_vertices()),
        lines_(edge_lines(polygon)),
        size_(polygon.size()),
        tolerance_(kTolerance * bounding_box(polygon).extent()),
        area_(area_moments(polygon).area) {}

  std::optional<std::string> broken() {
    check_numbers();
    if (!broken_) check_outline();
    if (!broken_) check_arcs();
    if (!broken_) check_network();
    if (!broken_) check_heights();
    if (!broken_) check_faces();
    if (!broken_) check_valleys();
    if (!broken_) check_inside();
    return broken_;
  }

 private:
  void fail(const std::string& law) {
    if (!broken_) broken_ = law;
  }
  [[nodiscard]] bool is_node(int i) const {
    return i >= 0 && i < static_cast<int>(skeleton_.nodes.size());
  }
  [[nodiscard]] bool is_face(int i) const { return i >= 0 && i < size_; }
  [[nodiscard]] const Vec2& point(int node) const { return skeleton_.nodes[node].point; }

  void check_numbers() {
    for (const Node& node : skeleton_.nodes) {
      if (!is_finite(node.point) || !std::isfinite(node.height)) fail("a node is not finite");
    }
    double top = 0;
    for (const Node& node : skeleton_.nodes) top = std::max(top, node.height);
    if (skeleton_.roof_height != top) fail("the roof height is not that of the highest node");
    for (const Skeleton::Arc& arc : skeleton_.arcs) {
      if (!is_node(arc.start) || !is_node(arc.end) || !is_face(arc.left) || arc.right >= size_) {
        fail("an arc has an index out of range");
      }
    }
    for (const std::vector<int>& face : skeleton_.faces) {
      if (!std::all_of(face.begin(), face.end(), [&](int i) { return is_node(i); })) {
        fail("a face has an index out of range");
      }
    }
  }

  void check_outline() {
    const auto n = static_cast<size_t>(size_);
    if (skeleton_.faces.size() != n || skeleton_.nodes.size() <= n || skeleton_.arcs.size() <= n) {
      return fail("there are too few faces, nodes or arcs");
    }
    for (int e = 0; e < size_; ++e) {
      const Node& node = skeleton_.nodes[e];
      if (node.point != ring_[e] || node.height != 0) fail("a vertex of the polygon is not a node");
      const Skeleton::Arc& arc = skeleton_.arcs[e];
      if (arc.start != e || arc.end != polygon_.next(e) || arc.left != e || arc.right != -1) {
        fail("an edge of the polygon is not an arc");
      }
      const std::vector<int>& face = skeleton_.faces[e];
      if (face.size() < 3 || face[0] != e || face[1] != polygon_.next(e)) {
        fail("a face does not start with its own edge");
      }
    }
  }

  void check_arcs() {
    for (const Skeleton::Arc& arc : skeleton_.arcs) {
      bool fresh = left_of_.try_emplace({arc.start, arc.end}, arc.left).second;
      if (arc.right >= 0) {
        fresh = left_of_.try_emplace({arc.end, arc.start}, arc.right).second && fresh;
      }
      if (!fresh) fail("two arcs join the same nodes");
      if (arc.left == arc.right) fail("an arc has one face on both sides");
    }
    for (size_t a = static_cast<size_t>(size_); a < skeleton_.arcs.size(); ++a) {
      if (skeleton_.arcs[a].right < 0) fail("an arc lacks a face on one side");
    }
    size_t passed = 0;
    for (int f = 0; f < size_; ++f) {
      const std::vector<int>& face = skeleton_.faces[f];
      for (size_t i = 0; i < face.size(); ++i, ++passed) {
        const auto found = left_of_.find({face[i], after(face, i)});
        if (found == left_of_.end() || found->second != f) fail("a side of a face is not its arc");
      }
    }
    if (passed != left_of_.size()) fail("an arc is not a side of its faces");
  }

  // The inner arcs have as many independent cycles as the polygon has holes.
  void check_network() {
    const int holes = polygon_.rings() - 1;
    int cycles = 0;
    DisjointSets joined(skeleton_.nodes.size());
    for (size_t a = static_cast<size_t>(size_); a < skeleton_.arcs.size(); ++a) {
      if (!joined.join(skeleton_.arcs[a].start, skeleton_.arcs[a].end)) ++cycles;
    }
    if (cycles > holes) {
      fail(holes == 0 ? "the inner arcs contain a cycle"
                      : "the inner arcs contain more cycles than there are holes");
    }
    if (cycles < holes) fail("a hole is not surrounded by inner arcs");
    const size_t joining = skeleton_.arcs.size() - static_cast<size_t>(size_ + cycles);
    if (joining + 1 != skeleton_.nodes.size()) fail("the inner arcs do not reach every node");
  }

  void check_heights() {
    for (int f = 0; f < size_; ++f) {
      for (const int i : skeleton_.faces[f]) {
        const Node& node = skeleton_.nodes[i];
        if (!(node.height >= -tolerance_)) fail("a node has a negative height");
        if (!(std::abs(lines_[f].distance(node.point) - node.height) <= tolerance_)) {
          fail("the height of a node is not its distance to an edge whose face meets there");
        }
      }
    }
  }

  void check_faces() {
    double sum = 0;
    for (int f = 0; f < size_; ++f) {
      const double area = face_area(f);
      // A face may be so thin that its area consists of round-off.
      if (!(area >= -tolerance_ * lines_[f].length)) fail("a face has no positive area");
      sum += area;
      check_face(f);
    }
    if (!(std::abs(sum - area_) <= tolerance_ * tolerance_ / kTolerance)) {
      fail("the areas of the faces do not sum to the polygon's");
    }
  }

  [[nodiscard]] double face_area(int f) const {
    const std::vector<int>& face = skeleton_.faces[f];
    double twice = 0;
    for (size_t i = 2; i < face.size(); ++i) {
      twice += cross(point(face[i - 1]) - ring_[f], point(face[i]) - ring_[f]);
    }
    return twice / 2;
  }

  // Checks that face f is monotone along its edge, and that its upper chain lies above its lower
  // one. The border runs from the end of the edge to the rightmost node, above the edge back to the
  // leftmost node, and down to the start of the edge. A violation is weighted with the error that
  // it causes in the roof: where two edges are in line, the position of the arc between their faces
  // cannot be determined and does not matter.
  void check_face(int f) {
    const std::vector<int>& face = skeleton_.faces[f];
    const size_t n = face.size();
    std::vector<double> along(n + 1);
    std::vector<double> bends(n);
    for (size_t i = 0; i <= n; ++i) along[i] = lines_[f].along(point(face[i % n]));
    for (size_t i = 0; i < n; ++i) bends[i] = bend(f, face[i], after(face, i));
    const auto right = std::max_element(along.begin() + 1, along.end());
    const auto left = std::min_element(right, along.end());
    double error = 0;
    double slack = tolerance_;  // along the edge
    for (size_t i = 1; i < n; ++i) {
      const auto at = along.begin() + static_cast<std::ptrdiff_t>(i);
      const double sense = at >= right && at < left ? -1 : 1;
      const double back = std::max(0.0, sense * (along[i] - along[i + 1]));
      error += bends[i] * back;
      slack += back;
    }
    if (!(error <= tolerance_)) fail("a face is not monotone along its edge");
    const std::vector<size_t> order = sorted(along, n);
    for (size_t i = 0; i < n; ++i) {
      const Vec2& p = point(face[i]);
      const Vec2 side = point(after(face, i)) - p;
      const double length = side.norm();
      const double low = std::min(along[i], along[i + 1]) + slack;
      const double high = std::max(along[i], along[i + 1]) - slack;
      auto j = std::partition_point(order.begin(), order.end(),
                                    [&](size_t k) { return !(along[k] > low); });
      for (; j != order.end() && along[*j] < high; ++j) {
        if (!(bends[i] * cross(side, point(face[*j]) - p) >= -tolerance_ * length)) {
          fail("a face is folded over itself");
        }
      }
    }
  }

  // The indices 0 to n - 1 in ascending order of their values.
  static std::vector<size_t> sorted(const std::vector<double>& values, size_t n) {
    std::vector<size_t> order(n);
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return values[a] < values[b]; });
    return order;
  }

  // Change of the roof's gradient across the side of face f from node `start` to node `end`.
  [[nodiscard]] double bend(int f, int start, int end) const {
    const auto other = left_of_.find({end, start});
    if (other == left_of_.end()) return 1;  // outside
    return (lines_[f].tangent - lines_[other->second].tangent).norm();
  }

  // Checks that every valley starts at a vertex or continues another valley. Nodes that are joined
  // by short arcs count as one.
  void check_valleys() {
    const double shortest = 1000 * tolerance_;
    DisjointSets joined(skeleton_.nodes.size());
    for (const Skeleton::Arc& arc : skeleton_.arcs) {
      if ((point(arc.end) - point(arc.start)).norm() < shortest) {
        joined.join(arc.start, arc.end);
      }
    }
    std::vector<bool> fed(skeleton_.nodes.size());
    for (int v = 0; v < size_; ++v) fed[joined.find(v)] = true;
    for (const Valley& valley : valleys(0)) fed[joined.find(valley.upper)] = true;
    for (const Valley& valley : valleys(1e-6)) {
      if (valley.length > shortest && !fed[joined.find(valley.lower)]) {
        fail("a valley of the roof starts inside");
      }
    }
  }

  // A valley of the roof: an inner arc from which the roof rises on both sides.
  struct Valley {
    int lower, upper;  // nodes at its ends
    double length;
  };
  // All valleys across which the roof's gradient changes by more than `steepness`.
  [[nodiscard]] std::vector<Valley> valleys(double steepness) const {
    std::vector<Valley> result;
    for (const Skeleton::Arc& arc : skeleton_.arcs) {
      if (arc.right < 0) continue;
      const Vec2 along = point(arc.end) - point(arc.start);
      const double length = along.norm();
      const Vec2 bend = lines_[arc.left].normal() - lines_[arc.right].normal();
      if (!(cross(along, bend) > steepness * length)) continue;
      const bool rising = skeleton_.nodes[arc.start].height <= skeleton_.nodes[arc.end].height;
      result.push_back(rising ? Valley{arc.start, arc.end, length}
                              : Valley{arc.end, arc.start, length});
    }
    return result;
  }

  // Counts the edges that a ray to the right of each node crosses.
  void check_inside() {
    const std::vector<bool> near = near_their_edges();
    std::vector<RingTree> rings;
    for (int k = 0; k < polygon_.rings(); ++k) {
      rings.emplace_back(
          Ring(ring_.begin() + polygon_.ring_start(k), ring_.begin() + polygon_.ring_start(k + 1)));
    }
    for (size_t i = 0; i < skeleton_.nodes.size(); ++i) {
      const Vec2& p = skeleton_.nodes[i].point;
      const auto crossed = std::count_if(
          rings.begin(), rings.end(), [&](const RingTree& ring) { return ring.odd_crossings(p); });
      if (crossed % 2 == 0 && !near[i] && !near_outline(p)) fail("a node is outside the polygon");
    }
  }

  [[nodiscard]] double distance_to_edge(int e, const Vec2& p) const {
    const double along = std::clamp(lines_[e].along(p), 0.0, lines_[e].length);
    return (ring_[e] - p + along * lines_[e].tangent).norm();
  }
  [[nodiscard]] bool near_outline(const Vec2& p) const {
    for (int e = 0; e < size_; ++e) {
      if (distance_to_edge(e, p) <= tolerance_) return true;
    }
    return false;
  }
  // The nodes that lie within the tolerance of the edge of one of their faces.
  [[nodiscard]] std::vector<bool> near_their_edges() const {
    std::vector<bool> near(skeleton_.nodes.size());
    for (int f = 0; f < size_; ++f) {
      for (const int i : skeleton_.faces[f]) {
        if (!near[i]) near[i] = distance_to_edge(f, point(i)) <= tolerance_;
      }
    }
    return near;
  }

  const Skeleton& skeleton_;
  const Polygon& polygon_;
  Ring ring_;  // the vertices of all rings
  std::vector<EdgeLine> lines_;
  int size_;
  double tolerance_;
  double area_;
  std::map<std::pair<int, int>, int> left_of_;  // face on the left of each arc and of its reverse
  std::optional<std::string> broken_;
};

}  // namespace

std::optional<std::string> broken_law(const Skeleton& skeleton, const Polygon& polygon) {
  return Laws(skeleton, polygon).broken();
}

}  // namespace apothem
