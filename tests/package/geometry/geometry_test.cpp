// Unit tests of shapes without a framework: what a program that makes polygons may check of them.
#include <apothem/geometry/potential/point_values.hpp>
#include <apothem/geometry/regions/boolean.hpp>
#include <apothem/geometry/regions/repair.hpp>
#include <cmath>
#include <cstdio>

namespace {

int failures = 0;

void check(bool holds, const char* what) {
  if (holds) return;
  std::printf("failed: %s\n", what);
  ++failures;
}

}  // namespace

int main() {
  using namespace apothem;
  const Polygon plate({{0, 0}, {4, 0}, {4, 3}, {0, 3}});
  const Polygon window({{1, 1}, {2, 1}, {2, 2}, {1, 2}});

  // The plate without the window: one polygon with a hole. Areas of whole numbers are exact.
  const auto frame = boolean_operation(plate, window, BooleanOperation::difference);
  check(frame.size() == 1 && frame[0].holes.size() == 1, "the frame has one hole");
  check(area_of(frame) == 11, "the area of the frame is 11 m^2");
  check(boolean_operation(window, plate, BooleanOperation::difference).empty(),
        "the window lies in the plate");

  // Points are inside, on the boundary or outside by exact predicates.
  const Potential potential = make_potential(plate);
  const PointEvaluator at(plate, potential);
  check(at({4, 1}).side == Side::boundary, "a point of the right edge is on the boundary");
  check(at({std::nextafter(4, 5), 1}).side == Side::outside, "the next double is outside");
  check(at({2, 0.75}).phi == 0.5, "half way to the middle the potential is one half");
  check(at({2, 0.75}).signed_distance == -0.75, "the distance is negative inside");

  // A ring that crosses itself is refused by Polygon, and repair says why.
  const Repaired bow_tie = repair({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}});
  check(bow_tie.polygons.size() == 2, "a bow tie is two triangles");
  for (const RingFault& fault : bow_tie.faults) std::printf("%s\n", describe(fault).c_str());
  return failures;
}
