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
  std::vector<BodyIndex> first;  // the first body of each kind
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
      rough_ = rough_ || pair.rough();
      damped_ = damped_ || pair.damped();
      stiffest_ = std::max(stiffest_, pair.normal_stiffness);
      softest_ = std::min(softest_, pair.normal_stiffness);
      if (!pair.rough()) continue;
      const auto raise = [](double value, double& largest) { largest = std::max(largest, value); };
      raise(pair.friction.tangential_stiffness, stiffest_friction_.tangential_stiffness);
      raise(pair.friction.stiffness_ratio, stiffest_friction_.stiffness_ratio);
    }
  }
}

}  // namespace apothem
