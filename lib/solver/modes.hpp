// Modes: eigenvalues and eigenvectors of sparse symmetric matrices.
//
//   vibration  K phi = w^2 M phi, M diagonal, by shift and invert
//   buckling   (K_0 + f (K_1 - K_0)) phi = 0, K_0 positive definite, likewise
//
// The lowest ones are found by the Lanczos method with implicit restarts (Spectra), which needs
// products and solutions with sparse factors only. A Lanczos run may miss
// copies of multiple eigenvalues. So the number of eigenvalues below the highest one that has been
// found is compared with the number of negative pivots there (Sylvester's law of inertia), and
// what is missing is looked for again, with the known ones taken out (K. J. Bathe, Finite Element
// Procedures, 2014, Sec. 11.6).
#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "lib/solver/tangent.hpp"

namespace apothem {

/// The coordinates of a system; see LinearSolver.
struct ModalSystem {
  size_t rigid = 0;                 ///< number of the first coordinates, those of rigid bodies
  std::vector<std::uint8_t> moves;  ///< of each coordinate: whether it belongs to the system
  std::vector<double> mass;         ///< of each coordinate, kg and kg m^2; positive where it moves
};

struct Mode {
  double eigenvalue = 0;  ///< w^2, 1/s^2; of buckling the factor f
  /// Of all coordinates; 0 where they do not belong to the system. phi^T M phi = 1, and the entry
  /// that is largest in size is positive.
  std::vector<double> shape;
};

struct VibrationModes {
  int coordinates = 0;  ///< of the system
  int unstable = 0;     ///< eigenvalues below zero
  int rigid = 0;        ///< eigenvalues that are zero up to the rounding of K
  /// Ascending: unstable ones, zero ones (with the eigenvalue 0), others.
  std::vector<Mode> modes;
  /// Norm of the part of K that is not symmetric over that of K.
  double skew = 0;
};

/// The eigenvalues cannot be told apart from the rounding of the matrices. The message says how.
class NoModes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Zero modes whose shapes are found, at most. Where there are more, their number is found alone.
inline constexpr int kMostRigidShapes = 60;

/// The lowest `count` modes of vibration, unstable ones first among them, and the zero modes
/// besides. The zero modes are orthogonal, and the first ones of them are as far as possible the
/// joint translations along x and y. K is the symmetric part of `tangent`. Throws NoModes.
VibrationModes vibration_modes(const Tangent& tangent, const ModalSystem& system, int count);

/// The buckling modes with the `count` smallest positive factors, ascending; fewer if there are
/// fewer. Throws NoModes if K_0 is not positive definite. The mass only scales the shapes.
std::vector<Mode> buckling_modes(const Tangent& unloaded, const Tangent& loaded,
                                 const ModalSystem& system, int count);

}  // namespace apothem
