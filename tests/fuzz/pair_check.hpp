// What must hold for every pair of polygons, however degenerate: shared by the test of a million
// pairs and the fuzzer.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>

#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/placed_shapes.hpp"

namespace apothem::test {

/// The pair as the step loop evaluates it, with rounded decisions.
inline PairIntegral kernel(const Polygon& a, const Potential& potential_a, const Polygon& b,
                           const Potential& potential_b) {
  PlacedShapes shapes;
  shapes.place(shapes.add(potential_a), 0, 0, 0);
  shapes.place(shapes.add(potential_b), 0, 0, 0);
  EdgeWorkspace workspace;
  return pair_integral(shapes.view(0), shapes.view(1), a.origin() - b.origin(), workspace);
}

/// Error of the edge kernel against the exact overlap, in units of the round-off that it may have:
/// eps (size/r) own length for forces, times the size for moments (docs/theory.md, Normal contact).
/// Numbers of order 1 are a sane kernel's.
struct PairErrors {
  double force = 0, moment = 0, energy = 0, area = 0;
  [[nodiscard]] double worst() const { return std::max({force, moment, energy, area}); }
};

struct PairCheck {
  PairErrors errors;
  std::optional<std::string> defect;  ///< what is wrong beyond round-off, if anything
  bool touching = false;
};

inline bool is_finite(const PairResult& r) {
  const PairIntegral& p = r.integral;
  return apothem::is_finite(p.force) && apothem::is_finite(p.centre) &&
         std::isfinite(p.moment_a + p.moment_b + p.weight + p.own_length_a + p.own_length_b) &&
         std::isfinite(p.largest_phi + p.depth + p.breadth) &&
         std::isfinite(r.volume.energy + r.volume.overlap_area);
}

inline PairCheck check_pair(const Polygon& a, const Potential& potential_a, const Polygon& b,
                            const Potential& potential_b) {
  constexpr double kMost = 50;  // in units of round-off
  PairCheck check;
  const PairResult ab = edge_method(a, potential_a, b, potential_b);
  const PairResult ba = edge_method(b, potential_b, a, potential_a);
  const PairResult exact = overlap_method(a, potential_a, b, potential_b);
  if (!is_finite(ab) || !is_finite(exact)) {
    check.defect = "a result is not finite";
    return check;
  }
  const PairIntegral &p = ab.integral, &x = exact.integral;
  check.touching = x.weight > 0;
  if (p.force != -ba.integral.force || p.moment_a != ba.integral.moment_b) {
    check.defect = "swapping the polygons does not swap the forces";
    return check;
  }
  const double size = std::max(bounding_box(a).extent(), bounding_box(b).extent());
  const double steepest = std::max(potential_a.steepest, potential_b.steepest);
  // The kernel's own lengths: edges that touch within round-off count, as they add round-off.
  const PairIntegral kernel = test::kernel(a, potential_a, b, potential_b);
  const double length =
      std::max(kernel.own_length_a + kernel.own_length_b, x.own_length_a + x.own_length_b);
  const double unit = 0x1p-52 * size * steepest * length;
  const auto in_units = [](double error, double u) {
    return error == 0 ? 0 : error / std::max(u, 1e-300);
  };
  check.errors = {
      in_units((p.force - x.force).norm(), unit),
      in_units(std::max(std::abs(p.moment_a - x.moment_a), std::abs(p.moment_b - x.moment_b)),
               unit * size),
      in_units(std::abs(ab.volume.energy - exact.volume.energy), 0x1p-52 * size * size),
      in_units(std::abs(ab.volume.overlap_area - exact.volume.overlap_area),
               0x1p-52 * size * size)};
  if (!(check.errors.worst() <= kMost)) {
    check.defect = fmt::format(
        "round-off of {:.3g} (force), {:.3g} (moment), {:.3g} (energy), {:.3g} (area) units",
        check.errors.force, check.errors.moment, check.errors.energy, check.errors.area);
  }
  return check;
}

/// The pair as a line that `apothem contact --batch` reads.
inline std::string as_line(const std::string& name, const Polygon& a, const Polygon& b) {
  std::string line = name;
  for (const Polygon* p : {&a, &b}) {
    line += fmt::format(" {}", p->size());
    for (const Vec2& v : p->vertices()) line += fmt::format(" {} {}", v.x(), v.y());
  }
  return line;
}

}  // namespace apothem::test
