#include "lib/dynamics/population.hpp"

#include "geometry/spatial/boxes.hpp"
#include "lib/model/rotation.hpp"
#include "lib/model/statistics.hpp"

namespace apothem {

bool Population::needed(const Model& model) {
  return !model.inflows.empty() || !model.left.empty() ||
         model.world.outside != World::Outside::keep;
}

std::vector<std::uint8_t> Population::absent_at_start(const Model& model) {
  if (!needed(model)) return {};
  std::vector<std::uint8_t> absent(model.bodies.size() + model.deformables.size());
  for (const Inflow& inflow : model.inflows) {
    for (const std::vector<BodyIndex>& batch : inflow.batches) {
      for (const BodyIndex b : batch) {
        absent[static_cast<size_t>(b)] = static_cast<std::uint8_t>(Presence::waiting);
      }
    }
  }
  for (const BodyIndex b : model.left) {
    absent[static_cast<size_t>(b)] = static_cast<std::uint8_t>(Presence::left);
  }
  return absent;
}

Population::Change Population::look(const State& state) {
  Change change;
  const auto bodies = static_cast<BodyIndex>(state.absent.size());
  if (model_.world.outside != World::Outside::keep) {
    for (BodyIndex b = 0; b < bodies; ++b) {
      if (state.is_absent(b) || !is_free(model_, b) || !is_outside(state, b)) continue;
      if (model_.world.outside == World::Outside::stop) {
        if (outside_ < 0) outside_ = b;
      } else {
        change.leave.push_back(b);
      }
    }
  }
  for (size_t i = 0; i < inflows_.size(); ++i) {
    const Inflow& inflow = model_.inflows[i];
    Progress& progress = inflows_[i];
    if (progress.next == static_cast<std::int64_t>(inflow.batches.size())) continue;
    if (state.time < progress.last + inflow.every) continue;
    const std::vector<BodyIndex>& batch = inflow.batches[static_cast<size_t>(progress.next)];
    if (!has_room(state, batch)) continue;
    ++progress.next;
    progress.last = state.time;
    change.come.insert(change.come.end(), batch.begin(), batch.end());
  }
  left_ += static_cast<std::int64_t>(change.leave.size());
  come_ += static_cast<std::int64_t>(change.come.size());
  return change;
}

Box Population::box_of(const State& state, BodyIndex body) const {
  Box box;
  const auto rigid = static_cast<BodyIndex>(model_.bodies.size());
  if (body < rigid) {
    const auto x = state.pose(body);
    for (const Vec2& v : model_.bodies[body].potential.vertices) {
      box.include(Vec2(x.head<2>()) + turned(v, x[2]));
    }
    return box;
  }
  const DeformableBody& of = model_.deformables[body - rigid];
  for (int i = 0; i < static_cast<int>(of.mesh.nodes.size()); ++i) {
    box.include(of.mesh.nodes[i] + state.node(of.first_node + i));
  }
  return box;
}

bool Population::is_outside(const State& state, BodyIndex body) const {
  const Box& world = model_.world.box;
  if (body < static_cast<BodyIndex>(model_.bodies.size())) {
    const auto x = state.pose(body);
    if (contains(world, Box{x[0], x[1], x[0], x[1]})) return false;
  }
  return apart(box_of(state, body), world);
}

int Population::count_outside(const State& state) const {
  if (model_.world.outside == World::Outside::keep) return 0;
  int count = 0;
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(state.absent.size()); ++b) {
    if (!state.is_absent(b) && is_free(model_, b) && is_outside(state, b)) ++count;
  }
  return count;
}

// What cannot move has been kept out of the way when the blocks were arranged.
bool Population::has_room(const State& state, const std::vector<BodyIndex>& batch) const {
  std::vector<Box> boxes;
  Box all;
  for (const BodyIndex b : batch) {
    boxes.push_back(box_of(state, b));
    all.include(boxes.back());
  }
  for (BodyIndex b = 0; b < static_cast<BodyIndex>(state.absent.size()); ++b) {
    if (state.is_absent(b)) continue;
    if (b < static_cast<BodyIndex>(model_.bodies.size()) && !model_.bodies[b].can_move()) continue;
    const Box own = box_of(state, b);
    if (apart(own, all)) continue;
    for (const Box& box : boxes) {
      if (!apart(own, box)) return false;
    }
  }
  return true;
}

}  // namespace apothem
