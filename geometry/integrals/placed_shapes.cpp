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
  const auto n = static_cast<size_t>(potential.size());
  const bool convex = !potential.cells;
  Shape shape{
      .placed = x_.size() + (convex ? 0 : 1),
      .edges = body_.x.size(),
      .size = potential.size(),
      .capped = potential.capped(),
      .radius = 0,
      .slope = potential.steepest,
      .depth_ratio = apothem::depth_ratio(potential),
      .top = by_edge(potential.top_points.front(), potential.vertices[0], potential.vertices[1]),
      .roof = potential.roof ? &*potential.roof : nullptr,
      .distance = potential.distance ? &*potential.distance : nullptr,
      .cells = convex ? nullptr : &*potential.cells};
  for (size_t k = 0; k < n; ++k) {
    const Vec2 &v = potential.vertices[k], &g = potential.gradients[k];
    shape.radius = std::max(shape.radius, v.norm());
    body_.x.push_back(v.x()), body_.y.push_back(v.y());
    body_.gx.push_back(g.x()), body_.gy.push_back(g.y());
  }
  shapes_.push_back(shape);
  const size_t end = shape.placed + n + 1 + (convex ? 0 : kReadBehind);
  for (std::vector<double>* numbers : {&x_, &y_, &gx_, &gy_}) numbers->resize(end);
  boxes_.emplace_back();
  return size() - 1;
}

Box PlacedShapes::rotate(const Shape& shape, const BodyFrame& body, double c, double s,
                         const Coordinates& to) {
  const auto turn = [&](const double* from_x, const double* from_y, double* to_x, double* to_y) {
    for (int k = 0; k < shape.size; ++k) {
      to_x[k] = c * from_x[k] - s * from_y[k];
      to_y[k] = s * from_x[k] + c * from_y[k];
    }
    to_x[shape.size] = to_x[0];
    to_y[shape.size] = to_y[0];
    if (!shape.cells) return;
    to_x[-1] = to_x[shape.size - 1];
    to_y[-1] = to_y[shape.size - 1];
  };
  turn(body.x.data() + shape.edges, body.y.data() + shape.edges, to.x, to.y);
  turn(body.gx.data() + shape.edges, body.gy.data() + shape.edges, to.gx, to.gy);
  Box box;
  for (int k = 0; k < shape.size; ++k) box.include(to.x[k], to.y[k]);
  return box;
}

void PlacedShapes::place(int i, double x, double y, double angle) {
  Shape& shape = shapes_[i];
  const auto [sine, cosine] = sine_cosine(angle);
  shape.cosine = cosine, shape.sine = sine;
  const size_t p = shape.placed;
  const Box box = rotate(shape, body_, cosine, sine,
                         {x_.data() + p, y_.data() + p, gx_.data() + p, gy_.data() + p});
  boxes_[i] = {x + box.x0, y + box.y0, x + box.x1, y + box.y1};
}

PlacedPotential PlacedShapes::turn(int i, double angle, Turned& t) const {
  const Shape& shape = shapes_[i];
  const auto [sine, cosine] = sine_cosine(angle);
  const size_t size = static_cast<size_t>(shape.size) + 2 + kReadBehind;
  for (std::vector<double>* v : {&t.x, &t.y, &t.gx, &t.gy}) {
    if (v->size() < size) v->resize(size);
  }
  const Coordinates to{t.x.data() + 1, t.y.data() + 1, t.gx.data() + 1, t.gy.data() + 1};
  rotate(shape, body_, cosine, sine, to);
  PlacedPotential result = view(i);
  result.x = to.x, result.y = to.y;
  result.gx = to.gx, result.gy = to.gy;
  result.cosine = cosine, result.sine = sine;
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
  double* const vx = x_.data() + shape.placed;
  double* const vy = y_.data() + shape.placed;
  double* const gx = gx_.data() + shape.placed;
  double* const gy = gy_.data() + shape.placed;
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
  const double* const x = x_.data() + shape.placed;
  const double* const y = y_.data() + shape.placed;
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
