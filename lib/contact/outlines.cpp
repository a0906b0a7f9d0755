#include "apothem/contact/outlines.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/geometry/spatial/loops.hpp"

namespace apothem {
namespace {

constexpr double kClear = 1e-9;  // of a depth: a point nearer to a line than this is not clear

void include(Box& box, const Box& other) {
  box.include(other.x0, other.y0);
  box.include(other.x1, other.y1);
}

// The area over the length of the boundary, m: no more than the inradius of the body.
double least_inradius(const std::vector<std::vector<Vec2>>& rings) {
  double area = 0, length = 0;
  for (const std::vector<Vec2>& ring : rings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2& next = ring[i + 1 == ring.size() ? 0 : i + 1];
      area += cross(ring[i] - ring[0], next - ring[0]) / 2;
      length += (next - ring[i]).norm();
    }
  }
  return area / length;
}

// The smallest thickness of a body, m, or `most` if it is nowhere thinner.
double thickness_of(const Mesh& mesh, const Boundary& boundary, double most) {
  std::vector<std::vector<Vec2>> rings;
  for (const BoundaryLoop& loop : boundary.loops) {
    std::vector<Vec2>& ring = rings.emplace_back();
    for (const int n : loop.nodes) ring.push_back(mesh.nodes[n]);
  }
  if (least_inradius(rings) < most / 2) most = std::min(most, 2 * mesh_inradius(mesh, boundary));
  return smallest_thickness(rings, most);
}

}  // namespace

void Outlines::add_mesh(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                        std::optional<double> reference) {
  const int first = size();
  std::vector<Vec2> places;
  std::vector<NodeIndex> nodes;
  for (const BoundaryLoop& loop : boundary.loops) {
    places.clear(), nodes.clear();
    for (const int n : loop.nodes) {
      places.push_back(mesh.nodes[n]);
      nodes.push_back(first_node + n);
    }
    add_loop(places, nodes);
  }
  if (reference) {
    const double thickness = thickness_of(mesh, boundary, 2 * *reference);
    close_body({first, size(), -1, *reference, thickness / 2});
    return;
  }
  // The collars of opposite sides must not reach through a body that is squeezed to half. A row of
  // squares is four times half its r thick: less is never needed.
  const double r = boundary_inradius(mesh, boundary);
  const double thickness = thickness_of(mesh, boundary, 4 * r);
  close_body({first, size(), -1, r, std::max(r / 2, thickness / 4)});
}

void Outlines::add_rigid(const std::vector<Vec2>& vertices, RigidIndex rigid, double reference) {
  const int first = size();
  add_loop(vertices, {});
  close_body({first, size(), rigid, reference,
              std::min(reference, smallest_thickness({vertices}, 2 * reference) / 2)});
}

void Outlines::add_loop(const std::vector<Vec2>& places, std::span<const NodeIndex> nodes) {
  const int first = size();
  const int n = static_cast<int>(places.size());
  for (int i = 0; i < n; ++i) {
    x0_.push_back(places[i].x());
    y0_.push_back(places[i].y());
    node.push_back(nodes.empty() ? -1 : nodes[i]);
    next.push_back(first + (i + 1 == n ? 0 : i + 1));
    previous.push_back(first + (i == 0 ? n - 1 : i - 1));
    body.push_back(static_cast<BodyIndex>(bodies.size()));
  }
  x.resize(x0_.size()), y.resize(x0_.size());
  loops.push_back({first, size(), static_cast<BodyIndex>(bodies.size())});
}

void Outlines::close_body(const Body& added) {
  bodies.push_back(added);
  const size_t n = x.size();
  for (std::vector<double>* v : {&mx, &my, &tx, &ty, &length, &plain}) v->resize(n);
  depth.resize(n, added.depth);
  active_.push_back(static_cast<BodyIndex>(bodies.size()) - 1);
  is_active_.push_back(1);
  forget();
}

void Outlines::place(const Kinematics& now, const PlacedShapes& polygons) {
  move(now, polygons);
  for (const BodyIndex b : active_) find_edges(bodies[b]);
}

void Outlines::move(const Kinematics& now, const PlacedShapes& polygons) {
  for (Body& b : bodies) {
    double all = 0;  // NaN if a place is not finite
    if (b.is_rigid()) {
      const double* q = now.pose.data() + 3 * static_cast<size_t>(b.rigid);
      const PlacedPotential polygon = polygons.view(b.rigid);
      b.cx = q[0], b.cy = q[1];
      for (int i = b.first; i < b.end; ++i) {
        x[i] = q[0] + polygon.x[i - b.first];
        y[i] = q[1] + polygon.y[i - b.first];
      }
    } else {
      for (int i = b.first; i < b.end; ++i) {
        const double* u = now.displacement.data() + 2 * static_cast<size_t>(node[i]);
        x[i] = x0_[i] + u[0];
        y[i] = y0_[i] + u[1];
      }
    }
    for (int i = b.first; i < b.end; ++i) all += 0 * x[i] + 0 * y[i];
    if (all != 0) throw NotFinite(body[b.first]);
  }
}

void Outlines::find_edges(const Body& of) {
  for (int i = of.first; i < of.end; ++i) {
    const double dx = x[next[i]] - x[i], dy = y[next[i]] - y[i];
    length[i] = std::sqrt(dx * dx + dy * dy);
    const double scale = 1 / length[i];
    tx[i] = dx * scale;
    ty[i] = dy * scale;
  }
  for (int i = of.first; i < of.end; ++i) {
    const int p = previous[i];
    const Mitre<double> m(tx[p], ty[p], tx[i], ty[i]);
    mx[i] = m.x, my[i] = m.y;
  }
  for (int i = of.first; i < of.end; ++i) {
    const int j = next[i];
    const double alpha = mx[i] * tx[i] + my[i] * ty[i];
    const double beta = mx[j] * tx[i] + my[j] * ty[i];
    plain[i] = plain_depth(depth[i], collar_event(length[i], alpha, beta));
  }
}

Outlines::Corners Outlines::corners(int i) const {
  const int j = next[i];
  const double h = depth[i];
  return {x[i], y[i], x[i] + h * mx[i], y[i] + h * my[i], x[j] + h * mx[j], y[j] + h * my[j]};
}

void Outlines::find_boxes(double growth) {
  const int n = size();
  edge_boxes.resize(n), face_boxes.resize(n);
  for (int i = 0; i < n; ++i) {
    const int j = next[i];
    Box box;
    box.include(x[i], y[i]);
    box.include(x[j], y[j]);
    edge_boxes[i] = box.grown(growth);
    const Corners c = corners(i);
    box.include(c[2], c[3]);
    box.include(c[4], c[5]);
    face_boxes[i] = box.grown(growth);
  }
}

// Bodies do not overlap as long as their vertices are in boxes that are apart. This is known of
// bodies that are not active without a look at their faces.
bool Outlines::stale() const {
  if (static_cast<int>(kept_.size()) != size()) return true;
  double farthest = 0;
  const auto note = [&](double now, double before) {
    const double moved = std::abs(now - before);
    farthest = moved > farthest ? moved : farthest;
  };
  for (size_t b = 0; b < bodies.size(); ++b) {
    if (is_active_[b]) {
      for (int i = bodies[b].first; i < bodies[b].end; ++i) {
        const Corners now = corners(i);
        for (size_t k = 0; k < now.size(); ++k) note(now[k], kept_[i][k]);
      }
    } else {
      for (int i = bodies[b].first; i < bodies[b].end; ++i) {
        note(x[i], kept_[i][0]);
        note(y[i], kept_[i][1]);
      }
    }
    if (!(farthest <= skin_ / 2)) return true;
  }
  return false;
}

void Outlines::activate(std::span<const BoxPair> pairs) {
  is_active_.assign(bodies.size(), 0);
  for (const auto& [a, b] : pairs) is_active_[a] = is_active_[b] = 1;
  active_.clear();
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(bodies.size()); ++b) {
    if (is_active_[b]) active_.push_back(b);
  }
}

void Outlines::prepare_search() {
  const int count = static_cast<int>(bodies.size());
  for (int b = 0; b < count; ++b) {
    if (!is_active_[b]) find_edges(bodies[b]);
  }
  find_boxes(skin_ / 2);
  kept_.clear();
  body_boxes.assign(count, {});
  for (int i = 0; i < size(); ++i) {
    kept_.push_back(corners(i));
    include(body_boxes[body[i]], edge_boxes[i]);
    include(body_boxes[body[i]], face_boxes[i]);
  }
}

int Outlines::winding(const Vec2& p, BodyIndex b, bool of_top, bool* clear) const {
  int sum = 0;
  for (int i = bodies[b].first; i < bodies[b].end; ++i) {
    const Vec2 from = (of_top ? top(i) : point(i)) - p;
    const Vec2 to = (of_top ? top(next[i]) : point(next[i])) - p;
    const bool up = to.y() > 0;
    if ((from.y() > 0) == up) continue;
    const double side = cross(from, to);
    if (clear && std::abs(side) < kClear * depth[i] * (to - from).norm()) *clear = false;
    if (up ? side > 0 : side < 0) sum += up ? 1 : -1;
  }
  return sum;
}

}  // namespace apothem
