#include "apothem/contact/law.hpp"

namespace apothem {
namespace {

bool matches(const ContactRule::Party& party, int body, int material) {
  return party.index == (party.is_body ? body : material);
}

}  // namespace

Friction friction_between(const ContactLaw& law, int a, int material_a, int b, int material_b) {
  Friction friction = law.friction;
  for (const ContactRule& rule : law.rules) {  // later rules win
    const auto [p, q] = rule.between;
    const bool straight = matches(p, a, material_a) && matches(q, b, material_b);
    const bool crossed = matches(p, b, material_b) && matches(q, a, material_a);
    if (straight || crossed) friction = rule.friction;
  }
  if (friction.tangential_stiffness == 0) {
    friction.tangential_stiffness = kTangentialShare * law.normal_stiffness;
  }
  return friction;
}

}  // namespace apothem
