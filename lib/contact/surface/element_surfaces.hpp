// The elements at the boundaries of meshes as surfaces of their own, each a convex polygon that
// follows its nodes (the paper, Sec. 3; docs/theory.md, Contact).
//
// The edges of an element's potential follow its corners; its lengths r are those of the mesh as
// given. An r that follows the deformation without the force of its derivative costs 1e-3 of the
// kinetic energy at any step, and its derivative would act on corners that touch nothing.
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
  /// Adds the outermost elements of a mesh whose node 0 has the number `first_node` to `shapes`.
  /// Throws InvalidPolygon if one of them is not convex or cannot have the potential.
  void add(const Mesh& mesh, const Boundary& boundary, NodeIndex first_node, BodyIndex body,
           const PotentialChoice& choice, PlacedShapes& shapes);

  /// Moves the elements in `shapes`, the first of which has the number `first`, and writes the
  /// place of their first corners to `pose`. Throws NotFinite if a corner is not at a finite
  /// place.
  void place(const Kinematics& now, SurfaceIndex first, PlacedShapes& shapes,
             std::span<std::array<double, 3>> pose);

  [[nodiscard]] int size() const { return static_cast<int>(elements_.size()); }
  [[nodiscard]] BodyIndex body(int element) const { return elements_[element].body; }
  /// False if the element has lost its strict convexity: its shape must not be used then.
  [[nodiscard]] bool convex(int element) const { return elements_[element].convex; }
  [[nodiscard]] std::span<const NodeIndex> nodes(int element) const {
    const Element& e = elements_[element];
    return std::span(nodes_).subspan(e.corners, e.count);
  }
  /// True if the edge from the corner k of an element is on the boundary of the body.
  [[nodiscard]] bool outer(int element, int k) const {
    return outer_[elements_[element].corners + static_cast<size_t>(k)];
  }

  /// A node on a boundary and half the length of the boundary's edges at it, m.
  struct Share {
    NodeIndex node;
    BodyIndex body;
    double length;
  };
  [[nodiscard]] const std::vector<Share>& shares() const { return shares_; }

 private:
  struct Element {
    BodyIndex body;
    size_t corners, count;  // in nodes_, start_ and outer_
    bool convex = true;
  };
  std::vector<Element> elements_;
  std::vector<NodeIndex> nodes_;
  std::vector<Vec2> start_;  // places of the corners in the mesh as given, m
  std::vector<char> outer_;
  std::vector<Share> shares_;
  std::vector<Vec2> ring_;
};

}  // namespace apothem
