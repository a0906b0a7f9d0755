#include "lib/contact/mesh/saturated_regions.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace apothem {
namespace {

constexpr int kTrials = 16;  // number of vertices of a line that are tried as its base

}  // namespace

void SaturatedRegions::set_pairs(std::span<const BoxPair> pairs) {
  pairs_.clear(), bases_.clear();
  for (const auto& [a, b] : pairs) {
    add_pair(a, b);
    if (a != b) add_pair(b, a);
  }
  std::ranges::sort(pairs_, {}, [](const EdgeFacePair& p) { return std::pair(p.edges, p.faces); });
  quiet_ = std::ranges::all_of(bases_, [](const Base& b) { return b.settled && b.winding == 0; });
  first_crossing_.assign(static_cast<size_t>(outlines_.size()), -1);
}

void SaturatedRegions::add_pair(BodyIndex edges, BodyIndex faces) {
  const std::vector<OutlineSurfaces::Loop>& loops = outlines_.loops;
  EdgeFacePair pair{edges, faces, bases_.size(), 0};
  const auto add = [&](BodyIndex own, BodyIndex other, bool of_offset_curve) {
    auto loop = std::ranges::lower_bound(loops, own, {}, &OutlineSurfaces::Loop::body);
    for (; loop != loops.end() && loop->body == own; ++loop) {
      bases_.push_back(base_of(static_cast<int>(loop - loops.begin()), other, of_offset_curve));
    }
  };
  add(edges, faces, false);
  add(faces, edges, true);
  pair.end = bases_.size();
  pairs_.push_back(pair);
}

// Chooses a vertex of a closed line as its base. A vertex is settled if its winding number cannot
// change until the next search, because it is not near the other body, or not near the line that it
// would have to cross.
SaturatedRegions::Base SaturatedRegions::base_of(int index, BodyIndex other,
                                                 bool of_offset_curve) const {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Loop& loop = o.loops[static_cast<size_t>(index)];
  const std::vector<Box>& own = of_offset_curve ? o.face_boxes : o.edge_boxes;
  for (int i = loop.first; i < loop.end; ++i) {
    if (apart(own[i], o.body_boxes[other])) return {index, i, 0, of_offset_curve, true};
  }
  const OutlineSurfaces::Body& body = o.bodies[other];
  const auto grown_box = [&](const Vec2& a, const Vec2& b) {
    return box_of(a, b).grown(o.growth());
  };
  const int count = loop.end - loop.first;
  for (int k = 0; k < std::min(kTrials, count); ++k) {
    const int i = loop.first +
                  static_cast<int>(static_cast<std::int64_t>(k) * count / std::min(kTrials, count));
    const Vec2 place = of_offset_curve ? o.offset_point(i) : o.point(i);
    const Box box = grown_box(place, place);
    bool far = true;
    for (int j = body.first; far && j < body.end; ++j) {
      far = apart(box, of_offset_curve ? o.edge_boxes[j]
                                       : grown_box(o.offset_point(j), o.offset_point(o.next[j])));
    }
    if (far)
      return {index, i, winding(place, index, other, of_offset_curve), of_offset_curve, true};
  }
  return {index, loop.first, 0, of_offset_curve, false};
}

// The winding number of the other body's outline about a point of an offset curve, or of its offset
// curve about a point of an outline.
int SaturatedRegions::winding(const Vec2& place, int loop, BodyIndex other, bool of_offset_curve,
                              bool* clear) const {
  const bool self = outlines_.loops[static_cast<size_t>(loop)].body == other;
  return outlines_.winding(place, other, !of_offset_curve, clear) -
         (self && of_offset_curve ? 1 : 0);
}

void SaturatedRegions::settle(Base& base, BodyIndex other) const {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Loop& loop = o.loops[static_cast<size_t>(base.loop)];
  for (base.vertex = loop.first; base.vertex < loop.end; ++base.vertex) {
    bool clear = true;
    const Vec2 place = base.of_offset_curve ? o.offset_point(base.vertex) : o.point(base.vertex);
    base.winding = winding(place, base.loop, other, base.of_offset_curve, &clear);
    if (clear) return;
  }
  base.vertex = loop.end - 1;
}

void SaturatedRegions::evaluate() {
  edges_.clear(), faces_.clear();
  if (quiet_ && crossings_.empty()) return;
  const OutlineSurfaces& o = outlines_;
  std::ranges::sort(crossings_, {}, [&](const Crossing& c) {
    return std::tuple(o.body[c.edge], o.body[c.face], c.edge, c.face);
  });
  auto first = crossings_.begin();
  for (const EdgeFacePair& pair : pairs_) {
    auto end = first;
    while (end != crossings_.end() && o.body[end->edge] == pair.edges &&
           o.body[end->face] == pair.faces) {
      ++end;
    }
    bool inside = first != end;
    for (size_t i = pair.first; i < pair.end; ++i) {
      Base& base = bases_[i];
      if (!base.settled) settle(base, base.of_offset_curve ? pair.edges : pair.faces);
      inside = inside || base.winding != 0;
    }
    if (inside) {
      find_edges(pair, {first, end});
      find_faces(pair, {first, end});
    }
    first = end;
  }
}

// The winding number is constant along a closed line except where the line crosses the other one.
void SaturatedRegions::find_edges(const EdgeFacePair& pair, std::span<const Crossing> crossings) {
  const OutlineSurfaces& o = outlines_;
  const Vec2 origin = o.point(o.bodies[pair.edges].first);
  for (size_t c = crossings.size(); c-- > 0;)
    first_crossing_[crossings[c].edge] = static_cast<int>(c);
  for (size_t i = pair.first; i < pair.end; ++i) {
    const Base& base = bases_[i];
    if (base.of_offset_curve) continue;
    int w = base.winding, e = base.vertex;
    do {
      const int q = o.next[e];
      SaturatedEdge found{e, pair.faces, static_cast<double>(w), w / 2., 0};
      if (first_crossing_[e] >= 0) {
        for (size_t c = static_cast<size_t>(first_crossing_[e]);
             c < crossings.size() && crossings[c].edge == e; ++c) {
          const auto& [u, tau, sign] = crossings[c].crossing;
          w += sign;
          found.sum += sign * (1 - u);
          found.first += sign * (1 - u * u) / 2;
        }
      }
      if (first_crossing_[e] >= 0 || w != 0) {
        found.swept = cross(o.point(e) - origin, o.point(q) - origin) / 2 * found.sum;
        edges_.push_back(found);
      }
      e = q;
    } while (e != base.vertex);
  }
  for (const Crossing& c : crossings) first_crossing_[c.edge] = -1;
}

void SaturatedRegions::find_faces(const EdgeFacePair& pair, std::span<Crossing> crossings) {
  const OutlineSurfaces& o = outlines_;
  const Vec2 origin = o.point(o.bodies[pair.edges].first);
  std::ranges::sort(crossings, {}, [](const Crossing& c) { return std::pair(c.face, c.edge); });
  for (size_t c = crossings.size(); c-- > 0;)
    first_crossing_[crossings[c].face] = static_cast<int>(c);
  for (size_t i = pair.first; i < pair.end; ++i) {
    const Base& base = bases_[i];
    if (!base.of_offset_curve) continue;
    int w = base.winding, f = base.vertex;
    do {
      const int q = o.next[f];
      if (first_crossing_[f] >= 0 || w != 0) {
        const CollarFace<double> face = o.face(f);
        const Vec2 start = o.offset_point(f) - origin, end = o.offset_point(q) - origin;
        SaturatedFace found{f, pair.edges, {}, w * cross(start, end) / 2};
        const auto add = [&](double weight, const CollarMoments<double>& m) {
          found.moment.area += weight * m.area;
          found.moment.along += weight * m.along;
          found.moment.height += weight * m.height;
        };
        if (w != 0) add(w, collar_cell(face));
        if (first_crossing_[f] >= 0) {
          for (size_t c = static_cast<size_t>(first_crossing_[f]);
               c < crossings.size() && crossings[c].face == f; ++c) {
            const auto& [u, tau, sign] = crossings[c].crossing;
            w -= sign;
            add(-sign, collar_rest(face, tau));
            const Vec2 point = o.point(f) + tau * Vec2(o.tx[f], o.ty[f]) +
                               o.depth[f] * Vec2(-o.ty[f], o.tx[f]) - origin;
            found.swept -= sign * cross(point, end) / 2;
          }
        }
        faces_.push_back(found);
      }
      f = q;
    } while (f != base.vertex);
  }
  for (const Crossing& c : crossings) first_crossing_[c.face] = -1;
}

}  // namespace apothem
