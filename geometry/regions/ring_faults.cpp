#include "geometry/regions/ring_faults.hpp"

#include <array>
#include <charconv>
#include <set>
#include <tuple>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/spatial/boxes.hpp"

namespace apothem {
namespace {

using Kind = RingFault::Kind;

struct NumberedVertex {
  Vec2 place;
  int index;  // in the ring as it was given
};
using NumberedRing = std::vector<NumberedVertex>;

// True if the way from a over b to c turns back on itself at b.
bool turns_back(const Vec2& a, const Vec2& b, const Vec2& c) {
  if (orientation(a, b, c) != 0) return false;
  const int axis = a.x() != b.x() ? 0 : 1;
  return (a[axis] < b[axis]) != (b[axis] < c[axis]);
}

// Finds the faults of a list of rings.
class Search {
 public:
  explicit Search(const Rings& rings) : rings_(rings) {}

  std::vector<RingFault> faults() {
    for (size_t r = 0; r < rings_.size(); ++r) clean(static_cast<int>(r));
    find_meetings();
    find_misplaced_holes();
    return std::move(faults_);
  }

 private:
  struct Edge {
    int ring, place;  // its place in the cleaned ring
  };

  void add(Kind kind, int ring, int index, const Vec2& place, int other_ring = 0, int other = 0) {
    faults_.push_back({kind, ring, index, other_ring, other, place});
  }

  // Leaves out vertices that repeat the one before, and spikes, until there are none.
  void clean(int ring) {
    NumberedRing left;
    const auto tidy_end = [&] {
      while (left.size() > 1) {
        const size_t n = left.size();
        if (left[n - 1].place == left[n - 2].place) {
          add(Kind::repeated_vertex, ring, left[n - 1].index, left[n - 1].place);
          left.pop_back();
        } else if (n > 2 && turns_back(left[n - 3].place, left[n - 2].place, left[n - 1].place)) {
          add(Kind::spike, ring, left[n - 2].index, left[n - 2].place);
          left.erase(left.end() - 2);
        } else {
          return;
        }
      }
    };
    const std::vector<Vec2>& given = rings_[static_cast<size_t>(ring)];
    for (size_t i = 0; i < given.size(); ++i) {
      left.push_back({given[i], static_cast<int>(i)});
      tidy_end();
    }
    while (tidy_start(ring, left)) {
    }
    if (left.size() < 3) {
      add(Kind::no_area, ring, 0, given.empty() ? Vec2(0, 0) : given[0]);
      left.clear();
    }
    cleaned_.push_back(std::move(left));
  }

  // The same where the end of the ring meets its start.
  bool tidy_start(int ring, NumberedRing& left) {
    const size_t n = left.size();
    if (n < 2) return false;
    if (left.back().place == left.front().place) {
      // The closing vertex, which formats ask for, is no fault; vertices before it are.
      const bool closing =
          left.back().index + 1 == static_cast<int>(rings_[static_cast<size_t>(ring)].size());
      if (!closing) add(Kind::repeated_vertex, ring, left.back().index, left.back().place);
      left.pop_back();
      return true;
    }
    for (const size_t i : {size_t{0}, n - 1}) {
      if (n < 3 || !turns_back(before(left, i).place, left[i].place, after(left, i).place))
        continue;
      add(Kind::spike, ring, left[i].index, left[i].place);
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
      return true;
    }
    return false;
  }

  [[nodiscard]] const NumberedVertex& start(const Edge& e) const {
    return cleaned_[e.ring][e.place];
  }
  [[nodiscard]] const NumberedVertex& end(const Edge& e) const {
    return after(cleaned_[e.ring], static_cast<size_t>(e.place));
  }
  [[nodiscard]] bool are_neighbours(const Edge& a, const Edge& b) const {
    const int n = static_cast<int>(cleaned_[a.ring].size());
    return a.ring == b.ring && (next(a.place, n) == b.place || next(b.place, n) == a.place);
  }

  void find_meetings() {
    std::vector<Edge> edges;
    std::vector<Box> boxes;
    for (size_t r = 0; r < cleaned_.size(); ++r) {
      for (size_t i = 0; i < cleaned_[r].size(); ++i) {
        edges.push_back({static_cast<int>(r), static_cast<int>(i)});
        boxes.push_back(box_of(start(edges.back()).place, end(edges.back()).place));
      }
    }
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    for (const BoxPair& pair : pairs) {
      const Edge &a = edges[pair.first], &b = edges[pair.second];
      if (!are_neighbours(a, b)) classify(a, b);
    }
  }

  // The way in which two edges meet, if they do.
  void classify(const Edge& a, const Edge& b) {
    const Vec2 &p = start(a).place, &q = end(a).place, &r = start(b).place, &s = end(b).place;
    if (!segments_meet(p, q, r, s)) return;
    const bool in_line = orientation(p, q, r) == 0 && orientation(p, q, s) == 0;
    if (in_line && common_length(p, q, r, s)) {
      add(Kind::common_part, a.ring, start(a).index, r, b.ring, start(b).index);
      return;
    }
    bool touches = false;
    for (const NumberedVertex* v : {&start(a), &end(a)}) {
      for (const NumberedVertex* w : {&start(b), &end(b)}) {
        if (v->place != w->place) continue;
        touches = true;
        if (a.ring == b.ring) add_touch(a.ring, v->index, w->index, v->place);
      }
    }
    if (touches) return;
    for (const auto& [one, other] : {std::pair(a, b), std::pair(b, a)}) {
      for (const NumberedVertex* v : {&start(one), &end(one)}) {
        if (!segments_meet(start(other).place, end(other).place, v->place, v->place)) continue;
        touches = true;
        if (a.ring == b.ring) add_touched_edge(one.ring, v->index, start(other).index, v->place);
      }
    }
    if (touches) return;
    const double share = cross(Vec2(r - p), Vec2(s - r)) / cross(Vec2(q - p), Vec2(s - r));
    add(Kind::crossing, a.ring, start(a).index, p + share * (q - p), b.ring, start(b).index);
  }

  static bool common_length(const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
    const int axis = p.x() != q.x() ? 0 : 1;
    return std::max(std::min(p[axis], q[axis]), std::min(r[axis], s[axis])) <
           std::min(std::max(p[axis], q[axis]), std::max(r[axis], s[axis]));
  }

  // Up to four pairs of edges meet at such a vertex.
  void add_touch(int ring, int v, int w, const Vec2& place) {
    if (!said_.insert({ring, std::max(v, w), std::min(v, w)}).second) return;
    add(Kind::touch, ring, std::max(v, w), place, ring, std::min(v, w));
  }
  void add_touched_edge(int ring, int vertex, int edge, const Vec2& place) {
    if (!said_.insert({-1 - ring, vertex, edge}).second) return;
    add(Kind::touched_edge, ring, vertex, place, ring, edge);
  }

  void find_misplaced_holes() {
    const auto side = [&](size_t of, const Vec2& point) {
      std::vector<Vec2> ring;
      for (const NumberedVertex& v : cleaned_[of]) ring.push_back(v.place);
      return side_of_ring(ring, point);
    };
    for (size_t h = 1; h < cleaned_.size(); ++h) {
      if (cleaned_[h].empty()) continue;
      // A vertex may lie on the other ring. One that does not decides.
      for (size_t other = 0; other < cleaned_.size(); ++other) {
        if (other == h || cleaned_[other].empty()) continue;
        int where = 0;
        for (const NumberedVertex& v : cleaned_[h]) {
          where = side(other, v.place);
          if (where != 0) break;
        }
        const int ring = static_cast<int>(h);
        const Vec2& place = cleaned_[h][0].place;
        if (other == 0 && where < 0) add(Kind::outside, ring, 0, place);
        if (other > 0 && where > 0) add(Kind::nested, ring, 0, place, static_cast<int>(other));
      }
    }
  }

  const Rings& rings_;
  std::vector<NumberedRing> cleaned_;
  std::set<std::array<int, 3>> said_;
  std::vector<RingFault> faults_;
};

// The shortest digits that bring back the same double.
std::string digits(double number) {
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  return {text.data(), end};
}

}  // namespace

std::string describe(const RingFault& fault) {
  const auto number = [](int i) { return std::to_string(i); };
  const std::string of_hole = fault.ring > 0 ? " of hole " + number(fault.ring) : "";
  const std::string of_other = fault.other_ring > 0 ? " of hole " + number(fault.other_ring) : "";
  const std::string vertex = "vertex " + number(fault.index) + of_hole;
  const std::string edges =
      "edge " + number(fault.index) + of_hole + " and edge " + number(fault.other) + of_other;
  const std::string at = " at (" + digits(fault.place.x()) + ", " + digits(fault.place.y()) + ") m";
  switch (fault.kind) {
    case Kind::repeated_vertex:
      return vertex + " repeats the one before" + at;
    case Kind::spike:
      return vertex + " is a spike" + at;
    case Kind::touch:
      return vertex + " touches vertex " + number(fault.other) + of_other + at;
    case Kind::touched_edge:
      return vertex + " touches edge " + number(fault.other) + of_other + at;
    case Kind::crossing:
      return edges + " cross" + at;
    case Kind::common_part:
      return edges + " lie on each other" + at;
    case Kind::outside:
      return "hole " + number(fault.ring) + " lies outside" + at;
    case Kind::nested:
      return "hole " + number(fault.ring) + " lies in hole " + number(fault.other_ring) + at;
    case Kind::no_area:
      return (fault.ring > 0 ? "hole " + number(fault.ring) : "the ring") + " has no area" + at;
  }
  return {};
}

std::vector<RingFault> faults_of(const Rings& rings) { return Search(rings).faults(); }

}  // namespace apothem
