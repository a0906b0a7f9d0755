// The tangent stiffness K = -dF/dx of all forces, which the terms add up entry by entry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace apothem {

/// Entries of a square matrix. Those of one place are summed in the order in which they have come,
/// so that the sums have the same bits for any number of threads.
class Tangent {
 public:
  struct Entry {
    std::int32_t row, column;
    double value;  ///< N/m, N or N m
  };

  void clear() { entries_.clear(); }
  /// Friction springs at their limit are to add the stiffness that they would have below it: those
  /// of a contact whose slip has come to rest.
  void let_friction_stick() { friction_sticks_ = true; }
  [[nodiscard]] bool friction_sticks() const { return friction_sticks_; }
  void add(size_t row, size_t column, double value) {
    entries_.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(column), value});
  }
  /// Joins the coordinates c and c + 1 of a point to one, c, that moves it along the vector (x, y).
  void put_on_rail(size_t c, double x, double y) {
    const auto first = static_cast<std::int32_t>(c);
    for (Entry& entry : entries_) {
      for (std::int32_t Entry::*const place : {&Entry::row, &Entry::column}) {
        if (entry.*place == first) {
          entry.value *= x;
        } else if (entry.*place == first + 1) {
          entry.value *= y;
          entry.*place = first;
        }
      }
    }
  }

  [[nodiscard]] std::span<const Entry> entries() const { return entries_; }

 private:
  std::vector<Entry> entries_;
  bool friction_sticks_ = false;
};

}  // namespace apothem
