// Single elements against their laws: force = gradient of energy, no force from rigid motion,
// constant stress in any patch.
#include <catch2/catch.hpp>
#include <complex>
#include <numbers>

#include "apps/cases/samples.hpp"
#include "lib/fem/element.hpp"
#include "lib/fem/mass.hpp"

using namespace apothem;
using Complex = std::complex<double>;

namespace {

// One element with its stored numbers in lane 0.
struct OneElement {
  ElementKind kind;
  std::vector<Vec2> x;
  Elastic material;
  double thickness = .7;
  std::vector<double> data;

  OneElement(ElementKind k, std::vector<Vec2> corners, const Elastic& e)
      : kind(k), x(std::move(corners)), material(e) {
    with_element(kind, [&]<class Element>(Element) {
      data.resize(static_cast<size_t>(Element::stored(size())) * kLanes);
      Element::prepare(x, material, thickness, data.data());
    });
  }
  [[nodiscard]] int size() const { return static_cast<int>(x.size()); }

  template <class N>
  N energy(const std::vector<Point<N>>& u) const {
    return with_element(kind, [&]<class Element>(Element) {
      return with_law(material, [&]<class Law>(const Law& law) {
        const Response<Law, false> r(law, material, 0, thickness);
        return Element::energy(Stored<N>{data.data()}, r, size(), u.data());
      });
    });
  }
  template <class N>
  std::vector<Point<N>> force(const std::vector<Point<N>>& u, const std::vector<Point<N>>& v = {},
                              double beta = 0, N* power = nullptr, double lag = 0) const {
    std::vector<Point<N>> f(size());
    N lost(0.);
    with_element(kind, [&]<class Element>(Element) {
      with_law(material, [&]<class Law>(const Law& law) {
        if (beta > 0) {
          const Response<Law, true> r(law, material, beta, thickness, lag);
          Element::force(Stored<N>{data.data()}, r, size(), u.data(), v.data(), f.data(), lost);
        } else {
          const Response<Law, false> r(law, material, 0, thickness);
          Element::force(Stored<N>{data.data()}, r, size(), u.data(), u.data(), f.data(), lost);
        }
      });
    });
    if (power) *power = lost;
    return f;
  }
};

std::vector<Elastic> materials() {
  std::vector<Elastic> all;
  for (const ElasticLaw law : {ElasticLaw::st_venant_kirchhoff, ElasticLaw::neo_hookean}) {
    for (const Plane plane : {Plane::stress, Plane::strain}) all.push_back({law, plane, 3, .3});
  }
  return all;
}

std::vector<OneElement> elements(const Elastic& e) {
  const std::vector<Vec2> triangle{{0, 0}, {1.2, .1}, {.3, .9}};
  const std::vector<Vec2> quad{{0, 0}, {1.3, -.1}, {1.1, .8}, {-.2, 1.1}};
  const std::vector<Vec2> pentagon{{0, 0}, {1, -.2}, {1.4, .6}, {.6, 1.2}, {-.3, .7}};
  const std::vector<Vec2> reflex{{0, 0}, {1, 0}, {1, 1}, {.6, 1}, {.5, .4}, {.3, 1.1}, {-.1, 1}};
  return {{ElementKind::tri3, triangle, e},   {ElementKind::quad4, quad, e},
          {ElementKind::quad4_full, quad, e}, {ElementKind::polygon, triangle, e},
          {ElementKind::polygon, quad, e},    {ElementKind::polygon, pentagon, e},
          {ElementKind::polygon, reflex, e}};
}

std::vector<Point<double>> random_field(int n, double size, samples::Random& random) {
  std::vector<Point<double>> u(n);
  for (Point<double>& p : u) p = {random.uniform(-size, size), random.uniform(-size, size)};
  return u;
}

std::vector<Point<double>> linear(const std::vector<Vec2>& x, const Tensor<double>& h) {
  std::vector<Point<double>> u;
  for (const Vec2& p : x)
    u.push_back({h.xx * p.x() + h.xy * p.y() + .3, h.yx * p.x() + h.yy * p.y()});
  return u;
}

double largest(const std::vector<Point<double>>& f) {
  double m = 0;
  for (const auto& p : f) m = std::max({m, std::abs(p.x), std::abs(p.y)});
  return m;
}

}  // namespace

TEST_CASE("internal force is the gradient of the strain energy", "[fem]") {
  samples::Random random(3);
  for (const Elastic& material : materials()) {
    for (const OneElement& e : elements(material)) {
      for (int trial = 0; trial < 20; ++trial) {
        auto u = random_field(e.size(), .15, random);
        const double turn = random.uniform(-3, 3);  // large rotation on top
        const double c = std::cos(turn) - 1, s = std::sin(turn);
        for (int i = 0; i < e.size(); ++i) {
          const Point<double> p{e.x[i].x() + u[i].x, e.x[i].y() + u[i].y};
          u[i] = u[i] + Point<double>{c * p.x - s * p.y, s * p.x + c * p.y};
        }
        const auto f = e.force(u);
        std::vector<Point<Complex>> z;
        for (const auto& p : u) z.push_back({p.x, p.y});
        const Complex step(0, 1e-30);
        for (int i = 0; i < e.size(); ++i) {
          z[i].x += step;
          const double fx = e.energy(z).imag() / 1e-30;
          z[i].x -= step;
          z[i].y += step;
          const double fy = e.energy(z).imag() / 1e-30;
          z[i].y -= step;
          INFO(static_cast<int>(e.kind)
               << " corners " << e.size() << " law " << static_cast<int>(material.law));
          CHECK(f[i].x == Approx(fx).margin(1e-13));
          CHECK(f[i].y == Approx(fy).margin(1e-13));
        }
      }
    }
  }
}

TEST_CASE("a polygon with four corners is Q4", "[fem]") {
  samples::Random random(4);
  const std::vector<Vec2> convex{{0, 0}, {1.3, -.1}, {1.1, .8}, {-.2, 1.1}};
  const std::vector<Vec2> reflex{{0, 0}, {2, -.3}, {.8, .7}, {-.2, 1.9}};
  for (const Elastic& material : materials()) {
    for (const std::vector<Vec2>& x : {convex, reflex}) {
      const OneElement quad(ElementKind::quad4, x, material);
      const OneElement polygon(ElementKind::polygon, x, material);
      for (int trial = 0; trial < 20; ++trial) {
        const auto u = random_field(4, .2, random);
        const auto f = quad.force(u), g = polygon.force(u);
        CHECK(polygon.energy(u) == Approx(quad.energy(u)).epsilon(1e-13));
        for (int i = 0; i < 4; ++i) {
          CHECK(g[i].x == Approx(f[i].x).margin(1e-13));
          CHECK(g[i].y == Approx(f[i].y).margin(1e-13));
        }
      }
    }
  }
}

TEST_CASE("a rigid motion makes no force", "[fem]") {
  for (const Elastic& material : materials()) {
    for (const OneElement& e : elements(material)) {
      for (const double degrees : {90., 180., 1000.}) {
        const double a = degrees * std::numbers::pi / 180;
        const auto f =
            e.force(linear(e.x, {std::cos(a) - 1, -std::sin(a), std::sin(a), std::cos(a) - 1}));
        CHECK(largest(f) < 1e-14 * material.young);
      }
    }
  }
}

TEST_CASE("a linear field has its own energy and the tractions of its stress", "[fem]") {
  const Tensor<double> h{.12, .05, -.08, -.03};
  for (const Elastic& material : materials()) {
    for (const OneElement& e : elements(material)) {
      const auto u = linear(e.x, h);
      Tensor<double> p{};
      double density = 0;
      with_law(material, [&](const auto& law) {
        p = law.stress(h);
        density = law.energy(h);
      });
      double area = 0;
      for (const double share : corner_areas(e.x)) area += share;
      CHECK(e.energy(u) == Approx(density * area * e.thickness).epsilon(1e-13));
      const auto f = e.force(u);
      const int n = e.size();
      for (int i = 0; i < n; ++i) {
        const Vec2 across = e.x[(i + 1) % n] - e.x[(i + n - 1) % n];
        const Point<double> expected =
            (e.thickness / 2) * (p * Point<double>{across.y(), -across.x()});
        CHECK(f[i].x == Approx(expected.x).margin(1e-14));
        CHECK(f[i].y == Approx(expected.y).margin(1e-14));
      }
    }
  }
}

TEST_CASE("damping takes the power of its forces and nothing from a rotation", "[fem]") {
  samples::Random random(5);
  for (const Elastic& material : materials()) {
    for (const OneElement& e : elements(material)) {
      const auto u = random_field(e.size(), .1, random);
      const auto v = random_field(e.size(), 1, random);
      double power = 0;
      const auto damped = e.force(u, v, .3, &power);
      const auto elastic = e.force(u);
      double work = 0;
      for (int i = 0; i < e.size(); ++i) {
        work += (damped[i].x - elastic[i].x) * v[i].x + (damped[i].y - elastic[i].y) * v[i].y;
      }
      CHECK(power > 0);
      CHECK(work == Approx(power).epsilon(1e-12));
      std::vector<Point<double>> spin;
      for (int i = 0; i < e.size(); ++i) {
        spin.push_back({-(e.x[i].y() + u[i].y), e.x[i].x() + u[i].x});
      }
      const auto turning = e.force(u, spin, .3, &power);
      CHECK(power < 1e-28);
      for (int i = 0; i < e.size(); ++i) {
        CHECK(turning[i].x == Approx(elastic[i].x).margin(1e-14));
        CHECK(turning[i].y == Approx(elastic[i].y).margin(1e-14));
      }
      // A turn within one step, by the velocities that lead from one place to the other.
      const double lag = .2, c = std::cos(2 * lag), sine = std::sin(2 * lag);
      std::vector<Point<double>> way;
      for (int i = 0; i < e.size(); ++i) {
        const double x = e.x[i].x() + u[i].x, y = e.x[i].y() + u[i].y;
        way.push_back({(x - (c * x + sine * y)) / (2 * lag), (y - (c * y - sine * x)) / (2 * lag)});
      }
      const auto turned = e.force(u, way, .3, &power, lag);
      CHECK(power < 1e-28);
      for (int i = 0; i < e.size(); ++i) {
        CHECK(turned[i].x == Approx(elastic[i].x).margin(1e-14));
        CHECK(turned[i].y == Approx(elastic[i].y).margin(1e-14));
      }
    }
  }
}

TEST_CASE("corner areas keep area and centroid and are positive", "[fem]") {
  for (const OneElement& e : elements(materials()[0])) {
    const Polygon polygon(e.x);
    const std::vector<double> areas = corner_areas(e.x);
    double area = 0;
    Vec2 moment = Vec2::Zero();
    for (int i = 0; i < e.size(); ++i) {
      CHECK(areas[i] > 0);
      area += areas[i];
      moment += areas[i] * e.x[i];
    }
    const AreaMoments exact = area_moments(polygon);
    const Vec2 centroid = exact.centroid + polygon.origin();
    CHECK(area == Approx(exact.area).epsilon(1e-14));
    CHECK(moment.x() == Approx(exact.area * centroid.x()).epsilon(1e-13));
    CHECK(moment.y() == Approx(exact.area * centroid.y()).epsilon(1e-13));
  }
}

TEST_CASE("a corner in the middle of the others has mass", "[fem]") {
  const std::vector<Vec2> l{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const double area : corner_areas(l)) CHECK(area > .03);
  const std::vector<Vec2> dart{{0, 0}, {1, 0}, {.1, .1}, {0, 1}};
  for (const double area : corner_areas(dart)) CHECK(area > 0);
}

TEST_CASE("plane stress leaves no stress across the plane", "[fem]") {
  // The closed form against the condition it solves, and against small strains.
  const Elastic e{ElasticLaw::neo_hookean, Plane::stress, 3, .3};
  const NeoHookean<Plane::stress> law(e);
  for (const Tensor<double>& h :
       {Tensor<double>{.4, .1, -.2, .3}, Tensor<double>{-.5, .2, .1, -.3}}) {
    const double t = law.thickness_stretch(h);
    const double j = ((1 + h.xx) * (1 + h.yy) - h.xy * h.yx) * t;
    CHECK(e.shear() * (t - 1 / t) + e.lame() * (j - 1) * j / t == Approx(0).margin(1e-14));
  }
  const Tensor<double> small{1e-7, 2e-8, 3e-8, -4e-8};
  const StVenantKirchhoff hooke(e);
  const Tensor<double> p = law.stress(small), q = hooke.stress(small);
  CHECK(p.xx == Approx(q.xx).epsilon(1e-6));
  CHECK(p.xy == Approx(q.xy).epsilon(1e-6));
  CHECK(law.energy(small) == Approx(hooke.energy(small)).epsilon(1e-2));
}
