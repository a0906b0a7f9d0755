#include "apothem/contact/outlines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apothem {
namespace {

void include(Box& box, const Box& other) {
  box.include(other.x0, other.y0);
  box.include(other.x1, other.y1);
}

}  // namespace

void Outlines::add_mesh(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                        std::optional<double> reference) {
  const int first = size();
  double r = std::numeric_limits<double>::infinity();
  std::vector<Vec2> places;
  std::vector<NodeIndex> nodes;
  for (const BoundaryLoop& loop : boundary.loops) {
    places.clear(), nodes.clear();
    for (const int n : loop.nodes) {
      places.push_back(mesh.nodes[n]);
      nodes.push_back(first_node + n);
    }
    const std::vector<double> caps =
        reference ? std::vector<double>(nodes.size(), *reference) : inradii(mesh, loop);
    r = std::min(r, *std::min_element(caps.begin(), caps.end()));
    add_loop(places, nodes, caps);
  }
  close_body({first, size(), -1, r});
}

void Outlines::add_rigid(const std::vector<Vec2>& vertices, RigidIndex rigid, double reference) {
  const int first = size();
  add_loop(vertices, {}, std::vector<double>(vertices.size(), reference));
  close_body({first, size(), rigid, reference});
}

void Outlines::add_loop(const std::vector<Vec2>& places, std::span<const NodeIndex> nodes,
                        std::span<const double> caps) {
  const int first = size();
  const int n = static_cast<int>(places.size());
  cap.insert(cap.end(), caps.begin(), caps.end());
  for (int i = 0; i < n; ++i) {
    x0_.push_back(places[i].x());
    y0_.push_back(places[i].y());
    node.push_back(nodes.empty() ? -1 : nodes[i]);
    next.push_back(first + (i + 1 == n ? 0 : i + 1));
    previous.push_back(first + (i == 0 ? n - 1 : i - 1));
    body.push_back(static_cast<BodyIndex>(bodies.size()));
  }
  x.resize(x0_.size()), y.resize(x0_.size());
}

void Outlines::close_body(const Body& added) {
  bodies.push_back(added);
  const size_t n = x.size();
  for (std::vector<double>* v : {&mx, &my, &tx, &ty, &length, &depth, &events_}) v->resize(n);
  clearance.insert(clearance.end(), cap.begin() + added.first, cap.end());
  forget();
}

void Outlines::place(const Kinematics& now, const PlacedShapes& polygons) {
  move(now, polygons);
  find_edges();
  find_depths();
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

void Outlines::find_edges() {
  const int n = size();
  for (int i = 0; i < n; ++i) {
    const double dx = x[next[i]] - x[i], dy = y[next[i]] - y[i];
    length[i] = std::sqrt(dx * dx + dy * dy);
    const double scale = 1 / length[i];
    tx[i] = dx * scale;
    ty[i] = dy * scale;
  }
  for (int i = 0; i < n; ++i) {
    const int p = previous[i];
    const Mitre<double> m(tx[p], ty[p], tx[i], ty[i]);
    mx[i] = m.x, my[i] = m.y;
  }
}

// An edge's face ends where it shrinks to a point or another front arrives, there or at a
// neighbour; the second neighbours count as well because events follow each other.
void Outlines::find_depths() {
  const int n = size();
  for (int i = 0; i < n; ++i) {
    const int j = next[i];
    const double alpha = mx[i] * tx[i] + my[i] * ty[i];
    const double beta = mx[j] * tx[i] + my[j] * ty[i];
    events_[i] = std::min(clearance[i], collar_event(length[i], alpha, beta));
  }
  for (int i = 0; i < n; ++i) {
    const int p = previous[i], q = next[i];
    depth[i] =
        std::min({events_[previous[p]], events_[p], events_[i], events_[q], events_[next[q]]});
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

bool Outlines::stale() const {
  const int n = size();
  if (static_cast<int>(kept_.size()) != n) return true;
  for (int i = 0; i < n; ++i) {
    const Corners now = corners(i);
    double moved = 0;
    for (size_t k = 0; k < now.size(); ++k) moved = std::max(moved, std::abs(now[k] - kept_[i][k]));
    if (!(moved <= skin_ / 2)) return true;
  }
  return false;
}

void Outlines::prepare_search() {
  self_contact_.reset();
  find_boxes(0);
  const int count = static_cast<int>(bodies.size());
  for (BodyIndex b = 0; b < count; ++b) {
    if (!bodies[b].is_rigid() || b >= measured_) find_clearance(b);
  }
  measured_ = count;
  find_depths();
  find_boxes(skin_ / 2);
  kept_.clear();
  body_boxes.assign(count, {});
  for (int i = 0; i < size(); ++i) {
    kept_.push_back(corners(i));
    include(body_boxes[body[i]], edge_boxes[i]);
    include(body_boxes[body[i]], face_boxes[i]);
  }
}

// The time at which the inward-moving front of an edge f meets a vertex v of the same body that
// moves along its bisector: h_f(v) / (1 - m_v . n_f), if v arrives within the front. Also finds
// edges that cross.
void Outlines::find_clearance(BodyIndex b) {
  const Body& own = bodies[b];
  // A vertex and a front come within the cap of each other from farther away than twice the cap,
  // the more so the sharper the reflex corner: here from three times the larger cap of the two, no
  // cap being smaller than r.
  near_boxes_.clear();
  for (int i = own.first; i < own.end; ++i) {
    clearance[i] = cap[i];
    near_boxes_.push_back(edge_boxes[i].grown(3 * cap[i] - 1.5 * own.reference));
  }
  grid_.find_pairs(near_boxes_, near_pairs_);
  const auto meet = [&](int v, int f) {  // vertex v, front f
    if (f == v || f == previous[v]) return;
    const double px = x[v] - x[f], py = y[v] - y[f];
    const double h = tx[f] * py - ty[f] * px;
    const double closing = 1 - (tx[f] * my[v] - ty[f] * mx[v]);
    if (!(h > 0) || !(closing > 0)) return;
    const double time = h / closing;
    if (time >= std::max({clearance[f], clearance[v], clearance[previous[v]]})) return;
    const CollarFace<double> front = face(f);
    const double tau = tx[f] * (px + time * mx[v]) + ty[f] * (py + time * my[v]) - front.length / 2;
    const double left = front.alpha() * time, right = front.beta() * time;
    if (tau < left - front.length || tau > right + front.length) return;
    for (const int k : {f, v, previous[v]}) clearance[k] = std::min(clearance[k], time);
  };
  const auto side = [&](int e, int v) { return tx[e] * (y[v] - y[e]) - ty[e] * (x[v] - x[e]); };
  for (auto [i, j] : near_pairs_) {
    i += own.first, j += own.first;
    const int in = next[i], jn = next[j];
    meet(i, j), meet(in, j), meet(j, i), meet(jn, i);
    if (i == jn || j == in || self_contact_) continue;
    const double p = side(i, j), q = side(i, jn);
    if (p * q < 0 && side(j, i) * side(j, in) < 0) {
      const double u = p / (p - q);
      self_contact_ = {b, {x[j] + u * (x[jn] - x[j]), y[j] + u * (y[jn] - y[j])}};
    }
  }
}

}  // namespace apothem
