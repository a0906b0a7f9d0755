// Linear buckling: (K_0 + f K_s) phi = 0 with K_s = K_1 - K_0.
#include <algorithm>
#include <cmath>

#include "lib/solver/eigen_pairs.hpp"
#include "lib/solver/symmetric_system.hpp"

namespace apothem {
namespace {

using Vector = SymmetricSystem::Vector;
using Sparse = Eigen::SparseMatrix<double>;

constexpr Eigen::Index kDenseBuckling = 120;  // coordinates up to which dense matrices are faster
constexpr double kTension = 1e-11;  // above 1, of eigenvalues of the inverse: what is no tension
constexpr int kMostRounds = 20;
constexpr double kAbove = 1e-6;  // of a factor: nearer ones count as multiple
constexpr int kMostTriesOfFactor = 8;
constexpr double kStride = 8, kBracket = 1.5;  // ratios of factors that are tried
constexpr double kLargestFactor = 1e9;

struct Buckle {
  double factor;
  Vector shape;  // of the norm 1 in K_0
};

// The largest pairs of (K_0 + s K_s)^-1 K_0, which is symmetric in the inner product of K_0,
// without those that are known: the eigenvalues f/(f - s) are largest for the factors f next above
// s.
EigenPairs next_pairs(const Sparse& base, const SymmetricSystem& inverse, double shift,
                      Eigen::Index count, const std::vector<Buckle>& known) {
  const Eigen::Index size = base.rows();
  const auto matrix = [&](const double* in, double* out) {
    const Vector b = base * Eigen::Map<const Vector>(in, size);
    Vector x = inverse.solve(b);
    for (const Buckle& k : known) x -= k.factor / (k.factor - shift) * k.shape.dot(b) * k.shape;
    Eigen::Map<Vector>(out, size) = x;
  };
  return largest_pairs(size, count, matrix, [&](const double* in, double* out) {
    Eigen::Map<Vector>(out, size) = base * Eigen::Map<const Vector>(in, size);
  });
}

void refuse_soft(SymmetricSystem& system) {
  if (system.count_below(system.least()) > 0) {
    throw NoModes(
        "where the loads begin, there are motions that nothing resists: support what can move "
        "freely");
  }
}

// The positive factors, ascending.
std::vector<Buckle> dense_buckles(const Sparse& change, const Sparse& base) {
  const EigenPairs all = dense_pairs(Eigen::MatrixXd(change), Eigen::MatrixXd(base));
  std::vector<Buckle> found;
  for (Eigen::Index i = 0; i < base.rows() && all.values[i] < 0; ++i) {
    found.push_back({-1 / all.values[i], all.vectors.col(i)});
  }
  return found;
}

// The stiffness under several loads.
class LoadPath {
 public:
  LoadPath(const Tangent& unloaded, const Tangent& loaded, const ModalSystem& of)
      : unloaded_(unloaded), loaded_(loaded), of_(of) {}
  /// K_0 + f (K_1 - K_0), factorised; with a factor that is a little larger where need be.
  [[nodiscard]] SymmetricSystem at(double& f) const {
    for (int tries = 0; tries < kMostTriesOfFactor; ++tries, f *= 1 + kAbove) {
      Tangent sum;
      add(unloaded_, 1 - f, sum);
      add(loaded_, f, sum);
      SymmetricSystem system(sum, of_);
      if (system.factorise(Vector::Zero(system.size()))) return system;
    }
    throw NoModes("the stiffness matrix under the loads has no useful factors");
  }
  /// The number of factors between 0 and f: of negative eigenvalues.
  [[nodiscard]] int factors_below(double f) const { return at(f).negative(); }

 private:
  static void add(const Tangent& part, double times, Tangent& sum) {
    for (const Tangent::Entry& e : part.entries()) {
      sum.add(static_cast<size_t>(e.row), static_cast<size_t>(e.column), times * e.value);
    }
  }
  const Tangent& unloaded_;
  const Tangent& loaded_;
  const ModalSystem& of_;
};

// A number below the lowest factor, up to that ratio; 0 if there is none up to kLargestFactor.
double shift_of(const LoadPath& path) {
  double low = 1;
  while (path.factors_below(low) > 0) low /= kStride;
  double high = kStride * low;
  while (path.factors_below(high) == 0) {
    low = high, high *= kStride;
    if (high > kLargestFactor) return 0;
  }
  while (high / low > kBracket) {
    const double middle = std::sqrt(low * high);
    (path.factors_below(middle) == 0 ? low : high) = middle;
  }
  return low;
}

// The lowest ones, which may be multiple: what is found is taken out and looked for again, until
// the number of factors says that none is missing.
std::vector<Buckle> lowest_buckles(const SymmetricSystem& base, const LoadPath& path, int count) {
  std::vector<Buckle> found;
  double shift = shift_of(path);
  if (shift == 0) return found;
  const SymmetricSystem inverse = path.at(shift);
  int wanted = count;
  for (int round = 0; round < kMostRounds && wanted > 0; ++round) {
    const Eigen::Index most = std::min<Eigen::Index>(wanted, base.size() - 1);
    const auto [values, vectors] = next_pairs(base.matrix(), inverse, shift, most, found);
    const size_t before = found.size();
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (!(values[i] > 1 + kTension)) continue;  // of tension
      const Vector shape = vectors.col(i);
      found.push_back({shift * values[i] / (values[i] - 1),
                       shape / std::sqrt(shape.dot(base.matrix() * shape))});
    }
    if (found.size() == before) break;
    std::ranges::stable_sort(found, {}, &Buckle::factor);
    const size_t last = std::min(found.size(), static_cast<size_t>(count)) - 1;
    const double highest = found[last].factor * (1 + kAbove);
    const auto below =
        std::ranges::count_if(found, [&](const Buckle& b) { return b.factor <= highest; });
    wanted = path.factors_below(highest) - static_cast<int>(below);
  }
  return found;
}

}  // namespace

std::vector<Mode> buckling_modes(const Tangent& unloaded, const Tangent& loaded,
                                 const ModalSystem& of, int count) {
  SymmetricSystem base(unloaded, of);
  if (base.size() == 0) return {};
  refuse_soft(base);
  const SymmetricSystem end(loaded, of);
  const Sparse change = end.matrix() - base.matrix();
  const std::vector<Buckle> found =
      base.size() <= kDenseBuckling || 3 * static_cast<Eigen::Index>(count) >= base.size()
          ? dense_buckles(change, base.matrix())
          : lowest_buckles(base, LoadPath(unloaded, loaded, of), count);
  // A change of the stiffness that rounding may have made says nothing.
  const Vector rounding = base.rounding() + end.rounding();
  std::vector<Mode> modes;
  for (const Buckle& b : found) {
    const double rounded = b.shape.cwiseProduct(rounding).dot(b.shape);
    const double stiffness = b.shape.dot(base.matrix() * b.shape);
    if (stiffness < rounded * b.factor || static_cast<int>(modes.size()) == count) break;
    modes.push_back({b.factor, base.shape(b.shape)});
  }
  return modes;
}

}  // namespace apothem
