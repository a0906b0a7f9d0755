// A contact is a place where the boundaries of two bodies touch, as a kernel finds it.
#pragma once

#include "geometry/polygon/point.hpp"
#include "lib/archive/archive.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// The kinds of kernels (kernel.hpp). The friction law of a kernel has the same number.
enum KernelKind { polygon_kernel, element_kernel, outline_kernel, kernel_kinds };

/// The record that all kernels share. `a` and `b` are two surfaces, or an edge and a face of
/// outlines. Whatever else a kernel knows about a contact is kept in a list of its own, in the same
/// order.
struct Contact {
  KernelKind kernel;
  int a, b;
  double depth;    ///< lower bound of the penetration, m
  double at_most;  ///< upper bound, m; the penetration is known if both are equal
  /// Depth over the depth at which the potential ends; out of range from 1 on.
  double relative_depth;
  double stiffness;  ///< upper bound of the derivative of the force by the depth, N/m
                     ///< (docs/theory.md, Normal contact)
};

/// The forces in one contact patch, which is a connected part of the overlap of two bodies. Forces
/// act on a.
struct ContactRecord {
  BodyIndex a, b;                  ///< a < b
  Vec2 point = Vec2::Zero();       ///< loading point relative to the origin of the model, m
  Vec2 normal = Vec2::Zero();      ///< elastic normal force, N
  Vec2 tangential = Vec2::Zero();  ///< friction, N
  double penetration = 0;          ///< penetration of the bodies, m, see Kernel
  double phi = 0;                  ///< largest potential in the patch
  Vec2 damping = Vec2::Zero();     ///< normal force of the dashpots, N
};

/// A resultant on a body: force and moment about the mass centre of a rigid body.
struct Resultant {
  Vec2 force = Vec2::Zero();  ///< N
  double moment = 0;          ///< N m
  void fields(Archive& archive) { archive("force", force)("moment", moment); }
};

/// An edge of a boundary that takes part in contact of deformable bodies.
struct SurfaceRecord {
  BodyIndex body;
  Vec2 from, to;        ///< relative to the origin of the model, m
  double pressure = 0;  ///< mean normal pressure, Pa
  double traction = 0;  ///< mean friction along the edge, Pa
};

}  // namespace apothem
