// The memory of contacts, and its mapping to a simulation that numbers its bodies differently.
#pragma once

#include <span>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/law/friction_memory.hpp"
#include "lib/contact/law/law.hpp"
#include "lib/contact/surface/surfaces.hpp"

namespace apothem {

/// The numbers by which the keys of contacts refer to the bodies of a scene.
struct ContactNumbers {
  struct Body {
    bool rigid = false;
    int edges = 0;                        ///< number of edges of a rigid body's polygon
    int first_surface = 0, surfaces = 0;  ///< range of the body's surfaces, see Surfaces
    /// Range of the body's vertices, see OutlineSurfaces; empty without outlines.
    int first_vertex = 0, vertices = 0;
    void fields(Archive& archive) {
      archive("rigid", rigid)("edges", edges)("first_surface", first_surface)("surfaces", surfaces)(
          "first_vertex", first_vertex)("vertices", vertices);
    }
  };
  FrictionLaw law = FrictionLaw::resultant;  ///< the friction law of rigid bodies
  std::vector<Body> bodies;                  ///< one entry per body, in the order of BodyIndex

  void fields(Archive& archive) {
    int number = static_cast<int>(law);
    archive("friction_law", number)("bodies", bodies);
    law = static_cast<FrictionLaw>(number);
  }
};

/// Maps the friction memory of one simulation to the numbering of another one (restart mapping).
/// `body_map` gives for each body of `source` its number in `target`, or -1 if it has no
/// counterpart; contacts of such bodies are dropped. Springs between rigid bodies are dropped if
/// the friction laws of the two scenes differ.
FrictionMemory map_memory(const FrictionMemory& memory, const ContactNumbers& source,
                          const ContactNumbers& target, std::span<const BodyIndex> body_map);

}  // namespace apothem
