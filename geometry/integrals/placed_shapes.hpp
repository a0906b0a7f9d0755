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
    std::vector<double> x, y, gx, gy, node_x, node_y;
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
    return {x_.data() + s.vertices,
            y_.data() + s.vertices,
            gx_.data() + s.edges,
            gy_.data() + s.edges,
            s.size,
            s.capped,
            s.roof,
            node_x_.data() + s.nodes,
            node_y_.data() + s.nodes,
            s.distance,
            Vec2::Zero(),
            s.radius,
            s.slope,
            s.cells};
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
  struct Shape {
    size_t vertices;  // first of size + 1 entries of x_, y_
    size_t edges;     // first of size entries of gx_, gy_
    int size;
    bool capped;
    double radius;
    double slope;
    double depth_ratio;
    Vec2 top;          // of the potential (see by_edge); of a deforming shape the mean vertex
    const Roof* roof;  // if not convex, or
    size_t nodes;      // (first of its placed nodes)
    const DistanceField* distance;
    const CollarCell* cells;
  };
  struct Coordinates {
    double *x, *y, *gx, *gy, *node_x, *node_y;
  };
  // Writes the coordinates of a shape at an angle and returns their box.
  Box rotate(const Shape& shape, double angle, const Coordinates& to) const;

  std::vector<Shape> shapes_;
  std::vector<Vec2> body_vertices_, body_gradients_;  // body frame, indexed by `edges`
  std::vector<double> inverse_length_;                // 1/m, of deforming shapes, the same
  std::vector<double> x_, y_, gx_, gy_;               // relative to the reference point, rotated
  std::vector<double> node_x_, node_y_;               // of roofs, the same
  std::vector<Box> boxes_;                            // in the coordinates of the model
};

}  // namespace apothem
