// Two other elements with any number of corners, to compare with the library's.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

#include "geometry/polygon/triangulation.hpp"
#include "lib/fem/polygon_element.hpp"

namespace apothem::test {

/// First-order virtual elements as they are taught: half the modulus on all that is not linear.
struct PenaltyOnly : PolygonElement {
  static void prepare(std::span<const Vec2> x, const Elastic& e, double thickness, double* out) {
    PolygonElement::prepare(x, e, thickness, out);
    const int n = static_cast<int>(x.size());
    out[kLanes] = n > 3 ? e.uniaxial() * thickness / 2 : 0;
    for (int i = 0; i < n; ++i) {
      for (int k = 4; k < kPerCorner; ++k) out[(2 + kPerCorner * i + k) * kLanes] = 0;
    }
  }
};

/// Mean-value coordinates (M. Floater, Comput. Aided Geom. Des. 20, 2003; convex or not) with 27
/// points in each triangle of the cell. The mean of their gradients is set to the exact one, so
/// that the patch test holds (C. Talischi et al., Int. J. Numer. Meth. Eng. 101, 2015).
struct MeanValue {
  static constexpr int kCorners = 0;
  static constexpr int kPieces = 3;  // of each side of a triangle
  static constexpr int kPoints = 3 * kPieces * kPieces;
  static int stored(int corners) { return (corners - 2) * kPoints * (1 + 2 * corners); }

  /// Per point its volume and the gradient of every corner's function.
  static void prepare(std::span<const Vec2> x, const Elastic&, double thickness, double* out) {
    const int n = static_cast<int>(x.size());
    const std::vector<Vec2> ring(x.begin(), x.end());
    std::vector<std::pair<double, Vec2>> points;
    for (const Triangle& t : triangulate(Polygon(ring))) {
      const Vec2 o = x[t[0]], a = (x[t[1]] - o) / kPieces, b = (x[t[2]] - o) / kPieces;
      for (int i = 0; i < kPieces; ++i) {
        for (int j = 0; i + j < kPieces; ++j) {
          for (const Vec2& l : {Vec2(1 / 6., 1 / 6.), Vec2(2 / 3., 1 / 6.), Vec2(1 / 6., 2 / 3.)}) {
            const Vec2 corner = o + i * a + j * b, move = l.x() * a + l.y() * b;
            points.emplace_back(cross(a, b) / 6, corner + move);
            if (i + j < kPieces - 1) points.emplace_back(cross(a, b) / 6, corner + a + b - move);
          }
        }
      }
    }
    using Gradients = Eigen::Matrix<double, Eigen::Dynamic, 2>;
    std::vector<Gradients> gradients;
    Gradients excess = Gradients::Zero(n, 2);
    double area = 0;
    for (const auto& [share, place] : points) {
      gradients.push_back(gradients_at(x, place));
      excess += share * gradients.back();
      area += share;
    }
    for (int i = 0; i < n; ++i) {
      const Vec2 across = x[(i + 1) % n] - x[(i + n - 1) % n];
      excess.row(i) -= Eigen::RowVector2d(across.y(), -across.x()) / 2;
    }
    excess /= area;
    int at = 0;
    for (size_t p = 0; p < points.size(); ++p) {
      out[kLanes * at++] = thickness * points[p].first;
      for (int i = 0; i < n; ++i) {
        for (int axis = 0; axis < 2; ++axis) {
          out[kLanes * at++] = gradients[p](i, axis) - excess(i, axis);
        }
      }
    }
  }

  template <class R, class N>
  static void force(const Stored<N>& d, const R& material, int corners, const Point<N>* u,
                    const Point<N>*, Point<N>* f, N&) {
    for (int i = 0; i < corners; ++i) f[i] = {N(0.), N(0.)};
    for (int p = 0; p < (corners - 2) * kPoints; ++p) {
      const int at = p * (1 + 2 * corners);
      const auto slope = [&](int i) { return Point<N>{d[at + 1 + 2 * i], d[at + 2 + 2 * i]}; };
      Tensor<N> h{N(0.), N(0.), N(0.), N(0.)};
      for (int i = 0; i < corners; ++i) h = h + outer(u[i], slope(i));
      const Tensor<N> stress = d[at] * material.stress(h, h);
      for (int i = 0; i < corners; ++i) f[i] = f[i] + stress * slope(i);
    }
  }

 private:
  static Eigen::Matrix<double, Eigen::Dynamic, 2> gradients_at(std::span<const Vec2> x,
                                                               const Vec2& place) {
    using Varied = std::complex<double>;
    constexpr double kStep = 1e-40;
    const int n = static_cast<int>(x.size());
    Eigen::Matrix<double, Eigen::Dynamic, 2> result(n, 2);
    for (int axis = 0; axis < 2; ++axis) {
      const Point<Varied> varied{Varied(place.x(), axis == 0 ? kStep : 0),
                                 Varied(place.y(), axis == 1 ? kStep : 0)};
      std::vector<Point<Varied>> arm;
      for (const Vec2& p : x) arm.push_back(Point<Varied>{p.x(), p.y()} - varied);
      std::vector<Varied> half_tangent, weight(n);
      for (int i = 0; i < n; ++i) {
        const Point<Varied>&a = arm[i], &b = arm[(i + 1) % n];
        const Varied lengths = square_root(dot(a, a)) * square_root(dot(b, b));
        const Varied across = a.x * b.y - a.y * b.x, along = dot(a, b);
        half_tangent.push_back(along.real() > 0 ? across / (lengths + along)
                                                : (lengths - along) / across);
      }
      Varied sum = 0;
      for (int i = 0; i < n; ++i) {
        weight[i] =
            (half_tangent[(i + n - 1) % n] + half_tangent[i]) / square_root(dot(arm[i], arm[i]));
        sum += weight[i];
      }
      for (int i = 0; i < n; ++i) result(i, axis) = (weight[i] / sum).imag() / kStep;
    }
    return result;
  }
};

}  // namespace apothem::test
