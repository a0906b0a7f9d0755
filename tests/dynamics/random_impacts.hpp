// Random impacts of two bodies. The same seed gives the same impact on every platform.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "apps/cases/samples.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/model/model.hpp"
#include "lib/model/settings.hpp"

namespace apothem::samples {

/// What may happen in a random impact.
struct ImpactKind {
  bool fixed_partner = true;  ///< sometimes the second body cannot move
  bool friction = true;       ///< sometimes
  double damping = 0;         ///< largest ratio of normal and tangential dashpots; 0: none
  double least_damping = 0;   ///< smallest ratio
};

struct RandomImpact {
  Model model;
  double time = 0;      ///< s, that it takes at most until the bodies are apart for good
  std::string summary;  ///< what it is, in words
};

namespace detail {

inline double log_uniform(Random& random, double a, double b) {
  return std::exp(random.uniform(std::log(a), std::log(b)));
}

inline Polygon random_shape(Random& random, std::string& name) {
  switch (random.integer(0, 8)) {
    case 0:
      name = "quad";
      return random_quad(random);
    case 1: {
      const int n = random.integer(3, 12);
      name = fmt::format("convex-{}", n);
      return random_convex(random, n);
    }
    case 2: {
      const int n = random.integer(3, 8);
      name = fmt::format("regular-{}", n);
      return regular(n);
    }
    case 3: {
      const auto n = static_cast<int>(log_uniform(random, 9, 101));
      name = fmt::format("regular-{}", n);
      return regular(n);
    }
    case 4:
      name = "cross";
      return cross_of_squares(random.uniform(.3, 1.5));
    case 5: {
      const int tips = random.integer(3, 12);
      name = fmt::format("star-{}", tips);
      return star(tips, random.uniform(.3, .8));
    }
    case 6: {
      const int n = random.integer(5, 60);
      name = fmt::format("rough-{}", n);
      return random_star_shaped(random, n, random.uniform(.4, .9));
    }
    case 7:
      name = "bar";
      return block(0, 0, random.uniform(1, 6), 1);
    default:
      name = "L";
      return l_shape(random.uniform(1.3, 3));
  }
}

// How far `a` can move along `direction` until it meets `b`; HUGE_VAL if it passes.
inline double way_to(const std::vector<Vec2>& a, const std::vector<Vec2>& b,
                     const Vec2& direction) {
  double way = HUGE_VAL;
  const auto rays = [&](const std::vector<Vec2>& from, const std::vector<Vec2>& to, const Vec2& d) {
    for (const Vec2& p : from) {
      for (size_t i = 0; i < to.size(); ++i) {
        const Vec2& u = to[i];
        const Vec2 e = after(to, i) - u;
        const double det = cross(d, e);
        if (det == 0) continue;
        const double t = cross(Vec2(u - p), e) / det, s = cross(Vec2(u - p), d) / det;
        if (s >= 0 && s <= 1 && t >= 0) way = std::min(way, t);
      }
    }
  };
  rays(a, b, direction);
  rays(b, a, -direction);
  return way;
}

inline double extent(const Polygon& p) {
  double r = 0;
  for (const Vec2& v : p.vertices()) r = std::max(r, v.norm());
  return r;
}

// The direction out of the body across a random edge of its convex hull.
inline double hull_normal(Random& random, const Polygon& p) {
  // A random direction, then the edge whose both ends are the farthest in some direction near it.
  const double angle = random.uniform(-M_PI, M_PI);
  double best = HUGE_VAL, normal = angle;
  const std::vector<Vec2>& v = p.vertices();
  for (size_t i = 0; i < v.size(); ++i) {
    for (size_t j = 0; j < v.size(); ++j) {
      if (i == j) continue;
      const Vec2 e = v[j] - v[i];
      const Vec2 n = Vec2(e.y(), -e.x()) / e.norm();
      const double reach = n.dot(v[i]);
      if (!std::ranges::all_of(v, [&](const Vec2& q) { return n.dot(q) <= reach + 1e-9; }))
        continue;
      const double at = std::atan2(n.y(), n.x());
      const double off = std::abs(std::remainder(at - angle, 2 * M_PI));
      if (off < best) best = off, normal = at;
    }
  }
  return normal;
}

}  // namespace detail

/// Two rigid bodies, convex or not, of 3 to 100 corners and a mass ratio of 1e-3 to 1e3, a little
/// before they touch: flat, tilted by up to half a radian, or anyhow.
inline RandomImpact random_impact(std::uint64_t seed, const ImpactKind& kind = {}) {
  using namespace detail;
  Random random(seed * 7919 + 17);
  RandomImpact impact;
  Model& model = impact.model;
  std::string name_a, name_b;
  const double ratio = log_uniform(random, 1e-3, 1e3);
  const bool fixed = random.integer(0, 1) == 0 && kind.fixed_partner;
  const bool rough = random.integer(0, 1) == 0 && kind.friction;
  const double mu = random.uniform(.05, 1);
  const double share = random.uniform(.3, 1);
  const auto shape = [&](std::string& name) {
    for (;;) {
      const Polygon p = random_shape(random, name);
      const Polygon centred = shifted(p, -world_centroid(p));
      return scaled(centred, log_uniform(random, .1, 1) / extent(centred));
    }
  };
  Polygon a = shape(name_a);
  Polygon b = shape(name_b);
  if (fixed && random.integer(0, 1) == 0) {
    b = block(-3, -1, 3, 1);
    name_b = "floor";
  }
  // Turned so that faces of both look at each other, but for a tilt.
  double tilt = 0;
  const int pose = random.integer(0, 3);
  if (pose == 1) tilt = log_uniform(random, 1e-5, .5);
  if (pose == 2) tilt = random.uniform(0, .5);
  if (pose == 3) tilt = random.uniform(-M_PI, M_PI);
  const double up = name_b == "floor" ? M_PI / 2 : hull_normal(random, b);
  b = turned(b, M_PI / 2 - up);
  a = turned(a, -M_PI / 2 - hull_normal(random, a) + tilt);
  const double ra = extent(a), rb = extent(b);
  const double speed = log_uniform(random, .1, 10);
  model.materials = {{"a", 2000}, {"b", 2000}};
  {
    RigidBody first, second;
    set_shape(first, a, model), set_shape(second, b, model);
    if (!fixed) model.materials[1].density *= ratio * first.area / second.area;
  }
  double along = 0;
  Vec2 from, direction;
  for (double way = HUGE_VAL; !std::isfinite(way);) {
    direction = turned(Vec2(0, -1), random.integer(0, 1) == 0 ? 0 : random.uniform(-.6, .6));
    const double aside = random.uniform(-.7, .7) * (name_b == "floor" ? 1 : std::min(ra, rb));
    from = -direction * 2 * (ra + rb) + Vec2(aside, 0);
    way = way_to(shifted(a, from).vertices(), b.vertices(), direction);
    along = way;
  }
  // Deep by 1e-4 to 1e-2 of the size, roughly: k d^2 / 2 = m v^2 / 2 per area.
  const double depth = log_uniform(random, 1e-4, 1e-2);
  model.contact.normal_stiffness = 2000 * speed * speed / (depth * depth);
  if (rough) {
    model.contact.friction = {mu, share * model.contact.normal_stiffness};
  }
  if (kind.damping > 0) {
    model.contact.damping.normal = log_uniform(random, kind.least_damping, kind.damping);
    if (rough) model.contact.damping.tangential = model.contact.damping.normal;
  }
  const double spin = random.integer(0, 1) == 0 ? 0 : random.uniform(-1, 1) * speed / ra;
  const auto add = [&](const Polygon& p, const char* name, MaterialIndex material,
                       const Vec2& velocity, double turning) -> RigidBody& {
    RigidBody body;
    body.name = name;
    body.material = material;
    set_shape(body, p, model);
    body.velocity = velocity;
    body.spin = turning;
    model.bodies.push_back(body);
    return model.bodies.back();
  };
  const double gap = std::min(ra, rb) * 1e-2 * random.uniform(.1, 1);
  const Vec2 place = from + direction * (along - gap);
  // The first body moves, or both, or the second one.
  const double part = fixed ? 1 : std::array{1., 0., .5}[static_cast<size_t>(random.integer(0, 2))];
  add(shifted(a, place), "a", 0, part * speed * direction, spin);
  const double other = fixed || random.integer(0, 1) == 0 ? 0 : random.uniform(-1, 1) * speed / rb;
  add(b, "b", 1, (part - 1) * speed * direction, other);
  if (fixed) model.bodies.back().motion = Motion::fixed;
  impact.time = (gap + 4 * std::min(ra, rb)) / speed;
  impact.summary = fmt::format(
      "{}: {} on {}{}, tilt {:.1e}, mass ratio {:.1e}, v {:.2f}, spin {:.1f}{}, depth {:.0e}{}",
      seed, name_a, fixed ? "fixed " : "", name_b, tilt, fixed ? 0. : ratio, speed, spin,
      rough ? fmt::format(", mu {:.2f}", mu) : "", depth,
      kind.damping > 0 ? fmt::format(", damping {:.2f}", model.contact.damping.normal) : "");
  return impact;
}

/// What an impact has left of the energy.
struct ImpactResult {
  double error = 0;          ///< total error after the separation, of the kinetic energy before
  double kept = 0;           ///< kinetic energy after it, of that before
  std::int64_t steps = 0;    ///< of which bodies touch
  std::int64_t changes = 0;  ///< of the step
  bool touched = false;
  std::string unstable;  ///< why the run has ended, if it has
};

/// The step that is chosen at the start, s.
inline double start_step(const RandomImpact& impact, const TimeSettings& time) {
  return Simulation(impact.model, time, 1, 1).step_size();
}

/// Runs until the bodies have been apart for some time. Energies are those of the velocities
/// relative to the common centre of mass where both bodies can move.
inline ImpactResult run_impact(const RandomImpact& impact, const TimeSettings& time) {
  ImpactResult result;
  const Model& model = impact.model;
  TimeSettings settings = time;
  settings.end = impact.time;
  const auto inner = [&](const State& state) {
    double mass = 0, x = 0, y = 0;
    bool free = true;
    for (size_t i = 0; i < model.bodies.size(); ++i) {
      const double* const v = &state.v[3 * i];
      free = free && model.bodies[i].motion == Motion::free;
      mass += model.bodies[i].mass;
      x += model.bodies[i].mass * v[0], y += model.bodies[i].mass * v[1];
    }
    x = free ? x / mass : 0, y = free ? y / mass : 0;
    double energy = 0;
    for (size_t i = 0; i < model.bodies.size(); ++i) {
      const double* const v = &state.v[3 * i];
      energy += (model.bodies[i].mass * ((v[0] - x) * (v[0] - x) + (v[1] - y) * (v[1] - y)) +
                 model.bodies[i].inertia * v[2] * v[2]) /
                2;
    }
    return energy;
  };
  try {
    Simulation simulation(model, settings, 1, 1);
    const double before = inner(simulation.state());
    double since = 0;
    const double wait = impact.time / 20;
    while (simulation.state().time < impact.time) {
      simulation.step();
      if (simulation.counts().touching_now > 0) {
        result.touched = true, since = 0;
        ++result.steps;
      } else if (result.touched) {
        since += simulation.step_size();
        if (since > wait) break;
      }
    }
    result.error = simulation.energies().total_error / before;
    result.kept = inner(simulation.state()) / before;
    result.changes = simulation.step_changes().shortened + simulation.step_changes().lengthened;
  } catch (const Unstable& error) {
    result.unstable = error.what();
  }
  return result;
}

}  // namespace apothem::samples
