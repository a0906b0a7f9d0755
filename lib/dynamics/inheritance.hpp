// A simulation that begins where another one has stopped: bodies of the same name and shape take
// over place and velocity, and contacts between them what they remember.
#pragma once

#include <string>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/contact/contact_memory.hpp"
#include "lib/dynamics/body_start.hpp"
#include "lib/dynamics/simulation.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// By what a body is recognised in another scene.
struct BodyRecord {
  std::string name;
  bool rigid = true;
  /// x and y of the vertices about the mass centre at angle 0, or of the nodes of the mesh as given
  /// in model coordinates, m.
  std::vector<double> shape;
  std::int64_t cells = 0;  ///< hash of the elements of a mesh
  void fields(Archive& archive) {
    archive("name", name)("rigid", rigid)("shape", shape)("cells", cells);
  }
};

struct ModelRecord {
  Vec2 origin = Vec2::Zero();  ///< of the model's coordinates, m
  std::vector<BodyRecord> bodies;
  ContactNumbers contacts;
  void fields(Archive& archive) {
    archive("origin", origin)("bodies", bodies)("contacts", contacts);
  }
  /// Of the state that belongs to it.
  [[nodiscard]] Layout layout() const;
};
ModelRecord record_of(const Simulation& simulation);

/// What the bodies of a model take over from a state of another one.
struct Inheritance {
  std::vector<BodyIndex> heirs;  ///< of each body of the other model; -1: none
  std::vector<BodyStart> starts;
};
/// Bodies are the same if name, kind and shape agree; nodes may be given at another place.
Inheritance inheritance(const ModelRecord& other, const State& state, const Model& model);

/// Lets bodies begin there. What their scene holds or prescribes keeps its velocity. Throws
/// ArchiveMismatch if a start does not fit its body.
void begin_at(Model& model, const std::vector<BodyStart>& starts);

}  // namespace apothem
