// The far end of a cell of a distance field, while the features that bound it are being found. Each
// point of the cell is the centre of a circle that touches the cell's own feature. Another feature
// bounds the cell only if it reaches into one of these circles.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/integrals/distance_outline.hpp"
#include "geometry/potential/piecewise_minimum.hpp"
#include "geometry/potential/quadratic.hpp"
#include "geometry/spatial/touching_circles.hpp"

namespace apothem {

/// The distances from a cell's own feature at which a box may be; an edge has those behind it,
/// too. There are none if the least one is more than the largest one.
struct CellRange {
  double least = -HUGE_VAL, most = HUGE_VAL;
};

/// The lower envelope of the functions of the features that bound a cell, one piece for each.
template <class Real>
class CellCeiling : public PiecewiseMinimum<Real, Quadratic<Real>> {
  using Minimum = PiecewiseMinimum<Real, Quadratic<Real>>;

 public:
  using Minimum::at, Minimum::end, Minimum::size;

  /// More than one by far more than round-off.
  static constexpr double kSure = 1 + 1e-9;

  /// A part of a cell with more pieces than this is to be divided.
  static constexpr size_t kMostPieces = 24;

  /// Begins with the cells of a polygon; `slack` is what round-off does to its positions, m.
  void begin(double slack) {
    slack_ = slack;
    empty_.radius = -HUGE_VAL;
  }
  /// Begins with the cell, or a part of one, between two places.
  void reset(const Real& from, const Real& to) {
    Minimum::reset(from, to);
    highest_ = std::numeric_limits<Real>::infinity();
  }
  /// The start of the piece in the middle of all.
  [[nodiscard]] const Real& middle() const { return (*this)[size() / 2].from; }

  /// What find() has found.
  enum class Found { all, too_many, nothing };
  /// Calls add(j) for the features that may lie below the ceiling of the present part of a cell.
  /// add(j) says whether it has changed the ceiling. circle(k, s) is the circle that touches the
  /// cell's own feature and that of piece k of the ceiling, at the place s, and radius(box) at most
  /// that of any such circle that reaches into a box: the smallest circles come first. Stops when
  /// the ceiling has too many pieces, and when nothing that counts is below it any more, which
  /// counts() says.
  template <class Radius, class Add, class Circle, class Counts>
  Found find(DistanceOutline<Real>& outline, const Radius& radius, const Add& add,
             const Circle& circle, const Counts& counts) {
    Found found = counts() ? Found::all : Found::nothing;
    bool changed = true;
    int changes = 0, next_look = 1;
    const auto meets = [&](const Box& box, const Slab& slab, double least) {
      if (size() > kMostPieces) found = Found::too_many;
      if (changes >= next_look) {
        next_look = 2 * changes;
        if (!counts()) found = Found::nothing;
      }
      if (found != Found::all || least > kSure * static_cast<double>(highest_) + slack_) {
        return false;
      }
      if (changed) draw_circles(circle), changed = false;
      return std::ranges::any_of(circles_, [&](const auto& part) { return part.meets(box, slab); });
    };
    outline.each_in_order(radius, meets, [&](int j, const Box& box, const Slab& slab) {
      if (meets(box, slab, 0) && add(j)) changed = true, ++changes;
    });
    if (found == Found::all && !counts()) found = Found::nothing;
    if (found == Found::all) remember_circle(outline, circle);
    return found;
  }

  /// Adds a function to the ceiling, unless its distances, which are at least `least`, are above
  /// it. Returns whether it has changed the ceiling.
  template <class Height>
  bool add(const Quadratic<Real>& f, const Real& from, const Real& to, const Real& least,
           const Height& height) {
    if (least > kSure * highest_ || !Minimum::insert(f, from, to)) return false;
    lower_highest(height);
    return true;
  }

  /// Whether the ceiling lies below a box from s0 to s1, whose piece k is height(k, s) away at s.
  /// That is largest at the ends of a piece, and of a part of it. The box may be at the distances
  /// `all` there, and at range(a, b) from a to b.
  template <class Height, class RangeIn>
  [[nodiscard]] bool lies_below(const Real& s0, const Real& s1, const CellRange& all,
                                const Height& height, const RangeIn& range) const {
    for (size_t k = at(s0); k < size() && !((*this)[k].from > s1); ++k) {
      if (!(*this)[k].known) return false;
      const Real a = std::max(s0, (*this)[k].from), b = std::min(s1, end(k));
      const double high =
          kSure * static_cast<double>(std::max(Real(height(k, a)), Real(height(k, b)))) + slack_;
      if (all.least > high) continue;
      const CellRange here = range(a, b);
      if (!(here.least > std::min(high, here.most))) return false;
    }
    return true;
  }

 private:
  // The circles of the pieces of the ceiling. In a round polygon most cells have one in its middle
  // that touches all features, up to round-off. It is seen to be empty once.
  template <class Circle>
  void draw_circles(const Circle& circle) {
    circles_.clear();
    const auto draw = [&](size_t k, const Real& s) {
      TouchingCircle drawn = circle(k, s);
      drawn.empty = empty_.holds(drawn, slack_);
      return drawn;
    };
    for (size_t k = 0; k < size(); ++k) {
      circles_.emplace_back(draw(k, (*this)[k].from), draw(k, end(k)), slack_);
    }
  }
  // Remembers a circle of a ceiling that is known, if it is larger than the one before. Between the
  // functions of two features round-off may leave a gap in which nothing has been found, so that
  // it has to be seen that the circle is empty.
  template <class Circle>
  void remember_circle(DistanceOutline<Real>& outline, const Circle& circle) {
    for (size_t k = 1; k < size(); ++k) {
      const TouchingCircle drawn = circle(k, (*this)[k].from);
      if (drawn.radius > empty_.radius + slack_ &&
          outline.distance(drawn.centre) >= drawn.radius - slack_) {
        empty_ = drawn;
      }
    }
  }

  // Lowers highest_ to the largest distance of the ceiling.
  template <class Height>
  void lower_highest(const Height& height) {
    Real highest = 0;
    for (size_t k = 0; k < size(); ++k) {
      if (!(*this)[k].known) return;
      highest = std::max(highest, Real(height(k)));
    }
    highest_ = std::min(highest_, highest);
  }

  double slack_ = 0;                      // round-off of positions in boxes, m
  Real highest_{};                        // no more than this is the ceiling's distance
  std::vector<TouchingCircles> circles_;  // of the pieces of the ceiling
  TouchingCircle empty_;                  // the largest circle that is known to be empty
};

}  // namespace apothem
