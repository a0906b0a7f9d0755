#include <array>
#include <catch2/catch.hpp>
#include <chrono>

#include "geometry/spatial/boxes.hpp"
#include "tests/support.hpp"

using namespace apothem;

TEST_CASE("the box grid finds what brute force finds", "[boxes]") {
  test::SeededRandom random(3);
  BoxGrid grid;
  std::vector<BoxPair> found;
  for (int round = 0; round < test::scaled(200); ++round) {
    const double offset = round % 3 == 0 ? 0 : std::pow(10.0, random.uniform(0, 12));
    std::vector<Box> boxes;
    const int n = random.integer(0, 120);
    for (int i = 0; i < n; ++i) {
      const double size = std::pow(10.0, random.uniform(-3, 1));  // ratio 1 : 10 000
      const double x = offset + random.uniform(-5, 5);
      const double y = -offset + random.uniform(-5, 5);
      boxes.push_back({x, y, x + size * random.uniform(0, 1), y + size * random.uniform(0, 1)});
      if (random.integer(0, 9) == 0) boxes.push_back(boxes.back());                // twice the same
      if (random.integer(0, 9) == 0) boxes.push_back({x, y, x, y});                // a point
      if (random.integer(0, 9) == 0) boxes.push_back({x - size, y, x, y + size});  // touching
    }
    std::vector<BoxPair> expected;
    for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
      for (int j = i + 1; j < static_cast<int>(boxes.size()); ++j) {
        if (!apart(boxes[i], boxes[j])) expected.push_back({i, j});
      }
    }
    grid.find_pairs(boxes, found);
    REQUIRE(found == expected);
  }
}

TEST_CASE("the box grid follows boxes that move, grow, vanish and come", "[boxes]") {
  test::SeededRandom random(4);
  int few = 0;
  for (int round = 0; round < test::scaled(100); ++round) {
    BoxGrid grid;
    std::vector<BoxPair> found;
    const double offset = round % 3 == 0 ? 0 : std::pow(10.0, random.uniform(0, 12));
    const double sizes = round % 2 == 0 ? 1 : 3;  // ratio 1 : 10 or 1 : 1000
    const auto box = [&] {
      const double size = .3 * std::pow(10.0, random.uniform(-sizes, 0));
      const double x = offset + random.uniform(-1, 1), y = -offset + random.uniform(-1, 1);
      if (random.integer(0, 19) == 0) return Box();
      return Box{x, y, x + size * random.uniform(0, 1), y + size * random.uniform(0, 1)};
    };
    std::vector<Box> boxes;
    const int n = random.integer(1, 150);
    for (int i = 0; i < n; ++i) boxes.push_back(box());
    grid.find_pairs(boxes, found);
    for (int again = 0; again < 10; ++again) {
      std::vector<std::int32_t> changed;
      const int part = random.integer(1, 30);
      for (int i = 0; i < n; ++i) {
        if (random.integer(0, part) != 0) continue;
        changed.push_back(i);
        boxes[i] = box();
        if (random.integer(0, 40) == 0) boxes[i].x1 = 100 * std::abs(offset) + 1;  // out of reach
      }
      few += changed.size() < boxes.size() / 4;
      grid.find_pairs_again(boxes, changed, found);
      std::vector<BoxPair> expected;
      for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) {
          if (!apart(boxes[i], boxes[j])) expected.push_back({i, j});
        }
      }
      REQUIRE(found == expected);
    }
  }
  CHECK(few > test::least(test::scaled(300)));
}

TEST_CASE("boxes far away and without end are found, and the others as fast", "[boxes]") {
  test::SeededRandom random(6);
  for (int round = 0; round < test::scaled(100); ++round) {
    std::vector<Box> boxes;
    const int n = random.integer(1, 200);
    for (int i = 0; i < n; ++i) {
      const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
      boxes.push_back({x, y, x + random.uniform(0, .1), y + random.uniform(0, .1)});
      const double far = std::pow(10., random.integer(10, 308));
      if (random.integer(0, 39) == 0) boxes.back().x1 = far;
      if (random.integer(0, 39) == 0) boxes.back().y0 = -far;
      if (random.integer(0, 79) == 0) boxes.back().x0 = -HUGE_VAL;
      if (random.integer(0, 79) == 0) boxes.back() = {-HUGE_VAL, -.5, HUGE_VAL, HUGE_VAL};
      if (random.integer(0, 79) == 0) boxes.back() = {far, far, HUGE_VAL, HUGE_VAL};
    }
    std::vector<BoxPair> expected, found;
    const auto expect = [&] {
      expected.clear();
      for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) {
          if (!apart(boxes[i], boxes[j])) expected.push_back({i, j});
        }
      }
    };
    BoxGrid grid;
    grid.find_pairs(boxes, found);
    expect();
    REQUIRE(found == expected);
    const std::vector<std::int32_t> changed{random.integer(0, n - 1)};
    boxes[changed[0]] = {0, 0, .1, random.integer(0, 2) == 0 ? HUGE_VAL : .1};
    grid.find_pairs_again(boxes, changed, found);
    expect();
    REQUIRE(found == expected);
  }
  // One box without end would leave all others in one cell: 2e9 pairs to look at.
  std::vector<Box> many{{-HUGE_VAL, 2, HUGE_VAL, HUGE_VAL}};
  for (int i = 0; i < 60000; ++i) many.push_back({1. * i, 0, i + .5, 1});
  std::vector<BoxPair> none;
  const auto start = std::chrono::steady_clock::now();
  BoxGrid().find_pairs(many, none);
  CHECK(none.empty());
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));
}

TEST_CASE("the box grid finds the same on any number of threads", "[boxes][parallel]") {
  samples::Random random(5);
  const int n = 6000;  // so many that threads divide all that they can divide
  const auto box = [&] {
    const double size = .03 * std::pow(10.0, random.uniform(-1, 0));
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    if (random.integer(0, 99) == 0) return Box();
    if (random.integer(0, 999) == 0) return Box{x - .5, y - .01, x + .5, y};
    return Box{x, y, x + size * random.uniform(0, 1), y + size * random.uniform(0, 1)};
  };
  std::vector<Box> boxes;
  for (int i = 0; i < n; ++i) boxes.push_back(box());
  std::vector<BoxPair> expected;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      if (!apart(boxes[i], boxes[j])) expected.push_back({i, j});
    }
  }
  const std::array counts{1, 2, 3, 7};
  std::array<BoxGrid, counts.size()> grids;
  std::array<std::vector<BoxPair>, counts.size()> found;
  for (size_t k = 0; k < counts.size(); ++k) {
    grids[k].find_pairs(boxes, found[k], Threads(counts[k]));
    REQUIRE(found[k] == expected);
  }
  for (int again = 0; again < 10; ++again) {
    std::vector<std::int32_t> changed;
    for (int i = 0; i < n; ++i) {
      if (random.integer(0, again % 2 == 0 ? 5 : 50) != 0) continue;
      changed.push_back(i);
      boxes[i] = box();
    }
    for (size_t k = 0; k < counts.size(); ++k) {
      grids[k].find_pairs_again(boxes, changed, found[k], Threads(counts[k]));
      REQUIRE(found[k] == found[0]);
    }
  }
  // One that looks at all of them anew.
  BoxGrid().find_pairs(boxes, expected);
  CHECK(found[0] == expected);
}
