// The surfaces: every boundary that can touch another one, in one list.
//
//   polygon   the polygon of a rigid body, with the potential of its whole area
//   element   an element at the boundary of a mesh, with a potential of its own
//   outline   the boundary of a mesh, with the potential of the body near its surface
//
// Polygons come first, so that the number of a rigid body's surface is that of the body. A scene
// has elements or outlines, not both. Where it has outlines, polygons have collars as well, because
// outlines touch them by these.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/integrals/placed_shapes.hpp"
#include "lib/contact/surface/element_surfaces.hpp"
#include "lib/contact/surface/outlines.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {

enum class SurfaceKind : unsigned char { polygon, element, outline };

/// A body with a mesh as a rigid one.
struct MeshInertia {
  std::array<double, 3> inverse_mass{};  ///< 1/m, 1/m, 1/I; 0 where supports hold it
  std::vector<double> shares;            ///< of each node in the mass
};

/// How much a rigid body gives way to a force of 1 N along a unit vector at `arm` (m) from its mass
/// centre, 1/kg: `inverse_mass` along x and y, 1/kg, and of rotation, 1/(kg m^2).
inline double mobility_at(const std::array<double, 3>& inverse_mass, const Vec2& arm,
                          const Vec2& along) {
  const double lever = cross(arm, along);
  return inverse_mass[0] * along.x() * along.x() + inverse_mass[1] * along.y() * along.y() +
         inverse_mass[2] * lever * lever;
}

class Surfaces {
 public:
  /// How far boundaries may move between two searches, twice over, m: the polygons of rigid bodies
  /// and the surfaces of meshes. `collars`: polygons get outlines too.
  Surfaces(double polygon_skin, double mesh_skin, bool collars)
      : polygon_skin_(polygon_skin),
        mesh_skin_(mesh_skin),
        collars_(collars),
        outlines_(mesh_skin) {}

  /// A rigid body as contact sees it.
  struct Rigid {
    std::array<double, 3> inverse_mass;  ///< 1/m, 1/m, 1/I where forces can move it, else 0
    /// Steepest slope of its potential, 1/m, and largest distance of a vertex from its mass centre,
    /// m: found by add_polygon.
    double slope = 0, radius = 0;
    double inradius = 0;  ///< m
    bool moves = false;   ///< it can change its place
    /// How far its boundary may move between two searches, twice over, m: no more than this.
    double skin = HUGE_VAL;
  };
  /// Makes room for so many polygons with so many vertices in all, and no more than that.
  void reserve_polygons(size_t polygons, size_t vertices);
  /// Adds the polygon of the next rigid body. The potential is about its mass centre and must
  /// outlive this object.
  void add_polygon(const Potential& potential, const Rigid& rigid);
  /// Adds the boundary of the next deformable body: see Outlines::add_mesh.
  void add_outline(const Mesh& mesh, NodeIndex first_node, std::optional<double> reference,
                   MeshInertia inertia = {});
  /// Adds the outermost elements of the next deformable body: see ElementSurfaces::add.
  void add_elements(const Mesh& mesh, NodeIndex first_node, const PotentialChoice& choice,
                    MeshInertia inertia = {});

  /// Moves all surfaces, or those of bodies that can move. Throws NotFinite.
  void place_all(const Kinematics& now);
  void place(const Kinematics& now, const Threads& threads = Threads());

  /// The surfaces of bodies with an entry other than 0 stay where they are and touch nothing.
  void set_absent(const std::vector<std::uint8_t>& absent);
  [[nodiscard]] bool is_present(SurfaceIndex i) const {
    return absent_.empty() || absent_[static_cast<size_t>(bodies_[i])] == 0;
  }

  [[nodiscard]] int size() const { return static_cast<int>(kinds_.size()); }
  [[nodiscard]] SurfaceKind kind(SurfaceIndex i) const { return kinds_[i]; }
  [[nodiscard]] BodyIndex body(SurfaceIndex i) const { return bodies_[i]; }
  [[nodiscard]] int rigid_count() const { return static_cast<int>(rigid_.size()); }
  [[nodiscard]] int body_count() const { return body_count_; }
  [[nodiscard]] bool has_outlines() const { return outlines_.size() > 0; }
  [[nodiscard]] bool is_rigid(SurfaceIndex i) const { return kinds_[i] == SurfaceKind::polygon; }
  [[nodiscard]] const Rigid& rigid(RigidIndex i) const { return rigid_[i]; }
  /// True if forces can move the body of a surface.
  [[nodiscard]] bool responsive(SurfaceIndex i) const {
    if (!is_rigid(i)) return true;
    const std::array<double, 3>& w = rigid_[i].inverse_mass;
    return w[0] + w[1] + w[2] > 0;
  }
  /// How much a body, as a rigid one, gives way at a point to a force of 1 N along a unit vector,
  /// 1/kg.
  [[nodiscard]] double mobility(BodyIndex body, const Kinematics& now, const Vec2& point,
                                const Vec2& along) const;
  /// Largest inscribed circle of a polygon, or smallest length r of an element's potential, m.
  [[nodiscard]] double inradius(SurfaceIndex i) const {
    return is_rigid(i) ? rigid_[static_cast<size_t>(i)].inradius : 1 / shapes_.slope(i);
  }
  /// How far the box of a surface grows for the search, m.
  [[nodiscard]] double growth(SurfaceIndex i) const {
    if (!is_rigid(i)) return mesh_skin_ / 2;
    return std::min(polygon_skin_, rigid_[i].skin) / 2;
  }

  /// Polygons and elements, with the numbers of their surfaces.
  [[nodiscard]] const PlacedShapes& shapes() const { return shapes_; }
  /// x, y (m) and angle of the reference point of a polygon or an element.
  [[nodiscard]] const std::array<double, 3>& pose(SurfaceIndex i) const { return pose_[i]; }
  [[nodiscard]] Vec2 reference(SurfaceIndex i) const { return {pose_[i][0], pose_[i][1]}; }
  [[nodiscard]] Vec2 between(SurfaceIndex a, SurfaceIndex b) const {
    return {pose_[a][0] - pose_[b][0], pose_[a][1] - pose_[b][1]};
  }
  /// Begins to bring a polygon or an element to the cache, but for its coordinates.
  void fetch(SurfaceIndex i) const {
    shapes_.fetch(i);
    __builtin_prefetch(&pose_[i]);
    if (static_cast<size_t>(i) < rigid_.size()) __builtin_prefetch(&rigid_[i]);
  }
  /// The same of a rigid body's place and inertia.
  void fetch_inertia(RigidIndex i) const {
    __builtin_prefetch(&pose_[i]);
    __builtin_prefetch(&rigid_[i]);
  }
  /// Elements; number e of these has the surface rigid_count() + e.
  [[nodiscard]] const ElementSurfaces& elements() const { return elements_; }
  /// Outlines of all bodies, with the numbers of their surfaces.
  [[nodiscard]] const Outlines& outlines() const { return outlines_; }
  [[nodiscard]] Outlines& outlines() { return outlines_; }

 private:
  /// False, and it stays where it is, if it would not be at a finite place.
  bool place_polygon(RigidIndex i, const Kinematics& now, const SineCosine& angle);
  void place_meshes(const Kinematics& now, const Threads& threads);

  double polygon_skin_, mesh_skin_;
  bool collars_;
  std::vector<SurfaceKind> kinds_;
  std::vector<BodyIndex> bodies_;
  int body_count_ = 0;
  /// Of each deformable body.
  struct Body {
    MeshInertia inertia;
    NodeIndex first_node;
    std::vector<Vec2> nodes;  // in the mesh as given, m
  };
  std::vector<Body> deformable_;
  std::vector<Rigid> rigid_;
  std::vector<RigidIndex> moving_;
  std::vector<std::uint8_t> absent_;  // of each body; empty while all are there
  PlacedShapes shapes_;
  std::vector<std::array<double, 3>> pose_;
  ElementSurfaces elements_;
  Outlines outlines_;
};

}  // namespace apothem
