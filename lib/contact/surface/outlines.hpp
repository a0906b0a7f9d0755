// The outlines of bodies with the collars of their potentials (docs/theory.md, Contact).
//
// An outline is the boundary of a body: the closed lines around a mesh, or the polygon of a rigid
// body that may touch a mesh. The collar is the part of the outline's roof near the surface, up to
// a depth that is the same all around a body and does not follow the deformation. Every edge has
// one face of it. The upper sides of the faces form the top, closed lines as well. The vertices of
// all outlines form one list; edge i leads from vertex i to vertex next[i].
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "geometry/integrals/collar.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "geometry/spatial/boxes.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/execution/parallel.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/indices.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

class Outlines {
 public:
  struct Body {
    int first, end;         ///< the vertices of the body
    RigidIndex rigid;       ///< -1 if the body is deformable
    double reference;       ///< r of its potential, m; it does not follow the deformation
    double depth;           ///< of its collar, m; nor does this
    double cx = 0, cy = 0;  ///< mass centre of a rigid body, m
    int first_loop = 0, end_loop = 0;  ///< its closed lines

    [[nodiscard]] bool is_rigid() const { return rigid >= 0; }
    [[nodiscard]] double slope() const { return 1 / reference; }  ///< of its potential, 1/m
  };
  std::vector<Body> bodies;         ///< in the order of BodyIndex
  std::vector<BodyIndex> body;      ///< of each vertex
  std::vector<int> next, previous;  ///< vertices around each vertex
  std::vector<NodeIndex> node;      ///< of each vertex; -1 on a rigid body
  /// The vertices of a closed line of a body.
  struct Loop {
    int first, end;
    BodyIndex body;
  };
  std::vector<Loop> loops;      ///< ascending
  std::vector<double> x, y;     ///< present place of each vertex, m
  std::vector<double> mx, my;   ///< direction of the bisector at each vertex
  std::vector<double> tx, ty;   ///< unit tangent of each edge
  std::vector<double> length;   ///< of each edge, m
  std::vector<double> depth;    ///< of the collar at each edge: that of the body, m
  std::vector<double> plain;    ///< of each face (geometry/integrals/collar.hpp), m
  std::vector<Box> edge_boxes;  ///< of the edges at the last search, grown by half the skin
  std::vector<Box> face_boxes;  ///< of the faces, likewise
  std::vector<Box> body_boxes;  ///< of the edges and faces of each body, likewise

  /// `skin`: how far corners of edges and faces may move between two searches, twice over, m.
  explicit Outlines(double skin = 0) : skin_(skin) {}

  /// Adds the outline of a mesh whose node 0 has the number `first_node`. r is the smallest
  /// inradius of the elements at its boundary, or `reference` (m). The collar has the depth r, or
  /// less where the body is thin: see collar_depth.
  void add_mesh(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node,
                std::optional<double> reference = {});

  /// Adds the polygon of a rigid body, counter-clockwise about the mass centre; `reference`: its r
  /// in m. The collar has the depth r, or half the smallest thickness.
  void add_rigid(const std::vector<Vec2>& vertices, RigidIndex rigid, double reference);

  /// Moves the outlines to where the bodies are; those of rigid bodies follow their polygons. Those
  /// of active bodies get their tangents, bisectors and depths. Throws NotFinite if a vertex is not
  /// at a finite place.
  void place(const Kinematics& now, const PlacedShapes& polygons,
             const Threads& threads = Threads());

  /// True if a vertex, or a face of an active body, has moved through half the skin since the last
  /// search, where the outlines have been placed.
  [[nodiscard]] bool stale() const { return strayed_; }
  /// Has the outlines be stale until the next search.
  void forget() {
    kept_ = {};
    strayed_ = true;
  }
  /// Renews the boxes for the search.
  void prepare_search();
  /// Where the vertices were at the last search, m.
  [[nodiscard]] const std::vector<double>& searched_x() const { return kept_.x; }
  [[nodiscard]] const std::vector<double>& searched_y() const { return kept_.y; }
  /// Puts the vertices where they were at a search, and renews the boxes for it.
  void prepare_search_at(const std::vector<double>& px, const std::vector<double>& py);
  /// After a search: only bodies of these pairs are active, as others are near nothing. Until the
  /// first call all are.
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

  /// How often the outline of a body, or the top of its collar, goes round a point. `clear`, if
  /// given, becomes false where round-off might decide.
  [[nodiscard]] int winding(const Vec2& point, BodyIndex body, bool of_top = false,
                            bool* clear = nullptr) const;

  /// A reflex corner of an active body with a mesh, so sharp that the collar reaches out of the
  /// body on the other side: self-contact is wrong there (docs/theory.md, Contact of a body with
  /// itself).
  struct Notch {
    int vertex;
    double angle;  ///< between its edges, outside the body, rad
  };
  /// The sharpest one.
  [[nodiscard]] std::optional<Notch> closed_notch() const;

  [[nodiscard]] int size() const { return static_cast<int>(x.size()); }
  /// Half the length of the two edges at a vertex, m.
  [[nodiscard]] double share(int vertex) const {
    return ((point(next[vertex]) - point(vertex)).norm() +
            (point(vertex) - point(previous[vertex])).norm()) /
           2;
  }
  /// Length of an edge as given, m.
  [[nodiscard]] double given_length(int edge) const {
    return hypotenuse(x0_[next[edge]] - x0_[edge], y0_[next[edge]] - y0_[edge]);
  }
  [[nodiscard]] Vec2 point(int vertex) const { return {x[vertex], y[vertex]}; }
  [[nodiscard]] CollarFace<double> face(int i) const {
    const int j = next[i];
    return {x[i],  y[i],  x[j],  y[j],  tx[i],    ty[i],   length[i],
            mx[i], my[i], mx[j], my[j], depth[i], plain[i]};
  }
  /// By how much the boxes are grown, m.
  [[nodiscard]] double growth() const { return skin_ / 2; }
  /// The vertex of the top over a vertex.
  [[nodiscard]] Vec2 top(int i) const { return {x[i] + depth[i] * mx[i], y[i] + depth[i] * my[i]}; }

 private:
  void add_loop(const std::vector<Vec2>& places, std::span<const NodeIndex> nodes);
  void close_body(const Body& body);
  bool move(Body& body, const Kinematics& now, const PlacedShapes& polygons);
  [[nodiscard]] std::span<const BodyIndex> active(BodyIndex first, BodyIndex end) const;
  void require_finite() const;
  void find_edges(std::span<const BodyIndex> of);
  [[nodiscard]] bool have_tops_strayed(std::span<const BodyIndex> among) const;
  void find_boxes(double growth);

  double skin_;
  std::vector<double> x0_, y0_;  // of each vertex in the mesh as given
  /// The vertices of the outlines and of their tops at the last search.
  struct Kept {
    std::vector<double> x, y, top_x, top_y;
  };
  Kept kept_;
  bool strayed_ = true;
  std::vector<BodyIndex> active_;
  std::vector<char> is_active_;  // of each body
};

}  // namespace apothem
