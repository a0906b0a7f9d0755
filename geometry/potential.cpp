#include "geometry/potential.hpp"

#include <cmath>

namespace apothem {
namespace {

// Two values of the envelope closer than this (relative) are one height: the centre of a
// rectangle's incircle is a segment although round-off tells its ends apart.
constexpr double kSameHeight = 1e-14;
constexpr double kSameDirection = 1e-15;

void require_convex(const Polygon& polygon) {
  if (const auto reflex = polygon.first_reflex_vertex()) {
    const int i = polygon.input_index(*reflex);
    throw InvalidPolygon("vertex " + std::to_string(i) +
                             " is reflex (interior angle above 180 degrees): contact needs convex "
                             "polygons; split the body into convex ones",
                         i);
  }
}

// Inward normals of unit length, from differences of the input coordinates.
std::vector<Vec2> inward_normals(const Polygon& polygon) {
  std::vector<Vec2> normals(polygon.size());
  for (int i = 0; i < polygon.size(); ++i) {
    const Vec2 d = polygon.after(i) - polygon[i];
    normals[i] = Vec2(-d.y(), d.x()) / std::hypot(d.x(), d.y());
  }
  return normals;
}

// Lower envelope of the lines L_i(x) = g_i . (x - p_i) of a convex polygon, by shrinking: edge j
// with neighbours i and k vanishes at the height where the three lines agree. For a convex polygon
// this is the straight skeleton (weighted, if the |g_i| differ). Simultaneous events give ridges of
// length 0.
class Envelope {
 public:
  Envelope(const std::vector<Vec2>& p, const std::vector<Vec2>& g) : p_(p), g_(g) {
    link();
    while (count_ > 2) collapse(lowest());
    // Two edges are left: their last ridge joins the two nodes between them, the higher one last.
    const int i = first_;
    const bool rises = node_[i].value <= node_[next_[i]].value;
    add_ridge(i, next_[i], node_[rises ? i : next_[i]], node_[rises ? next_[i] : i]);
    find_top();
  }

  std::vector<Ridge> ridges;
  double top = 0;
  std::vector<Vec2> top_points;

 private:
  struct Node {
    Vec2 point;
    double value;
  };

  // True when the boundary goes straight on from edge e to edge f (or turns by less than
  // round-off).
  [[nodiscard]] bool straight_on(int e, int f) const {
    return g_[e].dot(g_[f]) > 0 &&
           cross(g_[e], g_[f]) <= kSameDirection * g_[e].norm() * g_[f].norm();
  }

  // Circular list of the edges that are left; node_[j] is where edge j starts, collapse_[j] when
  // and where it vanishes. Edges that go straight on share one face.
  void link() {
    const int n = static_cast<int>(g_.size());
    next_.assign(n, -1);
    previous_.assign(n, -1);
    node_.resize(n);
    collapse_.resize(n);
    int start = 0;
    while (start < n && straight_on((start + n - 1) % n, start)) ++start;
    std::vector<int> kept;
    for (int k = 0; k < n && start < n; ++k) {
      const int j = (start + k) % n;
      if (kept.empty() || !straight_on(kept.back(), j)) kept.push_back(j);
    }
    count_ = static_cast<int>(kept.size());
    if (count_ < 3) throw InvalidPolygon("is thinner than double precision resolves", 0);
    for (int k = 0; k < count_; ++k) {
      const int j = kept[k];
      next_[j] = kept[(k + 1) % count_];
      previous_[next_[j]] = j;
      node_[j] = {p_[j], 0};
    }
    first_ = kept.front();
    for (const int j : kept) collapse_[j] = meeting_point(j);
  }

  // Where L_i = L_j = L_k for the neighbours i and k of j. Heights are taken from a point of edge
  // j, where they are all non-negative: the weighted mean has no cancellation.
  [[nodiscard]] Node meeting_point(int j) const {
    const int i = previous_[j];
    const int k = next_[j];
    const double weight_i = cross(g_[j], g_[k]);
    const double weight_k = cross(g_[i], g_[j]);
    const double sum = cross(g_[j] - g_[i], g_[k] - g_[i]);
    const double height_i = g_[i].dot(p_[j] - p_[i]);
    const double height_k = g_[k].dot(p_[j] - p_[k]);
    const double value = (weight_i * height_i + weight_k * height_k) / sum;
    // Along edge j from the neighbour that crosses it at the larger angle.
    const bool use_i = weight_k > weight_i;
    const int e = use_i ? i : k;
    const Vec2 tangent(g_[j].y(), -g_[j].x());
    const Vec2 rise = g_[j] * (value / g_[j].squaredNorm());
    const double along =
        (value - (use_i ? height_i : height_k) - g_[e].dot(rise)) / g_[e].dot(tangent);
    return {p_[j] + rise + along * tangent, value};
  }

  [[nodiscard]] int lowest() const {
    int best = first_;
    for (int j = next_[first_]; j != first_; j = next_[j]) {
      if (collapse_[j].value < collapse_[best].value) best = j;
    }
    return best;
  }

  void collapse(int j) {
    const int i = previous_[j];
    const int k = next_[j];
    const Node node = collapse_[j];
    add_ridge(i, j, node_[j], node);
    add_ridge(j, k, node_[k], node);
    next_[i] = k;
    previous_[k] = i;
    node_[k] = node;
    first_ = k;
    if (--count_ > 2) {
      collapse_[i] = meeting_point(i);
      collapse_[k] = meeting_point(k);
    }
  }

  void add_ridge(int e, int f, const Node& start, const Node& end) {
    const Vec2 jump = g_[e] - g_[f];
    const double size = jump.norm();
    if (size == 0) return;
    const Vec2 difference = g_[e] / g_[e].squaredNorm() - g_[f] / g_[f].squaredNorm();
    const double length = (end.point - start.point).norm();
    ridges.push_back(
        {start.point, end.point, start.value, end.value, length * difference.dot(jump) / size});
  }

  // The maximum is attained at a point, or along one ridge between two parallel edges.
  void find_top() {
    const Ridge* highest = &ridges.front();
    for (const Ridge& r : ridges) {
      if (r.end_value > highest->end_value) highest = &r;
    }
    top = highest->end_value;
    const auto length = [](const Ridge& r) { return (r.end - r.start).norm(); };
    const Ridge* level = nullptr;
    for (const Ridge& r : ridges) {
      const bool is_level = std::min(r.start_value, r.end_value) >= top * (1 - kSameHeight);
      if (is_level && length(r) * g_[first_].norm() > kSameHeight * top &&
          (!level || length(r) > length(*level))) {
        level = &r;
      }
    }
    if (level) {
      top_points = {level->start, level->end};
    } else {
      top_points = {highest->end};
    }
  }

  const std::vector<Vec2>& p_;
  const std::vector<Vec2>& g_;
  std::vector<int> next_, previous_;
  std::vector<Node> node_, collapse_;
  int first_ = 0;
  int count_ = 0;
};

void scale(Potential& potential, double factor) {
  for (Vec2& g : potential.gradients) g *= factor;
  for (Ridge& ridge : potential.ridges) {
    ridge.start_value *= factor;
    ridge.end_value *= factor;
    ridge.weight /= factor;
  }
  potential.top *= factor;
}

Potential envelope_potential(const Polygon& polygon, std::vector<Vec2> gradients) {
  Potential potential;
  potential.vertices = polygon.local_vertices();
  potential.gradients = std::move(gradients);
  Envelope envelope(potential.vertices, potential.gradients);
  potential.ridges = std::move(envelope.ridges);
  potential.top = envelope.top;
  potential.top_points = std::move(envelope.top_points);
  if (!(potential.top > 0) || !std::isfinite(potential.top)) {
    throw InvalidPolygon("is thinner than double precision resolves", 0);
  }
  return potential;
}

Potential distance_potential(const Polygon& polygon, const PotentialChoice& choice) {
  require_convex(polygon);
  Potential potential = envelope_potential(polygon, inward_normals(polygon));
  const double inradius = potential.top;
  if (choice.reference == PotentialChoice::Reference::length) {
    scale(potential, 1 / choice.length);
    potential.steepest = 1 / choice.length;
  } else {
    scale(potential, 1 / inradius);
    potential.top = 1;
    potential.steepest = 1 / inradius;
  }
  return potential;
}

Potential area_potential(const Polygon& polygon) {
  if (polygon.size() != 3) {
    throw InvalidPolygon("has " + std::to_string(polygon.size()) +
                             " vertices: the area potential is defined for triangles only (use the "
                             "distance potential)",
                         3);
  }
  const double area = area_moments(polygon).area;
  std::vector<Vec2> gradients(3);
  double steepest = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec2 d = polygon.after(i) - polygon[i];
    gradients[i] = Vec2(-d.y(), d.x()) * (1.5 / area);  // slope 3 / altitude
    steepest = std::max(steepest, gradients[i].norm());
  }
  Potential potential = envelope_potential(polygon, std::move(gradients));
  potential.top = 1;  // at the centroid, where the three areas agree
  potential.steepest = steepest;
  return potential;
}

}  // namespace

InscribedCircle inscribed_circle(const Polygon& polygon) {
  require_convex(polygon);
  Potential potential = envelope_potential(polygon, inward_normals(polygon));
  return {potential.top, std::move(potential.top_points)};
}

Potential make_potential(const Polygon& polygon, const PotentialChoice& choice) {
  return choice.kind == PotentialChoice::Kind::area ? area_potential(polygon)
                                                    : distance_potential(polygon, choice);
}

Potential translated(Potential potential, const Vec2& shift) {
  for (Vec2& v : potential.vertices) v -= shift;
  for (Vec2& v : potential.top_points) v -= shift;
  for (Ridge& ridge : potential.ridges) {
    ridge.start -= shift;
    ridge.end -= shift;
  }
  return potential;
}

}  // namespace apothem
