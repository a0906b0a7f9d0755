// The candidates of outlines, four side by side, and what an evaluation finds of them.
//
// Candidates ascend by edge and face. They are cut into units, which are worked on one at a time or
// by several threads: no friction spring belongs to two of them. Where they are cut follows from
// the numbers of edges and faces alone. So what is summed over a unit, contact by contact, depends
// neither on the number of threads nor on when candidates were searched for. A unit is a number of
// blocks of four candidates.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/surface/outlines.hpp"
#include "lib/execution/pack.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

/// Candidates of a block. What packs hold is worked on at the same time.
inline constexpr int kBlock = kComparedLanes;

/// Four candidates, or fewer at the end of a unit; the others repeat the last one.
struct EdgeFaceBlock {
  using Vertices = std::array<std::int32_t, kBlock>;
  using Numbers = std::array<double, kBlock>;
  Vertices p, q;  ///< the edge leads from p to q,
  Vertices a, b;  ///< and the base of the face from a to b
  Vertices law;
  Numbers slope;          ///< of the law; 0 in what is repeated
  Numbers nothing;        ///< up to this depth it is no contact, m
  Numbers edge_is_lower;  ///< 1 where the body of the edge has the lower number, else 0
  unsigned lanes;         ///< one bit for each candidate
  bool one_law;           ///< of all lanes
};

/// What friction needs to know of the contacts of a block. `sum`, `first`, `from` and `to` are 0
/// where there is no contact.
struct EdgeFaceTouch {
  using Numbers = EdgeFaceBlock::Numbers;
  Numbers from, to, sum, first, deepest;  ///< as in CollarPiece
  Numbers tx, ty;                         ///< unit tangent of the face
  Numbers edge_length;                    ///< m
  /// The place u of the edge, from 0 at p to 1 at q, has its foot at start + u rise of the base,
  /// and is height + u climb above it; both over the length of the base.
  Numbers start, rise, height, climb;
};

/// The candidates of a unit that have one friction spring.
struct EdgeFaceGroup {
  std::int32_t first, end;  ///< among those of the unit
  std::int32_t law;
  std::int32_t edge, partner;  ///< the spring's key: see ContactKey
};

struct EdgeFaceUnit {
  std::int32_t first, end;  ///< blocks
  std::int32_t first_candidate;
  std::int32_t candidates;
  std::int32_t first_law, end_law;
  std::int32_t first_group, end_group;
  // Found by an evaluation:
  std::int32_t touching = 0;  ///< contacts
  double deepest = 0;         ///< square of a depth that no contact exceeds, m^2
};

class EdgeFaceBlocks {
 public:
  explicit EdgeFaceBlocks(const Outlines& outlines);

  /// `candidates` ascend; their pairs are indices of `laws`.
  void take(std::span<const EdgeFace> candidates, std::span<const EdgeFaceLaw> laws);
  /// Finds the vertices that units of several workers have, if these divide the units.
  void divide(const Threads& threads);

  [[nodiscard]] std::span<EdgeFaceUnit> units() { return units_; }
  [[nodiscard]] std::span<const EdgeFaceUnit> units() const { return units_; }
  [[nodiscard]] std::span<const EdgeFaceBlock> blocks() const { return blocks_; }
  /// True if units of several workers have the vertex, or any vertex of a block.
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
  [[nodiscard]] size_t group_count() const { return groups_.size(); }
  /// Each law belongs to one unit.
  [[nodiscard]] std::span<const EdgeFaceLaw> laws() const { return laws_; }
  [[nodiscard]] int most_blocks() const { return most_blocks_; }  ///< of a unit

  /// Of each block.
  [[nodiscard]] std::span<EdgeFaceTouch> touches() { return touches_; }
  [[nodiscard]] std::span<const EdgeFaceTouch> touches() const { return touches_; }
  /// The lanes that are contacts, one bit for each, and kPushed if any edge meets its face, which
  /// without a depth is no contact.
  static constexpr unsigned kPushed = 1U << kBlock, kContacts = kPushed - 1;
  [[nodiscard]] std::span<std::uint8_t> met() { return met_; }
  [[nodiscard]] std::span<const std::uint8_t> met() const { return met_; }
  /// Normal force of the contacts with each law on that of the two bodies with the lower number, N.
  [[nodiscard]] std::span<Vec2> forces() { return forces_; }
  [[nodiscard]] std::span<const Vec2> forces() const { return forces_; }
  /// Calls f(block, lane) for every contact, of all units or of one, in the order of the
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
  /// The same of one spring.
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

  const Outlines& outlines_;
  std::vector<bool> is_long_;  // edges of rigid bodies that may touch many faces
  std::vector<EdgeFaceUnit> units_;
  std::vector<EdgeFaceBlock> blocks_;
  std::vector<EdgeFaceGroup> groups_;
  std::vector<EdgeFaceLaw> laws_;
  std::vector<EdgeFaceTouch> touches_;
  std::vector<std::uint8_t> met_;
  std::vector<Vec2> forces_;
  static constexpr int kNobody = -1, kSeveral = -2;
  std::vector<int> owners_;                  // workers, of each vertex
  std::vector<std::uint8_t> has_shared_;     // of each block
  std::vector<std::int32_t> number_of_law_;  // of the laws of candidates, in the unit at hand
  int most_blocks_ = 0;
};

}  // namespace apothem
