#include "lib/contact/rigid/polygon_events.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

// Change of the length inside that counts as sudden, relative to the inradius.
constexpr double kSudden = .03;
// Largest potential that counts as round-off at the start of a simulation.
constexpr double kAtFirst = 1e-9;
constexpr double kPairTime = 2000;   // ns
constexpr int kMostLooks = 1 << 14;  // largest number of pairs of a vertex and an edge to be tested
constexpr size_t kMostKinks = 8;
constexpr double kAtOnce = 1e-3;  // kinks closer than this fraction of the step are one
constexpr int kMostPanels = 8;    // largest number of panels of a step with kinks

// Calls f(coordinate, index in a load, sign) for the coordinates of both bodies of a pair.
template <class F>
void each_coordinate(RigidIndex a, RigidIndex b, const F& f) {
  const size_t of_a = 3 * static_cast<size_t>(a), of_b = 3 * static_cast<size_t>(b);
  f(of_a, 0, 1.), f(of_a + 1, 1, 1.), f(of_a + 2, 2, 1.);
  f(of_b, 0, -1.), f(of_b + 1, 1, -1.), f(of_b + 2, 3, 1.);
}

}  // namespace

struct PolygonEvents::Path {
  RigidIndex a, b;
  std::array<double, 3> rate_a, rate_b;  // change of the pose in the whole step
  double angle_a, angle_b;               // angles at the end of the step
  Vec2 between;                          // a relative to b at the end of the step

  [[nodiscard]] double turn_a(double theta) const { return angle_a - (1 - theta) * rate_a[2]; }
  [[nodiscard]] double turn_b(double theta) const { return angle_b - (1 - theta) * rate_b[2]; }
  [[nodiscard]] Vec2 offset(double theta) const {
    return {between.x() - (1 - theta) * (rate_a[0] - rate_b[0]),
            between.y() - (1 - theta) * (rate_a[1] - rate_b[1])};
  }
};

bool PolygonEvents::find(const PairIntegrals& pairs, const PatchTangential* tangential,
                         const Kinematics& now, const Dynamics& dynamics, double dt) {
  std::vector<TouchingPair>& now_touching = watch_.begin_step();
  tangential_ = tangential;
  for (const PairInTouch& result : pairs.touching()) {
    const PairIntegral& pair = pairs.integral(result);
    if (!(dt > 0) && pair.largest_phi < kAtFirst) continue;
    const double k = table_.between(result.a, result.b).normal_stiffness * thickness_;
    const double arm = surfaces_.inradius(result.a);
    now_touching.push_back({result.a, result.b, pair.inside_a, pair.inside_b,
                            pair.own_length_a + pair.own_length_b, k * pair.force.norm(),
                            k * pair.moment_a / arm});
  }
  changed_.clear(), impulses_.clear();
  if (!(dt > 0)) return false;
  watch_.compare(
      [&](RigidIndex a, RigidIndex b) {
        return kSudden * std::min(surfaces_.inradius(a), surfaces_.inradius(b));
      },
      [&](const PairChange& change) { changed_.push_back(change); });
  impulses_.resize(changed_.size());
  threads_.chunks(
      static_cast<int>(changed_.size()), kPairTime, [&](int first, int end, int worker) {
        for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
          impulses_[i] =
              find_pair(changed_[i], now, dynamics, dt, workers_[static_cast<size_t>(worker)]);
        }
      });
  find_friction_loss(now, dynamics, dt);
  return !impulses_.empty();
}

// Finds the work of friction in the impulses. The velocities are those after all other impulses and
// after half of the change by the friction.
void PolygonEvents::find_friction_loss(const Kinematics& now, const Dynamics& dynamics, double dt) {
  loss_ = 0;
  if (!tangential_) return;
  all_.resize(now.pose_rate.size());
  parts_.resize(now.pose_rate.size());
  for (const Impulse& i : impulses_) {
    each_coordinate(i.a, i.b, [&](size_t c, size_t k, double sign) {
      all_[c] += sign * i.mean[k];
      parts_[c] += sign * i.friction[k];
    });
  }
  for (const Impulse& i : impulses_) {
    double power = 0;
    each_coordinate(i.a, i.b, [&](size_t c, size_t k, double sign) {
      const double weight = dynamics.weight.empty() ? 0 : dynamics.weight[c];
      // Mean force during dt / 2.
      const double pushed = dynamics.after[c] + weight + 2 * all_[c] - parts_[c];
      const double speed = now.pose_rate[c] + dt / 2 * dynamics.inverse_mass[c] * pushed;
      power += sign * i.friction[k] * speed;
    });
    loss_ -= dt * power;
  }
  for (const Impulse& i : impulses_) {
    each_coordinate(i.a, i.b, [&](size_t c, size_t, double) { all_[c] = parts_[c] = 0; });
  }
}

// Finds the missing impulse of friction, which is proportional to the normal force. It is left out
// for pairs with several patches, each of which has friction of its own.
PolygonEvents::Load PolygonEvents::find_friction(const PairChange& pair,
                                                 const SampleWorkspace& worker,
                                                 size_t inside) const {
  // A force below this fraction of the mean force is about to vanish.
  constexpr double kVanishes = 1e-3;
  Load friction{};
  if (!table_.between(pair.a, pair.b).rough()) return friction;
  const std::optional<PairForce> none = PairForce{};
  const std::array known_friction{
      pair.before >= 0 ? tangential_->friction_before(pair.a, pair.b) : none,
      pair.now >= 0 ? tangential_->friction(pair.a, pair.b) : none};
  if (!known_friction[0] || !known_friction[1]) return friction;
  const auto size = [&](size_t i) {
    const Load& load = worker.loads[i];
    return std::sqrt(load[0] * load[0] + load[1] * load[1]);
  };
  const std::array ends{size(0), size(inside - 1)};
  double mean = 0;
  for (size_t i = 0; i < inside; ++i) mean += worker.samples[i].mean * size(i);
  const double lacks = mean - (ends[0] + ends[1]) / 2;
  // A force that is about to vanish says nothing about the rest of the step.
  const double least = kVanishes * 2 * mean;
  const double known = (ends[0] > least ? 1 : 0) + (ends[1] > least ? 1 : 0);
  for (const size_t end : {0, 1}) {
    if (!(ends[end] > least)) continue;
    const double fraction = lacks / ends[end] / known;
    const PairForce& force = *known_friction[end];
    friction[0] += fraction * force.x, friction[1] += fraction * force.y;
    friction[2] += fraction * force.a, friction[3] += fraction * force.b;
  }
  return friction;
}

// Finds the loads at all samples. Those of convex polygons are evaluated several at a time.
void PolygonEvents::find_loads(const Path& path, SampleWorkspace& worker) const {
  const PlacedShapes& shapes = surfaces_.shapes();
  const double k = table_.between(path.a, path.b).normal_stiffness * thickness_;
  worker.loads.clear();
  const auto add = [&](const PairIntegral& pair) {
    worker.loads.push_back(
        {k * pair.force.x(), k * pair.force.y(), k * pair.moment_a, k * pair.moment_b});
  };
  ConvexPairs& together = worker.edges.convex;
  const auto evaluate = [&] {
    for (const PairIntegral& pair : together.evaluate()) add(pair);
  };
  for (const EventSample& sample : worker.samples) {
    const auto index = static_cast<size_t>(together.count());
    const auto [turn_a, turn_b] =
        sine_cosine({path.turn_a(sample.theta), path.turn_b(sample.theta)});
    const PlacedPotential a = shapes.turn(path.a, turn_a, worker.turned[2 * index]);
    const PlacedPotential b = shapes.turn(path.b, turn_b, worker.turned[2 * index + 1]);
    const Vec2 offset = path.offset(sample.theta);
    if (!ConvexPairs::serves(a) || !ConvexPairs::serves(b)) {
      add(pair_integral(a, b, offset, worker.edges));
      continue;
    }
    worker.near[index] = {};
    together.add(a, b, offset, worker.near[index]);
    if (together.full()) evaluate();
  }
  evaluate();
}

// Finds the kinks of the force, where a vertex of one polygon crosses an edge of the other one.
// Heights are linear in theta except for the rotation within a step. Returns false if there are
// many kinks, or too many candidates: each kink then concerns a small part of the force, and
// equidistant samples are sufficient.
bool PolygonEvents::find_kinks(const Path& path, SampleWorkspace& worker) const {
  worker.kinks.clear();
  const PlacedShapes& shapes = surfaces_.shapes();
  if (shapes.view(path.a).size * shapes.view(path.b).size > kMostLooks) return false;
  const auto [turn_a, turn_b] = sine_cosine({path.turn_a(0), path.turn_b(0)});
  const PlacedPotential a0 = shapes.turn(path.a, turn_a, worker.start_a);
  const PlacedPotential b0 = shapes.turn(path.b, turn_b, worker.start_b);
  const PlacedPotential a1 = shapes.view(path.a);
  const PlacedPotential b1 = shapes.view(path.b);
  find_crossings(a0, a1, b0, b1, path.offset(0), path.offset(1), worker.kinks);
  find_crossings(b0, b1, a0, a1, -path.offset(0), -path.offset(1), worker.kinks);
  std::ranges::sort(worker.kinks);
  if (worker.kinks.size() <= kMostKinks) return true;
  // Where many vertices cross at once, as the teeth of a comb that lands, they count as one kink.
  const auto same = [](double a, double b) { return b - a < kAtOnce; };
  worker.kinks.erase(std::unique(worker.kinks.begin(), worker.kinks.end(), same),
                     worker.kinks.end());
  if (worker.kinks.size() <= kMostKinks) return true;
  worker.kinks.clear();
  return false;
}

// Finds where vertices of x cross edges of y. Coordinates are given at the start (0) and at the end
// (1) of the step; `offset` leads from y to x.
void PolygonEvents::find_crossings(const PlacedPotential& x0, const PlacedPotential& x1,
                                   const PlacedPotential& y0, const PlacedPotential& y1,
                                   const Vec2& offset0, const Vec2& offset1,
                                   std::vector<double>& kinks) {
  constexpr double kRound = 1e-9;
  Box all;
  for (int j = 0; j < y1.size; ++j) {
    all.include(y0.x[j], y0.y[j]);
    all.include(y1.x[j], y1.y[j]);
  }
  for (int i = 0; i < x1.size; ++i) {
    const Vec2 p0(x0.x[i] + offset0.x(), x0.y[i] + offset0.y());
    const Vec2 p1(x1.x[i] + offset1.x(), x1.y[i] + offset1.y());
    if (apart(box_of(p0, p1), all)) continue;
    for (int j = 0; j < y1.size; ++j) {
      const double h0 = y0.gx[j] * (p0.x() - y0.x[j]) + y0.gy[j] * (p0.y() - y0.y[j]);
      const double h1 = y1.gx[j] * (p1.x() - y1.x[j]) + y1.gy[j] * (p1.y() - y1.y[j]);
      const double theta = crossing(h0, h1);
      if (theta < 0) continue;
      const auto interpolated = [&](const double* q0, const double* q1, int k) {
        return q0[k] + theta * (q1[k] - q0[k]);
      };
      const Vec2 p = p0 + theta * (p1 - p0);
      const Vec2 from(interpolated(y0.x, y1.x, j), interpolated(y0.y, y1.y, j));
      const int end = y1.end(j);
      const Vec2 edge = Vec2(interpolated(y0.x, y1.x, end), interpolated(y0.y, y1.y, end)) - from;
      const double along = edge.dot(p - from) / edge.squaredNorm();
      if (along > -kRound && along < 1 + kRound) kinks.push_back(theta);
    }
  }
}

PolygonEvents::Impulse PolygonEvents::find_pair(const PairChange& pair, const Kinematics& now,
                                                const Dynamics& dynamics, double dt,
                                                SampleWorkspace& worker) const {
  const RigidIndex a = pair.a, b = pair.b;
  const auto rate = [&](RigidIndex i) { return &now.pose_rate[3 * static_cast<size_t>(i)]; };
  const auto step = [&](RigidIndex i) {
    return std::array{dt * rate(i)[0], dt * rate(i)[1], dt * rate(i)[2]};
  };
  const Path path{
      a, b, step(a), step(b), surfaces_.pose(a)[2], surfaces_.pose(b)[2], surfaces_.between(a, b)};
  const bool few = find_kinks(path, worker);
  const int most = kMostPanels / (static_cast<int>(worker.kinks.size()) + 1);
  const int panels = std::clamp(few ? pair.panels : kFewPanels, 1, std::max(most, 1));
  const auto inside = static_cast<size_t>(find_event_samples(worker.kinks, panels, worker.samples));
  find_loads(path, worker);
  std::array<EventForces, 4> forces;
  for (size_t i = 0; i < worker.samples.size(); ++i) {
    const Load& load = worker.loads[i];
    for (size_t k = 0; k < 4; ++k) {
      forces[k].add(worker.samples[i], load[k]);
      if (i == 0) forces[k].first = load[k];
      if (i + 1 == inside) forces[k].last = load[k];
    }
  }
  Load friction = find_friction(pair, worker, inside);
  Load missing;
  for (size_t k = 0; k < 4; ++k) missing[k] = forces[k].missing();
  const auto rest_of = [&](RigidIndex body, size_t moment, double sign) {
    EventResidual rest(dt);
    for (const size_t axis : {0, 1, 2}) {
      const size_t k = axis < 2 ? axis : moment;
      const size_t c = 3 * static_cast<size_t>(body) + axis;
      EventForces f = forces[k];
      const double own = axis < 2 ? sign : 1;
      for (double* x : {&f.first, &f.last, &f.mean, &f.start_slope, &f.end_slope}) *x *= own;
      rest.add(f, {own * missing[k], own * friction[k]}, dynamics.others(c, f),
               dynamics.inverse_mass[c], now.pose_rate[c]);
    }
    return rest;
  };
  EventResidual rest = rest_of(a, 2, 1);
  rest.add(rest_of(b, 3, -1));
  const double correction = rest.correction();
  for (size_t k = 0; k < 4; ++k) missing[k] += correction * forces[k].mean + friction[k];
  // Moments of forces at earlier positions do not balance at the end of the step. Half of the
  // difference goes to each body, so that the angular momentum is conserved.
  const auto balance = [&](Load& part) {
    const double couple = cross(path.between, Vec2(part[0], part[1])) + (part[2] + part[3]);
    part[2] -= couple / 2;
    part[3] -= couple / 2;
  };
  balance(missing), balance(friction);
  return {a, b, missing, friction};
}

void PolygonEvents::add(double scale, std::span<double> forces) const {
  for (const Impulse& i : impulses_) {
    double* fa = &forces[3 * static_cast<size_t>(i.a)];
    double* fb = &forces[3 * static_cast<size_t>(i.b)];
    fa[0] += scale * i.mean[0];
    fa[1] += scale * i.mean[1];
    fa[2] += scale * i.mean[2];
    fb[0] -= scale * i.mean[0];
    fb[1] -= scale * i.mean[1];
    fb[2] += scale * i.mean[3];
  }
}

}  // namespace apothem
