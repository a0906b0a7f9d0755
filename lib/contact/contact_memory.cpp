#include "lib/contact/contact_memory.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/contact/kernel.hpp"

namespace apothem {
namespace {

// Maps the surface, vertex and body numbers of one scene to those of another scene. The result is
// -1 for what belongs to a body that the other scene does not have.
class Renumbering {
 public:
  Renumbering(const ContactNumbers& source, const ContactNumbers& target_scene,
              std::span<const BodyIndex> body_map)
      : source_(source), body_map_(body_map.begin(), body_map.end()) {
    for (size_t i = 0; i < source.bodies.size(); ++i) {
      const ContactNumbers::Body& old = source.bodies[i];
      const ContactNumbers::Body target =
          body_map_[i] >= 0 ? target_scene.bodies.at(static_cast<size_t>(body_map_[i]))
                            : ContactNumbers::Body();
      add(surfaces_, old.first_surface, old.surfaces, target.first_surface, target.surfaces);
      add(vertices_, old.first_vertex, old.vertices, target.first_vertex, target.vertices);
      for (int k = 0; k < old.vertices; ++k) body_of_vertex_.push_back(static_cast<int>(i));
    }
  }

  [[nodiscard]] int surface(int i) const { return lookup(surfaces_, i); }
  [[nodiscard]] int vertex(int i) const { return lookup(vertices_, i); }
  [[nodiscard]] int body(int i) const { return lookup(body_map_, i); }
  [[nodiscard]] bool is_rigid_vertex(int i) const {
    const int body = lookup(body_of_vertex_, i);
    return body >= 0 && source_.bodies[static_cast<size_t>(body)].rigid;
  }
  [[nodiscard]] int edges(int rigid) const {
    return source_.bodies[static_cast<size_t>(rigid)].edges;
  }

 private:
  static void add(std::vector<int>& map, int first, int count, int target_first, int target_count) {
    map.resize(std::max(map.size(), static_cast<size_t>(first) + static_cast<size_t>(count)), -1);
    for (int k = 0; k < count && count == target_count; ++k) {
      map[static_cast<size_t>(first) + static_cast<size_t>(k)] = target_first + k;
    }
  }
  static int lookup(const std::vector<int>& map, int i) {
    return i >= 0 && static_cast<size_t>(i) < map.size() ? map[static_cast<size_t>(i)] : -1;
  }

  const ContactNumbers& source_;
  std::vector<int> body_map_, surfaces_, vertices_, body_of_vertex_;
};

std::optional<ContactKey> renumbered(const ContactKey& old, const Renumbering& numbers) {
  ContactKey key = old;
  if (key.law == outline_kernel) {
    key.b = numbers.is_rigid_vertex(old.a) ? numbers.vertex(old.b) : numbers.body(old.b);
    key.a = numbers.vertex(old.a);
  } else {
    key.a = numbers.surface(old.a);
    key.b = numbers.surface(old.b);
  }
  if (key.a < 0 || key.b < 0) return {};
  return key;
}

// True if the two surfaces of a renumbered key are in the wrong order: the lower number comes
// first, except in keys of an edge and its partner.
bool is_exchanged(const ContactKey& key) { return key.law != outline_kernel && key.a > key.b; }

// The force on the first body of a pair becomes the force on the second one: the tangent is
// reversed, and the signed force along it stays the same.
void exchange(Spring& spring) {
  std::swap(spring.key.a, spring.key.b);
  spring.tangent = -spring.tangent;
  const PairForce& force = spring.on_bodies;
  spring.on_bodies = {-force.x, -force.y, force.b, force.a};
}

void exchange(PatchSegment& segment) {
  std::swap(segment.key.a, segment.key.b);
  segment.place.of_a = !segment.place.of_a;
}

// Returns the records of those pairs whose bodies both exist in the other scene, in the order of
// their new keys. finish(record, old_key) completes a record whose two surfaces were exchanged.
template <class Record>
std::vector<Record> renumbered(std::span<const Record> records, const Renumbering& numbers,
                               const auto& finish) {
  std::vector<Record> result;
  for (Record record : records) {
    const ContactKey old = record.key;
    const std::optional<ContactKey> key = renumbered(old, numbers);
    if (!key) continue;
    record.key = *key;
    if (is_exchanged(*key)) {
      exchange(record);
      finish(record, old);
    }
    result.push_back(record);
  }
  std::ranges::sort(result, {}, &Record::key);
  return result;
}

}  // namespace

FrictionMemory map_memory(const FrictionMemory& memory, const ContactNumbers& source,
                          const ContactNumbers& target, std::span<const BodyIndex> body_map) {
  const Renumbering numbers(source, target, body_map);
  // The law per_edge numbers the edges of an overlap through both bodies, those of the first body
  // first.
  const auto renumber_edge = [&](Spring& spring, const ContactKey& old) {
    if (spring.key.law != polygon_kernel || source.law != FrictionLaw::per_edge) return;
    const int of_a = numbers.edges(old.a), of_b = numbers.edges(old.b);
    spring.key.part = old.part < of_a ? of_b + old.part : old.part - of_a;
  };
  std::vector<Spring> springs = renumbered(memory.springs(), numbers, renumber_edge);
  std::vector<PatchSegment> segments =
      renumbered(memory.segments().now(), numbers, [](const PatchSegment&, const ContactKey&) {});
  if (source.law != target.law) {
    std::erase_if(springs, [](const Spring& s) { return s.key.law == polygon_kernel; });
    segments.clear();
  }
  FrictionMemory result;
  result.restore(std::move(springs), std::move(segments));
  return result;
}

}  // namespace apothem
