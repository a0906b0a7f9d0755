#include "tests/fuzz/fuzz_target.hpp"

#include <cstring>
#include <stdexcept>

#include "geometry/potential/inscribed_circle.hpp"
#include "tests/fuzz/pair_check.hpp"

namespace apothem::test {
namespace {

using Ring = std::vector<Vec2>;

[[noreturn]] void fail(const std::string& what) { throw std::logic_error(what); }

// Reads zeros behind the end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  template <class T>
  T take() {
    T value{};
    if (size_ >= sizeof value) {
      std::memcpy(&value, data_, sizeof value);
      data_ += sizeof value;
      size_ -= sizeof value;
    } else {
      size_ = 0;
    }
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

enum class Coordinates { lattice, fine, any };

double coordinate(Bytes& bytes, Coordinates kind) {
  switch (kind) {
    case Coordinates::lattice:
      return bytes.take<std::int8_t>() / 4.0;
    case Coordinates::fine:
      return bytes.take<std::int32_t>() * 0x1p-20;
    default:
      return bytes.take<double>();
  }
}

Ring ring(Bytes& bytes, Coordinates kind, double offset) {
  Ring result(bytes.take<std::uint8_t>() % 16);
  for (Vec2& v : result) {
    v.x() = coordinate(bytes, kind) + offset;
    v.y() = coordinate(bytes, kind) - offset;
  }
  return result;
}

std::string text(const Ring& ring) {
  std::string line = fmt::format("{}", ring.size());
  for (const Vec2& v : ring) line += fmt::format(" {} {}", v.x(), v.y());
  return line;
}

struct Shape {
  Polygon polygon;
  Potential potential;
};

// Nothing for a ring that is refused with a reason.
std::optional<Shape> shape(const Ring& ring) {
  try {
    Polygon polygon(ring);
    const Box box = bounding_box(polygon);
    // Products of four lengths must be numbers.
    if (!(box.extent() > 1e-60 && box.extent() < 1e60)) return std::nullopt;
    Potential potential = make_potential(polygon);
    const AreaMoments moments = area_moments(polygon);
    if (!(moments.area > 0 && moments.polar > 0 && apothem::is_finite(moments.centroid))) {
      fail("area " + std::to_string(moments.area) + " of " + text(ring));
    }
    const double radius = largest_inscribed_circle(polygon).radius;
    const double roof_height = 1 / potential.steepest;
    if (!(roof_height <= radius * (1 + 1e-9) + 1e-12 * box.extent())) {
      fail(fmt::format("roof {} above inradius {} of {}", roof_height, radius, text(ring)));
    }
    return Shape{std::move(polygon), std::move(potential)};
  } catch (const InvalidPolygon& error) {
    if (std::string(error.what()).empty() || error.vertex() < 0 ||
        error.vertex() > static_cast<int>(ring.size())) {
      fail("refusal without a place: " + text(ring));
    }
    return std::nullopt;
  }
}

}  // namespace

void fuzz_pair(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const auto flags = bytes.take<std::uint8_t>();
  const Coordinates kind{flags % 3};
  const double offset =
      kind == Coordinates::any ? 0 : std::ldexp(flags / 3 % 4, 10 * (flags / 12 % 3));
  const Ring a = ring(bytes, kind, offset);
  const Ring b = ring(bytes, kind, offset);
  const std::optional<Shape> shape_a = shape(a);
  const std::optional<Shape> shape_b = shape(b);
  if (!shape_a || !shape_b) return;
  const PairCheck check =
      check_pair(shape_a->polygon, shape_a->potential, shape_b->polygon, shape_b->potential);
  if (check.defect)
    fail(*check.defect + "\n" + as_line("pair", shape_a->polygon, shape_b->polygon));
}

}  // namespace apothem::test
