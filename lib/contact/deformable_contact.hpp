// Normal contact of deformable bodies: nodal forces that are the gradient of an energy, from the
// collars of the bodies' deformed outlines (theory: Sec. 5.2).
//
//   E = k_n SUM over pairs of bodies  INT over the overlap  (h_a/r_a + h_b/r_b) dA
//
// with the depth h below each body's own surface. Every term is a sum over (edge of one outline) x
// (face of the other's collar); only the vertices of the outlines get forces. Rigid bodies take
// part with their polygons; pairs of two rigid bodies do not belong here.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "apothem/contact/collar.hpp"
#include "apothem/geometry/spatial/boxes.hpp"
#include "apothem/mesh/boundary.hpp"
#include "apothem/mesh/mesh.hpp"

namespace apothem {

/// The outlines of all bodies as one list of vertices; edge i leads from vertex i to next[i].
struct Outlines {
  struct Body {
    int first, end;         ///< its vertices
    int entry;              ///< rigid: number of the body in the arrays of positions; otherwise -1
    double reference;       ///< r, m; frozen
    double cx = 0, cy = 0;  ///< where the origin of its frame is, m

    [[nodiscard]] bool rigid() const { return entry >= 0; }
  };
  std::vector<Body> bodies;
  std::vector<int> body, next, previous;  ///< of each vertex
  std::vector<int> node;                  ///< in the nodal arrays; -1 for vertices of rigid bodies
  std::vector<double> x0, y0;             ///< in the mesh as given, or in the frame of the body
  std::vector<double> cap;                ///< largest depth of the collar at each edge, m
  // As they are now:
  std::vector<double> x, y;       ///< m
  std::vector<double> mx, my;     ///< direction of the bisector at each vertex
  std::vector<double> tx, ty;     ///< unit tangent of each edge
  std::vector<double> length;     ///< of each edge, m
  std::vector<double> clearance;  ///< height at which the fronts of other edges arrive, m
  std::vector<double> depth;      ///< of the collar at each edge, m

  [[nodiscard]] int size() const { return static_cast<int>(x.size()); }
  [[nodiscard]] CollarFace<double> face(int i) const {
    const int j = next[i];
    return {x[i],
            y[i],
            x[j],
            y[j],
            tx[i],
            ty[i],
            length[i],
            mx[i],
            my[i],
            mx[j],
            my[j],
            depth[i],
            depth[previous[i]],
            depth[j]};
  }
};

/// An edge of one body that may meet a face of another.
struct EdgeFacePair {
  std::int32_t edge, face;
  auto operator<=>(const EdgeFacePair&) const = default;
};

/// One that does.
struct EdgeFaceContact {
  int edge, face;
  CollarPiece<double> piece;
};

/// What happens in a contact patch, a connected part of the overlap of two bodies.
struct BodyContact {
  int a, b;                      ///< a < b
  Vec2 force = Vec2::Zero();     ///< on a, without friction, N
  Vec2 point = Vec2::Zero();     ///< centre of the pressure, m
  double penetration = 0;        ///< largest depth below a surface, m
  Vec2 friction = Vec2::Zero();  ///< on a, N
};

class DeformableContact {
 public:
  /// normal_stiffness: k_n, Pa; thickness and skin (how far candidates may move before a new
  /// search) in m.
  DeformableContact(double normal_stiffness, double thickness, double skin, int threads)
      : stiffness_(normal_stiffness * thickness),
        thickness_(thickness),
        skin_(skin),
        threads_(threads) {}

  /// Adds the outline of a mesh whose node 0 is `first_node` in the nodal arrays and returns the
  /// number of the body. The collar of an edge is as deep as the inradius of its element at most,
  /// and r is the smallest of them; or both are `reference`, in m.
  int add_deformable(const Mesh& mesh, const Boundary& boundary, int first_node,
                     std::optional<double> reference = {});

  /// Adds a polygon, counter-clockwise about the body's mass centre. `entry`: its number in the
  /// arrays of positions and velocities; `reference`: its r, m.
  int add_rigid(const std::vector<Vec2>& vertices, int entry, double reference);

  /// Moves the outlines: displacements of all nodes (x and y of each) and x, y, angle of all rigid
  /// bodies. Searches for candidates where needed. Throws std::domain_error if a vertex is not at
  /// a finite place.
  void update(std::span<const double> displacement, std::span<const double> position);

  /// Forces, depths and stiffnesses where the outlines are now; the same bits for any number of
  /// threads. No allocation unless there are more contacts than ever before.
  void evaluate();

  /// Adds the forces of the last evaluation (x and y of each node, N).
  void add_forces(std::span<double> node_force) const;
  /// Force on a body, and the moment about the origin of the frame of a rigid one.
  struct Resultant {
    Vec2 force;
    double moment;
  };
  [[nodiscard]] Resultant resultant(int body) const;
  /// The same for any list of forces on the vertices.
  [[nodiscard]] Resultant resultant(int body, std::span<const double> fx,
                                    std::span<const double> fy) const;

  /// Of the last evaluation, J.
  [[nodiscard]] double energy() const;
  /// The deepest point: depth below the surface, where, and against which limit. At a limit the
  /// collar ends, and the forces beyond are not to be trusted.
  struct Depth {
    double largest = 0;         ///< m
    double ratio = 0;           ///< largest of depth / depth of the collar; 1: beyond its end
    int body = -1, other = -1;  ///< whose collar, and who is in it, at that ratio
    Vec2 place = Vec2::Zero();  ///< m
    double limit = 0;           ///< m
  };
  [[nodiscard]] const Depth& depth() const { return depth_; }
  /// Upper bound of the stiffness of a body's contacts against its translation, N/m.
  [[nodiscard]] double stiffness(int body) const { return body_stiffness_[body]; }

  /// Two edges of one body that cross, noticed at the last search.
  struct SelfContact {
    int body;
    Vec2 place;  ///< m
  };
  [[nodiscard]] const std::optional<SelfContact>& self_contact() const { return self_contact_; }

  /// The largest w_c^2 = 2 k (1/r_c + 1/r_t) l_i/m_i of a boundary node (theory: Sec. 5.4), 1/s^2,
  /// for nodes of these masses (kg; infinite or 0 where held). Needs an update before.
  struct Rate {
    double value = 0;
    int body = -1;
  };
  [[nodiscard]] Rate rate(std::span<const double> node_mass) const;

  /// Adds to each node the same bound as a stiffness, m_i w_c^2, N/m, where the last search has
  /// found candidates.
  void add_stiffness(std::span<double> node_stiffness) const;
  /// Inverse of the length of a body's potential, 1/m.
  [[nodiscard]] double slope(int body) const { return 1 / outlines_.bodies[body].reference; }

  [[nodiscard]] const Outlines& outlines() const { return outlines_; }
  [[nodiscard]] const std::vector<EdgeFacePair>& candidates() const { return candidates_; }
  /// Ascending.
  [[nodiscard]] const std::vector<EdgeFaceContact>& contacts() const { return contacts_; }
  [[nodiscard]] size_t touching() const { return contacts_.size(); }
  /// Stiffness of a contact's pressure over the depth, k_n thickness / r of the face, N/m^2.
  [[nodiscard]] double slope(const EdgeFaceContact& c) const { return slope_[c.face]; }
  [[nodiscard]] double thickness() const { return thickness_; }
  /// Searches so far.
  [[nodiscard]] int searches() const { return searches_; }
  /// Has the next update search anew.
  void forget_search() { kept_.clear(); }

  /// Mean normal pressure on each edge, Pa.
  void pressures(std::vector<double>& pressure) const;
  /// The number of each contact's patch; ascending pairs of bodies. Not for every step.
  [[nodiscard]] std::vector<int> patches() const;
  /// One per patch, in that order.
  [[nodiscard]] std::vector<BodyContact> body_contacts() const;

 private:
  void add_loop(const std::vector<Vec2>& places, std::span<const int> nodes,
                std::span<const double> caps);
  void close_body(const Outlines::Body& body);
  void place(std::span<const double> displacement, std::span<const double> position);
  void find_edges();
  void find_depths();
  void find_boxes();
  /// x, y of the start of an edge and of both ends of its collar's upper end.
  using Corners = std::array<double, 6>;
  [[nodiscard]] Corners corners(int edge) const;
  [[nodiscard]] bool stale() const;
  void search();
  void find_clearance(int body);
  void find_candidates(int a, int b);
  void add_contact(const EdgeFacePair& pair, const CollarPiece<double>& piece);
  void note_depth(double ratio, int edge, int face, double u);

  double stiffness_, thickness_, skin_;
  int threads_;
  Outlines outlines_;
  std::vector<double> events_;  // height at which each face changes its shape
  std::vector<double> slope_;   // of each edge's face
  int measured_ = 0;            // so many bodies have their clearances, if they are rigid

  // Of the last search: corners, boxes, and boxes grown by half the skin.
  std::vector<Corners> kept_;
  std::vector<Box> edge_boxes_, face_boxes_, kept_edges_, kept_faces_;
  std::vector<Box> body_boxes_;
  std::vector<BoxPair> pairs_;
  std::vector<int> near_edges_, near_faces_;
  BoxGrid grid_;
  std::vector<EdgeFacePair> candidates_;
  int searches_ = 0;
  std::optional<SelfContact> self_contact_;

  std::vector<CollarPiece<double>> pieces_;  // of the candidates, with several threads
  std::vector<char> touching_;
  std::vector<EdgeFaceContact> contacts_;
  std::vector<double> ends_;   // force of each edge on its two ends, along its inward normal
  std::vector<double> areas_;  // of the overlap over each edge, m^2
  std::vector<double> fx_, fy_;
  std::vector<double> body_stiffness_;
  Depth depth_;
};

/// Inradii of the elements at the edges of a line of the boundary, m.
std::vector<double> inradii(const Mesh& mesh, const BoundaryLoop& loop);
/// The smallest of all lines.
double boundary_inradius(const Mesh& mesh, const Boundary& boundary);

}  // namespace apothem
