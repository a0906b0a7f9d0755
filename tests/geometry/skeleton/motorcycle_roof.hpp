// An independent roof for polygons in general position, with or without holes: the lower envelope
// of the edges' slabs, bounded by the tracks of the motorcycle graph (Huber & Held 2011; Cheng &
// Vigneron 2007).
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/polygon/polygon.hpp"
#include "geometry/polygon/predicates.hpp"

namespace apothem::test {

class MotorcycleRoof {
 public:
  explicit MotorcycleRoof(const Polygon& polygon)
      : polygon_(polygon), vertices_(polygon.local_vertices()) {
    for (int i = 0; i < size(); ++i) tangents_.push_back((end(i) - vertex(i)).normalized());
    tracks_.resize(vertices_.size());
    for (int i = 0; i < size(); ++i) {
      if (orientation(polygon.before(i), polygon[i], polygon.after(i)) >= 0) continue;
      const Vec2 p = normal(polygon.previous(i)), q = normal(i);
      tracks_[i] = {true, (p + q) / (1 + p.dot(q)), time_to_wall(i, (p + q) / (1 + p.dot(q)))};
    }
    run_motorcycles();
  }

  [[nodiscard]] double operator()(const Vec2& x) const {
    double lowest = std::numeric_limits<double>::infinity();
    for (int e = 0; e < size(); ++e) {
      const double height = normal(e).dot(x - vertex(e));
      if (height < 0 || height >= lowest) continue;
      if (right_of_start(e, x) && left_of_end(e, x)) lowest = height;
    }
    return lowest;
  }

 private:
  struct Track {
    bool exists = false;
    Vec2 speed = Vec2::Zero();
    double end = 0;  // time of the crash
  };
  [[nodiscard]] int size() const { return polygon_.size(); }
  [[nodiscard]] const Vec2& vertex(int i) const { return vertices_[i]; }
  [[nodiscard]] const Vec2& end(int e) const { return vertices_[polygon_.next(e)]; }
  [[nodiscard]] Vec2 normal(int e) const { return {-tangents_[e].y(), tangents_[e].x()}; }

  [[nodiscard]] double time_to_wall(int v, const Vec2& speed) const {
    double first = std::numeric_limits<double>::infinity();
    for (int e = 0; e < size(); ++e) {
      if (e == v || polygon_.next(e) == v) continue;
      const Vec2 side = end(e) - vertex(e);
      const double denominator = apothem::cross(speed, side);
      const double time = apothem::cross(vertex(e) - vertex(v), side) / denominator;
      const double u = apothem::cross(vertex(e) - vertex(v), speed) / denominator;
      if (time > 0 && u >= 0 && u <= 1) first = std::min(first, time);
    }
    return first;
  }

  // A motorcycle stops where another one has passed before, unless that one had stopped earlier.
  void run_motorcycles() {
    struct Meeting {
      double late, early;
      int loser, winner;
    };
    std::vector<Meeting> meetings;
    for (int i = 0; i < size(); ++i) {
      for (int j = 0; j < size(); ++j) {
        if (i == j || !tracks_[i].exists || !tracks_[j].exists) continue;
        const Vec2 &a = tracks_[i].speed, &b = tracks_[j].speed, d = vertex(j) - vertex(i);
        const double mine = apothem::cross(d, b) / apothem::cross(a, b);
        const double other = apothem::cross(d, a) / apothem::cross(a, b);
        if (other > 0 && mine >= other) meetings.push_back({mine, other, i, j});
      }
    }
    std::sort(meetings.begin(), meetings.end(),
              [](const Meeting& a, const Meeting& b) { return a.late < b.late; });
    for (const Meeting& m : meetings) {
      if (m.late < tracks_[m.loser].end && m.early <= tracks_[m.winner].end) {
        tracks_[m.loser].end = m.late;
      }
    }
  }

  // Sides of the slab of edge e: the track of a reflex vertex and, from its end or from a convex
  // vertex on, the perpendicular to the edge.
  [[nodiscard]] double border(int e, int v, double height) const {
    const Track& track = tracks_[v];
    const Vec2 base = vertex(v) - vertex(e);
    if (!track.exists) return tangents_[e].dot(base);
    return tangents_[e].dot(base + std::min(height, track.end) * track.speed);
  }
  [[nodiscard]] bool right_of_start(int e, const Vec2& x) const {
    return tangents_[e].dot(x - vertex(e)) >= border(e, e, normal(e).dot(x - vertex(e)));
  }
  [[nodiscard]] bool left_of_end(int e, const Vec2& x) const {
    return tangents_[e].dot(x - vertex(e)) <=
           border(e, polygon_.next(e), normal(e).dot(x - vertex(e)));
  }

  Polygon polygon_;
  std::vector<Vec2> vertices_;
  std::vector<Vec2> tangents_;
  std::vector<Track> tracks_;
};

}  // namespace apothem::test
