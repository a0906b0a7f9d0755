#include "lib/dynamics/landing.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/contact/law/stiffness.hpp"

namespace apothem {
namespace {

constexpr double kStraight = 1e-9;  // sine of the angle of two edges that are one
constexpr double kGrowth = 1.02;    // of the length with the depth that does not matter

double cross_of(const Vec2& a, const Vec2& b, const Vec2& c) {
  return cross(Vec2(b - a), Vec2(c - a));
}

bool straight(const Vec2& a, const Vec2& b, const Vec2& c) {
  return std::abs(cross_of(a, b, c)) <= kStraight * (b - a).norm() * (c - b).norm() &&
         (b - a).dot(c - b) > 0;
}

// The vertices at which the boundary bends.
std::vector<Vec2> bends(const std::vector<Vec2>& v) {
  std::vector<Vec2> ring;
  for (size_t i = 0; i < v.size(); ++i) {
    const Vec2& last = before(v, i);
    if (!straight(last, v[i], after(v, i))) ring.push_back(v[i]);
  }
  return ring.size() < 3 ? v : ring;
}

// Counter-clockwise, by Andrew's monotone chain (Inf. Process. Lett. 9 (1979), 216).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  std::ranges::sort(points, [](const Vec2& p, const Vec2& q) {
    return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y());
  });
  std::vector<Vec2> hull;
  const auto turn = [&](auto first, auto end) {
    const size_t start = hull.size();
    for (; first != end; ++first) {
      while (hull.size() > start + 1 && !(cross_of(hull[hull.size() - 2], hull.back(), *first) >
                                          kStraight * (hull.back() - hull[hull.size() - 2]).norm() *
                                              (*first - hull.back()).norm())) {
        hull.pop_back();
      }
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  turn(points.begin(), points.end());
  turn(points.rbegin(), points.rend());
  return hull;
}

Landing landing_of(double length, double breadth, double arm, double height, int pieces,
                   const std::array<double, 3>& inverse_mass) {
  const double slide =
      std::max(inverse_mass[0], inverse_mass[1]) + height * height * inverse_mass[2];
  return {length, breadth, arm, height, strip_mobility(inverse_mass, arm, breadth), slide, pieces};
}

// What of a ring lies within a depth below the line through an edge of its hull.
class Cap {
 public:
  Cap(const std::vector<Vec2>& ring, const Vec2& from, const Vec2& to) {
    const Vec2 along = (to - from).normalized();
    for (size_t i = 0; i < ring.size(); ++i) {
      const Vec2 p = ring[i] - from, q = after(ring, i) - from;
      depths_.push_back(cross(along, p));
      Edge edge{cross(along, p), cross(along, q), along.dot(p), along.dot(q)};
      if (edge.depth_p > edge.depth_q) edge = {edge.depth_q, edge.depth_p, edge.q, edge.p};
      edges_.push_back(edge);
    }
    std::ranges::sort(edges_, {}, &Edge::depth_p);
    origin_ = along.dot(from);
    height_ = cross(along, Vec2(-from));
  }

  struct Part {
    double length = 0, low = HUGE_VAL, high = -HUGE_VAL;
  };
  [[nodiscard]] Part within(double depth) const {
    Part part;
    for (const Edge& e : edges_) {
      if (e.depth_p > depth) break;
      const double share = e.depth_q <= depth ? 1 : (depth - e.depth_p) / (e.depth_q - e.depth_p);
      const double end = e.p + share * (e.q - e.p);
      part.length += std::abs(end - e.p);
      part.low = std::min({part.low, e.p, end});
      part.high = std::max({part.high, e.p, end});
    }
    return part;
  }

  // The depth of a flat partner that has taken up the energy: see landings().
  [[nodiscard]] double depth_of(double energy, double extent) const {
    const double flat = within(round_off(extent)).length;
    if (!(energy > 0)) return round_off(extent);
    if (flat > 0) {
      const double depth = std::sqrt(2 * energy / flat);
      if (within(depth).length <= kGrowth * flat) return depth;
    }
    // The length grows with the depth, so that it bends the energy up: bisection between bounds.
    constexpr int kPanels = 16, kHalvings = 24;
    const auto energy_at = [&](double depth) {  // Simpson's rule
      double sum = 0;
      for (int k = 0; k <= kPanels; ++k) {
        const double x = depth * k / kPanels;
        const int weight = k == 0 || k == kPanels ? 1 : 2 + 2 * (k % 2);
        sum += weight * (depth - x) * within(x).length;
      }
      return sum * depth / (3 * kPanels);
    };
    double low = 0, high = extent;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = (low + high) / 2;
      (energy_at(middle) < energy ? low : high) = middle;
    }
    return high;
  }

  // Runs of vertices that lie within a depth.
  [[nodiscard]] int pieces(double depth) const {
    int count = 0;
    for (size_t i = 0; i < depths_.size(); ++i) {
      const double last = before(depths_, i);
      count += depths_[i] <= depth && last > depth ? 1 : 0;
    }
    return std::max(count, 1);
  }

  [[nodiscard]] Landing landing(double depth, const std::array<double, 3>& inverse_mass) const {
    const Part part = within(depth);
    const double breadth = part.high - part.low, arm = origin_ + (part.low + part.high) / 2;
    return landing_of(part.length, breadth, arm, height_, pieces(2 * depth), inverse_mass);
  }

 private:
  struct Edge {
    double depth_p, depth_q;  // of its ends, the first one less deep, m
    double p, q;              // of these along the line, m
  };
  [[nodiscard]] static double round_off(double extent) { return 1e-9 * extent; }

  std::vector<Edge> edges_;
  std::vector<double> depths_;  // of the vertices, m
  double origin_ = 0, height_ = 0;
};

// Those of which no other one is as long, moves as easily both ways and has as many pieces.
std::vector<Landing> undominated(std::vector<Landing> all) {
  std::ranges::stable_sort(all, [](const Landing& a, const Landing& b) {
    return a.length > b.length || (a.length == b.length && a.mobility > b.mobility);
  });
  std::vector<Landing> best;
  for (const Landing& landing : all) {
    const bool dominated = std::ranges::any_of(best, [&](const Landing& b) {
      return landing.mobility <= b.mobility && landing.slide <= b.slide &&
             landing.pieces <= b.pieces;
    });
    if (!dominated) best.push_back(landing);
  }
  return best;
}

}  // namespace

std::vector<Landing> landings(const RigidBody& body, double compliant_energy) {
  Rings rings = body.potential.rings();
  for (std::vector<Vec2>& each : rings) each = bends(each);
  const std::vector<Vec2>& ring = rings.front();
  const std::vector<Vec2> hull = convex_hull(ring);
  const std::array<double, 3> inverse_mass = body.inverse_mass();
  double extent = 0;
  for (const Vec2& v : ring) extent = std::max(extent, v.norm());
  std::vector<Landing> all;
  for (size_t i = 0; i < hull.size(); ++i) {
    const Cap cap(ring, hull[i], after(hull, i));
    const double depth = std::min(cap.depth_of(compliant_energy, extent), body.inradius);
    all.push_back(cap.landing(depth, inverse_mass));
  }
  // Edges in notches and in holes, which meet the corners of a partner.
  if (hull.size() == ring.size()) rings.erase(rings.begin());
  for (const std::vector<Vec2>& inner : rings) {
    for (size_t i = 0; i < inner.size(); ++i) {
      const Vec2& p = inner[i];
      const Vec2& q = after(inner, i);
      const double length = (q - p).norm();
      const Vec2 along = (q - p) / length;
      const double arm = along.dot((p + q) / 2);
      all.push_back(landing_of(length, length, arm, -cross(along, p), 1, inverse_mass));
    }
  }
  return undominated(std::move(all));
}

std::vector<double> fastest_speeds(const Model& model) {
  Box scene;
  for (const RigidBody& body : model.bodies) {
    for (const Vec2& v : body.potential.vertices) scene.include(body.position + v);
  }
  std::vector<double> speeds;
  for (const RigidBody& body : model.bodies) {
    double speed = body.velocity.norm();
    double spin = std::abs(body.spin);
    if (body.servo) speed = body.servo->speed;
    for (const auto& point : body.history.velocity) speed = std::max(speed, point.velocity.norm());
    for (const auto& point : body.history.spin) spin = std::max(spin, std::abs(point.spin));
    if (body.motion == Motion::free) {
      speed = std::sqrt(speed * speed + 2 * model.strongest_gravity() * scene.extent());
    }
    speeds.push_back(speed + spin * body.reach());
  }
  return speeds;
}

}  // namespace apothem
