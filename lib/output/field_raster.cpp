#include "lib/output/field_raster.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/mesh/locate.hpp"

namespace apothem {
namespace {

const Colour kGrey{.78, .78, .78};
const Colour kEmpty{0, 0, 0, 0};

// The pixels of a picture, and which of them an element covers.
class Raster {
 public:
  Raster(const Box& window, int width, int height)
      : window_(window), width_(width), height_(height) {}

  /// The position in the data of a pixel's centre.
  [[nodiscard]] Vec2 place(int column, int row) const {
    return {window_.x0 + (column + .5) / width_ * (window_.x1 - window_.x0),
            window_.y1 - (row + .5) / height_ * (window_.y1 - window_.y0)};
  }

  /// Calls f(column, row) for each pixel whose centre is inside an odd number of the rings, of
  /// which the first one is around all others. If polygons share an edge, a
  /// centre belongs to exactly one of them, because the crossings of a row with the edge have the
  /// same bits in both. `crossings` is working memory.
  template <class F>
  void each_pixel(const Rings& rings, std::vector<double>& crossings, const F& f) const {
    const Box box = box_of(rings[0]);
    const double per_row = (window_.y1 - window_.y0) / height_;
    const auto row_of = [&](double y) {
      return static_cast<int>(std::clamp((window_.y1 - y) / per_row, -1., height_ + 1.));
    };
    const double per_column = (window_.x1 - window_.x0) / width_;
    const auto first_right_of = [&](double x) {
      return static_cast<int>(
          std::ceil(std::clamp((x - window_.x0) / per_column - .5, 0., width_ + 0.)));
    };
    const int last = std::min(row_of(box.y0) + 1, height_ - 1);
    for (int row = std::max(row_of(box.y1) - 1, 0); row <= last; ++row) {
      const double y = place(0, row).y();
      crossings.clear();
      for (const std::vector<Vec2>& ring : rings) add_crossings(ring, y, crossings);
      std::ranges::sort(crossings);
      for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
        const int end = first_right_of(crossings[i + 1]);
        for (int column = first_right_of(crossings[i]); column < end; ++column) f(column, row);
      }
    }
  }

 private:
  static void add_crossings(const std::vector<Vec2>& ring, double y,
                            std::vector<double>& crossings) {
    for (size_t i = 0; i < ring.size(); ++i) {
      Vec2 a = ring[i], b = after(ring, i);
      if ((a.y() <= y) == (b.y() <= y)) continue;
      if (a.y() > b.y()) std::swap(a, b);
      crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
  }

  Box window_;
  int width_, height_;
};

}  // namespace

std::vector<Colour> paint(const Field& field, const Box& window,
                          const std::function<Colour(double)>& colour_of, int width, int height) {
  std::vector<Colour> pixels(static_cast<size_t>(width) * static_cast<size_t>(height), kEmpty);
  const Raster raster(window, width, height);
  const auto colour = [&](double value) { return std::isfinite(value) ? colour_of(value) : kGrey; };
  std::vector<double> crossings, weights;
  std::vector<Vec2> relative;
  for (int e = 0; e < field.mesh.element_count(); ++e) {
    const std::span<const int> nodes = field.mesh.element(e);
    const Rings rings = rings_of(field.mesh.nodes, nodes, field.holes, e);
    const std::vector<Vec2>& ring = rings[0];
    const bool varies = field.nodal && !field.blank[e];
    const Colour even = varies ? kEmpty : field.blank[e] ? kGrey : colour(field.values[e]);
    weights.resize(ring.size());
    raster.each_pixel(rings, crossings, [&](int column, int row) {
      Colour& pixel = pixels[static_cast<size_t>(row) * width + column];
      if (!varies) {
        pixel = even;
        return;
      }
      relative = ring;  // values in a body with holes follow from those around it
      for (Vec2& p : relative) p -= raster.place(column, row);
      interpolation_weights(relative, weights);
      double value = 0;
      for (size_t i = 0; i < weights.size(); ++i) value += weights[i] * field.values[nodes[i]];
      pixel = colour(value);
    });
  }
  return pixels;
}

}  // namespace apothem
