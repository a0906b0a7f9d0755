// The moving front of a straight skeleton: the lines of the edges, the vertices on them, and when a
// triangle between three vertices collapses. This header is private to the construction of the
// straight skeleton.
#pragma once

#include <optional>
#include <vector>

#include "geometry/skeleton/double_double.hpp"
#include "geometry/skeleton/front_triangle.hpp"

namespace apothem {

/// The line of an edge: at the time t the points x on it fulfil normal . x = offset + t.
struct FrontLine {
  FineVec tangent, normal;
  DoubleDouble offset;
};

/// A vertex of the front, from the node at which it starts until the next event.
struct FrontVertex {
  FineVec start, speed;  // place at the time `since`; movement per time
  DoubleDouble since;
  int before, after;  // edges of the polygon on whose lines it moves: its front edges end and start
                      // in it
  int node;           // where it starts
};

/// The polygon's vertices, moved in random directions by at most `movement`, and so little that the
/// triangles remain triangles.
std::vector<FineVec> moved_vertices(const Polygon& polygon, const std::vector<Triangle>& triangles,
                                    double movement, unsigned seed);

/// Twice the area of a triangle, positive if it is counter-clockwise.
DoubleDouble twice_area(const FineVec& a, const FineVec& b, const FineVec& c);

/// The lines and vertices of the front. Times begin with 0, and the front moves with the speed 1.
class MovingFront {
 public:
  using Time = std::optional<DoubleDouble>;  // of an event, if there is one

  /// Adds the line from a to b as that of the next edge.
  void add_line(const FineVec& a, const FineVec& b);
  /// Adds a vertex between two edges, and returns its number.
  int add_vertex(const FineVec& start, const DoubleDouble& since, int before, int after, int node);

  [[nodiscard]] const FrontLine& line(int edge) const { return lines_[edge]; }
  [[nodiscard]] const FrontVertex& vertex(int i) const { return vertices_[i]; }
  [[nodiscard]] FineVec place(int vertex, const DoubleDouble& time) const {
    const FrontVertex& v = vertices_[vertex];
    return v.start + (time - v.since) * v.speed;
  }
  /// The point where the lines of three edges meet at a time. The two lines with the largest angle
  /// between them determine it.
  [[nodiscard]] FineVec meeting_point(int e, int f, int g, const DoubleDouble& time) const;

  /// The time at which a triangle collapses, seen from the time `now`. It may be earlier than `now`
  /// by round-off.
  [[nodiscard]] Time collapse_time(const FrontTriangle& t, const DoubleDouble& now) const;
  /// The time at which the front edge on side k of a triangle has shrunk to nothing.
  [[nodiscard]] Time shrink_time(const FrontTriangle& t, int k, const DoubleDouble& now) const;
  /// The time at which the corner opposite to the front edge on side k reaches the edge's line.
  [[nodiscard]] Time reach_time(const FrontTriangle& t, int k, const DoubleDouble& now) const;

 private:
  [[nodiscard]] Time flat_time(const FrontTriangle& t, const DoubleDouble& now) const;
  [[nodiscard]] Time end_time(const FrontTriangle& t, const DoubleDouble& now) const;

  std::vector<FrontLine> lines_;  // per edge of the polygon
  std::vector<FrontVertex> vertices_;
};

}  // namespace apothem
