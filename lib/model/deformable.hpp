// A body of finite elements, with its supports and loads.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lib/fem/kinds.hpp"
#include "lib/mesh/indices.hpp"
#include "lib/mesh/mesh.hpp"
#include "lib/model/history.hpp"

namespace apothem {

/// Coordinates of nodes that the scene moves, or holds: their velocity is given.
struct Support {
  std::vector<int> nodes;
  std::array<bool, 2> held{};  ///< x, y
  MotionHistory motion;        ///< empty: at rest
  Vec2 pivot = Vec2::Zero();   ///< in model coordinates: the point that it moves, and turns about
};

/// Forces that keep their direction.
struct DeadLoad {
  std::vector<int> nodes;
  std::vector<Vec2> forces;  ///< N on each node, at factor 1
  LoadHistory history;
};

/// Pressure on edges, along their normals as they deform.
struct PressureLoad {
  std::vector<std::array<int, 2>> edges;  ///< directed with the body on their left
  double pressure;                        ///< Pa, at factor 1
  LoadHistory history;
};

struct DeformableBody {
  std::string name;
  MaterialIndex material = 0;  ///< of the body in contact, and of its elements
  /// Of each element, where they are not all of the body's material; otherwise empty.
  std::vector<MaterialIndex> element_material = {};
  ElementKind element = ElementKind::quad4;
  Mesh mesh;                 ///< in model coordinates, along a space-filling curve
  NodeIndex first_node = 0;  ///< in the nodal arrays of the state
  std::vector<Support> supports;
  std::vector<DeadLoad> dead_loads;
  std::vector<PressureLoad> pressures;
  Vec2 velocity = Vec2::Zero();  ///< m/s, at time 0
  double spin = 0;               ///< rad/s, about the mass centre
  /// Of the nodes at time 0, x and y, m and m/s; empty: as the mesh, `velocity` and `spin` say.
  std::vector<double> displacement = {}, node_velocity = {};

  [[nodiscard]] MaterialIndex material_of(ElementIndex e) const {
    return element_material.empty() ? material : element_material[static_cast<size_t>(e)];
  }
  /// The materials of all elements, each once, in ascending order.
  [[nodiscard]] std::vector<MaterialIndex> materials() const;
};

/// A point of a deformable body: the weighted mean of nodes; its stress is that of an element.
struct TrackedPoint {
  std::string name;  ///< heads its columns
  DeformableIndex body = 0;
  ElementIndex element = 0;  ///< of its mesh, the one that holds the point
  std::vector<NodeIndex> nodes;
  std::vector<double> weights;
};

}  // namespace apothem
