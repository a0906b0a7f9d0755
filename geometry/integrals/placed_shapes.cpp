#include "geometry/integrals/placed_shapes.hpp"

#include <cmath>

#include "geometry/integrals/penetration.hpp"
#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/dispatch.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr int kManyVertices = 32;  // from this number on they are rotated by packs

// Rotates as many of n vectors as fill packs, and includes them in the box. Returns their number.
template <int lanes>
APOTHEM_INLINE int rotate_packs(const double* from, int n, const SineCosine& angle, double* to_x,
                                double* to_y, Box& box) {
  using Pack = PackOf<lanes>;
  const Pack s(angle.sine), c(angle.cosine);
  Pack x0(box.x0), y0(box.y0), x1(box.x1), y1(box.y1);
  int k = 0;
  for (; k + lanes <= n; k += lanes) {
    const Pack from_x = Pack::load(from + k), from_y = Pack::load(from + n + k);
    const Pack x = c * from_x - s * from_y, y = s * from_x + c * from_y;
    x.store(to_x + k), y.store(to_y + k);
    x0 = select(x < x0, x, x0), x1 = select(x1 < x, x, x1);
    y0 = select(y < y0, y, y0), y1 = select(y1 < y, y, y1);
  }
  for (int lane = 0; lane < lanes; ++lane) {
    box.include(Box{x0.v[lane], y0.v[lane], x1.v[lane], y1.v[lane]});
  }
  return k;
}

// A point in the frame of the edge from `v` to `w`: its components along and across the edge,
// divided by the length of the edge.
Vec2 by_edge(const Vec2& point, const Vec2& v, const Vec2& w) {
  const Vec2 edge = w - v, from = point - v;
  return Vec2(edge.dot(from), cross(edge, from)) / edge.squaredNorm();
}

}  // namespace

void PlacedShapes::reserve(size_t shapes, size_t vertices) {
  shapes_.reserve(shapes);
  boxes_.reserve(shapes);
  body_.reserve(4 * vertices);
  placed_.reserve(4 * (vertices + shapes));
}

int PlacedShapes::add(const Potential& potential) {
  const int n = potential.size();
  const bool layered = potential.layer.has_value();
  const int before = layered ? 1 : 0;
  Shape shape{
      .placed = placed_.size() + static_cast<size_t>(before),
      .stride = before + n + 1,
      .size = n,
      .radius = 0,
      .slope = potential.steepest,
      .roof = potential.roof ? &*potential.roof : nullptr,
      .distance = potential.distance ? &*potential.distance : nullptr,
      .layer = layered ? &*potential.layer : nullptr,
      .links = potential.ring_links(),
      .capped = potential.capped(),
      .depth_ratio = apothem::depth_ratio(potential),
      .top_radius = potential.top_points.front().norm(),
      .top = by_edge(potential.top_points.front(), potential.vertices[0], potential.vertices[1]),
      .edges = body_.size() / 4};
  for (const Vec2& v : potential.vertices) shape.radius = std::max(shape.radius, v.norm());
  for (const auto* points : {&potential.vertices, &potential.gradients}) {
    for (const Vec2& p : *points) body_.push_back(p.x());
    for (const Vec2& p : *points) body_.push_back(p.y());
  }
  shapes_.push_back(shape);
  placed_.resize(placed_.size() + 4 * static_cast<size_t>(shape.stride) +
                 (layered ? kReadBehind : 0));
  boxes_.emplace_back();
  return size() - 1;
}

Box PlacedShapes::rotate(const Shape& shape, const SineCosine& angle,
                         const Coordinates& target) const {
  const double s = angle.sine, c = angle.cosine;
  const int n = shape.size;
  const auto turn = [&](const double* from, double* to_x, double* to_y) {
    Box box;
    int k = 0;
    if (n >= kManyVertices) {
      with_widest([&](auto lanes) APOTHEM_LAMBDA {
        k = rotate_packs<lanes()>(from, n, angle, to_x, to_y, box);
        return 0.;
      });
    }
    for (; k < n; ++k) {
      to_x[k] = c * from[k] - s * from[n + k];
      to_y[k] = s * from[k] + c * from[n + k];
      box.include(to_x[k], to_y[k]);
    }
    to_x[n] = to_x[0];
    to_y[n] = to_y[0];
    if (shape.layer) {
      to_x[-1] = to_x[n - 1];
      to_y[-1] = to_y[n - 1];
    }
    return box;
  };
  const double* const body = body_.data() + 4 * shape.edges;
  turn(body + std::ptrdiff_t{2} * n, target.gx, target.gy);
  return turn(body, target.x, target.y);
}

void PlacedShapes::place(int i, double x, double y, const SineCosine& angle) {
  Shape& shape = shapes_[i];
  shape.cosine = angle.cosine, shape.sine = angle.sine;
  const Box box = rotate(shape, angle, coordinates(placed_.data() + shape.placed, shape.stride));
  boxes_[i] = {x + box.x0, y + box.y0, x + box.x1, y + box.y1};
}

PlacedPotential PlacedShapes::turn(int i, const SineCosine& angle, Turned& turned) const {
  const Shape& shape = shapes_[i];
  const size_t size = 1 + 4 * static_cast<size_t>(shape.stride) + kReadBehind;
  if (turned.numbers.size() < size) turned.numbers.resize(size);
  const Coordinates target = coordinates(turned.numbers.data() + 1, shape.stride);
  rotate(shape, angle, target);
  PlacedPotential result = view(i);
  result.x = target.x, result.y = target.y;
  result.gx = target.gx, result.gy = target.gy;
  result.cosine = angle.cosine, result.sine = angle.sine;
  return result;
}

int PlacedShapes::add_deforming(const Potential& potential) {
  const int i = add(potential);
  // The inradius may grow beyond its initial value, and the size is not known.
  shapes_[i].capped = true;
  shapes_[i].radius = 0;
  inverse_length_.resize(shapes_[i].edges);  // entries of shapes that do not deform are not used
  for (const Vec2& g : potential.gradients) inverse_length_.push_back(g.norm());
  return i;
}

bool PlacedShapes::deform(int i, double x, double y, std::span<const Vec2> vertices) {
  Shape& shape = shapes_[i];
  const auto [vx, vy, gx, gy] = coordinates(placed_.data() + shape.placed, shape.stride);
  const double* const inverse = inverse_length_.data() + shape.edges;
  const int n = shape.size;
  Box box;
  Vec2 mean = Vec2::Zero();
  bool convex = true;
  Vec2 before = vertices[0] - vertices[n - 1];
  for (int k = 0; k < n; ++k) {
    const Vec2& v = vertices[k];
    const Vec2 along = vertices[next(k, n)] - v;
    const double scale = inverse[k] / along.norm();
    vx[k] = v.x();
    vy[k] = v.y();
    gx[k] = -scale * along.y();
    gy[k] = scale * along.x();
    convex = convex && cross(before, along) > 0;
    before = along;
    box.include(v);
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
  const double* const x = placed_.data() + shape.placed;
  const double* const y = x + shape.stride;
  const Vec2 edge(x[1] - x[0], y[1] - y[0]);
  const Vec2 top =
      offset + Vec2(x[0], y[0]) + shape.top.x() * edge + shape.top.y() * Vec2(-edge.y(), edge.x());
  return encloses(view(j), Vec2::Zero(), top);
}

}  // namespace apothem
