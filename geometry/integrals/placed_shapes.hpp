// The shapes of all bodies where they are now: contiguous arrays for the contact kernel.
#pragma once

#include <span>
#include <vector>

#include "apothem/geometry/integrals/edge_integral.hpp"

namespace apothem {

class PlacedShapes {
 public:
  /// Adds a shape given in its body frame (reference point = mass centre) and returns its index.
  /// The potential must outlive this object.
  int add(const Potential& potential);

  /// Moves shape i: reference point to (x, y), rotated by `angle`.
  void place(int i, double x, double y, double angle);

  /// Coordinates of one shape at another angle.
  struct Turned {
    std::vector<double> x, y, gx, gy;
  };
  /// Shape i at an angle, in the memory of `turned`, which must live as long as the result is used.
  /// For shapes that do not deform.
  PlacedPotential turn(int i, double angle, Turned& turned) const;

  /// Adds a convex shape whose vertices will move by themselves. The inverse lengths of its edges
  /// stay those of `potential`.
  int add_deforming(const Potential& potential);

  /// Gives a deforming shape its vertices, relative to the reference point (x, y). False, with a
  /// shape that must not be used, if it is no longer strictly convex and counter-clockwise.
  bool deform(int i, double x, double y, std::span<const Vec2> vertices);

  [[nodiscard]] PlacedPotential view(int i) const {
    const Shape& s = shapes_[i];
    return {.x = x_.data() + s.placed,
            .y = y_.data() + s.placed,
            .gx = gx_.data() + s.placed,
            .gy = gy_.data() + s.placed,
            .size = s.size,
            .capped = s.capped,
            .roof = s.roof,
            .distance = s.distance,
            .reference = Vec2::Zero(),
            .radius = s.radius,
            .steepest = s.slope,
            .cells = s.cells,
            .cosine = s.cosine,
            .sine = s.sine,
            .shift = Vec2::Zero()};
  }
  /// True when the top of shape i's potential (the centre of its incircle) lies inside shape j;
  /// `offset` is i's reference point minus j's.
  [[nodiscard]] bool top_inside(int i, int j, const Vec2& offset) const;
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
  struct BodyFrame {
    std::vector<double> x, y, gx, gy;
  };
  struct Shape {
    size_t placed;  // number 0 in x_, y_, gx_, gy_, where it has all numbers of a PlacedPotential
    size_t edges;   // first of `size` numbers in the body frame
    int size;
    bool capped;
    double radius;
    double slope;
    double depth_ratio;
    Vec2 top;  // of the potential (see by_edge); of a deforming shape the mean vertex
    // Of a shape that is not convex.
    const Roof* roof;
    const DistanceField* distance;
    const CollarCells* cells;
    double cosine = 1, sine = 0;  // of its angle
  };
  struct Coordinates {
    double *x, *y, *gx, *gy;
  };
  // Writes the coordinates of a shape at an angle and returns their box.
  static Box rotate(const Shape& shape, const BodyFrame& body, double cosine, double sine,
                    const Coordinates& to);

  std::vector<Shape> shapes_;
  BodyFrame body_;                       // indexed by `edges`
  std::vector<double> inverse_length_;   // 1/m, of deforming shapes, the same
  std::vector<double> x_, y_, gx_, gy_;  // relative to the reference point, rotated
  std::vector<Box> boxes_;               // in the coordinates of the model
};

}  // namespace apothem
