// A contact: where the boundaries of two bodies touch, as the kernels find it.
#pragma once

#include "geometry/polygon/point.hpp"
#include "lib/archive/archive.hpp"
#include "lib/mesh/indices.hpp"

namespace apothem {

/// The kernels there are (kernel.hpp). A law of friction has the number of its kernel.
enum KernelKind { polygon_kernel, element_kernel, outline_kernel, kernel_kinds };

/// One record for every kernel. `a` and `b` are two surfaces, or an edge and a face of outlines;
/// what else the kernel knows about the contact stands in its own list, in the same order.
struct Contact {
  KernelKind kernel;
  int a, b;
  double depth;      ///< the penetration is at least this, m, and
  double at_most;    ///< at most this, m; where both are equal it is known
  double share;      ///< of the depth at which the potential ends; 1 or more: there or beyond
  double stiffness;  ///< bound of the change of the force over the depth, N/m (docs/theory.md,
                     ///< Normal contact)
};

/// What acts in one contact patch, a connected part of the overlap of two bodies. Forces act on a.
struct ContactRecord {
  BodyIndex a, b;                  ///< a < b
  Vec2 point = Vec2::Zero();       ///< loading point relative to the origin of the model, m
  Vec2 normal = Vec2::Zero();      ///< elastic normal force, N
  Vec2 tangential = Vec2::Zero();  ///< friction, N
  double penetration = 0;          ///< how deep the bodies are in each other, m: see Kernel
  double phi = 0;                  ///< largest potential met
  Vec2 damping = Vec2::Zero();     ///< damping of the normal force, N
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
