#include "lib/contact/law/pair_table.hpp"

#include <algorithm>

namespace apothem {

PairTable::PairTable(const ContactLaw& law, const std::vector<MaterialIndex>& material,
                     int materials)
    : self_(law.self) {
  std::vector<char> named(material.size());
  for (const ContactRule& rule : law.rules) {
    for (const ContactRule::Party& party : rule.between) {
      if (party.is_body) named[party.index] = 1;
    }
  }
  std::vector<BodyIndex> first;  // of each kind
  std::vector<int> of_material(materials, -1);
  for (BodyIndex a = 0; a < static_cast<BodyIndex>(material.size()); ++a) {
    int& known = of_material[material[a]];
    kind_.push_back(named[a] || known < 0 ? static_cast<int>(first.size()) : known);
    if (!named[a]) known = kind_.back();
    if (kind_.back() == static_cast<int>(first.size())) first.push_back(a);
  }
  kinds_ = first.size();
  for (const BodyIndex a : first) {
    for (const BodyIndex b : first) {
      table_.push_back(law_between(law, a, material[a], b, material[b]));
      const PairLaw& pair = table_.back();
      rough_ = rough_ || pair.friction.coefficient > 0;
      damped_ = damped_ || pair.damping.normal > 0 || pair.damping.tangential > 0;
      largest_damping_ = std::max(largest_damping_, pair.damping.normal);
      stiffest_ = std::max(stiffest_, pair.normal_stiffness);
      softest_ = std::min(softest_, pair.normal_stiffness);
      if (!(pair.friction.coefficient > 0)) continue;
      stiffest_friction_ = std::max(stiffest_friction_, pair.friction.tangential_stiffness);
    }
  }
}

}  // namespace apothem
