#include "lib/contact/mesh/edge_face_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr int kUnitEdges = 48;  // edges of a unit
constexpr int kUnitFaces = 64;  // faces of a unit with one long edge
constexpr double kLong = 32;    // an edge is long above this multiple of the smallest r of a mesh
constexpr double kNothing = 1e-12;  // round-off of a depth where an edge begins on a face, relative
                                    // to the depth of the collar

}  // namespace

EdgeFaceBlocks::EdgeFaceBlocks(const OutlineSurfaces& outlines)
    : outlines_(outlines), is_long_(static_cast<size_t>(outlines.size())) {
  double smallest = HUGE_VAL;
  for (const OutlineSurfaces::Body& body : outlines.bodies) {
    if (!body.is_rigid()) smallest = std::min(smallest, body.reference);
  }
  for (const OutlineSurfaces::Body& body : outlines.bodies) {
    for (int i = body.first; body.is_rigid() && i < body.end; ++i) {
      is_long_[static_cast<size_t>(i)] = outlines.given_length(i) > kLong * smallest;
    }
  }
}

EdgeFaceBlocks::Key EdgeFaceBlocks::unit_of(const EdgeFace& c) const {
  if (is_long_[static_cast<size_t>(c.edge)]) return {c.edge, c.face / kUnitFaces};
  return {-1 - c.edge / kUnitEdges, 0};
}

// The key of the spring that a contact belongs to. An edge of a mesh has one spring for each body
// that it touches. An edge of a rigid body may be long and has one spring for each face, which
// moves with the face.
EdgeFaceBlocks::Key EdgeFaceBlocks::key_of(const EdgeFace& c) const {
  const OutlineSurfaces& o = outlines_;
  return {c.edge, o.bodies[o.body[c.edge]].is_rigid() ? c.face : o.body[c.face]};
}

void EdgeFaceBlocks::set_candidates(std::span<const EdgeFace> candidates,
                                    std::span<const EdgeFaceLaw> laws) {
  units_.clear(), blocks_.clear(), groups_.clear(), laws_.clear();
  most_blocks_ = 0;
  number_of_law_.assign(laws.size(), -1);
  for (size_t first = 0; first < candidates.size();) {
    size_t end = first + 1;
    while (end < candidates.size() && unit_of(candidates[end]) == unit_of(candidates[first])) ++end;
    add_unit(candidates.subspan(first, end - first), static_cast<std::int32_t>(first), laws);
    first = end;
  }
  touches_.resize(blocks_.size());
  met_.assign(blocks_.size(), 0);
  forces_.assign(laws_.size(), Vec2::Zero());
}

void EdgeFaceBlocks::divide(const Threads& threads) {
  owners_.assign(static_cast<size_t>(outlines_.size()), kNobody);
  has_shared_.assign(blocks_.size(), 0);
  if (threads.count() == 1) return;
  const auto vertices = [](const EdgeFaceBlock& block) {
    return std::array{&block.p, &block.q, &block.a, &block.b};
  };
  const auto units = static_cast<int>(units_.size());
  for (int worker = 0; worker < threads.count(); ++worker) {
    for (int u = threads.first_of(units, worker); u < threads.first_of(units, worker + 1); ++u) {
      for (std::int32_t i = units_[u].first; i < units_[u].end; ++i) {
        for (const EdgeFaceBlock::Vertices* list : vertices(blocks_[i])) {
          for (const std::int32_t v : *list) {
            int& owner = owners_[static_cast<size_t>(v)];
            owner = owner == kNobody || owner == worker ? worker : kSeveral;
          }
        }
      }
    }
  }
  for (size_t i = 0; i < blocks_.size(); ++i) {
    for (const EdgeFaceBlock::Vertices* list : vertices(blocks_[i])) {
      if (std::ranges::any_of(*list, [&](std::int32_t v) { return is_shared(v); }))
        has_shared_[i] = 1;
    }
  }
}

void EdgeFaceBlocks::add_unit(std::span<const EdgeFace> candidates, std::int32_t first,
                              std::span<const EdgeFaceLaw> laws) {
  const OutlineSurfaces& o = outlines_;
  const auto size = [](const auto& list) { return static_cast<std::int32_t>(list.size()); };
  EdgeFaceUnit unit{};
  unit.first = size(blocks_), unit.first_law = size(laws_), unit.first_group = size(groups_);
  unit.first_candidate = first, unit.candidates = size(candidates);
  for (size_t i = 0; i < candidates.size(); i += kBlock) {
    EdgeFaceBlock& block = blocks_.emplace_back();
    block.lanes = 0;
    block.one_law = true;
    for (size_t l = 0; l < kBlock; ++l) {
      const EdgeFace& c = candidates[std::min(i + l, candidates.size() - 1)];
      const EdgeFaceLaw& law = laws[static_cast<size_t>(c.pair)];
      std::int32_t& number = number_of_law_[static_cast<size_t>(c.pair)];
      if (number < unit.first_law) {
        number = size(laws_);
        laws_.push_back(law);
      }
      const bool repeated = i + l >= candidates.size();
      block.p[l] = c.edge, block.q[l] = o.next[c.edge];
      block.a[l] = c.face, block.b[l] = o.next[c.face];
      block.law[l] = number;
      block.one_law = block.one_law && number == block.law[0];
      block.slope[l] = repeated ? 0 : law.slope;
      block.nothing[l] = repeated ? HUGE_VAL : law.self ? kNothing * o.depth[c.face] : 0;
      block.edge_is_lower[l] = o.body[c.edge] < o.body[c.face];
      if (repeated) continue;
      block.lanes |= 1U << l;
      const Key key = key_of(c);
      const auto lane = static_cast<std::int32_t>(i + l);
      if (size(groups_) > unit.first_group &&
          Key{groups_.back().edge, groups_.back().partner} == key) {
        groups_.back().end = lane + 1;
      } else {
        groups_.push_back({lane, lane + 1, number, key.edge, key.partner});
      }
    }
  }
  unit.end = size(blocks_), unit.end_law = size(laws_), unit.end_group = size(groups_);
  most_blocks_ = std::max(most_blocks_, unit.end - unit.first);
  units_.push_back(unit);
}

}  // namespace apothem
