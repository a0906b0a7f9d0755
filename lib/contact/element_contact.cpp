#include "apothem/contact/element_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "apothem/contact/groups.hpp"
#include "apothem/mesh/locate.hpp"

namespace apothem {

namespace {

// As for rigid bodies: beyond it an edge is about to cross the other's centre.
constexpr double kDeepestPhi = 0.95;

}  // namespace

int ElementContact::add_deformable(const Mesh& mesh, const Boundary& boundary, int first_node,
                                   const PotentialChoice& choice) {
  const int body = static_cast<int>(bodies_.size());
  bodies_.push_back({0, false});
  std::vector<int> outermost;
  std::set<std::pair<int, int>> edges;
  std::vector<double> share(mesh.nodes.size());
  for (const BoundaryLoop& loop : boundary.loops) {
    outermost.insert(outermost.end(), loop.elements.begin(), loop.elements.end());
    for (size_t i = 0; i < loop.nodes.size(); ++i) {
      const int p = loop.nodes[i], q = loop.nodes[i + 1 == loop.nodes.size() ? 0 : i + 1];
      const double half = (mesh.nodes[q] - mesh.nodes[p]).norm() / 2;
      share[p] += half, share[q] += half;
      edges.emplace(p, q);
    }
  }
  for (int n = 0; n < static_cast<int>(share.size()); ++n) {
    if (share[n] > 0) shares_.push_back({first_node + n, body, share[n]});
  }
  std::sort(outermost.begin(), outermost.end());
  outermost.erase(std::unique(outermost.begin(), outermost.end()), outermost.end());
  for (const int element : outermost) {
    const int first = static_cast<int>(nodes_.size());
    const std::span<const int> ring = mesh.element(element);
    for (size_t k = 0; k < ring.size(); ++k) {
      nodes_.push_back(first_node + ring[k]);
      start_.push_back(mesh.nodes[ring[k]]);
      outer_.push_back(edges.contains({ring[k], ring[(k + 1) % ring.size()]}));
    }
    const Polygon polygon({start_.begin() + first, start_.end()});
    if (!polygon.is_convex()) {
      throw InvalidPolygon(
          fmt::format("the element at ({:.6g}, {:.6g}) m on its boundary is not convex",
                      polygon[0].x(), polygon[0].y()),
          *polygon.first_reflex_vertex());
    }
    const Potential potential = make_potential(polygon, choice);
    shapes_.add_deforming(potential);
    pieces_.push_back({body, -1, first});
    bodies_[body].slope = std::max(bodies_[body].slope, potential.steepest);
    const size_t corners = polygon.vertices().size();
    ring_.resize(std::max(ring_.size(), corners));
  }
  kept_.clear();  // search anew
  return body;
}

int ElementContact::add_rigid(const Potential& potential, int entry) {
  pieces_.push_back({static_cast<int>(bodies_.size()), entry, -1});
  bodies_.push_back({potential.steepest, true});
  shapes_.add(potential);
  kept_.clear();
  return pieces_.back().body;
}

void ElementContact::update(std::span<const double> displacement,
                            std::span<const double> position) {
  places_.resize(3 * pieces_.size());
  convex_.resize(pieces_.size());
  double all = 0;
  for (size_t p = 0; p < pieces_.size(); ++p) {
    const Piece& piece = pieces_[p];
    const int index = static_cast<int>(p);
    double* place = &places_[3 * p];
    if (piece.entry >= 0) {
      std::copy_n(position.begin() + 3 * static_cast<ptrdiff_t>(piece.entry), 3, place);
      all += 0 * place[0] + 0 * place[1] + 0 * place[2];
      shapes_.place(index, place[0], place[1], place[2]);
      convex_[p] = 1;
      continue;
    }
    const auto moved = [&](int corner) -> Vec2 {
      const double* u = &displacement[2 * static_cast<size_t>(nodes_[static_cast<size_t>(corner)])];
      return {u[0], u[1]};
    };
    // Differences before sums: no digit is lost far from the origin.
    const Vec2& origin = start_[piece.corners];
    const Vec2 carried = moved(piece.corners);
    place[0] = origin.x() + carried.x();
    place[1] = origin.y() + carried.y();
    place[2] = 0;
    all += 0 * place[0] + 0 * place[1];
    const int count = corner_count(index);
    for (int k = 0; k < count; ++k) {
      const int c = piece.corners + k;
      ring_[k] = (start_[c] - origin) + (moved(c) - carried);
      all += 0 * ring_[k].x() + 0 * ring_[k].y();
    }
    convex_[p] = shapes_.deform(index, place[0], place[1], {ring_.data(), size_t(count)});
  }
  if (all != 0) throw std::domain_error("a vertex of a body is not at a finite place");
  if (stale()) search();
}

bool ElementContact::stale() const {
  if (kept_.size() != pieces_.size()) return true;
  for (size_t p = 0; p < pieces_.size(); ++p) {
    if (!contains(kept_[p], shapes_.boxes()[p])) return true;
  }
  return false;
}

void ElementContact::search() {
  ++searches_;
  kept_.clear();
  for (const Box& box : shapes_.boxes()) kept_.push_back(box.grown(skin_ / 2));
  grid_.find_pairs(kept_, pairs_);
  std::erase_if(pairs_, [&](const BoxPair& pair) {
    const int a = pieces_[pair.first].body, b = pieces_[pair.second].body;
    return a == b || (bodies_[a].rigid && bodies_[b].rigid);
  });
}

bool ElementContact::too_deep(int a, int b, const PairIntegral& pair) const {
  if (!(pair.largest_phi <= kDeepestPhi)) return true;
  const double inradius = 1 / std::max(shapes_.slope(a), shapes_.slope(b));
  if (pair.own_length_a + pair.own_length_b < inradius) return false;
  const Vec2 offset = reference(a) - reference(b);
  return shapes_.top_inside(a, places_[3 * static_cast<size_t>(a) + 2], b, offset) ||
         shapes_.top_inside(b, places_[3 * static_cast<size_t>(b) + 2], a, -offset);
}

void ElementContact::evaluate() {
  normal_.evaluate(shapes_, places_, pairs_);
  forces_.clear();
  sums_.assign(bodies_.size(), {Vec2::Zero(), 0});
  touches_.clear();
  depth_ = {};
  fault_.reset();
  for (size_t p = 0; p < pairs_.size(); ++p) {
    const PairIntegral& pair = normal_.integrals()[p];
    if (!pair.touching()) continue;
    const auto [a, b] = pairs_[p];
    const int body_a = pieces_[a].body, body_b = pieces_[b].body;
    const bool bent = !convex_[a] || !convex_[b];
    if (bent || too_deep(a, b, pair)) {
      fault_ = {bent ? Fault::Kind::not_convex : Fault::Kind::too_deep, body_a, body_b,
                reference(convex_[a] ? (bodies_[body_b].rigid ? a : b) : a)};
      return;
    }
    if (pair.penetration > depth_.largest) depth_ = {pair.penetration, body_a, body_b};
    const Vec2 force = stiffness_ * pair.force;
    sums_[body_a].force += force;
    sums_[body_b].force -= force;
    if (bodies_[body_a].rigid) sums_[body_a].moment += stiffness_ * pair.moment_a;
    if (bodies_[body_b].rigid) sums_[body_b].moment += stiffness_ * pair.moment_b;
    const Vec2 offset = reference(a) - reference(b);
    const Vec2 point = loading_point(pair);
    touches_.push_back({a, b, force, point, offset, stiffness_ * pair.weight});
    if (distribution_ == ForceDistribution::resultant) {
      distribute(a, force, point);
      distribute(b, -force, point + offset);
      continue;
    }
    contact_patches(shapes_.view(a), shapes_.view(b), offset, patch_workspace_, runs_, patches_);
    for (const BoundaryRun& run : runs_) {
      distribute(a, stiffness_ * run.force, run.centre);
      distribute(b, -stiffness_ * run.force, run.centre + offset);
    }
  }
}

void ElementContact::find_corners(int polygon, const Vec2& point, Corners& corners) const {
  corners.nodes = {};
  if (entry(polygon) >= 0) return;
  const PlacedPotential view = shapes_.view(polygon);
  const auto count = static_cast<size_t>(view.size);
  corners.nodes = std::span(nodes_).subspan(static_cast<size_t>(pieces_[polygon].corners), count);
  corners.ring.resize(count), corners.weights.resize(count);
  for (size_t k = 0; k < count; ++k) corners.ring[k] = Vec2(view.x[k], view.y[k]) - point;
  interpolation_weights(corners.ring, corners.weights);
}

// A force at a point relative to the polygon's reference point.
void ElementContact::distribute(int piece, const Vec2& force, const Vec2& point) {
  find_corners(piece, point, corners_);
  for (size_t k = 0; k < corners_.nodes.size(); ++k) {
    forces_.push_back({corners_.nodes[k], corners_.weights[k] * force});
  }
}

std::vector<ElementContact::SurfaceEdge> ElementContact::surface() const {
  std::vector<SurfaceEdge> edges;
  for (int p = 0; p < static_cast<int>(pieces_.size()); ++p) {
    const PlacedPotential view = shapes_.view(p);
    for (int k = 0; k < view.size; ++k) {
      if (entry(p) < 0 && !outer_[static_cast<size_t>(pieces_[p].corners + k)]) continue;
      edges.push_back({p, reference(p) + Vec2(view.x[k], view.y[k]),
                       reference(p) + Vec2(view.x[k + 1], view.y[k + 1])});
    }
  }
  return edges;
}

int ElementContact::nearest_edge(const std::vector<SurfaceEdge>& surface, int polygon,
                                 const Vec2& point) const {
  const Vec2 place = reference(polygon) + point;
  const auto [first, last] = std::equal_range(
      surface.begin(), surface.end(), SurfaceEdge{polygon, {}, {}},
      [](const SurfaceEdge& e, const SurfaceEdge& f) { return e.polygon < f.polygon; });
  const auto distance = [&](const SurfaceEdge& e) {
    const double along = std::clamp((place - e.from).dot(e.along()), 0., e.length());
    return (e.from + along * e.along() - place).norm();
  };
  return static_cast<int>(std::min_element(first, last,
                                           [&](const SurfaceEdge& e, const SurfaceEdge& f) {
                                             return distance(e) < distance(f);
                                           }) -
                          surface.begin());
}

std::vector<double> ElementContact::pressures(const std::vector<SurfaceEdge>& surface) const {
  std::vector<double> pressure(surface.size());
  for (const Touch& t : touches_) {
    const auto add = [&](int polygon, const Vec2& force, const Vec2& point) {
      const int i = nearest_edge(surface, polygon, point);
      pressure[i] += cross(surface[i].along(), force) / (surface[i].length() * thickness_);
    };
    add(t.a, t.force, t.point);
    add(t.b, -t.force, t.point + t.offset);
  }
  return pressure;
}

void ElementContact::add_forces(std::span<double> node_force) const {
  for (const auto& [node, force] : forces_) {
    node_force[2 * static_cast<size_t>(node)] += force.x();
    node_force[2 * static_cast<size_t>(node) + 1] += force.y();
  }
}

double ElementContact::energy() const {
  return stiffness_ * normal_.energy(shapes_, places_, pairs_);
}

DeformableContact::Rate ElementContact::rate(std::span<const double> node_mass) const {
  std::vector<double> other(bodies_.size());  // the steepest potential among the others
  for (size_t a = 0; a < bodies_.size(); ++a) {
    for (size_t b = 0; b < bodies_.size(); ++b) {
      if (a != b) other[a] = std::max(other[a], bodies_[b].slope);
    }
  }
  DeformableContact::Rate worst;
  for (const auto& [node, body, length] : shares_) {
    const double mass = node_mass[node];
    if (!(mass > 0) || other[body] == 0) continue;
    const double value = 2 * stiffness_ * (bodies_[body].slope + other[body]) * length / mass;
    if (value > worst.value) worst = {value, body};
  }
  return worst;
}

void ElementContact::add_stiffness(std::span<double> node_stiffness) const {
  std::vector<double> slope(node_stiffness.size());  // 1/r_c + 1/r_t
  for (const BoxPair& pair : pairs_) {
    const double both =
        bodies_[pieces_[pair.first].body].slope + bodies_[pieces_[pair.second].body].slope;
    for (const int p : {pair.first, pair.second}) {
      if (pieces_[p].entry >= 0) continue;
      const int* node = &nodes_[pieces_[p].corners];
      for (int k = 0; k < corner_count(p); ++k) slope[node[k]] = std::max(slope[node[k]], both);
    }
  }
  for (const auto& [node, body, length] : shares_) {
    node_stiffness[node] += 2 * stiffness_ * slope[node] * length;
  }
}

// Pairs of polygons belong together if on both sides the polygons are the same or share a node.
std::vector<int> ElementContact::patches() const {
  const auto nodes = [&](int polygon) {
    return entry(polygon) >= 0 ? std::span<const int>()
                               : std::span(nodes_).subspan(size_t(pieces_[polygon].corners),
                                                           size_t(corner_count(polygon)));
  };
  const auto adjacent = [&](int p, int q) {
    if (p == q) return true;
    const std::span<const int> of_p = nodes(p), of_q = nodes(q);
    return std::find_first_of(of_p.begin(), of_p.end(), of_q.begin(), of_q.end()) != of_p.end();
  };
  Groups groups(touches_.size());
  std::vector<std::pair<int, int>> keys;
  std::map<int, std::vector<int>> at_node;  // touches of elements there
  for (int i = 0; i < static_cast<int>(touches_.size()); ++i) {
    const Touch& t = touches_[i];
    keys.emplace_back(body(t.a), body(t.b));
    for (const int node : nodes(entry(t.a) < 0 ? t.a : t.b)) {
      for (const int j : at_node[node]) {
        const Touch& u = touches_[j];
        if (keys[j] == keys[i] && adjacent(t.a, u.a) && adjacent(t.b, u.b)) groups.join(i, j);
      }
      at_node[node].push_back(i);
    }
  }
  return groups.numbers(keys);
}

std::vector<BodyContact> ElementContact::body_contacts() const {
  const std::vector<int> patch = patches();
  std::vector<BodyContact> result(
      patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1);
  std::vector<double> weights(result.size());
  size_t next = 0;  // touch
  for (size_t p = 0; p < pairs_.size() && next < touches_.size(); ++p) {
    const Touch& t = touches_[next];
    if (pairs_[p] != BoxPair{t.a, t.b}) continue;
    const PairIntegral& pair = normal_.integrals()[p];
    const int k = patch[next++];
    BodyContact& sum = result[k];
    sum.a = body(t.a), sum.b = body(t.b);
    sum.force += t.force;
    sum.point += pair.weight * (reference(t.a) + t.point);
    sum.penetration = std::max(sum.penetration, pair.penetration);
    weights[k] += pair.weight;
  }
  for (size_t i = 0; i < result.size(); ++i) {
    if (weights[i] > 0) result[i].point /= weights[i];
  }
  return result;
}

}  // namespace apothem
