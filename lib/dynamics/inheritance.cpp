#include "lib/dynamics/inheritance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "lib/dynamics/population.hpp"

namespace apothem {
namespace {

constexpr double kSameShape = 1e-9;  // of its size

void append(std::vector<double>& to, const std::vector<Vec2>& points) {
  for (const Vec2& p : points) to.insert(to.end(), {p.x(), p.y()});
}

// FNV-1a of the node numbers of all elements.
std::int64_t hash_of_cells(const Mesh& mesh) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (int e = 0; e < mesh.element_count(); ++e) {
    hash = (hash ^ 0xffU) * 0x100000001b3U;
    for (const int node : mesh.element(e)) {
      hash = (hash ^ static_cast<std::uint64_t>(node)) * 0x100000001b3U;
    }
  }
  return static_cast<std::int64_t>(hash >> 1);
}

BodyRecord record_of(const RigidBody& body) {
  BodyRecord record{body.name, true, {}, 0};
  append(record.shape, body.potential.vertices);
  if (body.potential.links) {
    for (const int start : body.potential.links->starts) {
      record.cells = 31 * record.cells + start;  // the vertices alone do not tell the rings
    }
  }
  return record;
}

BodyRecord record_of(const DeformableBody& body) {
  BodyRecord record{body.name, false, {}, hash_of_cells(body.mesh)};
  append(record.shape, body.mesh.nodes);
  return record;
}

std::vector<BodyRecord> records_of(const Model& model) {
  std::vector<BodyRecord> records;
  for (const RigidBody& body : model.bodies) records.push_back(record_of(body));
  for (const DeformableBody& body : model.deformables) records.push_back(record_of(body));
  return records;
}

bool same(const BodyRecord& a, const BodyRecord& b) {
  if (a.name != b.name || a.rigid != b.rigid || a.cells != b.cells ||
      a.shape.size() != b.shape.size() || a.shape.empty()) {
    return false;
  }
  // Meshes may lie at another place: their first nodes are put on each other.
  const double shift[2]{a.rigid ? 0 : a.shape[0] - b.shape[0],
                        a.rigid ? 0 : a.shape[1] - b.shape[1]};
  double size = 0, apart = 0;
  for (size_t i = 0; i < a.shape.size(); ++i) {
    size = std::max(size, std::abs(a.shape[i] - a.shape[i % 2]));
    apart = std::max(apart, std::abs(a.shape[i] - b.shape[i] - shift[i % 2]));
  }
  return apart <= kSameShape * size;
}

// What is there, or has left, does not come any more.
void begin_present(Model& model, const BodyStart& start) {
  const auto presence = static_cast<Presence>(start.absent);
  if (presence == Presence::waiting) return;
  if (presence == Presence::left) model.left.push_back(start.body);
  for (Inflow& inflow : model.inflows) {
    for (std::vector<BodyIndex>& batch : inflow.batches) std::erase(batch, start.body);
  }
}

}  // namespace

Layout ModelRecord::layout() const {
  Layout layout;
  for (const BodyRecord& body : bodies) {
    layout.rigid_bodies += body.rigid;
    layout.nodes += body.rigid ? 0 : static_cast<int>(body.shape.size() / 2);
  }
  return layout;
}

ModelRecord record_of(const Simulation& simulation) {
  return {simulation.model().origin, records_of(simulation.model()), simulation.contact_numbers()};
}

Inheritance inheritance(const ModelRecord& other, const State& state, const Model& model) {
  const std::vector<BodyRecord> records = records_of(model);
  const Vec2 shift = other.origin - model.origin;
  std::unordered_map<std::string, const BodyRecord*> by_name;
  for (const BodyRecord& record : records) by_name[record.name] = &record;
  Inheritance result;
  size_t c = 0;  // the first coordinate of the body
  for (const BodyRecord& old : other.bodies) {
    const auto named = by_name.find(old.name);
    const BodyRecord* const found =
        named != by_name.end() && same(old, *named->second) ? named->second : nullptr;
    const size_t size = old.rigid ? 3 : old.shape.size();
    const auto slice = [&](const std::vector<double>& of) {
      return std::vector<double>(of.begin() + static_cast<std::ptrdiff_t>(c),
                                 of.begin() + static_cast<std::ptrdiff_t>(c + size));
    };
    BodyStart start{-1, slice(state.x), slice(state.v), 0};
    c += size;
    if (!state.absent.empty()) start.absent = state.absent[result.heirs.size()];
    if (found) {
      start.body = static_cast<BodyIndex>(found - records.data());
      for (size_t i = 0; i < (old.rigid ? 2 : size); ++i) {
        start.x[i] += shift[static_cast<Eigen::Index>(i % 2)];
        if (!old.rigid) start.x[i] += old.shape[i] - found->shape[i];
      }
      result.starts.push_back(start);
    }
    result.heirs.push_back(start.body);
  }
  return result;
}

void begin_at(Model& model, const std::vector<BodyStart>& starts) {
  const auto rigid = static_cast<BodyIndex>(model.bodies.size());
  const auto all = rigid + static_cast<BodyIndex>(model.deformables.size());
  for (const BodyStart& start : starts) {
    if (start.body < 0 || start.body >= all) throw ArchiveMismatch("body");
    const bool is_rigid = start.body < rigid;
    const size_t size =
        is_rigid ? 3
                 : 2 * model.deformables[static_cast<size_t>(start.body - rigid)].mesh.nodes.size();
    if (start.x.size() != size || start.v.size() != size) throw ArchiveMismatch("x");
    begin_present(model, start);
    if (is_rigid) {
      RigidBody& body = model.bodies[static_cast<size_t>(start.body)];
      body.position = {start.x[0], start.x[1]};
      body.angle = start.x[2];
      if (body.motion != Motion::free) continue;
      for (int k = 0; k < 2; ++k) {
        body.velocity[k] = body.held[static_cast<size_t>(k)] ? 0 : start.v[static_cast<size_t>(k)];
      }
      body.spin = body.held[2] ? 0 : start.v[2];
    } else {
      DeformableBody& body = model.deformables[static_cast<size_t>(start.body - rigid)];
      body.displacement = start.x;
      body.node_velocity = start.v;
    }
  }
}

}  // namespace apothem
