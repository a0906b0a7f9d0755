// Vectors of the plane, and forces and velocities of a pair of rigid bodies, for formulas with
// numbers or packs of numbers.
#pragma once

#include "lib/archive/archive.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {

/// A normal force has no meaningful direction if its magnitude is below this fraction of the sum of
/// the pressures that it consists of.
inline constexpr double kNoResultant = 1e-9;

/// The direction of friction, (-n_y, n_x) for the direction n of the normal force; zero if there is
/// no normal force.
inline Vec2 tangent_of(const Vec2& normal_force) {
  const double size = normal_force.norm();
  return size > 0 ? Vec2(Vec2(-normal_force.y(), normal_force.x()) / size) : Vec2(Vec2::Zero());
}

/// A vector of the plane.
template <class Real>
struct VectorOf {
  Real x = Real(0.), y = Real(0.);

  friend APOTHEM_INLINE VectorOf operator+(const VectorOf& a, const VectorOf& b) {
    return {a.x + b.x, a.y + b.y};
  }
  friend APOTHEM_INLINE VectorOf operator*(const Real& k, const VectorOf& a) {
    return {k * a.x, k * a.y};
  }
  [[nodiscard]] APOTHEM_INLINE Real dot(const VectorOf& b) const { return x * b.x + y * b.y; }
  [[nodiscard]] APOTHEM_INLINE Real cross(const VectorOf& b) const { return x * b.y - y * b.x; }
  /// The vector turned to the left by a right angle.
  [[nodiscard]] APOTHEM_INLINE VectorOf turned() const { return {-y, x}; }
  [[nodiscard]] APOTHEM_INLINE Real size() const { return square_root(x * x + y * y); }
};

/// A force on the first body of a pair with its moments about both mass centres, N and N m; or the
/// velocity of the first mass centre relative to the second one with both spins, m/s and rad/s.
template <class Real>
struct PairVectorOf {
  Real x = Real(0.), y = Real(0.), a = Real(0.), b = Real(0.);

  friend APOTHEM_INLINE PairVectorOf operator+(const PairVectorOf& p, const PairVectorOf& q) {
    return {p.x + q.x, p.y + q.y, p.a + q.a, p.b + q.b};
  }
  friend APOTHEM_INLINE PairVectorOf operator-(const PairVectorOf& p, const PairVectorOf& q) {
    return {p.x - q.x, p.y - q.y, p.a - q.a, p.b - q.b};
  }
  friend APOTHEM_INLINE PairVectorOf operator*(const Real& k, const PairVectorOf& p) {
    return {k * p.x, k * p.y, k * p.a, k * p.b};
  }
  /// The power of a force at a velocity, W.
  [[nodiscard]] APOTHEM_INLINE Real power(const PairVectorOf& velocity) const {
    return (x * velocity.x + y * velocity.y) + a * velocity.a + b * velocity.b;
  }
  [[nodiscard]] APOTHEM_INLINE VectorOf<Real> plane() const { return {x, y}; }
  /// The entries where the mask is true, and 0 elsewhere.
  [[nodiscard]] APOTHEM_INLINE PairVectorOf where(const Truth<Real>& mask) const {
    return {select(mask, x, Real(0.)), select(mask, y, Real(0.)), select(mask, a, Real(0.)),
            select(mask, b, Real(0.))};
  }
  void fields(Archive& archive) { archive("x", x)("y", y)("a", a)("b", b); }
};

using PairForce = PairVectorOf<double>;
using PairRate = PairVectorOf<double>;

}  // namespace apothem
