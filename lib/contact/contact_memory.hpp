// What contacts remember, and how it is handed to a simulation that numbers its bodies otherwise.
#pragma once

#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

/// The numbers by which the contacts of a scene call its bodies.
struct ContactNumbers {
  struct Body {
    bool rigid = false;
    int edges = 0;                        ///< of a polygon
    int first_surface = 0, surfaces = 0;  ///< see Surfaces
    int first_vertex = 0, vertices = 0;   ///< see Outlines; none without outlines
    void fields(Archive& archive) {
      archive("rigid", rigid)("edges", edges)("first_surface", first_surface)("surfaces", surfaces)(
          "first_vertex", first_vertex)("vertices", vertices);
    }
  };
  FrictionLaw law = FrictionLaw::resultant;  ///< of rigid bodies
  std::vector<Body> bodies;                  ///< in the order of BodyIndex

  void fields(Archive& archive) {
    int number = static_cast<int>(law);
    archive("friction_law", number)("bodies", bodies);
    law = static_cast<FrictionLaw>(number);
  }
};

/// The memory of contacts whose bodies both have an heir in another scene, by the numbers there.
/// `heirs`: for each body of `from` its number in `to`, or -1. Springs between rigid bodies are
/// left out if the friction laws of the two scenes differ.
FrictionMemory hand_over(const FrictionMemory& memory, const ContactNumbers& from,
                         const ContactNumbers& to, std::span<const BodyIndex> heirs);

}  // namespace apothem
