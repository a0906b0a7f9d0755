// The minimum of functions of one variable, each of which is given on an interval, as a sorted list
// of pieces. Two functions may cross at most twice.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace apothem {

/// The minimum of functions on an interval. A `Function` f has three members:
/// - int crossings(g, from, roots) const writes up to two candidates for solutions of f = g, in any
///   order, and returns their number. They are best computed relative to `from`. Candidates outside
///   the interval in question, and NaN, are ignored.
/// - bool below(g, a, b) const is true if f is below g between a and b, where they do not cross.
///   Mean values must decide, of f and g or of increasing functions of them. f and g may touch at
///   a single point, and there round-off would decide.
/// - bool operator== is true for the same function.
/// So a root that round-off moves, adds or loses changes the minimum by no more than round-off.
template <class Real, class Function>
class PiecewiseMinimum {
 public:
  /// A part of the interval on which one function is the minimum.
  struct Piece {
    Real from;          ///< start of the piece; it ends where the next one starts
    bool known;         ///< false where no function was given
    Function function;  ///< the lowest function, if `known`
  };

  /// Starts again with no function on the interval from `from` to `to`.
  void reset(const Real& from, const Real& to) {
    pieces_.clear();
    pieces_.push_back({from, false, {}});
    end_ = to;
  }

  /// Adds the function f on the interval from `from` to `to`. Returns true if f is the lowest
  /// somewhere. Only pieces that its interval meets are looked at. Nothing is allocated once the
  /// buffers are large enough.
  bool insert(const Function& f, const Real& from, const Real& to) {
    next_.clear();
    bool changed = false;
    const size_t first = at(from);
    size_t last = first;
    for (; last < pieces_.size() && (last == first || pieces_[last].from < to); ++last) {
      const Piece& piece = pieces_[last];
      const Real& stop = end(last);
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
    if (changed) replace(first, last);
    return changed;
  }

  /// Number of pieces.
  [[nodiscard]] size_t size() const { return pieces_.size(); }
  /// The number of the piece that a point of the interval is in; of the first one before it.
  [[nodiscard]] size_t at(const Real& s) const {
    const auto starts_behind = [](const Real& place, const Piece& piece) {
      return place < piece.from;
    };
    const auto behind = std::upper_bound(pieces_.begin(), pieces_.end(), s, starts_behind);
    return static_cast<size_t>(behind - pieces_.begin()) - (behind != pieces_.begin());
  }
  /// Piece i, counted along the interval.
  [[nodiscard]] const Piece& operator[](size_t i) const { return pieces_[i]; }
  /// The end of piece i.
  [[nodiscard]] const Real& end(size_t i) const {
    return i + 1 < pieces_.size() ? pieces_[i + 1].from : end_;
  }

 private:
  // Puts next_ in the place of the pieces first to last - 1.
  void replace(size_t first, size_t last) {
    const size_t both = std::min(last - first, next_.size());
    const auto at = [](auto& list, size_t i) {
      return list.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::copy(next_.begin(), at(next_, both), at(pieces_, first));
    pieces_.erase(at(pieces_, first + both), at(pieces_, last));
    pieces_.insert(at(pieces_, first + both), at(next_, both), next_.end());
  }

  // Appends the minimum of f and of the function of `piece` between a and b. Returns true if f is
  // lower somewhere.
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
      if (f.below(piece.function, start, stop)) {
        next_.push_back({start, true, f});
        changed = true;
      } else {
        keep(start, piece);
      }
      start = stop;
    }
    return changed;
  }

  // Appends the function of `piece` from `from` on, unless the last piece has it already.
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
