// The highest natural frequency of a mesh, which limits the time step of explicit integration.
#pragma once

#include <span>

#include "lib/fem/finite_elements.hpp"

namespace apothem {

/// An upper bound, less than 2 % above the value, of the largest eigenvalue omega^2, 1/s^2, of the
/// elastic stiffness against the lumped mass at the displacements `u` (m). Lanczos' method (G.
/// Golub, C. Van Loan, Matrix Computations, Sec. 10.1) in which differences of the internal force
/// replace the matrix-vector product, plus the residual of its result. `inverse_mass`, 1/kg, has
/// one entry per degree of freedom, 0 where a support holds it.
double largest_eigenvalue(FiniteElements& elements, std::span<const double> u,
                          std::span<const double> inverse_mass);

}  // namespace apothem
