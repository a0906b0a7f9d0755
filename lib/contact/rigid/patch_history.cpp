// What pairs of rigid bodies remember, as lists: for archives, other simulations, and records.
#include <algorithm>
#include <iterator>
#include <utility>

#include "lib/contact/rigid/patch_tangential.hpp"

namespace apothem {

// What matching patches needs of a run; the next step makes the rest anew.
static void describe(Archive& archive, RunPlace& run) {
  archive("of_a", run.of_a)("edge", run.edge)("patch", run.patch)("from", run.from)("to", run.to)(
      "length", run.length);
}

const PairMemory* PatchTangential::memory_of(const PairInTouch& pair) const {
  const auto slot = static_cast<size_t>(pair.slot);
  return slot < memory_.size() && memory_[slot].touched() ? &memory_[slot] : nullptr;
}

void PatchTangential::add_to(std::span<ContactRecord> patches, std::span<const BoundaryRun> runs,
                             const PairInTouch& pair) const {
  const PairMemory* const memory = memory_of(pair);
  if (!memory || memory->patches == 0) return;
  std::vector<Spring> springs;
  add_springs(pair, *memory, now_, springs);
  for (size_t i = 0; i < springs.size(); ++i) {
    const int patch = per_edge_ ? runs[i].patch : springs[i].key.part;
    patches[static_cast<size_t>(patch)].tangential += springs[i].force * springs[i].tangent;
  }
}

double PatchTangential::spring_in(const PairInTouch& pair, size_t patch) const {
  const PairMemory* const memory = memory_of(pair);
  if (!memory || per_edge_) return 0;
  if (memory->patches == 1) return memory->spring;
  const std::span<const Spring> springs = now_.springs_of(*memory);
  return patch < springs.size() ? springs[patch].force : 0;
}

void PatchTangential::keep_push(const PairInTouch& pair, size_t patch, double push) {
  PairMemory& memory = memory_[static_cast<size_t>(pair.slot)];
  if (memory.patches == 1 && !per_edge_) {
    memory.push = push;
  } else if (memory.split >= 0) {
    const Place& place = now_.places[static_cast<size_t>(memory.split)];
    if (patch < static_cast<size_t>(place.springs) && !per_edge_) {
      now_.springs[static_cast<size_t>(place.first_spring) + patch].push = push;
    }
  }
}

// Those of a pair; `lists` are those of the step that `memory` is of.
void PatchTangential::add_springs(const PairInTouch& pair, const PairMemory& memory,
                                  const Lists& lists, std::vector<Spring>& springs) const {
  if (!table_.between(pair.a, pair.b).rough()) return;
  if (memory.patches == 1 && !per_edge_) {
    springs.push_back({{polygon_kernel, pair.a, pair.b, 0},
                       memory.spring,
                       memory.stiffness,
                       {memory.tangent.x, memory.tangent.y},
                       memory.push});
    return;
  }
  const std::span<const Spring> listed = lists.springs_of(memory);
  springs.insert(springs.end(), listed.begin(), listed.end());
}

void PatchTangential::add_springs(std::vector<Spring>& springs) const {
  if (inherited_) {
    springs.insert(springs.end(), inherited_->springs.begin(), inherited_->springs.end());
    return;
  }
  for (const PairInTouch& pair : pairs_.touching()) {
    const PairMemory* const memory = memory_of(pair);
    if (memory) add_springs(pair, *memory, now_, springs);
  }
}

void PatchTangential::History::fields(Archive& archive) {
  archive("pairs", pairs)("runs", runs)("springs", springs);
}

void PatchTangential::fields(Archive& archive) {
  if (archive.loads()) {
    inherited_.emplace();
    inherited_->fields(archive);
  } else {
    History now = inherited_ ? *inherited_ : history();
    now.fields(archive);
  }
}

// Also of pairs that have ended since the last step.
PatchTangential::History PatchTangential::history() const {
  History history;
  const auto before = [](const PairInTouch& p, const PairInTouch& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  };
  std::vector<PairInTouch> all;
  std::ranges::merge(pairs_.touching(), pairs_.ended(), std::back_inserter(all), before);
  for (const PairInTouch& pair : all) {
    const PairMemory* const memory = memory_of(pair);
    if (!memory) continue;
    const std::span<const RunPlace> runs = now_.runs_of(*memory);
    history.pairs.push_back(
        {pair.a, pair.b, memory->patches, static_cast<int>(runs.size()), memory->force});
    history.runs.insert(history.runs.end(), runs.begin(), runs.end());
    add_springs(pair, *memory, now_, history.springs);
  }
  return history;
}

bool PatchTangential::adopt() {
  if (!inherited_) return false;
  const History from = std::move(*inherited_);
  inherited_.reset();
  memory_.assign(pairs_.slots(), {});
  now_.clear();
  left_.clear();
  auto touching = pairs_.touching().begin();
  const auto touching_end = pairs_.touching().end();
  size_t run = 0, spring = 0;
  for (const PairHistory& old : from.pairs) {
    const std::pair pair(old.a, old.b);
    const auto pair_of = [](const Spring& s) { return std::pair(s.key.a, s.key.b); };
    while (spring < from.springs.size() && pair_of(from.springs[spring]) < pair) ++spring;
    size_t end = spring;
    while (end < from.springs.size() && pair_of(from.springs[end]) == pair) ++end;
    Inherited of_pair{old};
    of_pair.runs = std::span(from.runs).subspan(run, static_cast<size_t>(old.runs));
    run += of_pair.runs.size();
    of_pair.springs = std::span(from.springs).subspan(spring, end - spring);
    while (touching != touching_end && std::pair(touching->a, touching->b) < pair) ++touching;
    if (touching != touching_end && std::pair(touching->a, touching->b) == pair) {
      take(*touching, of_pair);
      continue;
    }
    double energy = 0;
    for (const Spring& s : of_pair.springs) energy += s.energy();
    left_.push_back({old.a, old.b, old.force, energy});
  }
  return true;
}

void PatchTangential::take(const PairInTouch& pair, const Inherited& from) {
  PairMemory& memory = memory_[static_cast<size_t>(pair.slot)];
  memory = {.force = from.old.force, .patches = from.old.patches};
  const bool alone = from.old.patches == 1;
  const bool own_spring = alone && !per_edge_;
  if (own_spring && !from.springs.empty()) {
    const Spring& spring = from.springs[0];
    memory.spring = spring.force;
    memory.stiffness = spring.stiffness;
    memory.push = spring.push;
    memory.tangent = {spring.tangent.x(), spring.tangent.y()};
  }
  const auto append = [](auto& list, const auto& items, int& first, int& count) {
    first = static_cast<int>(list.size());
    count = static_cast<int>(items.size());
    list.insert(list.end(), items.begin(), items.end());
  };
  Place place;
  append(now_.runs, from.runs, place.first_run, place.runs);
  if (!own_spring) append(now_.springs, from.springs, place.first_spring, place.springs);
  if (place.runs + place.springs == 0) return;
  memory.split = static_cast<int>(now_.places.size());
  now_.places.push_back(place);
}

}  // namespace apothem
