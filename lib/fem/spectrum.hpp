// The highest frequency of a mesh, which limits the step of explicit integration.
#pragma once

#include <span>

#include "fem/finite_elements.hpp"

namespace apothem {

/// The largest eigenvalue w^2, 1/s^2, of the elastic stiffness against the lumped mass at the
/// displacements u, from above by less than 2 %: Lanczos' method (G. Golub, C. Van Loan, Matrix
/// Computations, Sec. 10.1) with the internal force as the product, plus the residual of its
/// answer. `inverse_mass` per coordinate, 1/kg, 0 where a coordinate is held.
double largest_eigenvalue(FiniteElements& elements, std::span<const double> u,
                          std::span<const double> inverse_mass);

}  // namespace apothem
