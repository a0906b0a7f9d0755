#include "apothem/run/warnings.hpp"

#include <fmt/format.h>

#include "apothem/model/inradius.hpp"

namespace apothem {
namespace {

// Contact is a penalty: what it lets bodies into each other should not matter for their motion.
void warn_of_penetration(const Model& model, const Peak& deepest,
                         std::vector<std::string>& warnings) {
  const double limit = model.contact.penetration_warning;
  if (!(deepest.value > limit)) return;
  double inradius = inradius_of(model, deepest.a);
  BodyIndex smaller = deepest.a;
  if (const double other = inradius_of(model, deepest.b); other < inradius) {
    inradius = other;
    smaller = deepest.b;
  }
  warnings.push_back(fmt::format(
      "\"{}\" and \"{}\" were {:.3g} m deep in each other at t = {:.6g} s, {:.3g} % of the "
      "inradius of \"{}\" ({:.3g} m) and more than contact.penetration_warning ({:.3g} %): raise "
      "contact.normal_stiffness",
      model.name_of(deepest.a), model.name_of(deepest.b), deepest.value * inradius, deepest.time,
      100 * deepest.value, model.name_of(smaller), inradius, 100 * limit));
}

}  // namespace

std::vector<std::string> warnings_of(const Model& model, const Extremes& extremes) {
  std::vector<std::string> warnings;
  warn_of_penetration(model, extremes.relative_penetration, warnings);
  return warnings;
}

}  // namespace apothem
