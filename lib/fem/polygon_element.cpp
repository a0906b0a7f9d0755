#include "fem/polygon_element.hpp"

#include <Eigen/Cholesky>

namespace apothem {
namespace {

constexpr double kRest = 0.1;  // kappa over modulus and thickness

struct Stress {
  double xx, yy, xy;
  [[nodiscard]] Vec2 on(const Vec2& normal) const {
    return {xx * normal.x() + xy * normal.y(), xy * normal.x() + yy * normal.y()};
  }
};

// The equilibrated stress fields that are linear in the place: Airy's cubics.
std::array<Stress, 4> linear_stresses(const Vec2& p) {
  return {Stress{p.y(), 0, 0}, Stress{0, p.x(), 0}, Stress{p.x(), 0, -p.y()},
          Stress{0, p.y(), -p.x()}};
}

// Strain energy density of two stresses.
double complementary(const Elastic& e, const Stress& a, const Stress& b) {
  const double c = e.constrained(), d = e.coupled(), det = c * c - d * d;
  return (a.xx * (c * b.xx - d * b.yy) + a.yy * (c * b.yy - d * b.xx)) / det +
         a.xy * b.xy / e.shear();
}

}  // namespace

void PolygonElement::prepare(std::span<const Vec2> x, const Elastic& e, double thickness,
                             double* out) {
  const int n = static_cast<int>(x.size());
  const auto after = [&](int i) { return x[i + 1 < n ? i + 1 : 0]; };
  const auto before = [&](int i) { return x[i > 0 ? i - 1 : n - 1]; };
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : x) mean += p / n;
  double area = 0;
  Vec2 centroid = Vec2::Zero();  // from the mean corner
  for (int i = 0; i < n; ++i) {
    const Vec2 p = x[i] - mean, q = after(i) - mean;
    area += cross(p, q) / 2;
    centroid += cross(p, q) / 6 * (p + q);
  }
  centroid = mean + centroid / area;

  // Complementary energies of the stresses; each triangle at the centroid by its edge midpoints,
  // exact for products of linear fields.
  Eigen::Matrix4d energy = Eigen::Matrix4d::Zero();
  for (int i = 0; i < n; ++i) {
    const Vec2 p = x[i] - centroid, q = after(i) - centroid;
    for (const Vec2& middle : {Vec2(p / 2), Vec2(q / 2), Vec2((p + q) / 2)}) {
      const std::array<Stress, 4> s = linear_stresses(middle);
      for (int k = 0; k < 4; ++k) {
        for (int l = 0; l < 4; ++l) {
          energy(k, l) += thickness * cross(p, q) / 6 * complementary(e, s[k], s[l]);
        }
      }
    }
  }
  const Eigen::LLT<Eigen::Matrix4d> cholesky(energy);

  out[0] = area * thickness;
  out[kLanes] = n > 4 ? kRest * e.uniaxial() * thickness : 0;
  for (int i = 0; i < n; ++i) {
    double* corner = out + static_cast<ptrdiff_t>(2 + kPerCorner * i) * kLanes;
    const Vec2 across = after(i) - before(i);
    const Vec2 place = x[i] - mean;
    // Work of the tractions on the two edges that end here: INT N_i (s n) ds.
    Eigen::Matrix<double, 4, 2> work = Eigen::Matrix<double, 4, 2>::Zero();
    for (const auto& [from, to, at_from] :
         {std::tuple(before(i), x[i], false), std::tuple(x[i], after(i), true)}) {
      const Vec2 normal(to.y() - from.y(), from.x() - to.x());  // times the length
      const std::array<Stress, 4> s_from = linear_stresses(from - centroid);
      const std::array<Stress, 4> s_to = linear_stresses(to - centroid);
      for (int k = 0; k < 4; ++k) {
        const double near = 1. / 3, far = 1. / 6;
        work.row(k) += thickness * ((at_from ? near : far) * s_from[k].on(normal) +
                                    (at_from ? far : near) * s_to[k].on(normal));
      }
    }
    if (n > 3)
      work = cholesky.matrixL().solve(work);
    else
      work.setZero();
    const double values[kPerCorner] = {across.y() / (2 * area),
                                       -across.x() / (2 * area),
                                       place.x(),
                                       place.y(),
                                       work(0, 0),
                                       work(0, 1),
                                       work(1, 0),
                                       work(1, 1),
                                       work(2, 0),
                                       work(2, 1),
                                       work(3, 0),
                                       work(3, 1)};
    for (int k = 0; k < kPerCorner; ++k) corner[k * kLanes] = values[k];
  }
}

}  // namespace apothem
