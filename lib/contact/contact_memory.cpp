#include "lib/contact/contact_memory.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "lib/contact/kernel.hpp"

namespace apothem {
namespace {

using History = PatchTangential::History;
using PairHistory = PatchTangential::PairHistory;

// The numbers in another scene of what belongs to bodies: -1 where there is no heir.
class Renumbering {
 public:
  Renumbering(const ContactNumbers& from, const ContactNumbers& to,
              std::span<const BodyIndex> heirs)
      : from_(from), heirs_(heirs.begin(), heirs.end()) {
    for (size_t i = 0; i < from.bodies.size(); ++i) {
      const ContactNumbers::Body& old = from.bodies[i];
      const ContactNumbers::Body heir =
          heirs_[i] >= 0 ? to.bodies.at(static_cast<size_t>(heirs_[i])) : ContactNumbers::Body();
      add(surfaces_, old.first_surface, old.surfaces, heir.first_surface, heir.surfaces);
      add(vertices_, old.first_vertex, old.vertices, heir.first_vertex, heir.vertices);
      for (int k = 0; k < old.vertices; ++k) body_of_vertex_.push_back(static_cast<int>(i));
    }
  }

  [[nodiscard]] int surface(int i) const { return at(surfaces_, i); }
  [[nodiscard]] int vertex(int i) const { return at(vertices_, i); }
  [[nodiscard]] int body(int i) const { return at(heirs_, i); }
  [[nodiscard]] bool is_rigid_vertex(int i) const {
    const int body = at(body_of_vertex_, i);
    return body >= 0 && from_.bodies[static_cast<size_t>(body)].rigid;
  }
  [[nodiscard]] int edges(int rigid) const {
    return from_.bodies[static_cast<size_t>(rigid)].edges;
  }

 private:
  static void add(std::vector<int>& map, int first, int count, int heir_first, int heir_count) {
    map.resize(std::max(map.size(), static_cast<size_t>(first) + static_cast<size_t>(count)), -1);
    for (int k = 0; k < count && count == heir_count; ++k) {
      map[static_cast<size_t>(first) + static_cast<size_t>(k)] = heir_first + k;
    }
  }
  static int at(const std::vector<int>& map, int i) {
    return i >= 0 && static_cast<size_t>(i) < map.size() ? map[static_cast<size_t>(i)] : -1;
  }

  const ContactNumbers& from_;
  std::vector<int> heirs_, surfaces_, vertices_, body_of_vertex_;
};

// The force on the first body of a pair becomes that on the second one: the tangent turns round,
// and the number along it stays.
void exchange(Spring& spring, bool per_edge, int edges_a, int edges_b) {
  std::swap(spring.key.a, spring.key.b);
  spring.tangent = -spring.tangent;
  if (!per_edge) return;
  const int part = spring.key.part;
  spring.key.part = part < edges_a ? edges_b + part : part - edges_a;
}

std::optional<Spring> renumbered(Spring spring, const Renumbering& to, FrictionLaw law) {
  SpringKey& key = spring.key;
  const SpringKey old = key;
  if (key.law == outline_kernel) {
    key.b = to.is_rigid_vertex(old.a) ? to.vertex(old.b) : to.body(old.b);
    key.a = to.vertex(old.a);
  } else {
    key.a = to.surface(old.a);
    key.b = to.surface(old.b);
  }
  if (key.a < 0 || key.b < 0) return {};
  if (key.law != outline_kernel && key.a > key.b) {
    const bool per_edge = key.law == polygon_kernel && law == FrictionLaw::per_edge;
    exchange(spring, per_edge, per_edge ? to.edges(old.a) : 0, per_edge ? to.edges(old.b) : 0);
  }
  return spring;
}

// The patches of one pair with all that belongs to them.
struct Pair {
  PairHistory pair;
  std::vector<RunPlace> runs;
};

std::vector<Pair> renumbered(const History& history, const Renumbering& to) {
  std::vector<Pair> pairs;
  size_t run = 0;
  for (const PairHistory& old : history.pairs) {
    Pair pair{old, {}};
    for (int k = 0; k < old.runs; ++k) pair.runs.push_back(history.runs.at(run++));
    pair.pair.a = to.surface(old.a);
    pair.pair.b = to.surface(old.b);
    if (pair.pair.a < 0 || pair.pair.b < 0) continue;
    if (pair.pair.a > pair.pair.b) {
      std::swap(pair.pair.a, pair.pair.b);
      for (RunPlace& r : pair.runs) r.of_a = !r.of_a;
    }
    pairs.push_back(std::move(pair));
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) {
    return std::tie(p.pair.a, p.pair.b) < std::tie(q.pair.a, q.pair.b);
  });
  return pairs;
}

}  // namespace

ContactMemory hand_over(const ContactMemory& memory, const ContactNumbers& from,
                        const ContactNumbers& to, std::span<const BodyIndex> heirs) {
  const Renumbering numbers(from, to, heirs);
  const auto heirs_of = [&](std::span<const Spring> springs) {
    std::vector<Spring> result;
    for (const Spring& spring : springs) {
      if (auto heir = renumbered(spring, numbers, from.law)) result.push_back(*heir);
    }
    std::ranges::sort(result, {}, &Spring::key);
    return result;
  };
  ContactMemory result;
  result.friction.inherit(heirs_of(memory.friction.springs()));
  if (from.law != to.law) return result;
  result.patches.springs = heirs_of(memory.patches.springs);
  for (Pair& pair : renumbered(memory.patches, numbers)) {
    result.patches.pairs.push_back(pair.pair);
    result.patches.runs.insert(result.patches.runs.end(), pair.runs.begin(), pair.runs.end());
  }
  return result;
}

}  // namespace apothem
