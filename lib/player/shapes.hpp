// Private header: the shapes of the bodies of a run, each as it is in the first frame that has it.
#pragma once

#include <array>
#include <vector>

#include "lib/output/run_folder.hpp"

namespace apothem {

/// Shapes of bodies. Nodes and elements of all meshed bodies are numbered one body after the other,
/// in the order in which frames first show the bodies.
struct Shapes {
  /// A body: rigid ones have a ring, and behind it those of its holes; meshed ones have elements.
  struct Body {
    bool known = false;  ///< whether a frame has shown it
    bool meshed = false;
    int material = 0;
    double area = 0;                                 ///< m^2
    double radius = 0;                               ///< of the circle about the centroid, m
    std::vector<Vec2> ring = {};                     ///< about the centroid, before any rotation, m
    std::vector<int> holes = {};                     ///< where rings of holes begin in `ring`
    std::vector<std::array<int, 3>> triangles = {};  ///< corners of the rings
    int first_node = 0, first_element = 0;
  };
  /// An element of a meshed body; numbers of nodes.
  struct Element {
    int body = 0;
    int material = 0;
    std::vector<int> nodes;
    std::vector<std::array<int, 3>> triangles;
  };
  /// An edge of a meshed body.
  struct Edge {
    int body = 0;
    std::array<int, 2> nodes{};
  };

  std::vector<Body> bodies;
  std::vector<Element> elements;
  std::vector<Edge> boundary, inner;  ///< edges of one element, and between two
  int nodes = 0;
};

/// The shapes in all frames. Reads no more frames than it takes to see every body.
Shapes read_shapes(const RunFolder& run);

/// The element of a frame that a rigid body is, or the first element of a meshed one, and the
/// lowest of the body's nodes; -1 if the body is not in the frame.
struct FramePart {
  int element = -1, elements = 0;
  int node = -1;
};
std::vector<FramePart> parts_of(const Frame& frame);

/// Centroid (m) and area (m^2) of a polygon: an outer ring and holes, clockwise.
struct RingMeasure {
  Vec2 centroid = Vec2::Zero();
  double area = 0;
};
RingMeasure measure(const Rings& rings);

/// The rings of an element where they are in the frame, m.
Rings rings_of(const Frame& frame, int element);

}  // namespace apothem
