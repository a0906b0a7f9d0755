// The order of what is kept in slots.
#include <catch2/catch.hpp>
#include <string>

#include "lib/contact/rigid/slot_order.hpp"
#include "tests/support.hpp"

using namespace apothem;

TEST_CASE("what slots hold is put into the order that was asked for", "[slots][contact]") {
  samples::Random random(5);
  for (int round = 0; round < 200; ++round) {
    const int count = random.integer(0, 30);
    std::vector<std::string> list;
    std::vector<int> slots;
    for (int i = 0; i < count; ++i) {
      list.push_back("what slot " + std::to_string(i) + " holds, too long to be kept in place");
      if (random.integer(0, 3) > 0) slots.push_back(i);
    }
    for (size_t i = slots.size(); i > 1; --i) {
      std::swap(slots[i - 1],
                slots[static_cast<size_t>(random.integer(0, static_cast<int>(i) - 1))]);
    }
    std::vector<std::string> expected;
    SlotOrder order;
    order.begin(list.size());
    for (const int slot : slots) {
      CHECK(order.add(slot) == static_cast<int>(expected.size()));
      expected.push_back(list[static_cast<size_t>(slot)]);
    }
    order.end();
    order.apply(list);
    CHECK(list == expected);
    // A list that has nothing for the last slots yet.
    std::vector<int> numbers(static_cast<size_t>(count / 2), 7);
    order.apply(numbers);
    REQUIRE(numbers.size() == slots.size());
    for (size_t i = 0; i < slots.size(); ++i) CHECK(numbers[i] == (slots[i] < count / 2 ? 7 : 0));
  }
}
