#include "lib/scene/import_report.hpp"

#include <fmt/format.h>

namespace apothem {
namespace {

// Names of entities are in upper case and stay as they are; others are words.
void add(std::string& list, int count, const std::string& entity, const std::string& reason) {
  const bool word = !entity.empty() && entity[0] >= 'a' && entity[0] <= 'z';
  list += fmt::format("{}{} {}{}{}", list.empty() ? "" : ", ", count, entity,
                      word && count != 1 ? "s" : "",
                      reason.empty() ? "" : fmt::format(" ({})", reason));
}

}  // namespace

std::string ImportReport::read_in_words() const {
  std::string list;
  for (const auto& [entity, count] : read) add(list, count, entity, "");
  return list;
}

std::string ImportReport::left_out_in_words() const {
  std::string list;
  for (const auto& [what, count] : left_out) add(list, count, what.first, what.second);
  return list;
}

}  // namespace apothem
