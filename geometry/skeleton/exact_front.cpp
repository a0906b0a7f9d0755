#include "geometry/skeleton/exact_front.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "geometry/skeleton/event_queue.hpp"
#include "geometry/skeleton/exact_planes.hpp"
#include "geometry/skeleton/fine_frame.hpp"
#include "geometry/skeleton/front_triangle.hpp"
#include "geometry/skeleton/node_order.hpp"

namespace apothem {
namespace {

using Time = std::optional<Fine>;

constexpr int kNone = -1;
constexpr int kProgressEvery = 100;
// The construction is given up after so many changes of triangles per vertex and in addition, as
// that of the wavefront is.
constexpr double kMostChanges = 500;
constexpr double kMoreChanges = 1e5;
// A discriminant that is smaller, as a share of its terms, is zero and nothing but round-off.
const Fine kTangent = ldexp(Fine(1), -260);

// A vertex of the front, from its node until the next event there.
struct Vertex {
  Fine x, y, speed_x, speed_y, since;
  int before, after;  // edges on whose lines it moves
  int node;           // where it starts
  // Between edges in line, the upright plane in which it moves, if it is known.
  int upright;
  // Where it is at the time of a step.
  Fine now_x, now_y;
  int seen = kNone;     // the last step that has asked for this
  int spotted = kNone;  // the last step in which it is in a spot,
  int spot = kNone;     // and in which one
};

// A place in which corners of flat triangles are at the time of an event.
struct Spot {
  std::vector<int> vertices;
  std::vector<int> hit = {};  // edges that these have reached between their ends
  bool touched = false;       // the front changes here
  int node = kNone;
};

// A stretch on which two edges have met, from one spot to another along the first edge.
struct Stretch {
  int from, to;
  int edge, other;
};

// A corner of a triangle.
struct Corner {
  int triangle, at;
};

class ExactFront {
 public:
  explicit ExactFront(const Polygon& polygon)
      : polygon_(polygon),
        size_(polygon.size()),
        planes_(polygon),
        frame_(polygon),
        lines_(frame_.lines()),
        triangles_(front_triangles(triangulate(polygon), polygon)),
        queue_(static_cast<int>(triangles_.size())),
        flat_at_(triangles_.size(), kNone),
        fanned_at_(triangles_.size(), {kNone, kNone, kNone}),
        borders_(size_) {
    sound_ = !triangles_.empty();
    for (const Vec2& v : polygon.local_vertices()) nodes_.push_back({v, 0});
    for (int v = 0; v < size_; ++v) {
      add_vertex(frame_.x(v), frame_.y(v), polygon.previous(v), v, v, size_ + v);
    }
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) schedule(t);
  }

  std::optional<SkeletonParts> run(const Progress& progress) {
    while (sound_ && !queue_.empty()) {
      if (++step_, changes_ > kMostChanges * size_ + kMoreChanges) return std::nullopt;
      advance();
      if (progress && step_ % kProgressEvery == 0) {
        progress({"straight skeleton", std::nullopt});
      }
    }
    if (!sound_) return std::nullopt;
    renumber(nodes_, borders_, events_, polygon_);
    return joined(std::move(nodes_), borders_, polygon_);
  }

 private:
  // ----------------------------------------------------------------------------------------------
  // Vertices

  int add_vertex(const Fine& x, const Fine& y, int before, int after, int node, int upright) {
    const FineLine &p = lines_[before], &q = lines_[after];
    const Fine turn = p.tx * q.ty - p.ty * q.tx;
    const Fine nx = -p.ty - q.ty, ny = p.tx + q.tx;
    const Fine square = (nx * nx + ny * ny) / 2;
    if (!(square > kFineNoise)) sound_ = false;  // an angle of 0 or 360 degrees
    const bool straight = abs(turn) < kFineNoise && planes_.parallel(before, after);
    vertices_.push_back({x, y, nx / square, ny / square, now_, before, after, node,
                         straight ? upright : kNone, x, y, step_});
    return static_cast<int>(vertices_.size()) - 1;
  }

  // A vertex with its place at the time of this step.
  const Vertex& seen(int vertex) {
    Vertex& v = vertices_[vertex];
    if (v.seen != step_) {
      v.seen = step_;
      const Fine age = now_ - v.since;
      v.now_x = v.x + age * v.speed_x;
      v.now_y = v.y + age * v.speed_y;
    }
    return v;
  }

  // ----------------------------------------------------------------------------------------------
  // When a triangle becomes flat

  void schedule(int triangle) {
    ++changes_;
    const FrontTriangle& t = triangles_[triangle];
    const Time time = t.front_sides() == 0 ? crossing_time(t) : front_time(t);
    time ? queue_.set(triangle, *time) : queue_.remove(triangle);
  }

  // A triangle with sides on the front is flat when one of these has shrunk to nothing, or the
  // corner opposite to one reaches its line.
  [[nodiscard]] Time front_time(const FrontTriangle& t) {
    Time first;
    const auto offer = [&](const Fine& size, const Fine& rate) {
      if (!(rate < -kFineNoise)) return;
      const Fine time = now_ - size / rate;
      if (!first || time < *first) first = time;
    };
    for (int k = 0; k < 3; ++k) {
      if (t.sides[k] >= 0) continue;
      const FineLine& line = lines_[~t.sides[k]];
      const Vertex &u = seen(t.corners[(k + 1) % 3]), &v = seen(t.corners[(k + 2) % 3]),
                   &c = seen(t.corners[k]);
      offer(line.along(v.now_x - u.now_x, v.now_y - u.now_y),
            line.along(v.speed_x - u.speed_x, v.speed_y - u.speed_y));
      offer(line.across(c.now_x, c.now_y) - line.offset - now_,
            line.across(c.speed_x, c.speed_y) - 1);
    }
    return first;
  }

  // Without such sides, its area is a quadratic function of time, which is positive now.
  [[nodiscard]] Time crossing_time(const FrontTriangle& t) {
    const Vertex &a = seen(t.corners[0]), &b = seen(t.corners[1]), &c = seen(t.corners[2]);
    const Fine px = b.now_x - a.now_x, py = b.now_y - a.now_y;
    const Fine qx = c.now_x - a.now_x, qy = c.now_y - a.now_y;
    const Fine ux = b.speed_x - a.speed_x, uy = b.speed_y - a.speed_y;
    const Fine vx = c.speed_x - a.speed_x, vy = c.speed_y - a.speed_y;
    const Fine area = px * qy - py * qx;
    const Fine rate = px * vy - py * vx + ux * qy - uy * qx;
    const Fine bend = ux * vy - uy * vx;
    const Fine square = rate * rate, product = 4 * area * bend;
    Fine discriminant = square - product;
    if (abs(discriminant) < kTangent * (square + abs(product))) discriminant = 0;
    if (discriminant < 0) return std::nullopt;
    const Fine root = sqrt(discriminant);
    if (rate < 0) return now_ + 2 * area / (root - rate);
    if (bend < 0) return now_ - (rate + root) / (2 * bend);
    return std::nullopt;
  }

  [[nodiscard]] bool is_flat(int triangle) {
    const FrontTriangle& t = triangles_[triangle];
    const Vertex &a = seen(t.corners[0]), &b = seen(t.corners[1]), &c = seen(t.corners[2]);
    const Fine px = b.now_x - a.now_x, py = b.now_y - a.now_y;
    const Fine qx = c.now_x - a.now_x, qy = c.now_y - a.now_y;
    const Fine longest = std::max({Fine(abs(px)), Fine(abs(py)), Fine(abs(qx)), Fine(abs(qy))});
    return abs(px * qy - py * qx) < kFineNoise * longest || longest < kFineNoise;
  }

  // ----------------------------------------------------------------------------------------------
  // An event

  void advance() {
    take_first();
    find_spots();
    for (const int t : flat_) {
      const int k = short_side(t);
      if (k != kNone && flat_at_[t] == step_) contract(t, k);
    }
    while (!flat_.empty()) {
      const int t = flat_.back();
      flat_.pop_back();
      if (flat_at_[t] == step_) take_out(t);
    }
    renew_front();
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const int t : changed_) {
      if (sound_ && is_there(t)) schedule(t);
    }
    changed_.clear();
  }

  // Finds the triangles that are flat at the time of the next event, with all of their neighbours
  // that are.
  void take_first() {
    now_ = queue_.first_time();
    const Fine late = now_ + kFineNoise;
    bool front = false;  // whether the time is that of an event of the front, without square roots
    flat_.clear();
    while (!queue_.empty() && queue_.first_time() < late) {
      const int t = queue_.first();
      if (!front && triangles_[t].front_sides() > 0) front = true, now_ = queue_.first_time();
      queue_.remove(t);
      flat_.push_back(t);
    }
    std::erase_if(flat_, [&](int t) {
      if (is_flat(t)) return false;
      changed_.push_back(t);
      return true;
    });
    for (const int t : flat_) flat_at_[t] = step_;
    for (size_t i = 0; i < flat_.size(); ++i) {
      for (const int side : triangles_[flat_[i]].sides) {
        if (side < 0 || flat_at_[side] == step_ || !is_flat(side)) continue;
        queue_.remove(side);
        flat_at_[side] = step_;
        flat_.push_back(side);
      }
    }
  }

  // Finds which corners of flat triangles are in the same place.
  void find_spots() {
    std::vector<int> members;
    for (const int t : flat_) {
      for (const int corner : triangles_[t].corners) {
        if (vertices_[corner].spotted == step_) continue;
        vertices_[corner].spotted = step_;
        members.push_back(corner);
      }
    }
    spots_.clear();
    const auto by = [&](Fine Vertex::*coordinate) {
      return [this, coordinate](int u, int v) {
        return vertices_[u].*coordinate < vertices_[v].*coordinate;
      };
    };
    const auto end_of_run = [&](auto from, auto end, Fine Vertex::*coordinate) {
      const auto apart = [&](int u, int v) {
        return !(vertices_[v].*coordinate - vertices_[u].*coordinate < kFineNoise);
      };
      const auto last = std::adjacent_find(from, end, apart);
      return last == end ? end : last + 1;
    };
    std::sort(members.begin(), members.end(), by(&Vertex::now_x));
    for (auto column = members.begin(); column != members.end();) {
      const auto end = end_of_run(column, members.end(), &Vertex::now_x);
      std::sort(column, end, by(&Vertex::now_y));
      while (column != end) {
        const auto above = end_of_run(column, end, &Vertex::now_y);
        for (auto v = column; v != above; ++v) {
          vertices_[*v].spot = static_cast<int>(spots_.size());
        }
        spots_.push_back({{column, above}});
        spots_.back().touched = above - column > 1;
        column = above;
      }
    }
  }

  [[nodiscard]] int spot(int triangle, int corner) const {
    return vertices_[triangles_[triangle].corners[corner % 3]].spot;
  }

  // ----------------------------------------------------------------------------------------------
  // Taking out flat triangles

  [[nodiscard]] bool is_there(int triangle) const { return flat_at_[triangle] != kGone; }

  // Takes a flat triangle out, or exchanges it for one that is not flat, or puts the triangles on
  // the list that have to be taken out first.
  void take_out(int triangle) {
    if (const int k = short_side(triangle); k != kNone) return contract(triangle, k);
    const int k = longest_side(triangle);
    const int side = triangles_[triangle].sides[k];
    if (side < 0) return divide(triangle, k);
    if (flat_at_[side] != step_) {
      flip(triangle, k);
      flat_at_[triangle] = kNone;
      return;
    }
    // Of flat neighbours, the one with the longer side comes first.
    flat_.push_back(triangle);
    if (longest_side(side) == triangles_[side].side_to(triangle)) flip(triangle, k);
    flat_.push_back(side);
  }

  // A side without length, if there is one.
  [[nodiscard]] int short_side(int triangle) const {
    for (int k = 0; k < 3; ++k) {
      if (spot(triangle, k + 1) == spot(triangle, k + 2)) return k;
    }
    return kNone;
  }

  // The longest side of a flat triangle with three corners in different places: the one opposite to
  // the corner between the others.
  [[nodiscard]] int longest_side(int triangle) {
    const FrontTriangle& t = triangles_[triangle];
    const Vertex &a = seen(t.corners[0]), &b = seen(t.corners[1]), &c = seen(t.corners[2]);
    const Fine dx = std::max({a.now_x, b.now_x, c.now_x}) - std::min({a.now_x, b.now_x, c.now_x});
    const Fine dy = std::max({a.now_y, b.now_y, c.now_y}) - std::min({a.now_y, b.now_y, c.now_y});
    const auto middle = [](const Fine& p, const Fine& q, const Fine& r) {
      if ((q < p) != (r < p)) return 0;
      return (p < q) != (r < q) ? 1 : 2;
    };
    return dx > dy ? middle(a.now_x, b.now_x, c.now_x) : middle(a.now_y, b.now_y, c.now_y);
  }

  // Side k has no length: it becomes a point, and the triangles beside it stretches.
  void contract(int triangle, int k) {
    const int other = triangles_[triangle].sides[k];
    close(triangle, k);
    if (other >= 0) close(other, triangles_[other].side_to(triangle));
  }

  void close(int triangle, int k) {
    const FrontTriangle t = triangles_[triangle];
    flat_at_[triangle] = kGone;
    const int from = spot(triangle, k), to = spot(triangle, k + 1);
    join(triangle, t.sides[(k + 2) % 3], t.sides[(k + 1) % 3], from, to);
  }

  // Corner k has reached the opposite side, which is on the front.
  void divide(int triangle, int k) {
    const FrontTriangle t = triangles_[triangle];
    flat_at_[triangle] = kGone;
    Spot& at = spots_[spot(triangle, k)];
    at.touched = true;
    at.hit.push_back(~t.sides[k]);
    join(triangle, t.sides[k], t.sides[(k + 2) % 3], spot(triangle, k + 1), spot(triangle, k));
    join(triangle, t.sides[k], t.sides[(k + 1) % 3], spot(triangle, k), spot(triangle, k + 2));
  }

  // What was on two sides of a triangle that is no more meets on a stretch: two triangles are
  // neighbours, a triangle has a side on the front, or two edges of the front end. The first one
  // runs between these spots.
  void join(int triangle, int first, int second, int from, int to) {
    const auto set = [&](int side, int by) {
      triangles_[side].sides[triangles_[side].side_to(triangle)] = by;
      changed_.push_back(side);
    };
    if (first >= 0) set(first, second);
    if (second >= 0) set(second, first);
    if (first >= 0 || second >= 0 || from == to) return;
    spots_[from].touched = spots_[to].touched = true;
    stretches_.push_back({from, to, ~first, ~second});
  }

  void flip(int triangle, int k) {
    const int other = triangles_[triangle].sides[k];
    exchange_diagonal(triangles_, triangle, k);
    changed_.push_back(triangle);
    changed_.push_back(other);
  }

  // ----------------------------------------------------------------------------------------------
  // What the front becomes

  void renew_front() {
    const bool any =
        std::any_of(spots_.begin(), spots_.end(), [](const Spot& s) { return s.touched; });
    if (!any) return;
    for (Spot& spot : spots_) {
      if (!spot.touched) continue;
      if (!is_one_place(spot)) sound_ = false;
      add_node(spot);
    }
    for (const Stretch& s : stretches_) {
      if (!planes_.parallel(s.edge, s.other)) sound_ = false;
      const int from = spots_[s.from].node, to = spots_[s.to].node;
      borders_[s.edge].push_back({to, from});
      borders_[s.other].push_back({from, to});
    }
    stretches_.clear();
    for (size_t i = 0; sound_ && i < changed_.size(); ++i) {
      const int t = changed_[i];
      for (int k = 0; k < 3 && is_there(t); ++k) {
        const Vertex& v = vertices_[triangles_[t].corners[k]];
        if (v.spotted != step_ || !spots_[v.spot].touched || fanned_at_[t][k] == step_) continue;
        renew_fan({t, k}, spots_[v.spot]);
      }
    }
  }

  // True if the planes of all vertices in a spot, and of the edges that they have reached, meet in
  // one point. Of three planes, or of those that are not known, there is nothing to decide.
  [[nodiscard]] bool is_one_place(const Spot& spot) {
    std::vector<int> planes = spot.hit;
    for (const int i : spot.vertices) {
      const Vertex& v = vertices_[i];
      planes.push_back(v.before);
      planes.push_back(v.after);
      if (v.upright != kNone) planes.push_back(v.upright);
    }
    std::sort(planes.begin(), planes.end());
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    return planes.size() <= 3 || planes_.concurrent(planes);
  }

  // Makes a node of a spot, and ends the arcs of its vertices there.
  void add_node(Spot& spot) {
    const Vertex& place = seen(spot.vertices.front());
    spot.node = static_cast<int>(nodes_.size());
    nodes_.push_back(frame_.node(place.now_x, place.now_y, now_));
    int first = size_;
    for (const int i : spot.vertices) {
      const Vertex& v = vertices_[i];
      borders_[v.before].push_back({v.node, spot.node});
      borders_[v.after].push_back({spot.node, v.node});
      first = std::min(first, v.after);
    }
    events_.push_back({step_, first});
  }

  // The triangles around a spot between two edges of the front get a new corner there.
  void renew_fan(const Corner& start, const Spot& spot) {
    std::vector<Corner> fan{start};
    const int after = walk(fan, 2), before = walk(fan, 1);
    if (!sound_ || before == after) {
      sound_ = false;
      return;
    }
    const Vertex place = seen(spot.vertices.front());
    const int vertex = add_vertex(place.now_x, place.now_y, before, after, spot.node, kNone);
    for (const Corner& c : fan) {
      triangles_[c.triangle].corners[c.at] = vertex;
      changed_.push_back(c.triangle);
    }
  }

  // Goes on from the first corner of a fan to the edge of the front that bounds it, over the side
  // that lies `turn` places after the corner. Returns the edge.
  int walk(std::vector<Corner>& fan, int turn) {
    Corner c = fan.front();
    while (true) {
      fanned_at_[c.triangle][c.at] = step_;
      const int side = triangles_[c.triangle].sides[(c.at + turn) % 3];
      if (side < 0) return ~side;
      c = {side, (triangles_[side].side_to(c.triangle) + turn) % 3};
      if (fanned_at_[side][c.at] == step_) {  // once around
        sound_ = false;
        return kNone;
      }
      fan.push_back(c);
    }
  }

  static constexpr int kGone = -2;

  const Polygon& polygon_;
  int size_;
  ExactPlanes planes_;
  FineFrame frame_;
  std::vector<FineLine> lines_;  // per edge of the polygon
  bool sound_ = true;            // false once something has happened that cannot be
  int step_ = 0;
  double changes_ = 0;
  Fine now_ = 0;
  std::vector<FrontTriangle> triangles_;
  EventQueue<Fine> queue_;    // of triangles
  std::vector<int> flat_at_;  // per triangle: the last step in which it was flat, or kGone
  std::vector<std::array<int, 3>> fanned_at_;  // per corner: the last step that has renewed it
  std::vector<Vertex> vertices_;
  std::vector<Skeleton::Node> nodes_;
  std::vector<NodeEvent> events_;                 // per inner node
  std::vector<std::vector<FaceBorder>> borders_;  // per face

  // Of the present step.
  std::vector<int> flat_;     // triangles that have to be taken out
  std::vector<int> changed_;  // triangles that have to be scheduled anew
  std::vector<Spot> spots_;
  std::vector<Stretch> stretches_;
};

}  // namespace

std::optional<SkeletonParts> exact_skeleton(const Polygon& polygon, const Progress& progress) {
  return ExactFront(polygon).run(progress);
}

}  // namespace apothem
