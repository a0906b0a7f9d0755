// A potential at a position in the plane.
#pragma once

#include <vector>

#include "geometry/polygon/ring_links.hpp"
#include "geometry/potential/boundary_layer.hpp"
#include "geometry/potential/distance_field.hpp"
#include "geometry/skeleton/roof.hpp"

namespace apothem {

/// A potential at a position in the plane: pointers to arrays of coordinates relative to some
/// frame. x and y have size + 1 entries, because the first vertex is repeated; gx and gy have
/// `size`. A polygon that is not convex has either a roof or a distance field. Its arrays have one
/// more entry at both ends, at -1 and after the last one, which repeat the other end of the
/// polygon, and kReadBehind more numbers after that. If `radius` is 0, it is not known, and long
/// edges of the other polygon are not shortened.
struct PlacedPotential {
  const double* x;                          ///< x coordinates of the vertices, m
  const double* y;                          ///< y coordinates of the vertices, m
  const double* gx;                         ///< x components of the gradients g_i, 1/m
  const double* gy;                         ///< y components of the gradients g_i, 1/m
  int size;                                 ///< number of vertices
  bool capped;                              ///< whether phi is limited to 1
  const Roof* roof = nullptr;               ///< roof, or null
  const DistanceField* distance = nullptr;  ///< distance field, or null
  Vec2 reference = Vec2::Zero();            ///< reference point of the moments, in the frame, m
  double radius = 0;                     ///< largest distance of a vertex from `reference`, m, or 0
  double steepest = 0;                   ///< largest |g_i|, 1/m, or 0 if it is not known
  const BoundaryLayer* layer = nullptr;  ///< boundary layer, if it is not convex
  const RingLinks* links = nullptr;      ///< neighbours of its vertices if it has holes, or null
  /// Of a polygon with a distance field and many edges that does not move, in the frame; or null.
  const EdgeTrees* trees = nullptr;
  /// Position of the inner nodes of the roof in the frame: they are rotated by the angle with this
  /// cosine and sine, and then moved by `shift`, m.
  double cosine = 1, sine = 0;
  Vec2 shift = Vec2::Zero();

  /// The number of the entry with the end of edge e.
  [[nodiscard]] int end(int e) const {
    return links ? links->after[static_cast<size_t>(e)] : e + 1;
  }
  /// The vertex or the edge after i, or before it.
  [[nodiscard]] int next(int i) const { return apothem::next(links, i, size); }
  [[nodiscard]] int previous(int i) const { return apothem::previous(links, i, size); }

  /// True if phi is the lower envelope of the linear functions of the edges.
  [[nodiscard]] bool convex() const { return !roof && !distance; }
};

/// The box of a polygon moved by `shift`.
inline Box box_of(const PlacedPotential& p, const Vec2& shift) {
  Box box;
  for (int i = 0; i < p.size; ++i) box.include(p.x[i] + shift.x(), p.y[i] + shift.y());
  return box;
}

/// Whether a polygon moved by `shift` encloses a point, by the even-odd rule and without a
/// tolerance.
inline bool encloses(const PlacedPotential& p, const Vec2& shift, const Vec2& point) {
  bool inside = false;
  for (int k = 0; k < p.size; ++k) {
    const int end = p.end(k);
    const double y0 = p.y[k] + shift.y() - point.y(), y1 = p.y[end] + shift.y() - point.y();
    if ((y0 > 0) == (y1 > 0)) continue;
    const double x0 = p.x[k] + shift.x() - point.x(), x1 = p.x[end] + shift.x() - point.x();
    if ((x0 * y1 - x1 * y0 > 0) == (y1 > y0)) inside = !inside;
  }
  return inside;
}

/// 0, or NaN if a coordinate of two polygons is not finite, x moved by (dx, dy).
inline double all_finite(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy) {
  double finite = 0;  // sum of 0 * coordinate
  for (int i = 0; i < y.size; ++i) finite += 0 * y.x[i] + 0 * y.y[i];
  for (int i = 0; i < x.size; ++i) finite += 0 * (x.x[i] + dx) + 0 * (x.y[i] + dy);
  return finite;
}

/// The nodes of a roof at its present position, m. They are computed only if a contact is deep
/// enough to need them.
struct RoofNodes {
  std::vector<double> x, y;

  void place(const PlacedPotential& p) {
    const std::vector<Vec2>& points = p.roof->points;
    if (x.size() < points.size()) x.resize(points.size());
    if (y.size() < points.size()) y.resize(points.size());
    for (int i = 0; i < p.size; ++i) x[i] = p.x[i], y[i] = p.y[i];
    for (size_t i = p.size; i < points.size(); ++i) {
      x[i] = p.cosine * points[i].x() - p.sine * points[i].y() + p.shift.x();
      y[i] = p.sine * points[i].x() + p.cosine * points[i].y() + p.shift.y();
    }
  }
};

}  // namespace apothem
