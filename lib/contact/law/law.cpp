#include "lib/contact/law/law.hpp"

namespace apothem {
namespace {

bool matches(const ContactRule::Party& party, int body, int material) {
  return party.index == (party.is_body ? body : material);
}

}  // namespace

std::string_view stiffening(const ContactLaw& law) {
  return law.penetration ? "lower contact.penetration" : "raise contact.normal_stiffness";
}

PairLaw law_between(const ContactLaw& law, int a, int material_a, int b, int material_b) {
  PairLaw result{law.normal_stiffness, law.friction, law.damping};
  for (const ContactRule& rule : law.rules) {  // later rules win
    const auto [p, q] = rule.between;
    const bool straight = matches(p, a, material_a) && matches(q, b, material_b);
    const bool crossed = matches(p, b, material_b) && matches(q, a, material_a);
    if (!straight && !crossed) continue;
    result.friction = rule.friction.value_or(result.friction);
    result.damping = rule.damping.value_or(result.damping);
    result.normal_stiffness = rule.normal_stiffness.value_or(result.normal_stiffness);
  }
  if (result.friction.tangential_stiffness > 0) result.friction.stiffness_ratio = 0;
  return result;
}

}  // namespace apothem
