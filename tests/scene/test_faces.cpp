// Ends of lines that are moved to what they nearly meet.
#include "lib/scene/faces.hpp"

#include <catch2/catch.hpp>

#include "apps/cases/samples.hpp"

using namespace apothem;

namespace faces {
namespace {

using Line = std::vector<Vec2>;

// The rule of snap_ends(), by looking at everything.
void snap_plainly(std::vector<Line>& lines, size_t own, Vec2& end, double tolerance) {
  const Vec2* vertex = nullptr;
  double nearest = tolerance;
  for (const Line& line : lines) {
    for (const Vec2& v : line) {
      if (&v == &end || (v - end).norm() > nearest) continue;
      vertex = &v;
      nearest = (v - end).norm();
    }
  }
  if (vertex != nullptr) {
    end = *vertex;
    return;
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    Line& line = lines[i];
    for (size_t k = 0; i != own && k + 1 < line.size(); ++k) {
      const Vec2 a = line[k], along = line[k + 1] - a;
      const double t = (end - a).dot(along) / along.squaredNorm();
      const Vec2 foot = t <= 0 ? a : t >= 1 ? line[k + 1] : Vec2(a + t * along);
      if (!((foot - end).norm() <= tolerance)) continue;
      end = foot;
      line.insert(line.begin() + static_cast<std::ptrdiff_t>(k) + 1, foot);
      return;
    }
  }
}

std::vector<Line> snapped_plainly(std::vector<Line> lines, double tolerance) {
  for (size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].size() < 2) continue;
    snap_plainly(lines, i, lines[i].front(), tolerance);
    snap_plainly(lines, i, lines[i].back(), tolerance);
  }
  return lines;
}

// Lines of 0 to 4 vertices. On a lattice many vertices coincide or are equally far from an end, and
// many ends lie on segments.
std::vector<Line> random_lines(samples::Random& random, bool on_lattice, double offset) {
  std::vector<Line> lines(static_cast<size_t>(random.uniform(1, 40)));
  const auto coordinate = [&] {
    const double x = random.uniform(0, 12);
    return offset + (on_lattice ? std::floor(x) : x);
  };
  for (Line& line : lines) {
    line.resize(static_cast<size_t>(random.uniform(0, 5)));
    for (Vec2& v : line) v = {coordinate(), coordinate()};
    if (line.size() > 2 && random.uniform(0, 1) < .2) line.back() = line.front();
    if (line.size() > 2 && random.uniform(0, 1) < .2) line[1] = line[0];
  }
  return lines;
}

}  // namespace

TEST_CASE("ends snap as if each had looked at all lines, with ties", "[scene][faces][slow]") {
  samples::Random random(7);
  int moved = 0, feet = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double offset = trial % 3 == 0 ? 1e6 + .1 : 0;
    const std::vector<Line> lines = random_lines(random, trial % 2 == 0, offset);
    for (const double tolerance : {0., 1e-6, .3, 1., std::sqrt(2.), 5., 100.}) {
      const std::vector<Line> expected = snapped_plainly(lines, tolerance);
      INFO("trial " << trial << ", tolerance " << tolerance);
      REQUIRE(snap_ends(lines, tolerance) == expected);
      for (size_t i = 0; i < lines.size(); ++i) {
        feet += expected[i].size() > lines[i].size();
        moved += !lines[i].empty() && expected[i].front() != lines[i].front();
      }
    }
  }
  CHECK(moved > 10000);
  CHECK(feet > 10000);
}

}  // namespace faces
