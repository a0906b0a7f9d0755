// The elements at the boundaries of meshes as surfaces of their own, each a convex polygon that
// follows its nodes (the paper, Sec. 3; docs/theory.md, Contact).
//
// The edges of an element's potential follow its corners; the lengths r are those of the undeformed
// mesh. If r followed the deformation without the force of its derivative, the error would be 1e-3
// of the kinetic energy at any step; with this force, corners that touch nothing would be loaded.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/integrals/placed_shapes.hpp"
#include "lib/contact/law/kinematics.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/indices.hpp"
#include "lib/mesh/mesh.hpp"

namespace apothem {

class ElementSurfaces {
 public:
  /// Adds the outermost elements of a mesh, whose first node has the number `first_node`, to
  /// `shapes`. Throws InvalidPolygon if one of them is not convex or cannot have the potential.
  void add(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node, BodyIndex body,
           const PotentialChoice& choice, PlacedShapes& shapes);

  /// Moves the elements in `shapes`, the first of which has the number `first`, and writes the
  /// positions of their first corners to `pose`. Throws NotFinite if a coordinate of a corner is
  /// not finite.
  void place(const Kinematics& now, SurfaceIndex first, PlacedShapes& shapes,
             std::span<std::array<double, 3>> pose);

  [[nodiscard]] int size() const { return static_cast<int>(elements_.size()); }
  [[nodiscard]] BodyIndex body(int element) const { return elements_[element].body; }
  /// False if the element is no longer strictly convex; its shape must not be used then.
  [[nodiscard]] bool convex(int element) const { return elements_[element].convex; }
  [[nodiscard]] std::span<const NodeIndex> nodes(int element) const {
    const Element& e = elements_[element];
    return std::span(nodes_).subspan(e.corners, e.count);
  }
  /// True if the edge from the corner k of an element is on the boundary of the body.
  [[nodiscard]] bool outer(int element, int k) const {
    return outer_[elements_[element].corners + static_cast<size_t>(k)];
  }

  /// The tributary length of a boundary node, m: half the length of the boundary edges at it.
  struct TributaryLength {
    NodeIndex node;
    BodyIndex body;
    double length;
  };
  [[nodiscard]] const std::vector<TributaryLength>& tributary_lengths() const {
    return tributary_lengths_;
  }

 private:
  struct Element {
    BodyIndex body;
    size_t corners, count;  // range in nodes_, start_ and outer_
    bool convex = true;
  };
  std::vector<Element> elements_;
  std::vector<NodeIndex> nodes_;
  std::vector<Vec2> start_;  // positions of the corners in the undeformed mesh, m
  std::vector<char> outer_;
  std::vector<TributaryLength> tributary_lengths_;
  std::vector<Vec2> ring_;
};

}  // namespace apothem
