// What the integers that number things count. Each is an int; its name says of what.
#pragma once

namespace apothem {

using BodyIndex = int;        ///< among all bodies: the rigid ones first, then the deformable ones
using RigidIndex = int;       ///< among the rigid bodies; the same number as their BodyIndex
using DeformableIndex = int;  ///< among the deformable bodies
using MaterialIndex = int;    ///< among the materials of the model
using NodeIndex = int;        ///< among the nodes of all meshes, one mesh after the other
using ElementIndex = int;     ///< among the elements of one mesh
using SurfaceIndex = int;     ///< among the surfaces of the contact (contact/surfaces.hpp)

}  // namespace apothem
