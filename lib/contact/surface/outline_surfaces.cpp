#include "lib/contact/surface/outline_surfaces.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <type_traits>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/spatial/loops.hpp"
#include "lib/execution/dispatch.hpp"

namespace apothem {
namespace {

constexpr double kMoveTime = 3, kEdgeTime = 6;  // time for a vertex, ns
constexpr int kTogether = 16;  // bodies placed together, so that their data stay in the cache
// A point nearer to a line than this, relative to the depth, is not clear.
constexpr double kClear = 1e-9;

template <class Number>
APOTHEM_INLINE Number load(const double* from) {
  if constexpr (std::is_same_v<Number, double>) {
    return *from;
  } else {
    return Number::load(from);
  }
}
APOTHEM_INLINE void store(double value, double* target) { *target = value; }
template <int lanes>
APOTHEM_INLINE void store(const PackOf<lanes>& value, double* target) {
  value.store(target);
}
template <class Number>
APOTHEM_INLINE Number loaded(const std::vector<double>& from, int i) {
  return load<Number>(from.data() + i);
}
template <class Number>
APOTHEM_INLINE void store(const Number& value, std::vector<double>& list, int i) {
  store(value, list.data() + i);
}

// Computes tangents, bisectors and regular depths of outlines. Each member function treats one edge
// or vertex, or a pack of them that are consecutive in all arrays.
template <class Of = OutlineSurfaces>
struct EdgeGeometry {
  Of& o;

  template <class Number>
  APOTHEM_INLINE void tangent(int i, int next) const {
    const Number dx = loaded<Number>(o.x, next) - loaded<Number>(o.x, i);
    const Number dy = loaded<Number>(o.y, next) - loaded<Number>(o.y, i);
    const Number length = square_root(dx * dx + dy * dy);
    const Number scale = Number(1.) / length;
    store(length, o.length, i);
    store(dx * scale, o.tx, i);
    store(dy * scale, o.ty, i);
  }
  template <class Number>
  APOTHEM_INLINE void bisector(int i, int previous) const {
    const Mitre<Number> m(loaded<Number>(o.tx, previous), loaded<Number>(o.ty, previous),
                          loaded<Number>(o.tx, i), loaded<Number>(o.ty, i));
    store(m.x, o.mx, i);
    store(m.y, o.my, i);
  }
  template <class Number>
  APOTHEM_INLINE void find_regular_depth(int i, int next) const {
    const Number tx = loaded<Number>(o.tx, i), ty = loaded<Number>(o.ty, i);
    const Number alpha = loaded<Number>(o.mx, i) * tx + loaded<Number>(o.my, i) * ty;
    const Number beta = loaded<Number>(o.mx, next) * tx + loaded<Number>(o.my, next) * ty;
    const Number event = edge_event_height(loaded<Number>(o.length, i), alpha, beta);
    store(regular_depth_of(loaded<Number>(o.depth, i), event), o.regular_depth, i);
  }
  /// Raises `farthest` to the distance of a vertex of the offset curve from a given position.
  template <class Number>
  APOTHEM_INLINE void stray(int i, const std::vector<double>& offset_x,
                            const std::vector<double>& offset_y, double* farthest) const {
    const Number h = loaded<Number>(o.depth, i);
    const Number x = loaded<Number>(o.x, i) + h * loaded<Number>(o.mx, i);
    const Number y = loaded<Number>(o.y, i) + h * loaded<Number>(o.my, i);
    const Number dx = magnitude(x - loaded<Number>(offset_x, i));
    const Number dy = magnitude(y - loaded<Number>(offset_y, i));
    Number most = load<Number>(farthest);
    most = select(dx > most, dx, most);
    most = select(dy > most, dy, most);
    store(most, farthest);
  }
};

// Calls f(type of number, i) for i from `first` to `end` - 1, in packs where there are enough; some
// indices may be treated twice.
template <int lanes, class F>
APOTHEM_INLINE void each_pack(int first, int end, const F& f) {
  if (end - first < lanes) {
    for (int i = first; i < end; ++i) f(std::type_identity<double>(), i);
    return;
  }
  for (int i = first; i < end - lanes; i += lanes) f(std::type_identity<PackOf<lanes>>(), i);
  f(std::type_identity<PackOf<lanes>>(), end - lanes);
}

// The area over the length of the boundary, m, which is a lower bound of the inradius of the body.
double least_inradius(const std::vector<std::vector<Vec2>>& rings) {
  double area = 0, length = 0;
  for (const std::vector<Vec2>& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2& next = after(ring, i);
      area += cross(ring[i] - ring[0], next - ring[0]) / 2;
      length += (next - ring[i]).norm();
    }
  }
  return area / length;
}

// The smallest thickness of a body, m, or `most` if the body is nowhere thinner. `rings` are those
// of the boundary.
double thickness_of(const Mesh& mesh, const Boundary& boundary,
                    const std::vector<std::vector<Vec2>>& rings, double most) {
  if (least_inradius(rings) < most / 2) most = std::min(most, 2 * mesh_inradius(mesh, boundary));
  return smallest_thickness(rings, most);
}

}  // namespace

void OutlineSurfaces::add_mesh(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                               std::optional<double> reference) {
  const int first = size();
  std::vector<std::vector<Vec2>> rings;
  std::vector<NodeIndex> nodes;
  for (const BoundaryLoop& loop : boundary.loops) {
    rings.push_back(mesh.places(loop.nodes));
    nodes.clear();
    for (const int n : loop.nodes) nodes.push_back(first_node + n);
    add_loop(rings.back(), nodes);
  }
  double r, reach;
  if (reference) {
    r = *reference;
    reach = thickness_of(mesh, boundary, rings, 2 * r) / 2;
  } else {
    // The collars of opposite sides must not meet in a body that is squeezed to half its thickness.
    // A row of square elements is 4 r thick, so thicknesses beyond that need not be measured.
    r = boundary_inradius(mesh, boundary);
    reach = std::max(r / 2, thickness_of(mesh, boundary, rings, 4 * r) / 4);
  }
  // Nor must the collar leave the body at an inner corner when this has closed to half its angle.
  if (const std::optional<InnerCorner> corner = lowest_inner_corner(rings, 2 * reach)) {
    reach = corner->height / 2;
    shallow.push_back({static_cast<BodyIndex>(bodies.size()), *corner});
  }
  close_body({first, size(), -1, r, reach});
}

void OutlineSurfaces::add_rigid(const Rings& rings, RigidIndex rigid, double reference) {
  const int first = size();
  for (const std::vector<Vec2>& ring : rings) add_loop(ring, {});
  double reach = std::min(reference, smallest_thickness(rings, 2 * reference) / 2);
  if (const std::optional<InnerCorner> corner = lowest_inner_corner(rings, reach)) {
    reach = corner->height;
  }
  close_body({first, size(), rigid, reference, reach});
}

void OutlineSurfaces::add_loop(const std::vector<Vec2>& places, std::span<const NodeIndex> nodes) {
  const int first = size();
  const int n = static_cast<int>(places.size());
  for (int i = 0; i < n; ++i) {
    x0_.push_back(places[i].x());
    y0_.push_back(places[i].y());
    node.push_back(nodes.empty() ? -1 : nodes[i]);
    next.push_back(first + apothem::next(i, n));
    previous.push_back(first + apothem::previous(i, n));
    body.push_back(static_cast<BodyIndex>(bodies.size()));
  }
  x.resize(x0_.size()), y.resize(x0_.size());
  loops.push_back({first, size(), static_cast<BodyIndex>(bodies.size())});
}

void OutlineSurfaces::close_body(const Body& added) {
  const int first_loop = bodies.empty() ? 0 : bodies.back().end_loop;
  bodies.push_back(added);
  bodies.back().first_loop = first_loop;
  bodies.back().end_loop = static_cast<int>(loops.size());
  const size_t n = x.size();
  for (std::vector<double>* v : {&mx, &my, &tx, &ty, &length, &regular_depth}) v->resize(n);
  depth.resize(n, added.depth);
  active_.push_back(static_cast<BodyIndex>(bodies.size()) - 1);
  is_active_.push_back(1);
  forget();
}

void OutlineSurfaces::place(const Kinematics& now, const PlacedShapes& polygons,
                            const Threads& threads) {
  std::atomic<bool> strayed = kept_.x.empty();
  const int count = static_cast<int>(bodies.size());
  // Mean number of vertices of a body.
  const double vertices = static_cast<double>(size()) / std::max(count, 1);
  const auto place_some = [&](BodyIndex first, BodyIndex end) {
    for (BodyIndex b = first; b < end; ++b) {
      if (!move(bodies[b], now, polygons)) strayed = true;
    }
    const std::span<const BodyIndex> part = active(first, end);
    find_edges(part);
    if (!strayed && have_offset_curves_strayed(part)) strayed = true;
  };
  threads.chunks(count, (kMoveTime + kEdgeTime) * vertices, [&](int first, int end, int) {
    for (int b = first; b < end; b += kTogether) place_some(b, std::min(b + kTogether, end));
  });
  if (strayed) require_finite();
  strayed_ = strayed;
}

// The active bodies with numbers from `first` to `end` - 1.
std::span<const BodyIndex> OutlineSurfaces::active(BodyIndex first, BodyIndex end) const {
  const auto from = std::ranges::lower_bound(active_, first);
  return {from, std::lower_bound(from, active_.end(), end)};
}

// Moves the vertices of a body. Returns false if a vertex is not near its position at the last
// search, or not at a finite position.
bool OutlineSurfaces::move(Body& b, const Kinematics& now, const PlacedShapes& polygons) {
  const bool compare = !kept_.x.empty();
  const double limit = growth();
  bool near = true;
  const auto put = [&](int i, double px, double py) {
    x[i] = px, y[i] = py;
    if (!compare) return;
    const bool near_x = std::abs(px - kept_.x[i]) <= limit;
    const bool near_y = std::abs(py - kept_.y[i]) <= limit;
    near &= near_x & near_y;
  };
  if (b.is_rigid()) {
    const double* q = now.pose.data() + 3 * static_cast<size_t>(b.rigid);
    const PlacedPotential polygon = polygons.view(b.rigid);
    b.cx = q[0], b.cy = q[1];
    for (int i = b.first; i < b.end; ++i) {
      put(i, q[0] + polygon.x[i - b.first], q[1] + polygon.y[i - b.first]);
    }
  } else {
    for (int i = b.first; i < b.end; ++i) {
      const double* u = now.displacement.data() + 2 * static_cast<size_t>(node[i]);
      put(i, x0_[i] + u[0], y0_[i] + u[1]);
    }
  }
  return near;
}

void OutlineSurfaces::require_finite() const {
  for (const Body& b : bodies) {
    double all = 0;  // NaN if a coordinate is not finite
    for (int i = b.first; i < b.end; ++i) all += 0 * x[i] + 0 * y[i];
    if (all != 0) throw NotFinite(body[b.first]);
  }
}

// The edges of a body are consecutive, except for those that close a line.
void OutlineSurfaces::find_edges(std::span<const BodyIndex> among) {
  const EdgeGeometry<> g{*this};
  with_widest([&](auto /*lanes*/) __attribute__((always_inline)) {
    constexpr int lanes = kComparedLanes;
    for (const BodyIndex b : among) {
      const Body& vertices = bodies[static_cast<size_t>(b)];
      const std::span<const Loop> lines =
          std::span(loops).subspan(static_cast<size_t>(vertices.first_loop),
                                   static_cast<size_t>(vertices.end_loop - vertices.first_loop));
      each_pack<lanes>(
          vertices.first, vertices.end - 1,
          [&]<class N>(std::type_identity<N>, int i)
              __attribute__((always_inline)) { g.tangent<N>(i, i + 1); });
      for (const Loop& l : lines) g.tangent<double>(l.end - 1, l.first);
      each_pack<lanes>(
          vertices.first + 1,
          vertices.end, [&]<class N>(std::type_identity<N>, int i) __attribute__((always_inline)) {
            g.bisector<N>(i, i - 1);
          });
      for (const Loop& l : lines) g.bisector<double>(l.first, l.end - 1);
      each_pack<lanes>(
          vertices.first, vertices.end - 1,
          [&]<class N>(std::type_identity<N>, int i)
              __attribute__((always_inline)) { g.find_regular_depth<N>(i, i + 1); });
      for (const Loop& l : lines) g.find_regular_depth<double>(l.end - 1, l.first);
    }
    return 0.;
  });
}

void OutlineSurfaces::find_boxes(double growth) {
  const int n = size();
  edge_boxes.resize(n), face_boxes.resize(n);
  for (int i = 0; i < n; ++i) {
    const int j = next[i];
    Box box = box_of(point(i), point(j));
    edge_boxes[i] = box.grown(growth);
    box.include(offset_point(i)), box.include(offset_point(j));
    face_boxes[i] = box.grown(growth);
  }
}

// Bodies do not overlap as long as their vertices are in separate boxes. For bodies that are not
// active this is known without their faces.
bool OutlineSurfaces::have_offset_curves_strayed(std::span<const BodyIndex> among) const {
  const EdgeGeometry<const OutlineSurfaces> g{*this};
  const double limit = growth();
  const auto look = [&](auto /*lanes*/) __attribute__((always_inline)) {
    constexpr int lanes = kComparedLanes;
    for (const BodyIndex b : among) {
      const Body& vertices = bodies[static_cast<size_t>(b)];
      std::array<double, lanes> farthest{};
      each_pack<lanes>(
          vertices.first,
          vertices.end, [&]<class N>(std::type_identity<N>, int i) __attribute__((always_inline)) {
            g.template stray<N>(i, kept_.offset_x, kept_.offset_y, farthest.data());
          });
      if (!(*std::ranges::max_element(farthest) <= limit)) return 1.;
    }
    return 0.;
  };
  return with_widest(look) != 0;
}

void OutlineSurfaces::activate(std::span<const BoxPair> pairs) {
  is_active_.assign(bodies.size(), 0);
  for (const auto& [a, b] : pairs) is_active_[a] = is_active_[b] = 1;
  active_.clear();
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(bodies.size()); ++b) {
    if (is_active_[b]) active_.push_back(b);
  }
}

void OutlineSurfaces::prepare_search() {
  const int count = static_cast<int>(bodies.size());
  std::vector<BodyIndex> others;
  for (BodyIndex b = 0; b < count; ++b) {
    if (!is_active_[b]) others.push_back(b);
  }
  find_edges(others);
  find_boxes(growth());
  strayed_ = false;
  kept_.x = x, kept_.y = y;
  kept_.offset_x.resize(x.size()), kept_.offset_y.resize(x.size());
  body_boxes.assign(count, {});
  for (int i = 0; i < size(); ++i) {
    kept_.offset_x[i] = offset_point(i).x(), kept_.offset_y[i] = offset_point(i).y();
    body_boxes[body[i]].include(edge_boxes[i]);
    body_boxes[body[i]].include(face_boxes[i]);
  }
}

void OutlineSurfaces::prepare_search_at(const std::vector<double>& px,
                                        const std::vector<double>& py) {
  x = px, y = py;
  find_edges(active_);
  prepare_search();
}

std::optional<OutlineSurfaces::Notch> OutlineSurfaces::closed_notch() const {
  // Length of the bisector over the height, which is 3 at an angle of 39 degrees.
  constexpr double kSharp = 3;
  std::optional<Notch> found;
  double longest = kSharp * kSharp;
  each_active_vertex([&](int i) {
    const double square = mx[i] * mx[i] + my[i] * my[i];
    if (node[i] < 0 || !(square > longest)) return;
    const int before = previous[i];
    const bool reflex = tx[before] * ty[i] - ty[before] * tx[i] < 0;
    if (!reflex || winding(offset_point(i), body[i]) > 0) return;
    longest = square;
    found = {i, 2 * std::asin(1 / std::sqrt(square))};
  });
  return found;
}

int OutlineSurfaces::winding(const Vec2& p, BodyIndex b, bool of_offset_curve, bool* clear) const {
  int sum = 0;
  for (int i = bodies[b].first; i < bodies[b].end; ++i) {
    const Vec2 start = (of_offset_curve ? offset_point(i) : point(i)) - p;
    const Vec2 end = (of_offset_curve ? offset_point(next[i]) : point(next[i])) - p;
    const bool up = end.y() > 0;
    if ((start.y() > 0) == up) continue;
    const double side = cross(start, end);
    if (clear && std::abs(side) < kClear * depth[i] * (end - start).norm()) *clear = false;
    if (up ? side > 0 : side < 0) sum += up ? 1 : -1;
  }
  return sum;
}

}  // namespace apothem
