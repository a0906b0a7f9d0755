// Random and adversarial pairs without a single failure. APOTHEM_LONG=1 in the environment runs the
// million; each pair depends on its number alone, so a failing one can be repeated by itself.
#include <catch2/catch.hpp>

#include "tests/fuzz/hard_pairs.hpp"
#include "tests/fuzz/pair_check.hpp"
#include "tests/support.hpp"

using namespace apothem;

TEST_CASE("random and adversarial pairs", "[fuzz]") {
  const bool all = test::long_run();
  const std::vector<test::HardShape> pool = test::shapes(all ? 600 : test::scaled(300) + 30);
  const int pairs = all ? 1'000'000 : test::scaled(20'000);
  int touching = 0;
  test::PairErrors worst;
  for (int i = 0; i < pairs; ++i) {
    const auto [a, b, moved] = test::hard_pair(pool, static_cast<unsigned>(i));
    const test::PairCheck check = test::check_pair(a.polygon, a.potential, moved, b.potential);
    touching += check.touching;
    worst.force = std::max(worst.force, check.errors.force);
    worst.moment = std::max(worst.moment, check.errors.moment);
    worst.energy = std::max(worst.energy, check.errors.energy);
    worst.area = std::max(worst.area, check.errors.area);
    if (check.defect)
      FAIL_CHECK(*check.defect << "\n" << test::as_line(std::to_string(i), a.polygon, moved));
  }
  CHECK(touching > test::least(pairs / 3));
  if (all) {
    WARN(pairs << " pairs, " << touching << " of them overlap; round-off at most " << worst.force
               << " (force), " << worst.moment << " (moment), " << worst.energy << " (energy), "
               << worst.area << " (area) units");
  }
}
