// The candidates of outlines in blocks of four, and the results of an evaluation.
//
// Candidates ascend by edge and face. They are divided into units, each of which one thread works
// on; no friction spring belongs to two units. The division depends on the numbers of edges and
// faces alone, so that sums over a unit, taken contact by contact, depend neither on the number of
// threads nor on the time of the last search. A unit consists of blocks of four candidates.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/execution/pack.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

/// Candidates of a block, which packs process at the same time.
inline constexpr int kBlock = kComparedLanes;

/// Four candidates. The last block of a unit may have fewer; its other lanes are padding, which
/// repeats the last candidate.
struct EdgeFaceBlock {
  using Vertices = std::array<std::int32_t, kBlock>;
  using Numbers = std::array<double, kBlock>;
  Vertices p, q;  ///< the edge leads from p to q
  Vertices a, b;  ///< the base of the face leads from a to b
  Vertices law;
  Numbers slope;          ///< slope of the law; 0 in padding
  Numbers nothing;        ///< depth up to which there is no contact, m
  Numbers edge_is_lower;  ///< 1 where the body of the edge has the lower number, else 0
  unsigned lanes;         ///< one bit for each lane with a candidate
  bool one_law;           ///< true if all lanes have the same law
};

/// What friction needs of the contacts of a block. `sum`, `first`, `from` and `to` are 0 where
/// there is no contact.
struct EdgeFaceTouch {
  using Numbers = EdgeFaceBlock::Numbers;
  Numbers from, to, sum, first, deepest;  ///< see CollarPiece
  Numbers tx, ty;                         ///< unit tangent of the face
  Numbers edge_length;                    ///< m
  /// The point of the edge at the fraction u, from 0 at p to 1 at q, has its foot at start + u rise
  /// along the base and the height height + u climb above it, both divided by the length of the
  /// base.
  Numbers start, rise, height, climb;
};

/// The candidates of a unit that share one friction spring.
struct EdgeFaceGroup {
  std::int32_t first, end;  ///< range among the candidates of the unit
  std::int32_t law;
  std::int32_t edge, partner;  ///< the key of the spring, see ContactKey
};

struct EdgeFaceUnit {
  std::int32_t first, end;  ///< range of blocks
  std::int32_t first_candidate;
  std::int32_t candidates;
  std::int32_t first_law, end_law;
  std::int32_t first_group, end_group;
  // Results of an evaluation:
  std::int32_t touching = 0;  ///< number of contacts
  double deepest = 0;         ///< square of an upper bound of all depths, m^2
};

class EdgeFaceBlocks {
 public:
  explicit EdgeFaceBlocks(const OutlineSurfaces& outlines);

  /// Sets the candidates, which ascend. EdgeFace::pair is an index of `laws`.
  void set_candidates(std::span<const EdgeFace> candidates, std::span<const EdgeFaceLaw> laws);
  /// Finds the vertices that belong to units of several threads, if these divide the units.
  void divide(const Threads& threads);

  [[nodiscard]] std::span<EdgeFaceUnit> units() { return units_; }
  [[nodiscard]] std::span<const EdgeFaceUnit> units() const { return units_; }
  [[nodiscard]] std::span<const EdgeFaceBlock> blocks() const { return blocks_; }
  /// True if the vertex, or any vertex of the block, belongs to units of several threads.
  [[nodiscard]] bool is_shared(std::int32_t vertex) const {
    return owners_[static_cast<size_t>(vertex)] == kSeveral;
  }
  [[nodiscard]] bool has_shared(std::int32_t block) const {
    return has_shared_[static_cast<size_t>(block)] != 0;
  }
  [[nodiscard]] std::span<const EdgeFaceGroup> groups(const EdgeFaceUnit& unit) const {
    return std::span(groups_).subspan(static_cast<size_t>(unit.first_group),
                                      static_cast<size_t>(unit.end_group - unit.first_group));
  }
  /// Calls f(unit, group, i) for the groups of all units in their order; i is the index of a group.
  template <class F>
  void each_group(const F& f) const {
    for (const EdgeFaceUnit& unit : units_) {
      for (auto i = static_cast<size_t>(unit.first_group); i < static_cast<size_t>(unit.end_group);
           ++i)
        f(unit, groups_[i], i);
    }
  }
  [[nodiscard]] size_t group_count() const { return groups_.size(); }
  /// Each law belongs to one unit.
  [[nodiscard]] std::span<const EdgeFaceLaw> laws() const { return laws_; }
  /// The largest number of blocks of a unit.
  [[nodiscard]] int most_blocks() const { return most_blocks_; }

  /// One entry for each block.
  [[nodiscard]] std::span<EdgeFaceTouch> touches() { return touches_; }
  [[nodiscard]] std::span<const EdgeFaceTouch> touches() const { return touches_; }
  /// For each block one bit for each lane that is a contact, and kPushed if any edge meets its
  /// face, which is no contact if it has no depth.
  static constexpr unsigned kPushed = 1U << kBlock, kContacts = kPushed - 1;
  [[nodiscard]] std::span<std::uint8_t> met() { return met_; }
  [[nodiscard]] std::span<const std::uint8_t> met() const { return met_; }
  /// For each law, the normal force of its contacts on the body with the lower number, N.
  [[nodiscard]] std::span<Vec2> forces() { return forces_; }
  [[nodiscard]] std::span<const Vec2> forces() const { return forces_; }
  /// Calls f(block, lane) for every contact of all units, or of one unit, in the order of the
  /// candidates.
  template <class F>
  void each_contact(const F& f) const {
    for (const EdgeFaceUnit& unit : units_) each_contact(unit, f);
  }
  template <class F>
  void each_contact(const EdgeFaceUnit& unit, const F& f) const {
    for (auto i = static_cast<size_t>(unit.first); i < static_cast<size_t>(unit.end); ++i) {
      for (unsigned m = met_[i] & kContacts; m != 0; m &= m - 1)
        f(i, static_cast<size_t>(std::countr_zero(m)));
    }
  }
  /// Calls f(block, lane) for every contact of one spring.
  template <class F>
  void each_contact(const EdgeFaceUnit& unit, const EdgeFaceGroup& group, const F& f) const {
    for (std::int32_t c = group.first; c < group.end; ++c) {
      const auto block = static_cast<size_t>(unit.first + c / kBlock);
      const auto lane = static_cast<size_t>(c % kBlock);
      if ((met_[block] >> lane & 1U) != 0) f(block, lane);
    }
  }

 private:
  struct Key {
    std::int32_t edge, partner;
    bool operator==(const Key&) const = default;
  };
  [[nodiscard]] Key key_of(const EdgeFace& candidate) const;
  [[nodiscard]] Key unit_of(const EdgeFace& candidate) const;
  void add_unit(std::span<const EdgeFace> candidates, std::int32_t first,
                std::span<const EdgeFaceLaw> laws);

  const OutlineSurfaces& outlines_;
  std::vector<bool> is_long_;  // whether each edge belongs to a rigid body and may touch many faces
  std::vector<EdgeFaceUnit> units_;
  std::vector<EdgeFaceBlock> blocks_;
  std::vector<EdgeFaceGroup> groups_;
  std::vector<EdgeFaceLaw> laws_;
  std::vector<EdgeFaceTouch> touches_;
  std::vector<std::uint8_t> met_;
  std::vector<Vec2> forces_;
  static constexpr int kNobody = -1, kSeveral = -2;
  std::vector<int> owners_;               // thread that each vertex belongs to
  std::vector<std::uint8_t> has_shared_;  // whether each block has a shared vertex
  // Index in laws_ of each given law, in the present unit.
  std::vector<std::int32_t> number_of_law_;
  int most_blocks_ = 0;
};

}  // namespace apothem
