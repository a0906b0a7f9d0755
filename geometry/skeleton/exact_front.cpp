#include "geometry/skeleton/exact_front.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/polygon/ring_links.hpp"
#include "geometry/skeleton/exact_planes.hpp"
#include "geometry/skeleton/fine_frame.hpp"

namespace apothem {
namespace {

constexpr int kNone = -1;
constexpr int kProgressEvery = 100;

using Triple = ExactPlanes::Triple;
using Time = std::optional<Fine>;

// A vertex of the front, from its node until the next event there.
struct Vertex {
  Fine x, y, speed_x, speed_y, since;
  int before, after;  // edges on whose lines it moves
  int node;           // where it starts
  // What determines it besides the line of the edge after it or before it: those themselves, or,
  // between edges in line, the upright plane in which it moves, which may be none that is known.
  int plane_before, plane_after;
  bool hits;  // may reach other edges: it is not convex
  bool fresh = true;
  int front = kNone, next = kNone;  // the front that it belongs to, and the vertex after it
  int born = 0;                     // step in which the piece from it to `next` came to be
  Time shrink = std::nullopt;       // of that piece
  Time hit = std::nullopt;          // when it reaches the first edge,
  int target = kNone;               // whose piece starts in this vertex
  int target_end = kNone;           // and ended in this one
  std::array<double, 5> rough{};    // x, y, speeds and since
  double fast = 0;                  // bound of its speed
};

// Where a vertex meets the line of a piece: beyond its start, in it, between, in its end, beyond.
enum class Where { outside, start, between, end };

struct Hit {
  int at, piece;  // positions in the front
  Where where;
  Fine along;  // coordinate in the direction of the piece
};

// A part of the border between two points of the front at the time of an event.
struct Segment {
  int from, to;  // sets of vertices in the same place
  int edge;
  bool gone = false;
  int follower = kNone, vertex = kNone;  // segment after it, vertex of the front in its start
  int other = kNone;                     // another segment with the same start
};

class ExactFront {
 public:
  explicit ExactFront(const Polygon& polygon)
      : polygon_(polygon),
        size_(polygon.size()),
        planes_(polygon),
        frame_(polygon),
        lines_(frame_.lines()),
        borders_(size_) {
    for (const FineLine& line : lines_) {
      rough_.push_back({static_cast<double>(line.tx), static_cast<double>(line.ty),
                        static_cast<double>(line.offset)});
    }
    for (const Vec2& v : polygon.local_vertices()) nodes_.push_back({v, 0});
    std::vector<std::vector<int>> loops(static_cast<size_t>(polygon.rings()));
    for (int k = 0; k < polygon.rings(); ++k) {
      for (int v = polygon.ring_start(k); v < polygon.ring_start(k + 1); ++v) {
        loops[k].push_back(
            add_vertex(frame_.x(v), frame_.y(v), 0, polygon.previous(v), v, v, size_ + v));
      }
    }
    add_front(loops, 0);
  }

  std::optional<SkeletonParts> run(const Progress& progress) {
    while (sound_ && !fronts_.empty()) {
      const Front front = std::move(fronts_.back());
      fronts_.pop_back();
      if (++step_ > 8 * size_ + kProgressEvery) return std::nullopt;
      advance(front);
      if (progress && step_ % kProgressEvery == 0) {
        progress({"straight skeleton", std::nullopt});
      }
    }
    if (!sound_) return std::nullopt;
    return joined(std::move(nodes_), borders_, polygon_);
  }

 private:
  // What moves from event to event on its own: a loop of vertices, or, in a polygon with holes, all
  // of its loops, because an event may join two of them.
  struct Front {
    std::vector<int> vertices;
    RingLinks links;  // none if it is one loop
    Fine now;
    int born;

    [[nodiscard]] int size() const { return static_cast<int>(vertices.size()); }
    // The position of the vertex after the one at a position.
    [[nodiscard]] int next(int at) const {
      return apothem::next(links.after.empty() ? nullptr : &links, at, size());
    }
  };

  // ----------------------------------------------------------------------------------------------
  // Vertices and pieces of edges between them

  int add_vertex(const Fine& x, const Fine& y, const Fine& since, int before, int after, int node,
                 int upright) {
    const FineLine &p = lines_[before], &q = lines_[after];
    const Fine turn = p.tx * q.ty - p.ty * q.tx;
    const Fine nx = -p.ty - q.ty, ny = p.tx + q.tx;
    const Fine square = (nx * nx + ny * ny) / 2;
    if (!(square > kFineNoise)) sound_ = false;  // an angle of 0 or 360 degrees
    const bool straight = abs(turn) < kFineNoise && planes_.parallel(before, after);
    Vertex v{x, y, nx / square, ny / square, since, before, after, node, before, after, straight};
    if (straight) v.plane_before = v.plane_after = upright;
    v.hits = straight || turn < 0;
    v.rough = {static_cast<double>(x), static_cast<double>(y), static_cast<double>(v.speed_x),
               static_cast<double>(v.speed_y), static_cast<double>(since)};
    v.fast = std::abs(v.rough[2]) + std::abs(v.rough[3]);
    vertices_.push_back(std::move(v));
    return static_cast<int>(vertices_.size()) - 1;
  }

  void add_front(const std::vector<std::vector<int>>& loops, const Fine& now) {
    if (loops.empty()) return;
    Front front{{}, {}, now, step_};
    const int name = loops.front().front();
    for (const std::vector<int>& loop : loops) {
      if (loop.size() < 3) sound_ = false;
      for (size_t i = 0; i < loop.size(); ++i) {
        Vertex& v = vertices_[loop[i]];
        v.front = name;
        const int end = after(loop, i);
        if (v.next == end) continue;
        v.next = end;
        v.born = step_;
        v.shrink = shrink_time(v, now);
      }
      front.vertices.insert(front.vertices.end(), loop.begin(), loop.end());
      if (loops.size() > 1) front.links.add(static_cast<int>(loop.size()));
    }
    fronts_.push_back(std::move(front));
  }

  [[nodiscard]] static Fine x_of(const Vertex& v, const Fine& t) {
    return v.x + (t - v.since) * v.speed_x;
  }
  [[nodiscard]] static Fine y_of(const Vertex& v, const Fine& t) {
    return v.y + (t - v.since) * v.speed_y;
  }
  // How far q is from p at a time, in the direction of an edge.
  [[nodiscard]] Fine way(const Vertex& p, const Vertex& q, int edge, const Fine& t) const {
    return lines_[edge].along(x_of(q, t) - x_of(p, t), y_of(q, t) - y_of(p, t));
  }

  // The time at which the piece from a vertex on has shrunk to nothing.
  [[nodiscard]] Time shrink_time(const Vertex& u, const Fine& now) const {
    const Vertex& v = vertices_[u.next];
    const Fine rate = lines_[u.after].along(v.speed_x - u.speed_x, v.speed_y - u.speed_y);
    if (!(rate < -kFineNoise)) return std::nullopt;
    return now - way(u, v, u.after, now) / rate;
  }
  [[nodiscard]] Triple shrink_triple(const Vertex& u) const {
    return {u.plane_before, u.after, vertices_[u.next].plane_after};
  }

  // ----------------------------------------------------------------------------------------------
  // When a vertex hits an edge

  [[nodiscard]] Triple hit_triple(const Vertex& c, int edge) const {
    return {c.before, c.plane_after, edge};
  }

  [[nodiscard]] Time reach_time(const Vertex& c, int edge, const Fine& now) const {
    const FineLine& line = lines_[edge];
    const Fine rate = line.across(c.speed_x, c.speed_y) - 1;
    const Fine height = line.across(x_of(c, now), y_of(c, now)) - line.offset - now;
    if (!(rate < -kFineNoise) || height < -kFineNoise) return std::nullopt;
    return now - height / rate;
  }

  // Where vertex c, which reaches the line of the piece from u on, meets it.
  [[nodiscard]] Where place(const Vertex& c, const Vertex& u, const Fine& time) const {
    const Vertex& v = vertices_[u.next];
    const Triple here = hit_triple(c, u.after);
    const auto side = [&](const Fine& beyond, int plane) {
      if (abs(beyond) < kFineNoise && (!known(here) || plane == kNone || meets(here, plane))) {
        return 0;
      }
      return beyond > 0 ? 1 : -1;
    };
    const int first = side(way(u, c, u.after, time), u.plane_before);
    const int second = side(way(c, v, u.after, time), v.plane_after);
    if (first < 0 || second < 0) return Where::outside;
    return first == 0 ? Where::start : second == 0 ? Where::end : Where::between;
  }
  static bool known(const Triple& p) { return std::find(p.begin(), p.end(), kNone) == p.end(); }
  [[nodiscard]] bool meets(const Triple& here, int plane) const {
    return std::find(here.begin(), here.end(), plane) != here.end() ||
           planes_.concurrent(here, plane);
  }

  // True if doubles show that vertex c misses the piece from u on, or meets it after a time.
  [[nodiscard]] bool misses(const Vertex& c, const Vertex& u, double now, double until) const {
    const Vertex& v = vertices_[u.next];
    if (!(c.fast < kFast && u.fast < kFast && v.fast < kFast)) return false;
    const auto& [tx, ty, offset] = rough_[u.after];
    const auto along = [tx = tx, ty = ty](const Vertex& p, double t) {
      const auto& [x, y, vx, vy, since] = p.rough;
      return tx * (x + (t - since) * vx) + ty * (y + (t - since) * vy);
    };
    const auto beside = [&](double t) {  // -1 before the piece, 1 behind it
      const double place = along(c, t);
      return place < along(u, t) - kRough ? -1 : place > along(v, t) + kRough ? 1 : 0;
    };
    const auto& [x, y, vx, vy, since] = c.rough;
    const double rate = tx * vy - ty * vx - 1;
    const double height =
        tx * (y + (now - since) * vy) - ty * (x + (now - since) * vx) - offset - now;
    if (rate > kRough || height < -kRough) return true;
    if (rate < -kSlow) {
      const double time = now - height / rate;
      return time > until + kRough || beside(time) != 0;
    }
    const double last = std::min(until, 1.0) + kRough;  // no front lasts longer than 1
    const int side = beside(now);
    return height > kSlow * (last - now) + kRough || (side != 0 && beside(last) == side);
  }
  // Doubles are asked about vertices that are slower than kFast. Where one approaches a line faster
  // than kSlow, the time has an error of 3e-11 for one of 1e-14 in the height, and a place 1e-9.
  static constexpr double kFast = 30, kSlow = 1e-2, kRough = 1e-7;

  // Looks whether vertex c hits the piece from u on before all that is known.
  void look(Vertex& c, int piece, const Fine& now, double rough_now) {
    const Vertex& u = vertices_[piece];
    if (u.next == vertex_number(c) || piece == vertex_number(c)) return;
    const double first = c.hit ? static_cast<double>(*c.hit) : HUGE_VAL;
    if (misses(c, u, rough_now, first) || same_start(c, u)) return;
    const Time time = reach_time(c, u.after, now);
    if (!time || (c.hit && !(*time < *c.hit))) return;
    if (place(c, u, *time) == Where::outside) return;
    c.hit = time;
    c.target = piece;
    c.target_end = u.next;
  }
  // True if the piece from u on begins or ends where vertex c starts. There it is part of another
  // corner of the region that the event has left, which only touches that of c.
  [[nodiscard]] bool same_start(const Vertex& c, const Vertex& u) const {
    return c.node == u.node || c.node == vertices_[u.next].node;
  }
  [[nodiscard]] int vertex_number(const Vertex& v) const {
    return static_cast<int>(&v - vertices_.data());
  }

  // Brings up to date what the vertices of a front hit first.
  void look_ahead(const Front& front) {
    const auto now = static_cast<double>(front.now);
    std::vector<int> fresh_pieces;
    for (const int u : front.vertices) {
      if (vertices_[u].born == front.born) fresh_pieces.push_back(u);
    }
    for (const int i : front.vertices) {
      Vertex& c = vertices_[i];
      if (!c.hits) continue;
      const bool lost = c.hit && (vertices_[c.target].front != c.front ||
                                  vertices_[c.target].next != c.target_end);
      if (c.fresh || lost) {
        c.fresh = false;
        c.hit.reset();
        for (const int u : front.vertices) look(c, u, front.now, now);
      } else {
        for (const int u : fresh_pieces) look(c, u, front.now, now);
      }
    }
  }

  // ----------------------------------------------------------------------------------------------
  // The next events

  // Of two times that cannot be told apart, whether they are the same.
  [[nodiscard]] bool same_time(const Fine& s, const Triple& p, const Fine& t,
                               const Triple& q) const {
    if (!(abs(s - t) < kFineNoise)) return false;
    return !known(p) || !known(q) || planes_.simultaneous(p, q);
  }

  // Moves a front to its next event, and makes loops of what remains.
  void advance(const Front& front) {
    look_ahead(front);
    Time time;
    Triple triple{};
    for (const int i : front.vertices) {
      const Vertex& v = vertices_[i];
      if (v.shrink && (!time || *v.shrink < *time)) time = v.shrink, triple = shrink_triple(v);
      if (v.hit && (!time || *v.hit < *time)) {
        time = v.hit;
        triple = hit_triple(v, vertices_[v.target].after);
      }
    }
    if (!time) {
      sound_ = false;
      return;
    }
    const int m = front.size();
    std::vector<bool> shrunk(m);
    std::vector<Hit> hits;
    const Fine late = *time + kFineNoise;
    for (int i = 0; i < m; ++i) {
      const Vertex& v = vertices_[front.vertices[i]];
      if (v.shrink && *v.shrink < late) {
        shrunk[i] = same_time(*v.shrink, shrink_triple(v), *time, triple);
      }
      if (!v.hit || !(*v.hit < late)) continue;
      const Triple own = hit_triple(v, vertices_[v.target].after);
      if (same_time(*v.hit, own, *time, triple)) add_hits(front, i, *time, triple, hits);
    }
    meet(front, *time, shrunk, hits);
  }

  // Everything that a vertex hits at a time.
  void add_hits(const Front& front, int at, const Fine& time, const Triple& triple,
                std::vector<Hit>& hits) const {
    const Vertex& c = vertices_[front.vertices[at]];
    const auto now = static_cast<double>(front.now);
    for (int i = 0; i < front.size(); ++i) {
      const Vertex& u = vertices_[front.vertices[i]];
      if (i == at || front.next(i) == at) continue;
      if (misses(c, u, now, static_cast<double>(time)) || same_start(c, u)) continue;
      const Time reach = reach_time(c, u.after, front.now);
      if (!reach || !same_time(*reach, hit_triple(c, u.after), time, triple)) continue;
      const Where where = place(c, u, *reach);
      if (where == Where::outside) continue;
      hits.push_back({at, i, where, lines_[u.after].along(x_of(c, time), y_of(c, time))});
    }
  }

  // ----------------------------------------------------------------------------------------------
  // What the front becomes

  void meet(const Front& front, const Fine& time, const std::vector<bool>& shrunk,
            std::vector<Hit>& hits) {
    const int m = front.size();
    DisjointSets same(m);
    std::vector<bool> moved(m);  // vertices that take part
    for (int i = 0; i < m; ++i) {
      if (!shrunk[i]) continue;
      same.join(i, front.next(i));
      moved[i] = moved[front.next(i)] = true;
    }
    for (const Hit& hit : hits) {
      moved[hit.at] = true;
      if (hit.where == Where::between) continue;
      const int end = hit.where == Where::start ? hit.piece : front.next(hit.piece);
      moved[end] = true;
      same.join(hit.at, end);
    }
    join_hits(front, hits, same);
    std::vector<bool> touched(m);  // sets that take part
    for (int i = 0; i < m; ++i) {
      if (moved[i]) touched[same.find(i)] = true;
    }
    std::vector<Segment> segments = divided(front, shrunk, hits, same);
    const std::vector<int> nodes = add_nodes(front, time, touched, same);
    cancel(segments, touched, nodes);
    follow(front, time, segments, touched, nodes);
    close_loops(segments, time);
  }

  // Sorts the hits along each piece, and joins those in the same place.
  void join_hits(const Front& front, std::vector<Hit>& hits, DisjointSets& same) {
    std::erase_if(hits, [](const Hit& hit) { return hit.where != Where::between; });
    const auto vertex = [&](const Hit& hit) -> const Vertex& {
      return vertices_[front.vertices[hit.at]];
    };
    const auto edge = [&](const Hit& hit) { return vertices_[front.vertices[hit.piece]].after; };
    std::sort(hits.begin(), hits.end(), [&](const Hit& p, const Hit& q) {
      return p.piece != q.piece ? p.piece < q.piece : p.along < q.along;
    });
    for (size_t i = 0; i + 1 < hits.size(); ++i) {
      const Hit &p = hits[i], &q = hits[i + 1];
      if (p.piece != q.piece || !(q.along - p.along < kFineNoise)) continue;
      const Triple here = hit_triple(vertex(p), edge(p));
      const Triple there = hit_triple(vertex(q), edge(q));
      if (!known(here) || !known(there) || (meets(here, there[0]) && meets(here, there[1]))) {
        same.join(p.at, q.at);
      }
    }
  }

  // The pieces that are left, divided where they are hit.
  std::vector<Segment> divided(const Front& front, const std::vector<bool>& shrunk,
                               const std::vector<Hit>& hits, DisjointSets& same) {
    const int m = front.size();
    std::vector<Segment> segments;
    auto hit = hits.begin();
    for (int i = 0; i < m; ++i) {
      if (shrunk[i]) continue;
      const int edge = vertices_[front.vertices[i]].after;
      int from = same.find(i);
      const auto add = [&](int to) {
        if (to == from) return;
        segments.push_back({from, to, edge});
        from = to;
      };
      const size_t first = segments.size();
      for (; hit != hits.end() && hit->piece < i; ++hit) {
      }
      for (; hit != hits.end() && hit->piece == i; ++hit) add(same.find(hit->at));
      add(same.find(front.next(i)));
      // A piece of some length cannot have both ends in the same place.
      if (segments.size() == first) sound_ = false;
    }
    return segments;
  }

  // Makes a node of each set of vertices that takes part, and ends the arcs of these vertices
  // there.
  std::vector<int> add_nodes(const Front& front, const Fine& time, const std::vector<bool>& touched,
                             DisjointSets& same) {
    const int m = front.size();
    std::vector<int> nodes(m, kNone);
    for (int i = 0; i < m; ++i) {
      const int set = same.find(i);
      if (!touched[set]) continue;
      Vertex& v = vertices_[front.vertices[i]];
      v.front = kNone;
      if (nodes[set] == kNone) {
        nodes[set] = static_cast<int>(nodes_.size());
        const Vertex& place = vertices_[front.vertices[set]];
        nodes_.push_back(frame_.node(x_of(place, time), y_of(place, time), time));
      }
      borders_[v.before].push_back({v.node, nodes[set]});
      borders_[v.after].push_back({nodes[set], v.node});
    }
    return nodes;
  }

  // Takes out segments of two edges that have met, and makes arcs of them.
  void cancel(std::vector<Segment>& segments, const std::vector<bool>& touched,
              const std::vector<int>& nodes) {
    std::map<std::pair<int, int>, int> between;
    for (int s = 0; s < static_cast<int>(segments.size()); ++s) {
      const auto [from, to] = std::pair(segments[s].from, segments[s].to);
      if (!touched[from] || !touched[to]) continue;
      if (!between.try_emplace({from, to}, s).second) sound_ = false;
      const auto other = between.find({to, from});
      if (other == between.end()) continue;
      Segment &p = segments[s], &q = segments[other->second];
      p.gone = q.gone = true;
      borders_[p.edge].push_back({nodes[to], nodes[from]});
      borders_[q.edge].push_back({nodes[from], nodes[to]});
    }
    std::erase_if(segments, [](const Segment& s) { return s.gone; });
  }

  // Finds which segment follows on which, and the vertices between them.
  void follow(const Front& front, const Fine& time, std::vector<Segment>& segments,
              const std::vector<bool>& touched, const std::vector<int>& nodes) {
    std::vector<int> leaving(front.vertices.size(), kNone);  // the last segment from each set
    for (int s = 0; s < static_cast<int>(segments.size()); ++s) {
      segments[s].other = std::exchange(leaving[segments[s].from], s);
    }
    for (Segment& in : segments) {
      for (int out = leaving[in.to]; out != kNone; out = segments[out].other) {
        if (in.follower == kNone ||
            earlier(segments[out].edge, segments[in.follower].edge, in.edge)) {
          in.follower = out;
        }
      }
      if (in.follower == kNone || segments[in.follower].vertex != kNone) {
        sound_ = false;
        return;
      }
      Segment& out = segments[in.follower];
      if (!touched[in.to]) {
        out.vertex = front.vertices[in.to];
      } else if (in.edge == out.edge) {
        sound_ = false;
      } else {
        const Vertex place = vertices_[front.vertices[in.to]];
        out.vertex = add_vertex(x_of(place, time), y_of(place, time), time, in.edge, out.edge,
                                nodes[in.to], kNone);
      }
    }
  }

  // True if edge p leaves a point before edge q, seen clockwise from the direction from which edge
  // `in` has come: the interior is on its left, so it is followed by the first one.
  [[nodiscard]] bool earlier(int p, int q, int in) const {
    const auto sine = [&](int a, int b) -> Fine {
      return lines_[a].tx * lines_[b].ty - lines_[a].ty * lines_[b].tx;
    };
    // The second half of the turn begins opposite to where the edge has come from.
    const bool late_p = sine(in, p) < 0, late_q = sine(in, q) < 0;
    if (late_p != late_q) return late_q;
    return sine(p, q) < 0;
  }

  void close_loops(std::vector<Segment>& segments, const Fine& time) {
    std::vector<std::vector<int>> loops;
    for (size_t s = 0; sound_ && s < segments.size(); ++s) {
      std::vector<int> loop;
      for (int at = static_cast<int>(s); !segments[at].gone; at = segments[at].follower) {
        segments[at].gone = true;
        loop.push_back(segments[at].vertex);
      }
      if (loop.empty()) continue;
      if (!polygon_.has_holes()) {
        add_front({std::move(loop)}, time);
      } else {
        loops.push_back(std::move(loop));
      }
    }
    if (sound_) add_front(loops, time);
  }

  const Polygon& polygon_;
  int size_;
  ExactPlanes planes_;
  FineFrame frame_;
  std::vector<FineLine> lines_;               // per edge of the polygon
  std::vector<std::array<double, 3>> rough_;  // their tangents and offsets
  bool sound_ = true;                         // false once something has happened that cannot be
  int step_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<Front> fronts_;
  std::vector<Skeleton::Node> nodes_;
  std::vector<std::vector<FaceBorder>> borders_;  // per face
};

}  // namespace

std::optional<SkeletonParts> exact_skeleton(const Polygon& polygon, const Progress& progress) {
  return ExactFront(polygon).run(progress);
}

}  // namespace apothem
