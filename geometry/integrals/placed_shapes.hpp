// The shapes of all bodies at their present positions, in contiguous arrays for the contact kernel.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "geometry/integrals/edge_integral.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {

class PlacedShapes {
 public:
  /// Reserves memory for this number of convex shapes with this number of vertices in total.
  void reserve(size_t shapes, size_t vertices);
  /// Adds a shape given in its body frame (reference point = mass centre) and returns its index.
  /// The potential must outlive this object.
  int add(const Potential& potential);

  /// Moves the reference point of shape i to (x, y) and rotates the shape by `angle`.
  void place(int i, double x, double y, double angle) { place(i, x, y, sine_cosine(angle)); }
  void place(int i, double x, double y, const SineCosine& angle);

  /// Memory for the coordinates of one shape at another angle.
  struct Turned {
    std::vector<double> numbers;
  };
  /// Shape i at an angle, in the memory of `turned`, which must live as long as the result is used.
  /// The shape must not be a deforming one.
  PlacedPotential turn(int i, const SineCosine& angle, Turned& turned) const;

  /// Adds a convex shape that deforms. The inverse lengths of its edges remain those of
  /// `potential`.
  int add_deforming(const Potential& potential);

  /// Sets the vertices of a deforming shape, relative to the reference point (x, y). Returns false
  /// if the shape is no longer strictly convex and counter-clockwise; it must not be used then.
  bool deform(int i, double x, double y, std::span<const Vec2> vertices);

  [[nodiscard]] PlacedPotential view(int i) const {
    const Shape& s = shapes_[i];
    const double* const x = placed_.data() + s.placed;
    return {.x = x,
            .y = x + s.stride,
            .gx = x + 2 * s.stride,
            .gy = x + 3 * s.stride,
            .size = s.size,
            .capped = s.capped,
            .roof = s.roof,
            .distance = s.distance,
            .reference = Vec2::Zero(),
            .radius = s.radius,
            .steepest = s.slope,
            .layer = s.layer,
            .links = s.links,
            .cosine = s.cosine,
            .sine = s.sine,
            .shift = Vec2::Zero()};
  }
  /// Prefetches shape i: first the shape, then, when that is in the cache, its coordinates.
  void fetch(int i) const {
    __builtin_prefetch(&boxes_[i]);
    __builtin_prefetch(&shapes_[i]);
    __builtin_prefetch(reinterpret_cast<const char*>(&shapes_[i] + 1) - 1);
  }
  void fetch_coordinates(int i) const {
    constexpr int kLine = 8;  // numbers
    const double* const first = placed_.data() + shapes_[i].placed;
    for (int k = 0; k < 4 * shapes_[i].stride; k += kLine) __builtin_prefetch(first + k);
  }
  /// True if the highest point of shape i's potential (the centre of its incircle) lies inside
  /// shape j; `offset` is i's reference point minus j's.
  [[nodiscard]] bool top_inside(int i, int j, const Vec2& offset) const;
  /// top_inside is false if the reference points are farther apart than this, m; HUGE_VAL where
  /// shapes deform.
  [[nodiscard]] double top_reach(int i, int j) const {
    const Shape &own = shapes_[i], &other = shapes_[j];
    constexpr double kAmply = 1 + 1e-9;
    return own.radius > 0 && other.radius > 0 ? kAmply * (own.top_radius + other.radius) : HUGE_VAL;
  }
  [[nodiscard]] int size() const { return static_cast<int>(shapes_.size()); }
  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }
  /// True if shape i has a potential without a roof or a distance field.
  [[nodiscard]] bool convex(int i) const { return !shapes_[i].roof && !shapes_[i].distance; }
  /// Largest distance of a vertex from the reference point, m.
  [[nodiscard]] double radius(int i) const { return shapes_[i].radius; }
  /// Steepest slope of its potential, 1/m.
  [[nodiscard]] double slope(int i) const { return shapes_[i].slope; }
  /// The bound depth_ratio of its potential (penetration.hpp).
  [[nodiscard]] double depth_ratio(int i) const { return shapes_[i].depth_ratio; }

 private:
  // The members that every pair needs come first.
  struct Shape {
    size_t placed;  // index in placed_ where x begins; y, gx and gy follow
    int stride;     // distance from one of these arrays to the next
    int size;
    double radius;
    double slope;
    // The following are needed for shapes that are not convex.
    const Roof* roof;
    const DistanceField* distance;
    const BoundaryLayer* layer;
    const RingLinks* links;
    bool capped;
    double depth_ratio;
    double top_radius;  // distance of the highest point from the reference point
    Vec2 top;  // highest point of the potential (see by_edge); for a deforming shape the mean of
               // the vertices
    size_t edges;                 // index of the first edge among those of all shapes
    double cosine = 1, sine = 0;  // cosine and sine of its angle
  };
  struct Coordinates {
    double *x, *y, *gx, *gy;
  };
  // Writes the coordinates of a shape at an angle and returns their box.
  Box rotate(const Shape& shape, const SineCosine& angle, const Coordinates& target) const;
  // The arrays of a shape whose x begins at `first`.
  static Coordinates coordinates(double* first, int stride) {
    return {first, first + stride, first + 2 * stride, first + 3 * stride};
  }

  std::vector<Shape> shapes_;
  std::vector<double> body_;            // x, y, gx, gy of each shape in the body frame
  std::vector<double> inverse_length_;  // inverse length of each edge of deforming shapes, 1/m
  // x, y, gx, gy of each shape, rotated, relative to the reference point.
  std::vector<double> placed_;
  std::vector<Box> boxes_;  // box of each shape in the coordinates of the model
};

}  // namespace apothem
