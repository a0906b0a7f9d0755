#include "apothem/geometry/skeleton/skeleton.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/create_straight_skeleton_2.h>

#include <Eigen/QR>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <tuple>

#include "apothem/geometry/skeleton/child_process.hpp"
#include "apothem/geometry/skeleton/edge_lines.hpp"

// CGAL orders events of equal rank by their addresses in memory, so the skeleton of a symmetric
// polygon would depend on what the program did before. This overload of the comparison replaces
// that order by one of edge indices.
namespace CGAL::CGAL_SS_i {

template <class Skeleton, class Traits>
bool operator<(const boost::intrusive_ptr<Event_2<Skeleton, Traits>>& a,
               const boost::intrusive_ptr<Event_2<Skeleton, Traits>>& b) {
  const auto rank = [](const Event_2<Skeleton, Traits>& event) {
    const auto id = [](const auto& edge) { return handle_assigned(edge) ? edge->id() : -1; };
    const auto& edges = event.triedge();
    return std::tuple(static_cast<int>(event.type()), id(edges.e0()), id(edges.e1()),
                      id(edges.e2()));
  };
  return rank(*a) < rank(*b);
}

}  // namespace CGAL::CGAL_SS_i

namespace apothem {
namespace {

using Ring = std::vector<Vec2>;
using Node = Skeleton::Node;
using Faces = std::vector<std::vector<int>>;

int next(int i, int n) { return i + 1 == n ? 0 : i + 1; }

// ------------------------------------------------------------------------------------------------
// Assembly of a skeleton from its nodes and faces

// Derives the arcs from the faces. Where two faces do not fit together, the result is an arc that
// breaks a law.
void set_arcs(Skeleton& skeleton) {
  const int n = static_cast<int>(skeleton.faces.size());
  std::map<std::pair<int, int>, int> face_of;
  for (int f = 0; f < n; ++f) {
    const std::vector<int>& face = skeleton.faces[f];
    for (size_t i = 0; i < face.size(); ++i) {
      face_of[{face[i], face[i + 1 == face.size() ? 0 : i + 1]}] = f;
    }
  }
  for (int e = 0; e < n; ++e) skeleton.arcs.push_back({e, next(e, n), e, -1});
  for (const auto& [ends, face] : face_of) {
    const auto [start, end] = ends;
    if (face < n && start == face && end == next(face, n)) continue;
    const auto opposite = face_of.find({end, start});
    const int right = opposite == face_of.end() ? -1 : opposite->second;
    if (right < 0 || start < end) skeleton.arcs.push_back({start, end, face, right});
  }
}

Skeleton assemble(std::vector<Node> nodes, Faces faces) {
  Skeleton skeleton;
  skeleton.nodes = std::move(nodes);
  skeleton.faces = std::move(faces);
  set_arcs(skeleton);
  for (const Node& node : skeleton.nodes) {
    skeleton.roof_height = std::max(skeleton.roof_height, node.height);
  }
  return skeleton;
}

// ------------------------------------------------------------------------------------------------
// Convex polygons

// Builds the skeleton of a convex polygon: the edge of the front that vanishes first is removed
// until three edges are left. All nodes are computed from the lines of the original edges, so a
// wrong order of nearly simultaneous events does no harm. Among simultaneous events, which occur
// along a ridge of constant height, the one with the shortest new arcs comes first.

class ConvexShrink {
 public:
  explicit ConvexShrink(const Polygon& polygon)
      : ring_(polygon.local_vertices()),
        lines_(edge_lines(polygon)),
        size_(polygon.size()),
        simultaneous_(1e-13 * bounding_box(polygon).extent()),
        previous_(size_),
        next_(size_),
        left_(size_),
        right_(size_),
        events_(size_) {
    for (const Vec2& v : ring_) nodes_.push_back({v, 0});
    for (int e = 0; e < size_; ++e) {
      next_[e] = next(e, size_);
      previous_[next_[e]] = e;
    }
    for (int e = 0; e < size_; ++e) events_[e] = collapse(e);
  }

  Skeleton run() {
    std::vector<int> front(size_);
    std::iota(front.begin(), front.end(), 0);
    while (front.size() > 3) {
      const auto first = first_event(front);
      take_out(*first);
      front.erase(first);
    }
    const auto best = std::max_element(front.begin(), front.end(), [&](int e, int f) {
      return events_[e].conditioning < events_[f].conditioning;
    });
    const int top = add_node(events_[*best]);
    for (const int e : front) right_[e].push_back(top);
    return assemble(std::move(nodes_), faces());
  }

 private:
  // The point at which an edge of the front vanishes.
  struct Event {
    Vec2 point;           // relative to polygon.origin(), m
    double height;        // height of the roof there, m; infinite if the edge does not vanish
    double conditioning;  // determinant of the bisectors; the larger, the more exact is the point
  };

  [[nodiscard]] std::vector<int>::iterator first_event(std::vector<int>& front) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (const int e : front) lowest = std::min(lowest, events_[e].height);
    auto first = front.end();
    double shortest = std::numeric_limits<double>::infinity();
    for (auto e = front.begin(); e != front.end(); ++e) {
      if (!(events_[*e].height <= lowest + simultaneous_)) continue;
      const double way = way_to(*e);
      if (first == front.end() || way < shortest) {
        first = e;
        shortest = way;
      }
    }
    return first;
  }

  // Total length of the two arcs on which the ends of a front edge travel to the point at which
  // they meet.
  [[nodiscard]] double way_to(int e) const {
    const int left = left_[e].empty() ? e : left_[e].back();
    const int right = right_[e].empty() ? next(e, size_) : right_[e].back();
    const Vec2& point = events_[e].point;
    return (nodes_[left].point - point).norm() + (nodes_[right].point - point).norm();
  }

  // Bisector of edge e and its neighbour f in the front, seen from the end point of e. At the
  // height t it has moved by (t rise - gap) / run along e, away from this end point. `rise` is
  // written without a difference that would cancel for a small angle between the edges.
  struct Bisector {
    double run, rise, gap;
  };
  [[nodiscard]] Bisector bisector(int e, int f, double turn, double gap) const {
    const double rise = (lines_[e].tangent - lines_[f].tangent).squaredNorm() / 2;
    const double norm = std::hypot(turn, rise);
    if (!(norm > 0)) return {1, 0, 0};  // straight on
    return {turn / norm, rise / norm, gap / norm};
  }

  // The event at which edge e vanishes between its present neighbours in the front.
  [[nodiscard]] Event collapse(int e) const {
    const int p = previous_[e];
    const int q = next_[e];
    const EdgeLine &line = lines_[e], &before = lines_[p], &after = lines_[q];
    const Vec2& end = ring_[next(e, size_)];
    const Bisector a = bisector(e, p, cross(before.tangent, line.tangent),
                                cross(before.tangent, line.start - ring_[next(p, size_)]));
    const Bisector b =
        bisector(e, q, cross(line.tangent, after.tangent), cross(after.tangent, end - after.start));
    const double determinant = a.run * b.rise + b.run * a.rise;
    const double reach = line.length * b.run + b.gap;
    const double height = (a.run * reach + b.run * a.gap) / determinant;
    const double along = (a.rise * reach - b.rise * a.gap) / determinant;
    if (!(determinant > 0)) return {line.start, std::numeric_limits<double>::infinity(), 0};
    return {line.start + along * line.tangent + height * line.normal(), height, determinant};
  }

  int add_node(const Event& event) {
    nodes_.push_back({event.point, event.height});
    return static_cast<int>(nodes_.size()) - 1;
  }

  // Removes the vanishing edge e from the front.
  void take_out(int e) {
    const int node = add_node(events_[e]);
    const int p = previous_[e];
    const int q = next_[e];
    right_[e].push_back(node);
    right_[p].push_back(node);
    left_[q].push_back(node);
    next_[p] = q;
    previous_[q] = p;
    events_[p] = collapse(p);
    events_[q] = collapse(q);
  }

  [[nodiscard]] Faces faces() const {
    Faces result(size_);
    for (int e = 0; e < size_; ++e) {
      result[e] = {e, next(e, size_)};
      result[e].insert(result[e].end(), right_[e].begin(), right_[e].end());
      result[e].insert(result[e].end(), left_[e].rbegin(), left_[e].rend());
    }
    return result;
  }

  Ring ring_;
  std::vector<EdgeLine> lines_;
  int size_;
  double simultaneous_;               // heights that differ by no more are simultaneous, m
  std::vector<int> previous_, next_;  // neighbours of each edge in the shrinking front
  Faces left_, right_;                // nodes on the two sides of each face, from below
  std::vector<Event> events_;         // per edge of the front
  std::vector<Node> nodes_;
};

// ------------------------------------------------------------------------------------------------
// CGAL, in a child process

// The numbers that are sent through the pipe: the number n of faces; the number of nodes; three
// numbers per node (x, y, height); then for every face the number of its nodes and their indices.
// An empty message means that CGAL found no skeleton.
using Message = std::vector<double>;

template <class Kernel>
Message cgal_skeleton(const Ring& ring) {
  using Point = typename Kernel::Point_2;
  std::vector<Point> points;
  std::map<std::pair<double, double>, int> index;  // of the vertex with these coordinates
  for (const Vec2& v : ring) {
    index[{v.x(), v.y()}] = static_cast<int>(points.size());
    points.emplace_back(v.x(), v.y());
  }
  const auto skeleton =
      CGAL::create_interior_straight_skeleton_2(points.begin(), points.end(), Kernel());
  if (!skeleton) return {};

  const size_t n = ring.size();
  std::map<int, int> node_of;  // from CGAL's vertex id to the node
  std::vector<Node> nodes;
  for (const Vec2& v : ring) nodes.push_back({v, 0});
  for (auto v = skeleton->vertices_begin(); v != skeleton->vertices_end(); ++v) {
    const Vec2 p(CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y()));
    if (v->is_contour()) {
      const auto found = index.find({p.x(), p.y()});
      if (found == index.end()) return {};
      node_of[v->id()] = found->second;
    } else {
      node_of[v->id()] = static_cast<int>(nodes.size());
      nodes.push_back({p, CGAL::to_double(v->time())});
    }
  }
  Faces faces(n);
  for (auto f = skeleton->faces_begin(); f != skeleton->faces_end(); ++f) {
    const auto contour = f->halfedge()->defining_contour_edge();
    std::vector<int> face;
    auto h = contour;
    do {
      face.push_back(node_of[h->opposite()->vertex()->id()]);
      h = h->next();
    } while (h != contour && face.size() <= nodes.size());
    if (face[0] < static_cast<int>(n)) faces[face[0]] = face;
  }

  Message message{static_cast<double>(n), static_cast<double>(nodes.size())};
  for (const Node& node : nodes) {
    message.insert(message.end(), {node.point.x(), node.point.y(), node.height});
  }
  for (const std::vector<int>& face : faces) {
    message.push_back(static_cast<double>(face.size()));
    message.insert(message.end(), face.begin(), face.end());
  }
  return message;
}

struct Answer {
  Message message;
  std::string failure;  // empty if there is a message
};

Answer ask_cgal(const Ring& ring, bool exact, double seconds) {
  ChildAnswer answer = run_in_child(
      [&](const SendNumbers& send) {
        send(exact ? cgal_skeleton<CGAL::Exact_predicates_exact_constructions_kernel>(ring)
                   : cgal_skeleton<CGAL::Exact_predicates_inexact_constructions_kernel>(ring));
      },
      seconds);
  if (const std::string failure = answer.failure(); !failure.empty())
    return {{}, "CGAL " + failure};
  if (answer.numbers.empty()) return {{}, "CGAL found no skeleton"};
  return {std::move(answer.numbers), ""};
}

// Builds the skeleton from a message. Returns nothing if the message is incomplete.
std::optional<Skeleton> decode(const Message& message) {
  size_t at = 0;
  const auto take = [&] { return at < message.size() ? message[at++] : (++at, 0.0); };
  const auto n = static_cast<size_t>(take());
  const auto node_count = static_cast<size_t>(take());
  if (message.size() < 2 + 3 * node_count + n) return std::nullopt;
  std::vector<Node> nodes(node_count);
  for (Node& node : nodes) {
    node.point.x() = take();
    node.point.y() = take();
    node.height = take();
  }
  Faces faces(n);
  for (std::vector<int>& face : faces) {
    for (auto left = static_cast<size_t>(take()); left > 0 && at < message.size(); --left) {
      face.push_back(static_cast<int>(take()));
    }
  }
  if (at != message.size()) return std::nullopt;
  return assemble(std::move(nodes), std::move(faces));
}

// ------------------------------------------------------------------------------------------------
// Correction of the nodes

// Moves every inner node by the shortest way onto the planes of its faces. This removes the errors
// of CGAL's arithmetic and of the jitter. In directions that the planes do not determine, nodes are
// not moved.
class Polish {
 public:
  Polish(Skeleton& skeleton, const Polygon& polygon)
      : skeleton_(skeleton), lines_(edge_lines(polygon)), faces_at_(skeleton.nodes.size()) {
    const int node_count = static_cast<int>(skeleton.nodes.size());
    for (size_t f = 0; f < skeleton.faces.size(); ++f) {
      for (const int node : skeleton.faces[f]) {
        if (node >= 0 && node < node_count) faces_at_[node].push_back(static_cast<int>(f));
      }
    }
  }

  void run() {
    skeleton_.roof_height = 0;
    for (size_t i = lines_.size(); i < skeleton_.nodes.size(); ++i) {
      for (int round = 0; round < 2; ++round) improve(skeleton_.nodes[i], faces_at_[i]);
      skeleton_.roof_height = std::max(skeleton_.roof_height, skeleton_.nodes[i].height);
    }
  }

 private:
  void improve(Node& node, const std::vector<int>& faces) {
    rows_.clear();
    off_.clear();
    for (const int f : faces) {
      const EdgeLine& line = lines_[f];
      add({line.normal().x(), line.normal().y(), -1}, line.distance(node.point) - node.height);
      const int g = next(f, static_cast<int>(lines_.size()));
      if (std::find(faces.begin(), faces.end(), g) != faces.end()) add_bisector(f, g, node.point);
    }
    const auto count = static_cast<Eigen::Index>(off_.size());
    const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> rows(rows_.data(), 3, count);
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, Eigen::Dynamic, 3>> solver;
    solver.setThreshold(1e-7);
    solver.compute(rows.transpose());
    const Eigen::Vector3d step =
        solver.solve(Eigen::Map<const Eigen::VectorXd>(off_.data(), count));
    node.point -= step.head<2>();
    node.height -= step[2];
  }

  // Adds the bisector of the neighbouring edges f and g as a vertical plane through the vertex
  // between them. If the two edges are nearly in line, their planes hardly determine where their
  // bisector is, but the vertex does.
  void add_bisector(int f, int g, const Vec2& point) {
    if (!(lines_[f].tangent.dot(lines_[g].tangent) > 0)) return;
    const Vec2 across = (lines_[f].tangent + lines_[g].tangent).normalized();
    add({across.x(), across.y(), 0}, across.dot(point - lines_[g].start));
  }

  // Adds one equation of the least-squares problem. `off` is the present distance of the node from
  // the plane.
  void add(const Eigen::Vector3d& row, double off) {
    rows_.insert(rows_.end(), row.begin(), row.end());
    off_.push_back(off);
  }

  Skeleton& skeleton_;
  std::vector<EdgeLine> lines_;
  Faces faces_at_;                  // faces that meet at each node
  std::vector<double> rows_, off_;  // matrix, by rows, and right-hand side of one node
};

// ------------------------------------------------------------------------------------------------
// Attempts

bool is_simple(const Ring& ring) {
  try {
    return Polygon(ring).vertices() == ring;  // equal unless the ring is clockwise
  } catch (const InvalidPolygon&) {
    return false;
  }
}

// The coordinates that CGAL works in, with the polygon centred and scaled to the size 1. The scale
// is a power of two and the centre has few digits, so that the transformation is exact where
// possible.
struct Frame {
  Vec2 centre;
  double scale;

  explicit Frame(const Polygon& polygon) {
    const Box box = bounding_box(polygon);
    scale = std::exp2(-std::ilogb(box.extent()));
    const double grid = std::ldexp(1 / scale, -8);
    centre = {grid * std::round((box.x0 + box.x1) / 2 / grid),
              grid * std::round((box.y0 + box.y1) / 2 / grid)};
    if (!is_simple(inward(polygon))) centre.setZero();
  }

  [[nodiscard]] Ring inward(const Polygon& polygon) const {
    Ring ring = polygon.vertices();
    for (Vec2& v : ring) v = (v - centre) * scale;
    return ring;
  }

  void outward(Skeleton& skeleton, const Polygon& polygon) const {
    const Vec2 shift = centre - polygon.origin();
    for (Node& node : skeleton.nodes) {
      node.point = node.point / scale + shift;
      node.height /= scale;
    }
    const Ring ring = polygon.local_vertices();
    for (size_t i = 0; i < ring.size(); ++i) skeleton.nodes[i] = {ring[i], 0};
  }
};

struct Attempt {
  double jitter;  // largest movement of a vertex, as a share of the polygon's size
  bool exact;     // whether CGAL uses exact constructions
};
constexpr Attempt kAttempts[] = {{0, false},     {1e-13, false}, {1e-12, false}, {0, true},
                                 {1e-11, false}, {1e-13, false}, {1e-12, false}, {1e-11, false},
                                 {1e-10, false}, {1e-12, true},  {1e-10, false}, {1e-9, false}};
// Simultaneous events, such as those of a regular star, cost CGAL 10 to 30 times as much time as
// others. Polygons with more than kMany vertices therefore start with a jitter, whose error the
// correction of the nodes removes.
constexpr Attempt kManySides = {1e-11, false};
constexpr size_t kMany = 64;

Ring jittered(Ring ring, double amplitude, unsigned seed) {
  std::mt19937_64 engine(seed);
  const auto random = [&] { return std::ldexp(static_cast<double>(engine() >> 11), -52) - 1; };
  const Ring original = ring;
  const size_t n = ring.size();
  for (size_t i = 0; i < n; ++i) {
    const double nearest = std::min((original[i] - original[(i + n - 1) % n]).norm(),
                                    (original[i] - original[(i + 1) % n]).norm());
    const double step = std::min(amplitude, nearest / 1000);
    ring[i] += step * Vec2(random(), random());
  }
  return ring;
}

// Time limit for CGAL in seconds. For a polygon without symmetry CGAL needs about n^2 steps.
double time_limit(size_t n, bool exact) {
  const double thousands = static_cast<double>(n) / 1000;
  return (exact ? 4 : 1) * (1 + 60 * thousands * thousands);
}

struct Outcome {
  Skeleton skeleton;
  std::string failure;  // empty if the skeleton passes the laws
};

Outcome try_once(const Polygon& polygon, const Frame& frame, const Ring& input,
                 const Attempt& attempt) {
  if (!is_simple(input)) return {{}, "the outline is not simple in scaled coordinates"};
  const Answer answer = ask_cgal(input, attempt.exact, time_limit(input.size(), attempt.exact));
  if (!answer.failure.empty()) return {{}, answer.failure};
  std::optional<Skeleton> skeleton = decode(answer.message);
  if (!skeleton) return {{}, "CGAL's answer was cut off"};
  frame.outward(*skeleton, polygon);
  Polish(*skeleton, polygon).run();
  return {*skeleton, broken_law(*skeleton, polygon).value_or("")};
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

}  // namespace

Skeleton straight_skeleton(const Polygon& polygon) {
  std::vector<std::string> failures;
  if (polygon.is_convex()) {
    Skeleton skeleton = ConvexShrink(polygon).run();
    const std::optional<std::string> broken = broken_law(skeleton, polygon);
    if (!broken) return skeleton;
    failures.push_back(*broken);
  }
  const Frame frame(polygon);
  const Ring ring = frame.inward(polygon);
  unsigned seed = 0;
  std::vector<Attempt> attempts(std::begin(kAttempts), std::end(kAttempts));
  if (ring.size() > kMany) attempts.insert(attempts.begin(), kManySides);
  for (const Attempt& attempt : attempts) {
    Outcome outcome = try_once(polygon, frame, jittered(ring, attempt.jitter, ++seed), attempt);
    if (outcome.failure.empty()) {
      outcome.skeleton.attempts = static_cast<int>(failures.size()) + 1;
      outcome.skeleton.exact = attempt.exact;
      return std::move(outcome.skeleton);
    }
    failures.push_back(outcome.failure);
  }
  throw SkeletonFailure("no valid straight skeleton of this polygon with " +
                        std::to_string(ring.size()) + " vertices in " +
                        std::to_string(failures.size()) + " attempts: " + describe(failures) +
                        ". Remove details smaller than 1e-9 of the polygon's size, or choose the "
                        "field 'distance', which needs no skeleton");
}

}  // namespace apothem
