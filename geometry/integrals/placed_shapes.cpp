#include "apothem/geometry/integrals/placed_shapes.hpp"

#include <cmath>

#include "apothem/execution/elementary.hpp"
#include "apothem/geometry/integrals/penetration.hpp"

namespace apothem {
namespace {

// A point in the frame of the edge from `v` to `w`: its components along and across, over the
// length of the edge.
Vec2 by_edge(const Vec2& point, const Vec2& v, const Vec2& w) {
  const Vec2 edge = w - v, from = point - v;
  return Vec2(edge.dot(from), cross(edge, from)) / edge.squaredNorm();
}

}  // namespace

int PlacedShapes::add(const Potential& potential) {
  Shape shape{x_.size(),
              gx_.size(),
              potential.size(),
              potential.capped(),
              0,
              potential.steepest,
              apothem::depth_ratio(potential),
              by_edge(potential.top_points.front(), potential.vertices[0], potential.vertices[1]),
              potential.roof ? &*potential.roof : nullptr,
              node_x_.size(),
              potential.distance ? &*potential.distance : nullptr,
              potential.cells.empty() ? nullptr : potential.cells.data()};
  if (shape.roof) {
    node_x_.resize(node_x_.size() + shape.roof->points.size());
    node_y_.resize(node_x_.size());
  }
  for (const Vec2& v : potential.vertices) shape.radius = std::max(shape.radius, v.norm());
  shapes_.push_back(shape);
  body_vertices_.insert(body_vertices_.end(), potential.vertices.begin(), potential.vertices.end());
  body_gradients_.insert(body_gradients_.end(), potential.gradients.begin(),
                         potential.gradients.end());
  x_.resize(x_.size() + shape.size + 1);
  y_.resize(x_.size());
  gx_.resize(gx_.size() + shape.size);
  gy_.resize(gx_.size());
  boxes_.emplace_back();
  return size() - 1;
}

Box PlacedShapes::rotate(const Shape& shape, double angle, const Coordinates& to) const {
  const auto [s, c] = sine_cosine(angle);
  const Vec2* const v = body_vertices_.data() + shape.edges;
  const Vec2* const g = body_gradients_.data() + shape.edges;
  Box box;
  for (int k = 0; k < shape.size; ++k) {
    to.x[k] = c * v[k].x() - s * v[k].y();
    to.y[k] = s * v[k].x() + c * v[k].y();
    to.gx[k] = c * g[k].x() - s * g[k].y();
    to.gy[k] = s * g[k].x() + c * g[k].y();
    box.include(to.x[k], to.y[k]);
  }
  to.x[shape.size] = to.x[0];
  to.y[shape.size] = to.y[0];
  if (shape.roof) {
    const std::vector<Vec2>& points = shape.roof->points;
    for (size_t k = 0; k < points.size(); ++k) {
      to.node_x[k] = c * points[k].x() - s * points[k].y();
      to.node_y[k] = s * points[k].x() + c * points[k].y();
    }
  }
  return box;
}

void PlacedShapes::place(int i, double x, double y, double angle) {
  const Shape& shape = shapes_[i];
  const Box box = rotate(
      shape, angle,
      {x_.data() + shape.vertices, y_.data() + shape.vertices, gx_.data() + shape.edges,
       gy_.data() + shape.edges, node_x_.data() + shape.nodes, node_y_.data() + shape.nodes});
  boxes_[i] = {x + box.x0, y + box.y0, x + box.x1, y + box.y1};
}

PlacedPotential PlacedShapes::turn(int i, double angle, Turned& t) const {
  const Shape& shape = shapes_[i];
  const auto n = static_cast<size_t>(shape.size);
  const size_t nodes = shape.roof ? shape.roof->points.size() : 0;
  const auto grow = [](std::vector<double>& v, size_t size) {
    if (v.size() < size) v.resize(size);
  };
  for (std::vector<double>* v : {&t.x, &t.y, &t.gx, &t.gy}) grow(*v, n + 1);
  for (std::vector<double>* v : {&t.node_x, &t.node_y}) grow(*v, nodes);
  rotate(shape, angle,
         {t.x.data(), t.y.data(), t.gx.data(), t.gy.data(), t.node_x.data(), t.node_y.data()});
  PlacedPotential result = view(i);
  result.x = t.x.data(), result.y = t.y.data();
  result.gx = t.gx.data(), result.gy = t.gy.data();
  result.node_x = t.node_x.data(), result.node_y = t.node_y.data();
  return result;
}

int PlacedShapes::add_deforming(const Potential& potential) {
  const int i = add(potential);
  // Its inradius may grow beyond the length that it had at first, and its size is not known.
  shapes_[i].capped = true;
  shapes_[i].radius = 0;
  inverse_length_.resize(shapes_[i].edges);  // without those of shapes that do not deform
  for (const Vec2& g : potential.gradients) inverse_length_.push_back(g.norm());
  return i;
}

bool PlacedShapes::deform(int i, double x, double y, std::span<const Vec2> vertices) {
  Shape& shape = shapes_[i];
  double* const vx = x_.data() + shape.vertices;
  double* const vy = y_.data() + shape.vertices;
  double* const gx = gx_.data() + shape.edges;
  double* const gy = gy_.data() + shape.edges;
  const double* const inverse = inverse_length_.data() + shape.edges;
  const int n = shape.size;
  Box box;
  Vec2 mean = Vec2::Zero();
  bool convex = true;
  Vec2 before = vertices[0] - vertices[n - 1];
  for (int k = 0; k < n; ++k) {
    const Vec2& v = vertices[k];
    const Vec2 along = vertices[k + 1 == n ? 0 : k + 1] - v;
    const double scale = inverse[k] / along.norm();
    vx[k] = v.x();
    vy[k] = v.y();
    gx[k] = -scale * along.y();
    gy[k] = scale * along.x();
    convex = convex && cross(before, along) > 0;
    before = along;
    box.include(v.x(), v.y());
    mean += v / n;
  }
  shape.top = by_edge(mean, vertices[0], vertices[1]);
  vx[n] = vx[0];
  vy[n] = vy[0];
  boxes_[i] = {x + box.x0, y + box.y0, x + box.x1, y + box.y1};
  return convex;
}

bool PlacedShapes::top_inside(int i, int j, const Vec2& offset) const {
  const Shape& shape = shapes_[i];
  const double* const x = x_.data() + shape.vertices;
  const double* const y = y_.data() + shape.vertices;
  const Vec2 edge(x[1] - x[0], y[1] - y[0]);
  const Vec2 top =
      offset + Vec2(x[0], y[0]) + shape.top.x() * edge + shape.top.y() * Vec2(-edge.y(), edge.x());
  // Even-odd rule, for convex and other shapes.
  const PlacedPotential other = view(j);
  bool inside = false;
  for (int k = 0; k < other.size; ++k) {
    const double dy0 = other.y[k] - top.y();
    const double dy1 = other.y[k + 1] - top.y();
    if ((dy0 > 0) == (dy1 > 0)) continue;
    const double dx0 = other.x[k] - top.x();
    const double dx1 = other.x[k + 1] - top.x();
    if ((dx0 * dy1 - dx1 * dy0 > 0) == (dy1 > dy0)) inside = !inside;
  }
  return inside;
}

}  // namespace apothem
