// The outlines of bodies with the collars of their potentials (docs/theory.md, Contact).
//
// An outline is the boundary of a body: the closed lines around a mesh, or the polygon of a rigid
// body that may touch a mesh. The collar is the part of the outline's roof near the surface, up to
// a depth that is the same all around a body and does not follow the deformation. Every edge has
// one face of the collar. The upper sides of the faces form the offset curve, which consists of
// closed lines; inside it is the saturated region, where the potential is constant. The vertices of
// all outlines form one list; edge i leads from vertex i to vertex next[i].
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "geometry/spatial/boxes.hpp"
#include "geometry/spatial/loops.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/execution/parallel.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/indices.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

class OutlineSurfaces {
 public:
  struct Body {
    int first, end;         ///< range of the vertices of the body
    RigidIndex rigid;       ///< -1 if the body is deformable
    double reference;       ///< reference length r of its potential, m, which does not follow the
                            ///< deformation
    double depth;           ///< depth of its collar, m, which does not follow the deformation
    double cx = 0, cy = 0;  ///< mass centre of a rigid body, m
    int first_loop = 0, end_loop = 0;  ///< range of its closed lines

    [[nodiscard]] bool is_rigid() const { return rigid >= 0; }
    [[nodiscard]] double slope() const { return 1 / reference; }  ///< slope of its potential, 1/m
  };
  std::vector<Body> bodies;  ///< in the order of BodyIndex
  /// A body with a mesh whose collar is less deep because of an inner corner.
  struct Shallow {
    BodyIndex body;
    InnerCorner corner;
  };
  std::vector<Shallow> shallow;
  std::vector<BodyIndex> body;      ///< body of each vertex
  std::vector<int> next, previous;  ///< next and previous vertex of each vertex
  std::vector<NodeIndex> node;      ///< node of each vertex; -1 on a rigid body
  /// The range of the vertices of a closed line of a body.
  struct Loop {
    int first, end;
    BodyIndex body;
  };
  std::vector<Loop> loops;     ///< closed lines, ascending
  std::vector<double> x, y;    ///< present position of each vertex, m
  std::vector<double> mx, my;  ///< direction of the bisector at each vertex
  std::vector<double> tx, ty;  ///< unit tangent of each edge
  std::vector<double> length;  ///< length of each edge, m
  std::vector<double> depth;   ///< depth of the collar at each edge, which is that of the body, m
  /// Regular depth of each face (geometry/integrals/collar.hpp), m.
  std::vector<double> regular_depth;
  std::vector<Box> edge_boxes;  ///< boxes of the edges at the last search, grown by half the skin
  std::vector<Box> face_boxes;  ///< boxes of the faces, grown likewise
  std::vector<Box> body_boxes;  ///< boxes of the edges and faces of each body, grown likewise

  /// Corners of edges and faces may move by half of `skin` (m) between two searches.
  explicit OutlineSurfaces(double skin = 0) : skin_(skin) {}

  /// Adds the outline of a mesh whose first node has the number `first_node`. r is the smallest
  /// inradius of the elements at its boundary, or `reference` (m). The depth of the collar is r, or
  /// less where the body is thin (docs/theory.md, Beyond the collar).
  void add_mesh(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                std::optional<double> reference = {});

  /// Adds the polygon of a rigid body, counter-clockwise and relative to the mass centre, with the
  /// reference length `reference`, m. The depth of the collar is r, or half the smallest thickness.
  void add_rigid(const Rings& rings, RigidIndex rigid, double reference);

  /// Moves the outlines with their bodies; those of rigid bodies follow their polygons. The
  /// tangents, bisectors and regular depths of active bodies are computed. Throws NotFinite if a
  /// coordinate of a vertex is not finite.
  void place(const Kinematics& now, const PlacedShapes& polygons,
             const Threads& threads = Threads());

  /// True if a vertex, or a corner of a face of an active body, has moved by more than half the
  /// skin since the last search.
  [[nodiscard]] bool stale() const { return strayed_; }
  /// Marks the outlines as stale until the next search.
  void forget() {
    kept_ = {};
    strayed_ = true;
  }
  /// Renews the boxes for a search.
  void prepare_search();
  /// The positions of the vertices at the last search, m.
  [[nodiscard]] const std::vector<double>& searched_x() const { return kept_.x; }
  [[nodiscard]] const std::vector<double>& searched_y() const { return kept_.y; }
  /// Moves the vertices to their positions at an earlier search, and renews the boxes for it.
  void prepare_search_at(const std::vector<double>& px, const std::vector<double>& py);
  /// Sets the active bodies after a search: those of the given pairs, as the others are near
  /// nothing. Until the first call all bodies are active.
  void activate(std::span<const BoxPair> pairs);
  /// The active bodies, ascending.
  [[nodiscard]] std::span<const BodyIndex> active() const { return active_; }
  /// Calls f(vertex) for every vertex of the active bodies.
  template <class F>
  void each_active_vertex(const F& f) const {
    for (const BodyIndex b : active_) {
      for (int i = bodies[b].first; i < bodies[b].end; ++i) f(i);
    }
  }

  /// The winding number of the outline of a body, or of the offset curve of its collar, about a
  /// point. `clear`, if given, becomes false where round-off might decide.
  [[nodiscard]] int winding(const Vec2& point, BodyIndex body, bool of_offset_curve = false,
                            bool* clear = nullptr) const;

  /// A reflex corner of an active body with a mesh that is so sharp that the collar reaches out of
  /// the body on the other side, where self-contact is wrong (docs/theory.md, Contact of a body
  /// with itself).
  struct Notch {
    int vertex;
    double angle;  ///< angle between its edges, outside the body, rad
  };
  /// The sharpest such corner.
  [[nodiscard]] std::optional<Notch> closed_notch() const;

  [[nodiscard]] int size() const { return static_cast<int>(x.size()); }
  /// The tributary length of a vertex, m: half the length of the two edges at it.
  [[nodiscard]] double tributary_length(int vertex) const {
    return ((point(next[vertex]) - point(vertex)).norm() +
            (point(vertex) - point(previous[vertex])).norm()) /
           2;
  }
  /// The length of an edge in the undeformed state, m.
  [[nodiscard]] double given_length(int edge) const {
    return hypotenuse(x0_[next[edge]] - x0_[edge], y0_[next[edge]] - y0_[edge]);
  }
  [[nodiscard]] Vec2 point(int vertex) const { return {x[vertex], y[vertex]}; }
  [[nodiscard]] CollarFace<double> face(int i) const {
    const int j = next[i];
    return {x[i],  y[i],  x[j],  y[j],  tx[i],    ty[i],           length[i],
            mx[i], my[i], mx[j], my[j], depth[i], regular_depth[i]};
  }
  /// The distance by which the boxes are grown, m.
  [[nodiscard]] double growth() const { return skin_ / 2; }
  /// The vertex of the offset curve that belongs to vertex i.
  [[nodiscard]] Vec2 offset_point(int i) const {
    return {x[i] + depth[i] * mx[i], y[i] + depth[i] * my[i]};
  }

 private:
  void add_loop(const std::vector<Vec2>& places, std::span<const NodeIndex> nodes);
  void close_body(const Body& body);
  bool move(Body& body, const Kinematics& now, const PlacedShapes& polygons);
  [[nodiscard]] std::span<const BodyIndex> active(BodyIndex first, BodyIndex end) const;
  void require_finite() const;
  void find_edges(std::span<const BodyIndex> among);
  [[nodiscard]] bool have_offset_curves_strayed(std::span<const BodyIndex> among) const;
  void find_boxes(double growth);

  double skin_;
  std::vector<double> x0_, y0_;  // undeformed position of each vertex, m
  /// The vertices of the outlines and of their offset curves at the last search.
  struct Kept {
    std::vector<double> x, y, offset_x, offset_y;
  };
  Kept kept_;
  bool strayed_ = true;
  std::vector<BodyIndex> active_;
  std::vector<char> is_active_;  // whether each body is active
};

}  // namespace apothem
