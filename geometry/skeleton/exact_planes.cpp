#include "geometry/skeleton/exact_planes.hpp"

#include <algorithm>
#include <climits>
#include <cmath>

namespace apothem {
namespace {

using Whole = boost::multiprecision::mpz_int;

// A double is a whole number of 53 bits times a power of two.
constexpr int kDigits = 53;

// The exponent of the last bit of a number that is not zero.
int last_bit(double value) {
  int exponent = 0;
  auto digits = static_cast<long long>(std::ldexp(std::frexp(value, &exponent), kDigits));
  exponent -= kDigits;
  for (; digits % 2 == 0; digits /= 2) ++exponent;
  return exponent;
}

Whole whole(double value, int unit) {
  if (value == 0) return 0;
  const int exponent = last_bit(value);
  Whole result(static_cast<long long>(std::ldexp(value, -exponent)));
  result <<= exponent - unit;
  return result;
}

}  // namespace

ExactPlanes::ExactPlanes(const Polygon& polygon) {
  int unit = INT_MAX;
  for (const Vec2& v : polygon.vertices()) {
    for (const double value : v) {
      if (value != 0) unit = std::min(unit, last_bit(value));
    }
  }
  const int n = polygon.size();
  std::vector<std::array<Whole, 2>> points;
  for (const Vec2& v : polygon.vertices())
    points.push_back({whole(v.x(), unit), whole(v.y(), unit)});
  for (int v = n - 1; v >= 0; --v) {  // small numbers make small products
    points[v][0] -= points[0][0];
    points[v][1] -= points[0][1];
  }
  planes_.resize(2 * static_cast<size_t>(n));
  for (int e = 0; e < n; ++e) {
    const auto& [x, y] = points[e];
    const auto& [end_x, end_y] = points[polygon.next(e)];
    const Whole dx = end_x - x;
    const Whole dy = end_y - y;
    planes_[e] = {-dy, dx, dx * y - dy * x, dx * dx + dy * dy};
    planes_[n + e] = {dx, dy, dx * x + dy * y, 0};
  }
}

bool ExactPlanes::concurrent(const std::vector<int>& planes) const {
  const size_t count = planes.size();
  for (size_t i = 1; i < count; ++i) {
    for (size_t k = i + 1; k < count; ++k) {
      if (!independent(planes[0], planes[i], planes[k])) continue;
      return std::all_of(planes.begin() + 1, planes.end(), [&](int plane) {
        return plane == planes[i] || plane == planes[k] ||
               passes(plane, planes[0], planes[i], planes[k]);
      });
    }
  }
  return true;
}

bool ExactPlanes::independent(int p, int q, int r) const {
  const Plane &a = planes_[p], &b = planes_[q], &c = planes_[r];
  const auto cross = [](const Plane& u, const Plane& v) -> Whole { return u.a * v.b - u.b * v.a; };
  return !is_zero({{cross(b, c), a.m}, {cross(c, a), b.m}, {cross(a, b), c.m}});
}

bool ExactPlanes::passes(int plane, int p, int q, int r) const {
  const Plane &a = planes_[p], &b = planes_[q], &c = planes_[r], &d = planes_[plane];
  return is_zero({{minor(b, c, d), a.m},
                  {-minor(a, c, d), b.m},
                  {minor(a, b, d), c.m},
                  {-minor(a, b, c), d.m}});
}

bool ExactPlanes::parallel(int e, int f) const {
  return planes_[e].a * planes_[f].b == planes_[e].b * planes_[f].a;
}

bool ExactPlanes::is_zero(const Roots& sum) {
  struct Class {
    Whole radicand, factors;  // the sum in this class is factors / radicand * sqrt(radicand)
  };
  std::vector<Class> classes;
  for (const auto& [factor, radicand] : sum) {
    if (factor == 0 || radicand == 0) continue;
    bool known = false;
    for (Class& other : classes) {
      const Whole product = radicand * other.radicand;
      if (mpz_perfect_square_p(product.backend().data()) == 0) continue;
      other.factors += factor * sqrt(product);
      known = true;
      break;
    }
    if (!known) classes.push_back({radicand, factor * radicand});
  }
  return std::all_of(classes.begin(), classes.end(), [](const Class& c) { return c.factors == 0; });
}

ExactPlanes::Whole ExactPlanes::minor(const Plane& p, const Plane& q, const Plane& r) {
  return p.c * (q.a * r.b - q.b * r.a) + q.c * (r.a * p.b - r.b * p.a) +
         r.c * (p.a * q.b - p.b * q.a);
}

}  // namespace apothem
