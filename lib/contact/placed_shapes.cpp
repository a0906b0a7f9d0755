#include "contact/placed_shapes.hpp"

#include <cmath>

namespace apothem {

int PlacedShapes::add(const Potential& potential) {
  Shape shape{x_.size(),          gx_.size(), potential.size(),
              potential.capped(), 0,          potential.top_points.front()};
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

void PlacedShapes::place(int i, double x, double y, double angle) {
  const Shape& shape = shapes_[i];
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  double* const vx = x_.data() + shape.vertices;
  double* const vy = y_.data() + shape.vertices;
  double* const gx = gx_.data() + shape.edges;
  double* const gy = gy_.data() + shape.edges;
  const Vec2* const v = body_vertices_.data() + shape.edges;
  const Vec2* const g = body_gradients_.data() + shape.edges;
  Box box;
  for (int k = 0; k < shape.size; ++k) {
    vx[k] = c * v[k].x() - s * v[k].y();
    vy[k] = s * v[k].x() + c * v[k].y();
    gx[k] = c * g[k].x() - s * g[k].y();
    gy[k] = s * g[k].x() + c * g[k].y();
    box.include(vx[k], vy[k]);
  }
  vx[shape.size] = vx[0];
  vy[shape.size] = vy[0];
  boxes_[i] = {x + box.x0, y + box.y0, x + box.x1, y + box.y1};
}

bool PlacedShapes::top_inside(int i, double angle, int j, const Vec2& offset) const {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Vec2& body = shapes_[i].top;
  const Vec2 top = offset + Vec2(c * body.x() - s * body.y(), s * body.x() + c * body.y());
  const PlacedPotential other = view(j);
  for (int k = 0; k < other.size; ++k) {
    if (other.gx[k] * (top.x() - other.x[k]) + other.gy[k] * (top.y() - other.y[k]) < 0)
      return false;
  }
  return true;
}

}  // namespace apothem
