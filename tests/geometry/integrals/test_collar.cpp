// The collar's closed forms: gradient by complex step, volume by CGAL, corners, flat edges.
#include <catch2/catch.hpp>
#include <complex>

#include "geometry/exact/overlap.hpp"
#include "geometry/integrals/collar.hpp"
#include "tests/contact/outline_pairs.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

using Complex = std::complex<double>;

struct ComplexRing {
  std::vector<Complex> x, y;
};

ComplexRing complex_ring(const std::vector<Vec2>& ring) {
  ComplexRing result;
  for (const Vec2& v : ring) {
    result.x.emplace_back(v.x());
    result.y.emplace_back(v.y());
  }
  return result;
}

// INT of t's collar over c, from all edges and all faces.
Complex volume(const ComplexRing& c, const ComplexRing& t, double depth) {
  const size_t n = t.x.size(), m = c.x.size();
  std::vector<Complex> tx(n), ty(n), length(n);
  for (size_t i = 0; i < n; ++i) {
    const Complex dx = t.x[(i + 1) % n] - t.x[i], dy = t.y[(i + 1) % n] - t.y[i];
    length[i] = std::sqrt(dx * dx + dy * dy);
    tx[i] = dx / length[i], ty[i] = dy / length[i];
  }
  Complex sum = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t p = (i + n - 1) % n, q = (i + 1) % n;
    const Mitre<Complex> a(tx[p], ty[p], tx[i], ty[i]), b(tx[i], ty[i], tx[q], ty[q]);
    const CollarFace<Complex> face =
        CollarFace<Complex>{t.x[i], t.y[i], t.x[q], t.y[q], tx[i], ty[i], length[i],
                            a.x,    a.y,    b.x,    b.y,    depth, 0}
            .with_regular_depth();
    for (size_t e = 0; e < m; ++e) {
      CollarPiece<Complex> piece;
      CollarCrossings<Complex> crossings;
      const size_t g = (e + 1) % m;
      if (collar_piece(face, c.x[e], c.y[e], c.x[g], c.y[g], piece, crossings)) sum += piece.height;
    }
  }
  return sum;
}

// Largest |f + dE/dx| over largest |f|.
double gradient_error(const OutlinePair& pair) {
  ComplexRing a = complex_ring(pair.a), b = complex_ring(pair.b);
  const std::vector<OutlineSurfaces::Body>& bodies = pair.contacts->surfaces().outlines().bodies;
  const auto slope = [&] {
    const double h = 1e-40;
    return -(volume(b, a, bodies[0].depth) / pair.reference_a +
             volume(a, b, bodies[1].depth) / pair.reference_b)
                .imag() /
           h;
  };
  double worst = 0;
  size_t k = 0;
  for (ComplexRing* ring : {&a, &b}) {
    for (size_t i = 0; i < ring->x.size(); ++i) {
      for (Complex* z : {&ring->x[i], &ring->y[i]}) {
        z->imag(1e-40);
        worst = std::max(worst, std::abs(slope() - pair.node_force[k++]));
        z->imag(0);
      }
    }
  }
  return worst / pair.largest_force();
}

}  // namespace

TEST_CASE("nodal forces are the gradient of the energy", "[collar]") {
  test::SeededRandom random(11);
  int pairs = 0;
  double worst = 0;
  const int wanted = scaled(600);
  while (pairs < wanted) {
    const double inner = random.integer(0, 3) == 0 ? 1 : random.uniform(.3, .9);
    const auto pair = random_pair(random, random.integer(3, 12), inner);
    if (!pair) continue;
    ++pairs;
    worst = std::max(worst, gradient_error(*pair));
  }
  CAPTURE(worst);
  CHECK(worst < 1e-12);
}

TEST_CASE("the energy is that of CGAL's overlap under CGAL's roof", "[collar]") {
  test::SeededRandom random(12);
  int pairs = 0;
  double worst = 0, worst_force = 0;
  const int wanted = scaled(100);
  while (pairs < wanted) {
    const double inner = random.integer(0, 1) == 0 ? 1 : random.uniform(.4, .9);
    auto pair = random_pair(random, random.integer(3, 9), inner);
    if (!pair) continue;
    const Polygon a(pair->a), b(pair->b);
    PairResult exact;
    try {
      exact = overlap_method(a, make_potential(a, length_choice(pair->reference_a)), b,
                             make_potential(b, length_choice(pair->reference_b)));
    } catch (const SkeletonFailure&) {
      continue;
    }
    ++pairs;
    worst = std::max(
        worst, std::abs(pair->contacts->energy() - exact.volume.energy) / exact.volume.energy);
    const Vec2 force = pair->on(0).force;
    worst_force =
        std::max(worst_force, (force - exact.integral.force).norm() / exact.integral.weight);
  }
  CAPTURE(worst, worst_force);
  CHECK(worst < 1e-12);
  CHECK(worst_force < 1e-12);
}

TEST_CASE("contact keeps linear and angular momentum", "[collar]") {
  test::SeededRandom random(13);
  double worst = 0, worst_moment = 0;
  for (int i = 0; i < scaled(2000); ++i) {
    const auto pair = random_pair(random, random.integer(3, 12), random.uniform(.3, 1.2));
    if (!pair) continue;
    const Resultant a = pair->on(0), b = pair->on(1);
    const double size = pair->largest_force();
    worst = std::max(worst, (a.force + b.force).norm() / size);
    worst_moment = std::max(worst_moment, std::abs(a.moment + b.moment) / size);
  }
  CAPTURE(worst, worst_moment);
  CHECK(worst < 1e-12);
  CHECK(worst_moment < 1e-12);
}

TEST_CASE("an edge on a bisector belongs to one face", "[collar]") {
  // Corner of the unit square, and a triangle with an edge exactly on the diagonal through it.
  const std::vector<Vec2> square = samples::block(0, 0, 1, 1).vertices();
  for (const std::vector<Vec2>& triangle :
       {std::vector<Vec2>{{-.25, -.25}, {.25, -.25}, {.25, .25}},
        std::vector<Vec2>{{.25, .25}, {-.25, .25}, {-.25, -.25}}}) {
    const OutlinePair pair(square, triangle, .5, .5);
    // Half of the square [0, .25]^2 under a roof h/r: INT h dA = d^3/6.
    const double own = std::pow(.25, 3) / 6 / .5;
    const Polygon a(square), b(triangle);
    const PairResult exact = overlap_method(a, make_potential(a, length_choice(.5)), b,
                                            make_potential(b, length_choice(.5)));
    CHECK(pair.contacts->energy() == Approx(exact.volume.energy).epsilon(1e-14));
    CHECK(pair.contacts->energy() > own);
    const Vec2 force = pair.on(0).force;
    CHECK((force - exact.integral.force).norm() < 1e-15);
  }
}

TEST_CASE("flat on flat: the closed form for any splitting of the edges", "[collar]") {
  const double d = .0625, width = 1, k = 3, r_c = .25, r_t = .375;
  const double force = k * d * (width / r_t + (width - d) / r_c);
  const double energy = k * (width * d * d / (2 * r_t) + (width * d * d / 2 - d * d * d / 3) / r_c);
  for (const int parts : {1, 2, 3, 7}) {
    for (const int other : {1, 2, 4}) {
      const OutlinePair pair(split(samples::block(-.5, -d, .5, 1 - d).vertices(), parts),
                             split(samples::block(-1, -1, 1, 0).vertices(), other), r_c, r_t,
                             law_of(k));
      const Resultant on_c = pair.on(0);
      CAPTURE(parts, other);
      CHECK(on_c.force.y() == Approx(force).epsilon(1e-13));
      CHECK(std::abs(on_c.force.x()) < 1e-14);
      CHECK(pair.contacts->energy() == Approx(energy).epsilon(1e-13));
      CHECK(largest_penetration(*pair.contacts) == Approx(d).epsilon(1e-14));
      // Away from the corners p = k d (1/r_c + 1/r_t).
      const double pressure = pair.contacts->surface_records()[3].pressure;
      if (parts == 7) CHECK(pressure == Approx(k * d * (1 / r_t + 1 / r_c)).epsilon(1e-13));
    }
  }
}

TEST_CASE("a tip dragged over a flat row of edges meets no tangential force", "[collar]") {
  test::SeededRandom random(14);
  for (const int parts : {1, 8, 31}) {
    double worst = 0;
    for (int i = 0; i <= scaled(400); ++i) {
      const double x = i % 2 ? random.uniform(-.9, .9) : .0625 * random.integer(-14, 14);
      const double d = random.uniform(.001, .012);
      const std::vector<Vec2> tip{{x, -d}, {x + .5, .5 - d}, {x - .5, .5 - d}};
      const OutlinePair pair(split(samples::block(-1, -.5, 1, 0).vertices(), parts), tip, .02, .02);
      const Vec2 force = pair.on(1).force;
      REQUIRE(force.y() > 0);
      REQUIRE(largest_relative_depth(*pair.contacts) < 1);
      worst = std::max(worst, std::abs(force.x() / force.y()));
      // Apex on flat.
      CHECK(force.y() == Approx(d * d * (1 + std::sqrt(.5)) / .02).epsilon(1e-11));
    }
    CAPTURE(parts, worst);
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("convex and reflex corners of many angles", "[collar]") {
  // A tip in the notch of a block, and a block's corner on a flat: gradient and CGAL's energy.
  for (const double opening : {.3, .8, 1.2, 2., 2.9}) {
    const double half = opening / 2;
    const Vec2 left = 2 * Vec2(-std::sin(half), std::cos(half));
    const Vec2 right(-left.x(), left.y());
    const std::vector<Vec2> notch{{0, 0},  left,           {-3, left.y()}, {-3, -2},
                                  {3, -2}, {3, right.y()}, right};
    const double tilt = half / 2;
    const std::vector<Vec2> tip{{.01, -.06},
                                {.01 + std::sin(tilt), -.06 + std::cos(tilt)},
                                {.01 - std::sin(1.1 * tilt), -.06 + std::cos(1.1 * tilt)}};
    const OutlinePair pair(notch, tip, .5, .3);
    CAPTURE(opening);
    REQUIRE(largest_relative_depth(*pair.contacts) > 0);
    REQUIRE(roof_ratio(pair) < 1);
    CHECK(gradient_error(pair) < 1e-12);
    const Polygon a(notch), b(tip);
    const PairResult exact = overlap_method(a, make_potential(a, length_choice(.5)), b,
                                            make_potential(b, length_choice(.3)));
    CHECK(pair.contacts->energy() == Approx(exact.volume.energy).epsilon(1e-12));
  }
}

TEST_CASE("outlines on a lattice: vertices on vertices, edges and bisectors", "[collar]") {
  test::SeededRandom random(15);
  double worst = 0, worst_energy = 0;
  int pairs = 0;
  for (int i = 0; i < scaled(2000); ++i) {
    const double grid = 1. / (8 << random.integer(0, 2));
    const auto outline = [&] {
      const Polygon star = samples::random_star_shaped(random, random.integer(3, 10), .4);
      return split(
          samples::mapped(star,
                          [&](const Vec2& v) -> Vec2 { return grid * (v / grid).array().round(); })
              .vertices(),
          random.integer(1, 3));
    };
    const Vec2 step(random.integer(-1, 1), random.integer(-1, 1));
    std::vector<Vec2> a, b;
    try {
      a = outline();
      b = random.integer(0, 2) == 0 ? a : outline();
    } catch (const InvalidPolygon&) {
      continue;  // two vertices in one place
    }
    std::optional<OutlinePair> pair;
    for (int k = static_cast<int>(2.5 / grid); k > 0 && !step.isZero(); --k) {
      std::vector<Vec2> moved = b;
      for (Vec2& v : moved) v += k * grid * step;
      pair.emplace(a, moved, .3, .4);
      if (largest_relative_depth(*pair->contacts) > 1e-6) break;
    }
    if (!pair || largest_relative_depth(*pair->contacts) < 1e-6 ||
        largest_relative_depth(*pair->contacts) >= 1)
      continue;
    // Overlapping parts of faces beyond the heights at which they shrink to a point cancel each
    // other; what remains may be small against them.
    const OutlineSurfaces& o = pair->contacts->surfaces().outlines();
    if (std::ranges::any_of(pair->contacts->contacts(), [&](const Contact& c) {
          return c.relative_depth * o.depth[c.b] > o.regular_depth[c.b];
        })) {
      continue;
    }
    ++pairs;
    const Resultant on_a = pair->on(0), on_b = pair->on(1);
    const double size = pair->largest_force();
    worst = std::max({worst, (on_a.force + on_b.force).norm() / size,
                      std::abs(on_a.moment + on_b.moment) / size});
    if (i % 20 != 0 || !(roof_ratio(*pair) < 1)) continue;
    try {
      const Polygon first(pair->a), second(pair->b);
      const PairResult exact = overlap_method(first, make_potential(first, length_choice(.3)),
                                              second, make_potential(second, length_choice(.4)));
      worst_energy =
          std::max(worst_energy,
                   std::abs(pair->contacts->energy() - exact.volume.energy) / exact.volume.energy);
    } catch (const SkeletonFailure&) {
    }
  }
  CHECK(pairs > least(scaled(2000) / 5));
  CAPTURE(worst, worst_energy);
  CHECK(worst < 1e-12);
  CHECK(worst_energy < 1e-12);
}

TEST_CASE("NaN is never a miss", "[collar]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const CollarFace<double> face{0, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, .5, .4};
  CollarPiece<double> piece;
  CollarCrossings<double> crossings;
  CHECK(collar_piece(face, nan, .1, .5, .1, piece, crossings));
  CHECK(collar_piece(face, .5, .1, .5, nan, piece, crossings));
  CHECK(std::isnan(piece.sum));
  CHECK_FALSE(collar_piece(face, .2, -.1, .5, -.1, piece, crossings));
}

namespace {

// Places on a coarse grid, so that many edges touch corners, bases and bisectors exactly.
struct EdgeAndFace {
  CollarFace<double> face;
  Vec2 p, q;

  explicit EdgeAndFace(samples::Random& random) {
    const bool coarse = random.uniform(0, 1) < .5;
    const auto place = [&](double reach) {
      const double x = random.uniform(-reach, reach);
      return coarse ? std::round(4 * x) / 4 : x;
    };
    Vec2 before, a, b, after;
    const auto far = [](const Vec2& u, const Vec2& v) { return (u - v).norm() > .2; };
    do {
      before = {place(2), place(2)}, a = {place(2), place(2)};
      b = {place(2), place(2)}, after = {place(2), place(2)};
    } while (!far(before, a) || !far(a, b) || !far(b, after));
    const Vec2 t0 = (a - before).normalized(), t = (b - a).normalized(),
               t1 = (after - b).normalized();
    const Mitre<double> ma(t0.x(), t0.y(), t.x(), t.y()), mb(t.x(), t.y(), t1.x(), t1.y());
    face = CollarFace<double>{a.x(), a.y(), b.x(),          b.y(),
                              t.x(), t.y(), (b - a).norm(), ma.x,
                              ma.y,  mb.x,  mb.y,           random.uniform(.1, 2),
                              0}
               .with_regular_depth();
    p = {place(3), place(3)}, q = {place(3), place(3)};
  }
};

template <int lanes>
void compare_packs(int count) {
  using Pack = PackOf<lanes>;
  samples::Random random(lanes);
  int met = 0, deep = 0, leaving = 0;  // the last: edges that are plain only inside the cell
  for (int i = 0; i < count; i += lanes) {
    std::vector<EdgeAndFace> all;
    for (int l = 0; l < lanes; ++l) all.emplace_back(random);
    const auto each = [&](const auto& f) {
      return pack_of<lanes>([&](int l) { return f(all[static_cast<size_t>(l)]); });
    };
    const auto of_face = [&](double CollarFace<double>::*number) {
      return each([&](const EdgeAndFace& e) { return e.face.*number; });
    };
    using Face = CollarFace<double>;
    const CollarFace<Pack> faces{
        of_face(&Face::ax),           of_face(&Face::ay),  of_face(&Face::bx),
        of_face(&Face::by),           of_face(&Face::tx),  of_face(&Face::ty),
        of_face(&Face::length),       of_face(&Face::max), of_face(&Face::may),
        of_face(&Face::mbx),          of_face(&Face::mby), of_face(&Face::depth),
        of_face(&Face::regular_depth)};
    const CollarPieces<Pack> found =
        collar_pieces(faces, each([](const EdgeAndFace& e) { return e.p.x(); }),
                      each([](const EdgeAndFace& e) { return e.p.y(); }),
                      each([](const EdgeAndFace& e) { return e.q.x(); }),
                      each([](const EdgeAndFace& e) { return e.q.y(); }));
    for (int l = 0; l < lanes; ++l) {
      const EdgeAndFace& e = all[static_cast<size_t>(l)];
      CollarPiece<double> piece;
      CollarCrossings<double> crossings;
      const bool meets = collar_piece(e.face, e.p.x(), e.p.y(), e.q.x(), e.q.y(), piece, crossings);
      if (found.general.m[l] != 0) {
        ++deep;
        REQUIRE(found.met.m[l] == 0);
        continue;
      }
      REQUIRE(crossings.count == 0);
      REQUIRE(meets == (found.met.m[l] != 0));
      if (!meets) continue;
      ++met;
      const Vec2 along(e.face.tx, e.face.ty), start(e.face.ax, e.face.ay);
      leaving +=
          std::max(cross(along, e.p - start), cross(along, e.q - start)) > e.face.regular_depth;
      const std::array of_pack{found.from.v[l],   found.to.v[l],     found.sum.v[l],
                               found.first.v[l],  found.area.v[l],   found.along.v[l],
                               found.height.v[l], found.deepest.v[l]};
      const std::array of_one{piece.from, piece.to,    piece.sum,    piece.first,
                              piece.area, piece.along, piece.height, piece.deepest};
      for (size_t k = 0; k < of_one.size(); ++k) {
        CAPTURE(k, of_pack[k], of_one[k]);
        REQUIRE((of_pack[k] == of_one[k] || (std::isnan(of_pack[k]) && std::isnan(of_one[k]))));
      }
    }
  }
  CHECK(met > least(count / 50));
  CHECK(deep > least(count / 50));
  CHECK(leaving > least(count / 500));
}

}  // namespace

TEST_CASE("packs of edges and cells have the bits of single ones", "[collar]") {
  compare_packs<4>(scaled(40000));
  compare_packs<8>(scaled(40000));
}
