#include "lib/contact/mesh/outline_events.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace apothem {
namespace {

// Change of the length inside that counts as sudden, relative to the smaller r.
constexpr double kSuddenLength = .1;
constexpr double kRoundOff = 1e-9;
constexpr double kPathTime = 5000;  // time for a pair, ns
constexpr double kUnitTime = 1000;  // ns

// A hash of a vertex. The sums of these hashes differ for different sets of vertices.
std::uint64_t scrambled(int vertex) {
  std::uint64_t z = (static_cast<std::uint64_t>(vertex) + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 31)) * 0xbf58476d1ce4e5b9ULL;
  return z ^ (z >> 29);
}

// Joins consecutive entries of the same pair.
void join_neighbours(std::vector<TouchingPair>& list) {
  size_t last = 0;
  for (size_t i = 1; i < list.size(); ++i) {
    if (list[i].same_pair(list[last])) {
      list[last].inside_a += list[i].inside_a;
      list[last].length += list[i].length;
      list[last].is_saturated = list[last].is_saturated || list[i].is_saturated;
    } else {
      list[++last] = list[i];
    }
  }
  list.resize(std::min(list.size(), last + 1));
}

}  // namespace

// Lists the pairs that touch: first one entry for each sequence of contacts of a pair within a
// unit, then one for each pair. Units do not depend on the number of threads, nor do sums over the
// contacts of a unit.
void OutlineEvents::find_touching(const EdgeFaceBlocks& blocks, const SaturatedRegions& saturated,
                                  bool at_first) {
  const OutlineSurfaces& o = outlines_;
  const auto add_unit = [&](const EdgeFaceUnit& unit, std::vector<TouchingPair>& sequences) {
    const size_t before = sequences.size();
    blocks.each_contact(unit, [&](size_t i, size_t lane) {
      const EdgeFaceTouch& touch = blocks.touches()[i];
      const int edge = blocks.blocks()[i].p[lane], face = blocks.blocks()[i].a[lane];
      if (at_first && touch.deepest[lane] < kRoundOff * o.length[edge]) return;
      const auto [a, b] = std::minmax({o.body[edge], o.body[face]});
      const TouchingPair pair{a, b, 0, 0, 0, 0, 0};
      if (sequences.size() == before || !sequences.back().same_pair(pair))
        sequences.push_back(pair);
      if (touch.from[lane] == 0) sequences.back().inside_a += scrambled(edge);
      sequences.back().length += (touch.to[lane] - touch.from[lane]) * o.length[edge];
    });
  };
  sequences_.begin(threads_);
  const std::span<const EdgeFaceUnit> units = blocks.units();
  threads_.chunks(static_cast<int>(units.size()), kUnitTime, [&](int first, int end, int worker) {
    for (int u = first; u < end; ++u)
      add_unit(units[static_cast<size_t>(u)], sequences_.of(worker));
  });
  std::vector<TouchingPair>& list = watch_.begin_step();
  sequences_.join(list);
  join_neighbours(list);
  const auto add_saturated = [&](int own, BodyIndex other) {
    const auto [a, b] = std::minmax(o.body[own], other);
    const TouchingPair pair{a, b, 0, 0, 0, 0, 0, true};
    if (list.empty() || !list.back().same_pair(pair) || !list.back().is_saturated)
      list.push_back(pair);
  };
  for (const SaturatedEdge& region : saturated.edges()) add_saturated(region.edge, region.body);
  for (const SaturatedFace& region : saturated.faces()) add_saturated(region.face, region.body);
  std::ranges::sort(list, std::less<>());
  join_neighbours(list);
}

bool OutlineEvents::find(std::span<const EdgeFace> candidates, const EdgeFaceBlocks& blocks,
                         const SaturatedRegions& saturated, const Kinematics& now,
                         const Dynamics& dynamics, double dt) {
  find_touching(blocks, saturated, !(dt > 0));
  changed_.clear();
  for (PathWorkspace& worker : workers_) worker.on_nodes.clear(), worker.on_rigid.clear();
  if (!(dt > 0)) return false;
  const std::vector<OutlineSurfaces::Body>& bodies = outlines_.bodies;
  watch_.compare(
      [&](BodyIndex a, BodyIndex b) {
        return kSuddenLength * std::min(bodies[a].reference, bodies[b].reference);
      },
      [&](const PairChange& change) {
        changed_.push_back({change.a, change.b, change.panels});
      });
  threads_.chunks(static_cast<int>(changed_.size()), kPathTime,
                  [&](int first, int end, int number) {
                    PathWorkspace& worker = workers_[static_cast<size_t>(number)];
                    for (int i = first; i < end; ++i) {
                      const auto& [a, b, panels] = changed_[static_cast<size_t>(i)];
                      worker.path.find(a, b, panels, candidates, {now, dynamics, dt},
                                       worker.on_nodes, worker.on_rigid);
                    }
                  });
  return std::ranges::any_of(workers_, [](const PathWorkspace& w) { return !w.on_nodes.empty(); });
}

void OutlineEvents::add(double scale, const ForceViews& forces) const {
  // Impulses are added in the order of the pairs, as if one thread had worked on all of them.
  for (const PathWorkspace& worker : workers_) {
    for (const auto& [i, mean] : worker.on_nodes) forces.nodes[i] += scale * mean;
    for (const auto& [i, mean] : worker.on_rigid) forces.rigid[i] += scale * mean;
  }
}

}  // namespace apothem
