#include "apps/polygon/input.hpp"

#include <fmt/format.h>

#include "apps/commands.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/text/decimal.hpp"

namespace apothem {

void set_reference(PotentialChoice& choice, const std::string& text) {
  for (const NamedReference& r : kReferences) {
    if (text == r.name) {
      choice.reference = r.reference;
      return;
    }
  }
  choice.reference = PotentialChoice::Reference::length;
  try {
    choice.length = parse_decimal(text);
  } catch (const BadNumber&) {
    choice.length = 0;
  }
  if (!(choice.length > 0)) {
    throw UsageError(
        "--reference",
        fmt::format("must be roof, inscribed_circle or a positive length in m, not \"{}\"", text));
  }
}

}  // namespace apothem
