// The impact of a rigid convex polygon on a rigid floor, integrated without the kernels: the floor
// is divided into many columns, and springs and dashpots act in each of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/polygon/point.hpp"

namespace apothem::test {

class ImpactByHand {
 public:
  /// What friction has: one spring for the whole contact, or one in each column, which slides where
  /// its own limit is reached.
  enum class Springs { one, in_columns };

  double stiffness = 0;  ///< contact stiffness over the reference length, N/m^3
  double friction = 0, stiffness_ratio = .8, damping_ratio = 0;
  double mass = 0, inertia = 0;
  std::vector<Vec2> polygon;      ///< around the mass centre
  Vec2 place = Vec2::Zero();      ///< of the mass centre, m; the floor is at y = 0
  Eigen::Vector3d rate{0, 0, 0};  ///< m/s, m/s, rad/s
  Springs springs = Springs::one;

  /// Velocity and spin at the time `end`, s.
  Eigen::Vector3d after(double end, double dt) {
    columns_.assign(static_cast<size_t>(2 * kHalf / kWidth), {});
    const Eigen::Vector3d inverse(1 / mass, 1 / mass, 1 / inertia);
    Eigen::Vector3d force(0, 0, 0);
    const auto steps = static_cast<int>(std::lround(end / dt));
    for (int i = 0; i < steps; ++i) {
      rate += dt / 2 * force.cwiseProduct(inverse);
      place += dt * rate.head<2>(), angle_ += dt * rate[2];
      force = find_force(dt);
      rate += dt / 2 * force.cwiseProduct(inverse);
    }
    return rate;
  }

 private:
  static constexpr double kHalf = .25, kWidth = 4e-5;  // m
  struct Column {
    double pressed = 0, stiffness = 0, push = 0;  // N, N/m, N
    double spring = 0, spring_stiffness = 0;
  };
  struct Edge {
    Vec2 from, to, tangent;
  };

  // Calls f(column, x, width) for the columns between two places, which some fill in part.
  template <class F>
  void each_column(double from, double to, const F& f) {
    const auto number = [](double x) {
      const double at = std::floor((x + kHalf) / kWidth);
      return static_cast<size_t>(std::clamp(at, 0., 2 * kHalf / kWidth - 1));
    };
    if (!(from < to)) return;
    const size_t first = number(from), last = number(to);
    first_ = std::min(first_, first), end_ = std::max(end_, last + 1);
    for (size_t i = first; i <= last; ++i) {
      const double left = std::max(from, static_cast<double>(i) * kWidth - kHalf);
      const double right = std::min(to, static_cast<double>(i + 1) * kWidth - kHalf);
      if (left < right) f(columns_[i], (left + right) / 2, right - left);
    }
  }

  void place_edges() {
    edges_.clear();
    const double c = std::cos(angle_), s = std::sin(angle_);
    const auto placed = [&](const Vec2& p) -> Vec2 {
      return place + Vec2(c * p.x() - s * p.y(), s * p.x() + c * p.y());
    };
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 from = placed(polygon[i]), to = placed(polygon[(i + 1) % polygon.size()]);
      edges_.push_back({from, to, (to - from).normalized()});
    }
  }

  // The edges of the body in the floor are pushed with their depth, at right angles.
  void press_edges(Eigen::Vector3d& force) {
    for (const Edge& e : edges_) {
      const double fall = e.from.y() - e.to.y();
      const double first = e.from.y() > 0 ? std::min(e.from.y() / fall, 1.) : 0;
      const double last = e.to.y() > 0 ? e.from.y() / fall : 1;
      if ((e.from.y() >= 0 && e.to.y() >= 0) || e.tangent.x() == 0) continue;
      const Vec2 start = e.from + first * (e.to - e.from), end = e.from + last * (e.to - e.from);
      const double side = end.x() > start.x() ? 1 : -1;
      const double slope = e.tangent.y() / e.tangent.x();
      each_column(std::min(start.x(), end.x()), std::max(start.x(), end.x()),
                  [&](Column& column, double x, double width) {
                    const double y = start.y() + (x - start.x()) * slope;
                    const double up = side * stiffness * -y * width;
                    column.pressed += up;
                    if (side > 0) column.stiffness += stiffness * width;
                    force += Eigen::Vector3d(-up * slope, up,
                                             up * (x - place.x()) + up * slope * (y - place.y()));
                  });
    }
  }

  // The floor is pushed with its depth in the body, and pushes back.
  void press_floor(Eigen::Vector3d& force) {
    double from = -kHalf, to = kHalf;
    for (const Edge& e : edges_) {
      const double x = e.from.x() - e.from.y() * e.tangent.x() / e.tangent.y();
      if (e.tangent.y() < 0) from = std::max(from, x);
      if (e.tangent.y() > 0) to = std::min(to, x);
    }
    each_column(from, to, [&](Column& column, double x, double width) {
      double depth = HUGE_VAL, along = 0;
      for (const Edge& e : edges_) {
        const double distance = -e.tangent.x() * e.from.y() - e.tangent.y() * (x - e.from.x());
        if (distance < depth) depth = distance, along = e.tangent.x();
      }
      const double up = stiffness * std::max(depth, 0.) * width;
      column.pressed += up;
      column.stiffness += stiffness * std::max(along, 0.) * width;
      force += Eigen::Vector3d(0, up, up * (x - place.x()));
    });
  }

  // The time of a dashpot, c/k, for a force at `arm` across its direction.
  [[nodiscard]] double time_of(double k, double arm) const {
    return 2 * damping_ratio / std::sqrt(k * (1 / mass + arm * arm / inertia));
  }

  Eigen::Vector3d find_force(double dt) {
    Eigen::Vector3d force(0, 0, 0);
    place_edges();
    for (size_t i = first_; i < end_; ++i) {
      columns_[i].pressed = columns_[i].stiffness = columns_[i].push = 0;
    }
    const size_t first_before = first_, end_before = end_;
    first_ = columns_.size(), end_ = 0;
    press_edges(force), press_floor(force);
    for (size_t i = first_before; i < end_before; ++i) {
      if (columns_[i].stiffness > 0) continue;
      columns_[i].spring = columns_[i].spring_stiffness = 0;
    }
    double k = 0;
    for (size_t i = first_; i < end_; ++i) k += columns_[i].stiffness;
    if (!(force.y() > 0 && k > 0)) {
      one_ = {};
      return force;
    }
    damp(k, force);
    rub(k, dt, force);
    return force;
  }

  // No column pulls.
  void damp(double k, Eigen::Vector3d& force) {
    const double time = time_of(k, force[2] / force[1]);
    for (size_t i = first_; i < end_; ++i) {
      Column& column = columns_[i];
      const double arm = (static_cast<double>(i) + .5) * kWidth - kHalf - place.x();
      column.push = std::max(-time * column.stiffness * (rate[1] + rate[2] * arm),
                             -std::max(column.pressed, 0.));
      force += Eigen::Vector3d(0, column.push, column.push * arm);
    }
  }

  void rub(double k, double dt, Eigen::Vector3d& force) {
    const double height = place.y(), slip = rate[0] + rate[2] * height;
    const double time = time_of(stiffness_ratio * k, height);
    double drag = 0;
    const auto follow = [&](Column& column, double normal_stiffness, double pressed) {
      const double spring = stiffness_ratio * normal_stiffness, limit = friction * pressed;
      if (spring < column.spring_stiffness) column.spring *= spring / column.spring_stiffness;
      column.spring = std::clamp(column.spring - spring * slip * dt, -limit, limit);
      column.spring_stiffness = spring;
      drag += std::clamp(column.spring - time * spring * slip, -limit, limit);
    };
    double pressed = 0;
    for (size_t i = first_; i < end_; ++i) {
      const double own = std::max(columns_[i].pressed + columns_[i].push, 0.);
      pressed += own;
      if (springs == Springs::in_columns) follow(columns_[i], columns_[i].stiffness, own);
    }
    if (springs == Springs::one) follow(one_, k, pressed);
    force += Eigen::Vector3d(drag, 0, height * drag);
  }

  double angle_ = 0;
  std::vector<Edge> edges_;
  std::vector<Column> columns_;
  Column one_;                  // the spring of the whole contact
  size_t first_ = 0, end_ = 0;  // columns in contact
};

}  // namespace apothem::test
