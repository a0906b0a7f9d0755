// The blocks of a fill: reads the shapes, sizes and angles that they are drawn from, and draws
// them.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/packing/arrange.hpp"
#include "geometry/polygon/random_numbers.hpp"
#include "lib/scene/json.hpp"

namespace apothem {

class BlockReader {
 public:
  /// `in` must outlive the reader.
  explicit BlockReader(const JsonReader& in) : in_(in) {}

  /// Reads "shapes", "diameter" and "angle" of a fill. Throws SceneError.
  void read(JsonObject& fill);
  /// The next block. Needs read().
  [[nodiscard]] Block draw(RandomNumbers& random) const;
  /// Whether blocks have different angles.
  [[nodiscard]] bool turn() const { return angles_[0] < angles_[1]; }

 private:
  // A number, or a shape of area 1, that is drawn for each block.
  using Draw = std::function<double(RandomNumbers&)>;
  using DrawRing = std::function<std::vector<Vec2>(RandomNumbers&)>;
  struct Shape {
    double weight = 1;
    DrawRing ring;
    Rings holes;
    std::optional<double> own_diameter;  // m
  };
  using Bounds = std::array<double, 2>;

  [[nodiscard]] Bounds range(const JsonValue& value, double least, double most,
                             const std::string& unit) const;
  [[nodiscard]] Bounds positive_range(const JsonValue& value) const;
  [[nodiscard]] Shape shape(const JsonValue& value) const;
  [[nodiscard]] DrawRing quadrilateral(const JsonValue& value) const;
  [[nodiscard]] DrawRing convex(const JsonValue& value) const;
  [[nodiscard]] Draw diameter(const JsonValue& value) const;
  [[nodiscard]] Draw lognormal(const JsonValue& value) const;
  [[nodiscard]] Draw table(const JsonValue& value) const;

  const JsonReader& in_;
  std::vector<Shape> shapes_;
  Draw diameter_;
  Bounds angles_{0, 2 * M_PI};
};

}  // namespace apothem
