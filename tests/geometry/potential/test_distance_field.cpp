// The Euclidean depth of polygons that are not convex: against point distances by brute force,
// the overlap polygon, the oracle and the energy.
#include <functional>

#include "geometry/exact/exact_integral.hpp"
#include "geometry/integrals/placed_shapes.hpp"
#include "geometry/skeleton/skeleton.hpp"
#include "tests/geometry/long_outlines.hpp"
#include "tests/geometry/nonconvex_pairs.hpp"

using namespace apothem;

namespace {

using Reference = PotentialChoice::Reference;

PotentialChoice field_choice(Reference reference = Reference::inscribed_circle, double length = 0) {
  return {.field = PotentialChoice::Field::distance, .reference = reference, .length = length};
}

Polygon non_convex(samples::Random& random) {
  switch (random.integer(0, 6)) {
    case 0:
      return test::cross_shape();
    case 1:
      return test::l_shape();
    case 2:
      return test::star(random.integer(3, 7), random.uniform(.3, .45));
    case 3:
      return test::comb(random.integer(2, 4));
    case 4:
      return test::spiral();
    default:
      while (true) {
        const Polygon blob = samples::random_star_shaped(random, random.integer(4, 12), .35);
        if (!blob.is_convex()) return blob;
      }
  }
}

// Distance to the boundary inside, 0 outside, from the definition.
long double point_distance(const Polygon& polygon, long double x, long double y) {
  bool inside = false;
  long double nearest = HUGE_VALL;
  for (int i = 0; i < polygon.size(); ++i) {
    const long double ax = polygon[i].x(), ay = polygon[i].y();
    const long double ex = polygon.after(i).x() - ax, ey = polygon.after(i).y() - ay;
    const long double rx = x - ax, ry = y - ay;
    if ((ay > y) != (ay + ey > y) && rx < ex * ry / ey) inside = !inside;
    const long double s = std::clamp((rx * ex + ry * ey) / (ex * ex + ey * ey), 0.0L, 1.0L);
    nearest = std::min(nearest, std::hypot(rx - s * ex, ry - s * ey));
  }
  return inside ? nearest : 0;
}

double simpson(const std::function<double(double)>& f, double a, double b, double fa, double fm,
               double fb, double tolerance, int depth) {
  const double m = (a + b) / 2;
  const double fl = f((a + m) / 2), fr = f((m + b) / 2);
  const double whole = (b - a) / 6 * (fa + 4 * fm + fb);
  const double halves = (b - a) / 12 * (fa + 4 * fl + 2 * fm + 4 * fr + fb);
  if (depth == 0 || std::abs(halves - whole) < tolerance) return halves + (halves - whole) / 15;
  return simpson(f, a, m, fa, fl, fm, tolerance / 2, depth - 1) +
         simpson(f, m, b, fm, fr, fb, tolerance / 2, depth - 1);
}

// Adaptive quadrature on equal parts.
double quadrature(const std::function<double(double)>& f, double a, double b, int parts,
                  double tolerance) {
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    const double u = a + (b - a) * i / parts, v = a + (b - a) * (i + 1) / parts;
    sum += simpson(f, u, v, f(u), f((u + v) / 2), f(v), tolerance / parts, 24);
  }
  return sum;
}

// A field where its polygon stands.
struct Placed {
  Placed(const Polygon& polygon, const PotentialChoice& choice)
      : potential(make_potential(polygon, choice)) {
    for (const Vec2& v : polygon.vertices()) {
      x.push_back(v.x());
      y.push_back(v.y());
    }
    for (const Vec2& g : potential.gradients) {
      gx.push_back(g.x());
      gy.push_back(g.y());
    }
    view = {polygon.size(),
            x.data(),
            y.data(),
            gx.data(),
            gy.data(),
            potential.distance->slope,
            &potential.distance->corners,
            potential.capped()};
  }
  SegmentMoments<double> along(const Vec2& p, const Vec2& e) {
    return trace.integrate(view, p.x(), p.y(), e.x(), e.y(), [](double, double) {});
  }
  Potential potential;
  std::vector<double> x, y, gx, gy;
  PlacedDistance<double> view;
  DistanceTrace<double> trace;
};

std::vector<PotentialChoice> all_references() {
  return {field_choice(), field_choice(Reference::roof), field_choice(Reference::length, .1),
          field_choice(Reference::length, 2)};
}

}  // namespace

TEST_CASE("both fields of a convex polygon are one, to the last bit", "[distance-field]") {
  test::SeededRandom random(60);
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon a = samples::random_convex(random, random.integer(3, 8));
    const Polygon b =
        samples::shifted(samples::random_convex(random, random.integer(3, 8)), {.7, .3});
    for (const Reference r : {Reference::roof, Reference::inscribed_circle, Reference::length}) {
      const PotentialChoice field = field_choice(r, .2);
      PotentialChoice roof = field;
      roof.field = PotentialChoice::Field::roof;
      const PairResult f = test::edge(a, b, field), g = test::edge(a, b, roof);
      REQUIRE(f.integral.force == g.integral.force);
      REQUIRE(f.integral.moment_a == g.integral.moment_a);
      REQUIRE(f.volume.energy == g.volume.energy);
    }
  }
}

TEST_CASE("reference lengths of the distance field", "[distance-field]") {
  const Polygon cross = test::cross_shape();
  const Potential circle = make_potential(cross, field_choice());
  CHECK(circle.steepest == Approx(std::sqrt(2.0)).epsilon(1e-14));
  CHECK(circle.top == 1);
  CHECK_FALSE(circle.capped());
  const Potential roof = make_potential(cross, field_choice(Reference::roof));
  CHECK(roof.steepest == Approx(2).epsilon(1e-14));
  CHECK(roof.top == Approx(std::sqrt(2.0)).epsilon(1e-14));  // saturated
  CHECK(roof.capped());
  CHECK(make_potential(cross, field_choice(Reference::length, 1)).top ==
        Approx(std::sqrt(.5)).epsilon(1e-14));
  for (const PotentialChoice& choice : all_references()) {
    CHECK_FALSE(make_potential(cross, choice).roof);
  }
}

TEST_CASE("the distance field at points", "[distance-field]") {
  test::SeededRandom random(61);
  double worst = 0;
  for (int i = 0; i < test::scaled(300); ++i) {
    const Polygon polygon = samples::posed(non_convex(random), {0, 0}, random.uniform(0, 6));
    Placed field(polygon, field_choice());
    const double r = 1 / field.potential.steepest;
    for (int k = 0; k < 20; ++k) {
      const Vec2 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
      // Along a segment so short that phi is one value on it.
      const double turn = random.uniform(0, 6);
      const Vec2 e = 0x1p-54 * Vec2(std::cos(turn), std::sin(turn));
      const double distance = field.along(p, e).sum * r;
      worst = std::max(worst, std::abs(distance - double(point_distance(polygon, p.x(), p.y()))) /
                                  bounding_box(polygon).extent());
    }
  }
  INFO(worst);
  CHECK(worst <= 1e-15);
}

TEST_CASE("the distance field along segments against quadrature", "[distance-field]") {
  test::SeededRandom random(62);
  for (const PotentialChoice& choice : all_references()) {
    for (int i = 0; i < test::scaled(20); ++i) {
      const Polygon polygon = samples::posed(non_convex(random), {0, 0}, random.uniform(0, 6));
      Placed field(polygon, choice);
      const double slope = field.potential.steepest;
      const double cap = field.potential.capped() ? 1 : HUGE_VAL;
      const Vec2 p(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5));
      const Vec2 e(random.uniform(-2, 2), random.uniform(-2, 2));
      const auto phi = [&](double u) {
        const Vec2 q = p + u * e;
        return std::min(cap, slope * double(point_distance(polygon, q.x(), q.y())));
      };
      const SegmentMoments<double> moments = field.along(p, e);
      REQUIRE(moments.sum == Approx(quadrature(phi, 0, 1, 64, 1e-12)).margin(1e-11));
      REQUIRE(
          moments.first ==
          Approx(quadrature([&](double u) { return u * phi(u); }, 0, 1, 64, 1e-12)).margin(1e-11));
    }
  }
}

TEST_CASE("trees find all that is near a segment in a long outline", "[distance-field]") {
  test::SeededRandom random(97);
  int inside = 0, parts = 0;
  for (int i = 0; i < test::scaled(200); ++i) {
    const Polygon polygon = test::long_outline(random, i % test::kOutlineKinds);
    const double r = i % 2 == 0 ? .02 : 10;
    const Potential potential = make_potential(polygon, field_choice(Reference::length, r));
    std::vector<double> x, y, gx, gy;
    for (int k = 0; k < polygon.size(); ++k) {
      x.push_back(polygon[k].x()), y.push_back(polygon[k].y());
      gx.push_back(potential.gradients[k].x()), gy.push_back(potential.gradients[k].y());
    }
    const EdgeTrees trees(x.data(), y.data(), polygon.size(), polygon.links());
    PlacedDistance<double> field{.size = polygon.size(),
                                 .x = x.data(),
                                 .y = y.data(),
                                 .gx = gx.data(),
                                 .gy = gy.data(),
                                 .slope = potential.distance->slope,
                                 .corners = &potential.distance->corners,
                                 .capped = potential.capped(),
                                 .links = polygon.links()};
    // Most segments are long and cross many edges. Some pass through vertices.
    const Box box = bounding_box(polygon);
    const auto place = [&]() -> Vec2 {
      if (random.integer(0, 3) == 0) return polygon[random.integer(0, polygon.size() - 1)];
      return {random.uniform(box.x0, box.x1), random.uniform(box.y0, box.y1)};
    };
    for (int k = 0; k < 20; ++k) {
      const Vec2 p = place(), e = random.uniform(0, 1.2) * (place() - p);
      using Part = std::array<double, 2>;
      std::vector<Part> all, found;
      const auto integrate = [&](std::vector<Part>& list) {
        return DistanceTrace<double>().integrate(field, p.x(), p.y(), e.x(), e.y(),
                                                 [&](double s0, double s1) {
                                                   list.push_back({s0, s1});
                                                 });
      };
      field.trees = nullptr;
      const SegmentMoments<double> expected = integrate(all);
      field.trees = &trees;
      const SegmentMoments<double> got = integrate(found);
      INFO("polygon " << i << ", segment " << k);
      REQUIRE(found == all);
      // A segment along an edge is as deep as the round-off of positions.
      const double tolerance = 1e-13 * expected.largest + 1e-16 / r;
      CHECK(std::abs(got.sum - expected.sum) <= tolerance);
      CHECK(std::abs(got.first - expected.first) <= tolerance);
      CHECK(std::abs(got.largest - expected.largest) <= tolerance);
      inside += !found.empty(), parts += static_cast<int>(found.size());
    }
  }
  CHECK(inside > test::least(test::scaled(200)));
  CHECK(parts > test::least(3 * inside / 2));
}

TEST_CASE("distance field: edge and overlap kernel against the oracle", "[distance-field]") {
  test::SeededRandom random(63);
  int touching = 0;
  for (const PotentialChoice& choice : all_references()) {
    for (const double offset : {0.0, 1e6, 1e9}) {
      for (int i = 0; i < test::scaled(25); ++i) {
        const Polygon other = i % 5 == 0 ? samples::random_convex(random, 5) : non_convex(random);
        const Polygon a = samples::posed(
            non_convex(random),
            {offset + random.uniform(-1.2, 1.2), 2 * offset + random.uniform(-1.2, 1.2)},
            random.uniform(0, 6));
        const Polygon b = samples::shifted(other, {offset, 2 * offset});
        const PairResult x = exact_method(a, b, choice);
        touching += x.integral.weight > 0;
        test::check_against(test::edge(a, b, choice), x);
        test::check_against(test::overlap(a, b, choice), x);
      }
    }
  }
  CHECK(touching > test::least(test::scaled(150)));
}

TEST_CASE("energy of the distance field against quadrature over lines", "[distance-field]") {
  test::SeededRandom random(64);
  for (const PotentialChoice& choice : all_references()) {
    for (int i = 0; i < test::scaled(5); ++i) {
      const Polygon a = samples::posed(non_convex(random), {.4, .3}, random.uniform(0, 6));
      const Polygon b = samples::posed(non_convex(random), {0, 0}, random.uniform(0, 6));
      Placed field_a(a, choice), field_b(b, choice);
      // phi of both on the parts of a level line that lie in both.
      const auto line = [&](double y) {
        std::array<std::vector<double>, 2> crossings;
        for (int k = 0; k < 2; ++k) {
          const Polygon& polygon = k == 0 ? a : b;
          for (int e = 0; e < polygon.size(); ++e) {
            const Vec2 &p = polygon[e], &q = polygon.after(e);
            if ((p.y() > y) == (q.y() > y)) continue;
            crossings[k].push_back(p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x()));
          }
          std::sort(crossings[k].begin(), crossings[k].end());
        }
        double sum = 0;
        for (size_t k = 0; k < crossings[0].size(); k += 2) {
          for (size_t l = 0; l < crossings[1].size(); l += 2) {
            const double from = std::max(crossings[0][k], crossings[1][l]);
            const double to = std::min(crossings[0][k + 1], crossings[1][l + 1]);
            if (!(from < to)) continue;
            const Vec2 p(from, y), e(to - from, 0);
            sum += (to - from) * (field_a.along(p, e).sum + field_b.along(p, e).sum);
          }
        }
        return sum;
      };
      const Box box = bounding_box(a);
      const double energy = test::edge(a, b, choice).volume.energy;
      REQUIRE(energy == Approx(quadrature(line, box.y0, box.y1, 200, 1e-11)).margin(1e-9));
    }
  }
}

TEST_CASE("force of the distance field is minus the gradient of the energy", "[distance-field]") {
  test::SeededRandom random(65);
  const double h = 1e-4;
  for (int i = 0; i < test::scaled(50); ++i) {
    const PotentialChoice choice = all_references()[i % 4];
    const Polygon a = non_convex(random);
    const Polygon b = non_convex(random);
    const Vec2 x =
        samples::world_centroid(b) + Vec2(random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2));
    const double angle = random.uniform(0, 6);
    const auto energy = [&](double dx, double dy, double turn) {
      return test::edge(samples::posed(a, x + Vec2(dx, dy), angle + turn), b, choice).volume.energy;
    };
    const PairIntegral pair = test::edge(samples::posed(a, x, angle), b, choice).integral;
    const double scale = std::max(pair.weight, 1e-2);
    REQUIRE(std::abs(pair.force.x() + (energy(h, 0, 0) - energy(-h, 0, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.force.y() + (energy(0, h, 0) - energy(0, -h, 0)) / (2 * h)) <
            2e-5 * scale);
    REQUIRE(std::abs(pair.moment_a + (energy(0, 0, h) - energy(0, 0, -h)) / (2 * h)) <
            2e-5 * scale);
  }
}

TEST_CASE("work of the distance field on closed paths", "[distance-field][slow]") {
  test::check_closed_paths(field_choice());
}

TEST_CASE("swapping the bodies of a distance-field pair, to the last bit", "[distance-field]") {
  test::SeededRandom random(67);
  for (int i = 0; i < test::scaled(100); ++i) {
    const Polygon a = samples::posed(
        non_convex(random), {random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0, 6));
    const Polygon b = non_convex(random);
    const PairIntegral ab = test::edge(a, b, field_choice()).integral;
    const PairIntegral ba = test::edge(b, a, field_choice()).integral;
    REQUIRE(ab.force == -ba.force);
    REQUIRE(ab.moment_a == ba.moment_b);
  }
}

TEST_CASE("shallow crosses: the distance field gives the force of the roof", "[distance-field]") {
  test::SeededRandom random(68);
  const Vec2 centre = area_moments(test::cross_shape()).centroid;
  const Potential roof =
      translated(make_potential(test::cross_shape(), test::length_choice(.5)), centre);
  const Potential field =
      translated(make_potential(test::cross_shape(), field_choice(Reference::length, .5)), centre);
  PlacedShapes roofs, fields;
  for (int i = 0; i < 2; ++i) {
    roofs.add(roof);
    fields.add(field);
  }
  roofs.place(1, 0, 0, 0);
  fields.place(1, 0, 0, 0);
  EdgeWorkspace workspace;
  const int poses = test::scaled(1000);
  for (const double depth : {.03, .1, .3}) {
    int same = 0;
    for (int i = 0; i < poses; ++i) {
      const double turn = random.uniform(0, 6), direction = random.uniform(0, 6);
      roofs.place(0, 0, 0, turn);
      fields.place(0, 0, 0, turn);
      const auto force = [&](const PlacedShapes& shapes, double distance) {
        const Vec2 away(std::cos(direction), std::sin(direction));
        return pair_integral(shapes.view(0), shapes.view(1), distance * away, workspace);
      };
      // In from far away until they touch, and deeper.
      double far = 4;
      while (!(force(roofs, far).weight > 0)) far -= .02;
      double near = far, apart = far + .02;
      for (int k = 0; k < 40; ++k) {
        const double middle = (near + apart) / 2;
        (force(roofs, middle).weight > 0 ? near : apart) = middle;
      }
      const PairIntegral r = force(roofs, near - depth), f = force(fields, near - depth);
      same += (r.force - f.force).norm() <= 1e-13 * r.weight;
    }
    INFO("depth " << depth << ": " << same << " of " << poses);
    CHECK(same >= test::least(9 * poses / 10));
  }
}

TEST_CASE("the distance field is continuous in the shape, the roof is not", "[distance-field]") {
  const Polygon cross = test::cross_shape();
  const Polygon block = samples::posed(Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), {.5, .5}, .3);
  const auto changed = [&](const std::vector<Vec2>& instead, const PotentialChoice& choice) {
    std::vector<Vec2> ring;  // another outline at the reflex vertex (.5, .5)
    for (const Vec2& v : cross.vertices()) {
      if (v == Vec2(.5, .5)) {
        ring.insert(ring.end(), instead.begin(), instead.end());
      } else {
        ring.push_back(v);
      }
    }
    return (test::edge(Polygon(ring), block, choice).integral.force -
            test::edge(cross, block, choice).integral.force)
        .norm();
  };
  const std::vector<Vec2> bevel{{.5 + 1e-12, .5}, {.5, .5 + 1e-12}};
  const std::vector<Vec2> crack{{.5 + 1e-12, .5}, {.5 - 1e-12, .5 - 1e-12}, {.5, .5 + 1e-15}};
  const PotentialChoice field = field_choice(Reference::length, .5);
  const double of_bevel = changed(bevel, field), of_crack = changed(crack, field);
  const double of_roof = changed(bevel, test::length_choice(.5));
  INFO(of_bevel << " " << of_crack << " " << of_roof);
  CHECK(of_bevel < 1e-11);
  CHECK(of_crack < 1e-11);
  CHECK(of_roof > 1e-3);
}

TEST_CASE("a distance field that is not a number is no separation", "[distance-field]") {
  const Potential potential = make_potential(test::cross_shape(), field_choice());
  PlacedShapes shapes;
  shapes.add(potential);
  shapes.add(potential);
  shapes.place(0, 0, 0, 0);
  shapes.place(1, 0, 0, NAN);
  EdgeWorkspace workspace;
  const PairIntegral pair = pair_integral(shapes.view(0), shapes.view(1), {1, 0}, workspace);
  CHECK(pair.touching());
  CHECK(std::isnan(pair.weight));
}
