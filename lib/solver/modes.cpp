#include "lib/solver/modes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/solver/eigen_pairs.hpp"
#include "lib/solver/symmetric_system.hpp"

namespace apothem {
namespace {

using Vector = SymmetricSystem::Vector;
using Matrix = Eigen::MatrixXd;

constexpr Eigen::Index kDense = 120;  // coordinates up to which dense matrices are faster
constexpr int kShareOfDense = 3;      // of many modes likewise: those asked for times that
constexpr int kMostPasses = 40;       // of the Lanczos method, until no mode is missing
constexpr double kBeyond = 1e-7;      // of an eigenvalue: nearer ones count as multiple
constexpr double kShiftRatio = 4;     // up to which a shift is sought
constexpr int kInverseSteps = 4;      // for small eigenvalues
constexpr double kNothing = 1e-9;     // of what may be rounding: what vectors of others leave
constexpr double kNearer = 1e-3;      // their shift, of that of the others
constexpr double kDependent = 1e-6;   // of the norm: what is left of a dependent vector

struct EigenPair {
  double value;
  Vector vector;
};

// The largest pairs of M^1/2 (K - s M)^-1 M^1/2, whose eigenvalues are 1/(w^2 - s), without those
// that are known.
EigenPairs largest_inverse_pairs(const SymmetricSystem& system, Eigen::Index count,
                                 const std::vector<EigenPair>& known) {
  const Vector root = system.mass().cwiseSqrt();
  const Eigen::Index size = system.size();
  const auto inverse = [&](const double* in, double* out) {
    const Vector x = Eigen::Map<const Vector>(in, size);
    Vector y = root.cwiseProduct(system.solve(root.cwiseProduct(x)));
    for (const EigenPair& p : known) y -= p.value * p.vector.dot(x) * p.vector;
    Eigen::Map<Vector>(out, size) = y;
  };
  return largest_pairs(size, count, inverse,
                       [&](const double* in, double* out) { std::copy_n(in, size, out); });
}

// Puts eigenvalues of several passes in order: by w^2 in ascending order.
void sort_by_value(std::vector<EigenPair>& pairs) {
  std::ranges::stable_sort(pairs, {}, &EigenPair::value);
}

// The `need` lowest eigenvalues above the shift, below which there are `base` ones. The pairs have
// w^2 and vectors M^1/2 phi.
std::vector<EigenPair> lowest_above(SymmetricSystem& system, double shift, int base, int need) {
  std::vector<EigenPair> found;
  int wanted = need;
  for (int pass = 0; pass < kMostPasses && wanted > 0; ++pass) {
    const double at = system.shift(shift);
    std::vector<EigenPair> known;
    known.reserve(found.size());
    for (const EigenPair& p : found) known.push_back({1 / (p.value - at), p.vector});
    const Eigen::Index most = std::min<Eigen::Index>(wanted, system.size() - 1);
    const auto [values, vectors] = largest_inverse_pairs(system, most, known);
    const size_t before = found.size();
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (values[i] > 0) found.push_back({at + 1 / values[i], vectors.col(i).normalized()});
    }
    sort_by_value(found);
    if (found.empty()) break;
    const size_t last = std::min(found.size(), static_cast<size_t>(need)) - 1;
    const double highest = found[last].value * (1 + kBeyond);
    const auto below =
        std::ranges::count_if(found, [&](const EigenPair& p) { return p.value <= highest; });
    const int missing = system.count_below(highest) - base - static_cast<int>(below);
    wanted = std::max(missing, need - static_cast<int>(found.size()));
    if (found.size() == before && missing <= 0) break;
  }
  if (static_cast<int>(found.size()) > need) found.resize(static_cast<size_t>(need));
  return found;
}

// The shift of this sign that is next to the eigenvalues behind it, to a factor: the largest one
// below which there are no more than `base` eigenvalues.
double shift_below(SymmetricSystem& system, double sign, int base) {
  double low = system.least(), high = 2 * system.bound() + low;  // sizes
  const auto fits = [&](double size) { return system.count_below(sign * size) <= base; };
  while (high / low > kShiftRatio) {
    const double middle = std::sqrt(low * high);
    (fits(middle) == (sign > 0) ? low : high) = middle;
  }
  return sign > 0 ? low : -high;
}

// Removes from y what lies in the space of these vectors; false if nothing is left.
bool make_orthonormal(const std::vector<EigenPair>& basis, Vector& y) {
  const double before = y.norm();
  for (int again = 0; again < 2; ++again) {
    for (const EigenPair& p : basis) y -= p.vector.dot(y) * p.vector;
  }
  if (!(y.norm() > kDependent * before)) return false;
  y.normalize();
  return true;
}

// Vectors M^1/2 (1, 0), M^1/2 (0, 1): all coordinates along x, and along y.
Vector translation(const SymmetricSystem& system, const ModalSystem& of, int axis) {
  std::vector<double> along(of.moves.size(), 0);
  Vector y = Vector::Zero(system.size());
  Eigen::Index i = 0;
  for (size_t c = 0; c < of.moves.size(); ++c) {
    if (of.moves[c] == 0) continue;
    const bool in_body = c < of.rigid;
    const size_t of_point = in_body ? c % 3 : (c - of.rigid) % 2;
    y[i] = of_point == static_cast<size_t>(axis) ? std::sqrt(system.mass()[i]) : 0;
    ++i;
  }
  return y;
}

// An orthonormal basis of the space of `vectors` that begins with the translations, as far as they
// lie in it.
std::vector<EigenPair> aligned(const SymmetricSystem& system, const ModalSystem& of,
                               const std::vector<EigenPair>& vectors) {
  std::vector<EigenPair> basis;
  const auto add = [&](const Vector& y) {
    Vector part = Vector::Zero(y.size());
    for (const EigenPair& p : vectors) part += p.vector.dot(y) * p.vector;
    if (part.norm() < kDependent * y.norm()) return;
    if (make_orthonormal(basis, part)) basis.push_back({0, part});
  };
  for (const int axis : {0, 1}) add(translation(system, of, axis));
  for (const EigenPair& p : vectors) {
    if (basis.size() < vectors.size()) add(p.vector);
  }
  return basis;
}

// The space of the small eigenvalues, by inverse iteration with a shift between them and all
// others.
std::vector<EigenPair> small_pairs(SymmetricSystem& system, int count, double shift) {
  system.shift(-shift);
  const Vector root = system.mass().cwiseSqrt();
  std::vector<EigenPair> basis;
  for (int i = 0; i < count; ++i) {
    Vector y(system.size());
    for (Eigen::Index k = 0; k < y.size(); ++k) {
      y[k] = std::sin(1. + 0.7 * (i + 1) * double(k % 1009) + 0.31 * double(k % 97) * (i + 2));
    }
    basis.push_back({0, y});
  }
  for (int step = 0; step < kInverseSteps; ++step) {
    std::vector<EigenPair> next;
    for (const EigenPair& p : basis) {
      Vector y = root.cwiseProduct(system.solve(root.cwiseProduct(p.vector)));
      if (make_orthonormal(next, y)) next.push_back({0, y});
    }
    basis = std::move(next);
  }
  return basis;
}

Matrix dense_scaled(const SymmetricSystem& system) {
  const Vector inverse_root = system.mass().cwiseSqrt().cwiseInverse();
  return inverse_root.asDiagonal() * Matrix(system.matrix()) * inverse_root.asDiagonal();
}

bool is_dense(Eigen::Index size, int count) {
  return size <= kDense || static_cast<Eigen::Index>(count) * kShareOfDense >= size;
}

// The pairs with the lowest eigenvalues: below -least, within it, and above it.
struct Parts {
  int below = 0, within = 0;  // numbers of all such eigenvalues
  std::vector<EigenPair> negative, small, positive;
};

Parts dense_parts(const SymmetricSystem& system) {
  const EigenPairs all = dense_pairs(dense_scaled(system));
  const double least = system.least();
  Parts parts;
  for (Eigen::Index i = 0; i < system.size(); ++i) {
    const double value = all.values[i];
    auto& part = value < -least ? parts.negative : value < least ? parts.small : parts.positive;
    part.push_back({value, all.vectors.col(i)});
  }
  parts.below = static_cast<int>(parts.negative.size());
  parts.within = static_cast<int>(parts.small.size());
  return parts;
}

Parts sparse_parts(SymmetricSystem& system, int count) {
  Parts parts;
  parts.below = system.count_below(-system.least());
  const int base = system.count_below(system.least());
  parts.within = base - parts.below;
  if (parts.below > 0) {
    parts.negative =
        lowest_above(system, shift_below(system, -1, 0), 0, std::min(parts.below, count));
  }
  const int others = std::min(count, static_cast<int>(system.size()) - base);
  const double shift = others > 0 ? shift_below(system, 1, base) : system.least();
  if (parts.within > 0 && parts.within <= kMostRigidShapes) {
    parts.small = small_pairs(system, parts.within, std::max(system.least(), kNearer * shift));
  }
  if (others > 0) parts.positive = lowest_above(system, shift, base, others);
  return parts;
}

// Sorts out which of the small eigenvalues are more than rounding, each mode by its own stiffness:
// a soft body beside a stiff one vibrates or is unstable as well. Returns those that are rounding.
std::vector<EigenPair> sort_small(const SymmetricSystem& system, Parts& parts) {
  const auto n = static_cast<Eigen::Index>(parts.small.size());
  if (n == 0) return {};
  Matrix vectors(system.size(), n);
  for (Eigen::Index i = 0; i < n; ++i) vectors.col(i) = parts.small[static_cast<size_t>(i)].vector;
  const Vector inverse_root = system.mass().cwiseSqrt().cwiseInverse();
  const Matrix shapes = inverse_root.asDiagonal() * vectors;
  const Matrix stiffness = shapes.transpose() * (system.matrix() * shapes);
  const EigenPairs pairs = dense_pairs((stiffness + stiffness.transpose()) / 2);
  std::vector<EigenPair> rounding;
  std::vector<EigenPair> soft;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector part = pairs.vectors.col(i), shape = shapes * part;
    const double value = pairs.values[i];
    const double rounded = shape.cwiseProduct(system.rounding()).dot(shape);
    const bool known = std::abs(value) > std::max(rounded, kNothing * system.least());
    (!known ? rounding : value < 0 ? parts.negative : soft).push_back({value, vectors * part});
  }
  sort_by_value(parts.negative);
  parts.positive.insert(parts.positive.begin(), soft.begin(), soft.end());
  parts.below += parts.within - static_cast<int>(rounding.size() + soft.size());
  parts.within = static_cast<int>(rounding.size());
  return rounding;
}

}  // namespace

VibrationModes vibration_modes(const Tangent& tangent, const ModalSystem& of, int count) {
  SymmetricSystem system(tangent, of);
  VibrationModes result;
  result.coordinates = static_cast<int>(system.size());
  result.skew = system.skew();
  if (system.size() == 0) return result;
  if (!std::isfinite(system.bound())) throw NoModes("the stiffness matrix is not finite");
  Parts parts = is_dense(system.size(), count) ? dense_parts(system) : sparse_parts(system, count);
  std::vector<EigenPair> zero;
  if (parts.within <= kMostRigidShapes) zero = aligned(system, of, sort_small(system, parts));
  result.unstable = parts.below;
  result.rigid = parts.within;
  const auto most = static_cast<size_t>(count);
  if (parts.negative.size() > most) parts.negative.resize(most);
  parts.positive.resize(std::min(parts.positive.size(), most - parts.negative.size()));
  const Vector inverse_root = system.mass().cwiseSqrt().cwiseInverse();
  for (const auto* part :
       {&std::as_const(parts.negative), &std::as_const(zero), &std::as_const(parts.positive)}) {
    for (const EigenPair& p : *part) {
      result.modes.push_back(
          {part == &zero ? 0 : p.value, system.shape(inverse_root.cwiseProduct(p.vector))});
    }
  }
  return result;
}

}  // namespace apothem
