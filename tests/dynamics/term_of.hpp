// Looking into the list of terms of a simulation.
#pragma once

#include <vector>

#include "lib/dynamics/contact_term.hpp"
#include "lib/dynamics/simulation.hpp"

namespace apothem::test {

/// The term of a kind; null if the scene has none.
template <class T>
const T* term_of(const Simulation& simulation) {
  for (const auto& term : simulation.terms()) {
    if (const auto* found = dynamic_cast<const T*>(term.get())) return found;
  }
  return nullptr;
}

/// The friction springs of all contacts.
inline std::vector<Spring> springs(const Simulation& simulation) {
  const auto* contact = term_of<ContactTerm>(simulation);
  return contact ? contact->contacts().springs() : std::vector<Spring>();
}

}  // namespace apothem::test
