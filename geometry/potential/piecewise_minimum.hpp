// Minimum of functions of one variable, each given on an interval, as a sorted list of pieces. Two
// functions may cross twice at most.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace apothem {

/// `Function` has three members:
///   int crossings(g, from, roots) const: candidates for f = g in any order, best computed relative
///     to `from`; those outside the interval asked for (NaN too) are ignored;
///   bool below(g, s) const: f(s) < g(s);
///   bool operator==.
/// Which of two functions is the lower one between two candidates is decided in the middle: a root
/// that round-off moves, adds or loses changes the minimum by no more than round-off.
template <class Real, class Function>
class PiecewiseMinimum {
 public:
  struct Piece {
    Real from;
    bool known;  ///< false where no function was given
    Function function;
  };

  void reset(const Real& from, const Real& to) {
    pieces_.clear();
    pieces_.push_back({from, false, {}});
    end_ = to;
  }

  /// True if f is the lowest somewhere. No allocation once the buffers have grown.
  bool insert(const Function& f, const Real& from, const Real& to) {
    next_.clear();
    bool changed = false;
    for (size_t i = 0; i < pieces_.size(); ++i) {
      const Piece& piece = pieces_[i];
      const Real& stop = end(i);
      const Real a = std::max(piece.from, from);
      const Real b = std::min(stop, to);
      if (!(a < b)) {
        keep(piece.from, piece);
        continue;
      }
      if (piece.from < a) keep(piece.from, piece);
      changed |= merge(f, piece, a, b);
      if (b < stop) keep(b, piece);
    }
    if (changed) std::swap(pieces_, next_);
    return changed;
  }

  [[nodiscard]] size_t size() const { return pieces_.size(); }
  [[nodiscard]] const Piece& operator[](size_t i) const { return pieces_[i]; }
  [[nodiscard]] const Real& end(size_t i) const {
    return i + 1 < pieces_.size() ? pieces_[i + 1].from : end_;
  }

 private:
  bool merge(const Function& f, const Piece& piece, const Real& a, const Real& b) {
    if (!piece.known) {
      next_.push_back({a, true, f});
      return true;
    }
    std::array<Real, 2> roots;
    int count = f.crossings(piece.function, a, roots);
    if (count == 2 && !(roots[0] > a && roots[0] < b)) roots[0] = roots[--count];
    if (count == 2 && !(roots[1] > a && roots[1] < b)) --count;
    if (count == 1 && !(roots[0] > a && roots[0] < b)) --count;
    if (count == 2 && roots[1] < roots[0]) std::swap(roots[0], roots[1]);
    bool changed = false;
    Real start = a;
    for (int k = 0; k <= count; ++k) {
      const Real& stop = k < count ? roots[k] : b;
      if (!(start < stop)) continue;
      if (f.below(piece.function, (start + stop) / 2)) {
        next_.push_back({start, true, f});
        changed = true;
      } else {
        keep(start, piece);
      }
      start = stop;
    }
    return changed;
  }

  // The function of `piece` from `from` on, unless it is there already.
  void keep(const Real& from, const Piece& piece) {
    if (from > piece.from && !next_.empty() && piece.known && next_.back().known &&
        next_.back().function == piece.function) {
      return;
    }
    next_.push_back({from, piece.known, piece.function});
  }

  std::vector<Piece> pieces_, next_;
  Real end_{};
};

}  // namespace apothem
