// Arrangements of blocks in a space: by random sequential insertion, on a lattice, or dense, by
// growing from small.
#pragma once

#include <vector>

#include "geometry/packing/packing_space.hpp"
#include "geometry/polygon/random_numbers.hpp"

namespace apothem {

/// A block to be placed. Random insertion may put smaller blocks into its holes; the other
/// arrangements put none there.
struct Block {
  std::vector<Vec2> shape;  ///< about its centroid, of area 1 without the holes (block_shapes.hpp)
  double scale = 1;         ///< square root of its area, m
  double angle = 0;         ///< rad
  Rings holes = {};         ///< in the coordinates of the shape
};

/// Where a block has been placed.
struct BlockPose {
  Vec2 place = Vec2::Zero();  ///< of the origin of its shape, m
  double angle = 0;           ///< rad
  double scale = 1;           ///< m
};

/// The holes of a block where it has been placed.
Rings holes_of(const Block& block, const BlockPose& pose);

/// What has been placed, and what could not be.
struct Arrangement {
  std::vector<std::vector<Vec2>> rings;  ///< of the blocks, in their order; empty if not placed
  std::vector<BlockPose> poses;          ///< of the blocks that have been placed
  int placed = 0;
  /// Of the blocks, as far as they have grown: square root of their area over that of full size.
  /// Below 1 only for `grow`.
  double scale = 1;
};

/// Puts one block after the other, the largest first, at a random place where it is free (random
/// sequential insertion). Ends at the first block that finds no place in 20 000 tries.
Arrangement insert_at_random(PackingSpace& space, RandomNumbers& random,
                             const std::vector<Block>& blocks);

/// Puts blocks row by row, from below, into rectangular cells as wide and as high as the widest and
/// the highest block. Cells where a block is not free stay empty.
Arrangement put_on_lattice(PackingSpace& space, const std::vector<Block>& blocks);

/// Inserts the blocks at random while they are small, and lets them grow while they move at random
/// and never overlap (Monte Carlo form of B. D. Lubachevsky and F. H. Stillinger, J. Stat. Phys. 60
/// (1990) 561-583; here each block grows as it finds room). `turns`: blocks may turn as well. Ends
/// at full size, or when 500 sweeps and 60 000 moves have gained less than a thousandth of the
/// missing area.
Arrangement grow(PackingSpace& space, RandomNumbers& random, const std::vector<Block>& blocks,
                 bool turns);

}  // namespace apothem
