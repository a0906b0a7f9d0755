// The surfaces: all boundaries that can touch another one, in one list.
//
//   polygon   the polygon of a rigid body, with the potential of its whole area
//   element   an element at the boundary of a mesh, with a potential of its own
//   outline   the boundary of a mesh, with the potential of the body near its surface
//
// Polygons come first, so that the surface of a rigid body has the number of the body. A scene has
// elements or outlines, not both. In a scene with outlines the polygons have collars as well, by
// which outlines touch them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/integrals/placed_shapes.hpp"
#include "lib/contact/surface/element_surfaces.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

enum class SurfaceKind : unsigned char { polygon, element, outline };

/// The inertia of a body with a mesh, treated as rigid.
struct MeshInertia {
  std::array<double, 3> inverse_mass{};  ///< 1/m, 1/m, 1/I; 0 where supports prevent the motion
  std::vector<double> mass_fractions;    ///< fraction of the mass at each node
};

/// The acceleration of a rigid body along a unit vector, per force of 1 N along that vector at
/// `arm` (m) from the mass centre, 1/kg. `inverse_mass` holds those along x and y, 1/kg, and of
/// rotation, 1/(kg m^2).
inline double mobility_at(const std::array<double, 3>& inverse_mass, const Vec2& arm,
                          const Vec2& along) {
  const double lever = cross(arm, along);
  return inverse_mass[0] * along.x() * along.x() + inverse_mass[1] * along.y() * along.y() +
         inverse_mass[2] * lever * lever;
}

class Surfaces {
 public:
  /// The skins of the polygons of rigid bodies and of the surfaces of meshes, m: a boundary may
  /// move by half of its skin between two searches. With `collars`, polygons get outlines too.
  Surfaces(double polygon_skin, double mesh_skin, bool collars)
      : polygon_skin_(polygon_skin),
        mesh_skin_(mesh_skin),
        collars_(collars),
        outlines_(mesh_skin) {}

  /// The data of a rigid body that contact needs.
  struct Rigid {
    std::array<double, 3> inverse_mass;  ///< 1/m, 1/m, 1/I; 0 where forces cannot move the body
    /// Steepest slope of its potential, 1/m, and largest distance of a vertex from its mass centre,
    /// m: found by add_polygon.
    double slope = 0, radius = 0;
    double inradius = 0;  ///< m
    bool moves = false;   ///< true if the body can move
    /// An upper limit of the skin of this body, m.
    double skin = HUGE_VAL;
  };
  /// Reserves memory for exactly this number of polygons with this number of vertices in total.
  void reserve_polygons(size_t polygons, size_t vertices);
  /// Adds the polygon of the next rigid body. The potential is relative to the mass centre and must
  /// outlive this object.
  void add_polygon(const Potential& potential, const Rigid& rigid);
  /// Adds the boundary of the next deformable body: see OutlineSurfaces::add_mesh.
  void add_outline(const Mesh& mesh, NodeIndex first_node, std::optional<double> reference,
                   MeshInertia inertia = {});
  /// Adds the outermost elements of the next deformable body: see ElementSurfaces::add.
  void add_elements(const Mesh& mesh, NodeIndex first_node, const PotentialChoice& choice,
                    MeshInertia inertia = {});

  /// place_all moves all surfaces; place moves only those of bodies that can move. Both throw
  /// NotFinite.
  void place_all(const Kinematics& now);
  void place(const Kinematics& now, const Threads& threads = Threads());

  /// Marks the bodies with a nonzero entry as absent: their surfaces stay where they are and touch
  /// nothing.
  void set_absent(const std::vector<std::uint8_t>& absent);
  [[nodiscard]] bool is_present(SurfaceIndex i) const {
    return absent_.empty() || absent_[static_cast<size_t>(bodies_[i])] == 0;
  }
  /// Marks the rigid bodies with a nonzero entry as resting: their surfaces stay where they are and
  /// can be touched.
  void set_resting(const std::vector<std::uint8_t>& resting);
  [[nodiscard]] bool is_resting(SurfaceIndex i) const {
    return static_cast<size_t>(i) < resting_.size() && resting_[static_cast<size_t>(i)] != 0;
  }

  [[nodiscard]] int size() const { return static_cast<int>(kinds_.size()); }
  [[nodiscard]] SurfaceKind kind(SurfaceIndex i) const { return kinds_[i]; }
  [[nodiscard]] BodyIndex body(SurfaceIndex i) const { return bodies_[i]; }
  [[nodiscard]] int rigid_count() const { return static_cast<int>(rigid_.size()); }
  [[nodiscard]] int body_count() const { return body_count_; }
  [[nodiscard]] bool has_outlines() const { return outlines_.size() > 0; }
  [[nodiscard]] bool is_rigid(SurfaceIndex i) const { return kinds_[i] == SurfaceKind::polygon; }
  [[nodiscard]] const Rigid& rigid(RigidIndex i) const { return rigid_[i]; }
  /// True if the body of a surface can move, by forces or as prescribed.
  [[nodiscard]] bool moves(SurfaceIndex i) const {
    return !is_rigid(i) || (rigid_[static_cast<size_t>(i)].moves && !is_resting(i));
  }
  /// True if forces can move the body of a surface.
  [[nodiscard]] bool responsive(SurfaceIndex i) const {
    if (!is_rigid(i)) return true;
    const std::array<double, 3>& w = rigid_[i].inverse_mass;
    return w[0] + w[1] + w[2] > 0;
  }
  /// The mobility of a body at a point along a unit vector, treated as rigid, 1/kg: see
  /// mobility_at.
  [[nodiscard]] double mobility(BodyIndex body, const Kinematics& now, const Vec2& point,
                                const Vec2& along) const;
  /// The inradius of a polygon, or the smallest length r of an element's potential, m.
  [[nodiscard]] double inradius(SurfaceIndex i) const {
    return is_rigid(i) ? rigid_[static_cast<size_t>(i)].inradius : 1 / shapes_.slope(i);
  }
  /// The steepest slope of the potentials of each body, 1/m.
  [[nodiscard]] std::vector<double> slopes() const;
  /// The distance by which the box of a surface is grown for the search, m.
  [[nodiscard]] double growth(SurfaceIndex i) const {
    if (!is_rigid(i)) return mesh_skin_ / 2;
    return std::min(polygon_skin_, rigid_[i].skin) / 2;
  }

  /// The shapes of polygons and elements, with the numbers of their surfaces.
  [[nodiscard]] const PlacedShapes& shapes() const { return shapes_; }
  /// x, y (m) and angle of the reference point of a polygon or an element.
  [[nodiscard]] const std::array<double, 3>& pose(SurfaceIndex i) const { return pose_[i]; }
  [[nodiscard]] Vec2 reference(SurfaceIndex i) const { return {pose_[i][0], pose_[i][1]}; }
  [[nodiscard]] Vec2 between(SurfaceIndex a, SurfaceIndex b) const {
    return {pose_[a][0] - pose_[b][0], pose_[a][1] - pose_[b][1]};
  }
  /// Prefetches a polygon or an element, except for its coordinates.
  void fetch(SurfaceIndex i) const {
    shapes_.fetch(i);
    __builtin_prefetch(&pose_[i]);
    if (static_cast<size_t>(i) < rigid_.size()) __builtin_prefetch(&rigid_[i]);
  }
  /// Prefetches the position and inertia of a rigid body.
  void fetch_inertia(RigidIndex i) const {
    __builtin_prefetch(&pose_[i]);
    __builtin_prefetch(&rigid_[i]);
  }
  /// The elements; element e has the surface rigid_count() + e.
  [[nodiscard]] const ElementSurfaces& elements() const { return elements_; }
  /// The outlines of all bodies, with the numbers of their surfaces.
  [[nodiscard]] const OutlineSurfaces& outlines() const { return outlines_; }
  [[nodiscard]] OutlineSurfaces& outlines() { return outlines_; }

 private:
  /// Moves a polygon. Returns false and does not move it if its position is not finite.
  bool place_polygon(RigidIndex i, const Kinematics& now, const SineCosine& angle);
  void place_meshes(const Kinematics& now, const Threads& threads);
  void find_moving();

  double polygon_skin_, mesh_skin_;
  bool collars_;
  std::vector<SurfaceKind> kinds_;
  std::vector<BodyIndex> bodies_;
  int body_count_ = 0;
  /// The data of a deformable body.
  struct Body {
    MeshInertia inertia;
    NodeIndex first_node;
    std::vector<Vec2> nodes;  // positions in the undeformed mesh, m
  };
  std::vector<Body> deformable_;
  std::vector<Rigid> rigid_;
  std::vector<RigidIndex> moving_;
  std::vector<std::uint8_t> absent_;   // for each body; empty if no body is absent
  std::vector<std::uint8_t> resting_;  // for each rigid body; empty if none is resting
  PlacedShapes shapes_;
  std::vector<std::array<double, 3>> pose_;
  ElementSurfaces elements_;
  OutlineSurfaces outlines_;
};

}  // namespace apothem
