#include "lib/fem/mass.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/fem/quad4.hpp"

namespace apothem {
namespace {

constexpr double kLeastShare = 0.1;  // least share of a corner over the mean share, before the tilt

std::vector<double> quad_areas(std::span<const Vec2> x) {
  const auto [a, b, q] = quad::Reference(x);
  const double mean = cross(a, b), along = cross(a, q) / 3, across = cross(q, b) / 3;
  return {mean - along - across, mean + along - across, mean + along + across,
          mean - along + across};
}

}  // namespace

std::vector<double> corner_areas(std::span<const Vec2> x) {
  const int n = static_cast<int>(x.size());
  if (n == 3) return std::vector<double>(3, cross(x[1] - x[0], x[2] - x[0]) / 6);
  if (n == 4) {
    std::vector<double> areas = quad_areas(x);
    const auto [least, most] = std::minmax_element(areas.begin(), areas.end());
    if (*least > kLeastShare * *most)
      return areas;  // refused where a corner would get nearly nothing
  }

  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : x) mean += p / n;
  std::vector<double> share(n, 0);
  double area = 0, size = 0;
  Vec2 moment = Vec2::Zero();
  for (int i = 0; i < n; ++i) {
    const int j = next(i, n);
    const Vec2 p = x[i] - mean, q = x[j] - mean;
    const double triangle = cross(p, q) / 2;
    area += triangle;
    moment += triangle / 3 * (p + q);
    size = std::max(size, p.norm());
    share[i] += std::abs(triangle) / 2;
    share[j] += std::abs(triangle) / 2;
  }
  const Vec2 centroid = moment / area;
  // A corner close to the mean of the corners, like the inner one of an L, would get no mass.
  double mean_share = 0;
  for (const double w : share) mean_share += w / n;
  for (double& w : share) w = std::max(w, kLeastShare * mean_share);
  // Newton's method for the tilt t with SUM share exp(t.(x - centroid)) (x - centroid) = 0, the
  // minimum of a convex function.
  Vec2 tilt = Vec2::Zero();
  std::vector<double> weight(n);
  const auto weigh = [&](const Vec2& t) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      sum += weight[i] = share[i] * exponential(t.dot(x[i] - mean - centroid) / size);
    }
    return sum;
  };
  double sum = weigh(tilt);
  for (int step = 0; step < 50; ++step) {
    Vec2 gradient = Vec2::Zero();
    Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();
    for (int i = 0; i < n; ++i) {
      const Vec2 p = (x[i] - mean - centroid) / size;
      gradient += weight[i] * p;
      curvature += weight[i] * p * p.transpose();
    }
    if (gradient.norm() <= 1e-15 * sum) break;
    const Vec2 move = curvature.inverse() * gradient;
    double scale = 1;
    double next = weigh(tilt - move);
    while (next > sum && scale > 1e-6) {
      scale /= 2;
      next = weigh(tilt - scale * move);
    }
    tilt -= scale * move;
    sum = next;
  }
  for (double& w : weight) w *= area / sum;
  return weight;
}

}  // namespace apothem
