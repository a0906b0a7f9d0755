// Normal contact of deformable bodies by the potentials of their outermost elements (the paper,
// Sec. 3; theory: Sec. 5.2), for comparison with DeformableContact.
//
// Every element with an edge on the boundary is a polygon with a potential of its own; rigid bodies
// are one polygon each. The kernel of rigid bodies gives force and loading point of each pair of
// polygons, shape functions turn them into nodal forces. Those are not the gradient of an energy,
// and the potentials vanish on borders between elements that are not part of any surface.
//
// The edges of a potential follow the corners; its lengths r are those of the mesh as given. An r
// that follows the deformation without the force of its derivative costs 1e-3 of the kinetic energy
// at any step, and its derivative would act on corners that touch nothing.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "apothem/contact/deformable_contact.hpp"
#include "apothem/contact/law.hpp"
#include "apothem/contact/normal.hpp"
#include "apothem/contact/placed_shapes.hpp"
#include "apothem/geometry/integrals/contact_patches.hpp"

namespace apothem {

class ElementContact {
 public:
  /// normal_stiffness: k_n, Pa; thickness and skin (how far candidates may move before a new
  /// search) in m; `distribution`: resultant or integrated.
  ElementContact(double normal_stiffness, double thickness, double skin,
                 ForceDistribution distribution, int threads)
      : stiffness_(normal_stiffness * thickness),
        thickness_(thickness),
        skin_(skin),
        distribution_(distribution),
        normal_(threads) {}

  /// Adds the outermost elements of a mesh whose node 0 is `first_node` in the nodal arrays and
  /// returns the number of the body. Throws InvalidPolygon if one of them is not convex or cannot
  /// have the potential.
  int add_deformable(const Mesh& mesh, const Boundary& boundary, int first_node,
                     const PotentialChoice& choice = {});

  /// Adds a rigid body, its potential about its mass centre. `entry`: its number in the arrays of
  /// positions. The potential must outlive this object.
  int add_rigid(const Potential& potential, int entry);

  /// Moves the polygons: displacements of all nodes (x and y of each) and x, y, angle of all rigid
  /// bodies. Searches for candidates where needed. Throws std::domain_error if a vertex is not at
  /// a finite place.
  void update(std::span<const double> displacement, std::span<const double> position);

  /// Forces where the polygons are now; the same bits for any number of threads. No allocation
  /// unless there are more contacts than ever before.
  void evaluate();

  /// Adds the forces of the last evaluation (x and y of each node, N).
  void add_forces(std::span<double> node_force) const;
  /// Force on a body, and the moment about the mass centre of a rigid one (0 for others).
  [[nodiscard]] DeformableContact::Resultant resultant(int body) const { return sums_[body]; }

  /// Of the last evaluation, J. Not for every step.
  [[nodiscard]] double energy() const;

  /// Two polygons that touch.
  struct Touch {
    int a, b;         ///< polygons
    Vec2 force;       ///< on a, N
    Vec2 point;       ///< where it acts, relative to a's reference point, m
    Vec2 offset;      ///< a's reference point minus b's, m
    double pressure;  ///< the sum of the sizes of what the force is the sum of, N
  };
  /// Ascending.
  [[nodiscard]] const std::vector<Touch>& touches() const { return touches_; }
  [[nodiscard]] double thickness() const { return thickness_; }
  [[nodiscard]] size_t body_count() const { return bodies_.size(); }
  /// The body of a polygon.
  [[nodiscard]] int body(int polygon) const { return pieces_[polygon].body; }
  /// Of a rigid body its number in the arrays of positions; -1 for elements.
  [[nodiscard]] int entry(int polygon) const { return pieces_[polygon].entry; }

  /// A point of an element as the weighted mean of its corners.
  struct Corners {
    std::span<const int> nodes;   ///< in the nodal arrays
    std::vector<double> weights;  ///< one for each
    std::vector<Vec2> ring;       ///< for those who find them
  };
  /// `point`: relative to the polygon's reference point, m. Rigid bodies have no nodes.
  void find_corners(int polygon, const Vec2& point, Corners& corners) const;

  /// An edge of the boundary of an element, or of a rigid body.
  struct SurfaceEdge {
    int polygon;
    Vec2 from, to;  ///< m
    [[nodiscard]] double length() const { return (to - from).norm(); }
    [[nodiscard]] Vec2 along() const { return (to - from) / length(); }
  };
  [[nodiscard]] std::vector<SurfaceEdge> surface() const;
  /// What acts on polygons goes to the nearest edge of their boundary: its index in `surface`.
  [[nodiscard]] int nearest_edge(const std::vector<SurfaceEdge>& surface, int polygon,
                                 const Vec2& point) const;
  /// Mean normal pressure on each of these edges, Pa.
  [[nodiscard]] std::vector<double> pressures(const std::vector<SurfaceEdge>& surface) const;

  /// The deepest pair.
  struct Depth {
    double largest = 0;         ///< extent of an overlap along its force, m
    int body = -1, other = -1;  ///< whose
  };
  [[nodiscard]] const Depth& depth() const { return depth_; }

  /// Two elements out of the method's range.
  struct Fault {
    enum class Kind { not_convex, too_deep } kind;
    int body, other;
    Vec2 place;  ///< m
  };
  /// Of the last evaluation: a touching element that is no longer convex, or a pair as deep as the
  /// centre of one of them. There are no forces beyond.
  [[nodiscard]] const std::optional<Fault>& fault() const { return fault_; }

  /// The bound of DeformableContact::rate, with the edges as they are in the mesh as given.
  [[nodiscard]] DeformableContact::Rate rate(std::span<const double> node_mass) const;
  /// Adds to each node on the boundary the same bound as a stiffness, N/m, where an element at it
  /// has candidates.
  void add_stiffness(std::span<double> node_stiffness) const;
  /// Inverse of the smallest length of a body's potentials, 1/m.
  [[nodiscard]] double slope(int body) const { return bodies_[body].slope; }

  [[nodiscard]] const std::vector<BoxPair>& candidates() const { return pairs_; }
  /// Pairs of polygons that touch.
  [[nodiscard]] size_t touching() const { return touches_.size(); }
  /// Searches so far.
  [[nodiscard]] int searches() const { return searches_; }
  /// Has the next update search anew.
  void forget_search() { kept_.clear(); }
  /// The number of each touch's patch; ascending pairs of bodies. Not for every step.
  [[nodiscard]] std::vector<int> patches() const;
  /// One per patch, in that order.
  [[nodiscard]] std::vector<BodyContact> body_contacts() const;

 private:
  struct Body {
    double slope;  // steepest of its potentials, 1/m
    bool rigid;
  };
  struct Piece {  // polygon, in the order of the shapes
    int body;
    int entry;    // of a rigid body in the positions; -1: an element
    int corners;  // of an element: first in nodes_
  };
  struct NodeForce {
    int node;
    Vec2 force;
  };
  [[nodiscard]] int corner_count(int piece) const { return shapes_.view(piece).size; }
  [[nodiscard]] Vec2 reference(int piece) const {
    return {places_[3 * static_cast<size_t>(piece)], places_[3 * static_cast<size_t>(piece) + 1]};
  }
  [[nodiscard]] bool stale() const;
  void search();
  [[nodiscard]] bool too_deep(int a, int b, const PairIntegral& pair) const;
  void distribute(int piece, const Vec2& force, const Vec2& point);

  double stiffness_, thickness_, skin_;
  ForceDistribution distribution_;
  std::vector<Body> bodies_;
  std::vector<Piece> pieces_;
  std::vector<int> nodes_;   // of all corners, in the nodal arrays
  std::vector<Vec2> start_;  // their places in the mesh as given
  std::vector<char> outer_;  // whether the edges from them are on the boundary
  struct Share {
    int node, body;
    double length;
  };
  std::vector<Share> shares_;  // half of the boundary edges at each boundary node, m

  PlacedShapes shapes_;
  std::vector<double> places_;  // x, y, angle of the reference point of each polygon
  std::vector<char> convex_;    // of each polygon
  std::vector<Vec2> ring_;
  Corners corners_;
  std::vector<Box> kept_;  // grown boxes of the last search
  BoxGrid grid_;
  std::vector<BoxPair> pairs_;
  int searches_ = 0;

  NormalContact normal_;
  PatchWorkspace patch_workspace_;
  std::vector<BoundaryRun> runs_;
  std::vector<PairIntegral> patches_;
  std::vector<NodeForce> forces_;
  std::vector<DeformableContact::Resultant> sums_;
  std::vector<Touch> touches_;
  Depth depth_;
  std::optional<Fault> fault_;
};

}  // namespace apothem
