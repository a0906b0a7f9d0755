// Events of a skeleton that coincide: what follows from rings full of them.
#include <catch2/catch.hpp>

#include "geometry/exact/pair_methods.hpp"
#include "geometry/polygon/canonical_pose.hpp"
#include "geometry/potential/inscribed_circle.hpp"
#include "geometry/skeleton/exact_front.hpp"
#include "geometry/skeleton/node_places.hpp"
#include "tests/geometry/skeleton/exact_wavefront.hpp"
#include "tests/geometry/skeleton/holed_polygons.hpp"
#include "tests/public_rings.hpp"

using namespace apothem;
using test::ExactWavefront;
using test::Map;

namespace {

using Corner = std::array<double, 3>;                                // of a face: x, y and height
using Faces = std::map<std::array<double, 4>, std::vector<Corner>>;  // by the ends of their edges

// The faces of a skeleton of a mapped polygon, in the coordinates of the original.
Faces faces_before(const Map& map, const Polygon& polygon, const Skeleton& skeleton) {
  const NodePlaces places(polygon, skeleton.nodes);
  Faces faces;
  for (int e = 0; e < polygon.size(); ++e) {
    Vec2 a = map.undo(polygon[e]), b = map.undo(polygon.after(e));
    if (std::pair(b.x(), b.y()) < std::pair(a.x(), a.y())) std::swap(a, b);
    std::vector<Corner> corners;
    for (const int i : skeleton.faces[e]) {
      const Vec2 p = map.undo(places[i]);
      corners.push_back({p.x(), p.y(), skeleton.nodes[i].height / map.scale});
    }
    std::sort(corners.begin(), corners.end());
    faces[{a.x(), a.y(), b.x(), b.y()}] = corners;
  }
  return faces;
}

std::string text(const Polygon& polygon) {
  std::string result;
  for (const std::vector<Vec2>& ring : rings_of(polygon)) {
    for (const Vec2& v : ring) result += std::to_string(v.x()) + " " + std::to_string(v.y()) + ", ";
    result += "; ";
  }
  return result;
}

// Half of the last bit of a double.
double half_ulp(double value) { return std::exp2(std::ilogb(value) - 53); }

// True if the nodes of a face are those of the brute-force wavefront, rounded to nearest.
bool agree(const std::set<ExactWavefront::Node>& nodes, const std::vector<int>& face,
           const Skeleton& skeleton, const Polygon& polygon) {
  using Rational = ExactWavefront::Rational;
  const double half = std::exp2(std::ilogb(bounding_box(polygon).extent()) + 1 - 53);
  const auto near = [](const Rational& exact, const Rational& rounded, double error) {
    return abs(exact - rounded) <= error;
  };
  return nodes.size() == face.size() && std::all_of(face.begin(), face.end(), [&](int i) {
           const Skeleton::Node& node = skeleton.nodes[i];
           return std::any_of(nodes.begin(), nodes.end(), [&](const ExactWavefront::Node& exact) {
             const auto& [x, y, time] = exact;
             const Rational nx = Rational(node.point.x()) + polygon.origin().x();
             const Rational ny = Rational(node.point.y()) + polygon.origin().y();
             return near(x, nx, half) && near(y, ny, half) &&
                    near(time, node.height, time == 0 ? 0 : half_ulp(node.height));
           });
         });
}

// Fails unless the faces of the skeletons of all images are those of the polygon's own.
void require_same_roof(const Polygon& polygon) {
  const Faces faces = faces_before({}, polygon, straight_skeleton(polygon));
  for (const Map& map : test::maps()) {
    INFO(map.name << ": " << text(polygon));
    const Polygon image = map(polygon);
    const Skeleton skeleton = straight_skeleton(image);
    REQUIRE_FALSE(broken_law(skeleton, image));
    REQUIRE(faces_before(map, image, skeleton) == faces);
  }
}

using Centres = std::set<std::array<double, 2>>;
Centres centres_before(const Map& map, const Polygon& polygon, const InscribedCircle& circle) {
  const PlaceGrid grid(polygon);
  Centres centres;
  for (const Vec2& c : circle.centres) {
    const Vec2 p = map.undo(grid.world(c));
    centres.insert({p.x(), p.y()});
  }
  return centres;
}

void require_same_circle(const Polygon& polygon) {
  const InscribedCircle circle = largest_inscribed_circle(polygon);
  const Centres centres = centres_before({}, polygon, circle);
  for (const Map& map : test::maps()) {
    INFO(map.name << ": " << text(polygon));
    const Polygon image = map(polygon);
    const InscribedCircle other = largest_inscribed_circle(image);
    REQUIRE(other.radius / map.scale == circle.radius);
    REQUIRE(centres_before(map, image, other) == centres);
  }
}

// Fails unless the skeleton is that of the brute-force wavefront.
void require_exact(const Polygon& polygon) {
  const Skeleton skeleton = straight_skeleton(polygon);
  const ExactWavefront exact(polygon);
  for (int e = 0; e < polygon.size(); ++e) {
    INFO("edge " << e);
    REQUIRE(agree(exact.faces()[e], skeleton.faces[e], skeleton, polygon));
  }
}

}  // namespace

TEST_CASE("tied events: no map of the ring changes a bit of roof and faces", "[skeleton]") {
  test::SeededRandom random(431);
  for (int i = 0; i < (test::long_run() ? 10000 : test::scaled(240)); ++i) {
    INFO("ring " << i);
    require_same_roof(test::random_tied(random, i));
  }
}

TEST_CASE("tied events around holes: no map of the rings changes a bit of roof and faces",
          "[skeleton]") {
  test::SeededRandom random(436);
  for (int i = 0; i < (test::long_run() ? 5000 : test::scaled(150)); ++i) {
    INFO("polygon " << i);
    require_same_roof(test::random_tied_with_holes(random, i));
  }
}

TEST_CASE("tied events: no map of the ring changes a bit of the inscribed circle", "[skeleton]") {
  test::SeededRandom random(433);
  for (int i = 0; i < (test::long_run() ? 10000 : test::scaled(1000)); ++i) {
    const Polygon polygon = test::random_tied(random, i);
    INFO("ring " << i);
    require_same_circle(polygon);
  }
}

TEST_CASE("tied events around holes: no map of the rings changes a bit of the inscribed circle",
          "[skeleton]") {
  test::SeededRandom random(437);
  for (int i = 0; i < (test::long_run() ? 5000 : test::scaled(500)); ++i) {
    INFO("polygon " << i);
    require_same_circle(test::random_tied_with_holes(random, i));
  }
}

namespace {

// A polygon near the axes whose coordinates have digits below those of its size: some of what
// coincides in whole numbers does so up to round-off.
Polygon random_fine(test::SeededRandom& random, int i) {
  const Polygon whole =
      i % 4 == 0 ? samples::random_star_shaped(random, random.integer(4, 90), random.uniform(.1, 1))
      : i % 4 == 1 ? test::random_tied_with_holes(random, i)
                   : test::random_tied(random, i);
  const double factor = random.uniform(.1, 1);
  const double extent = factor * bounding_box(whole).extent();
  const Vec2 shift(random.uniform(-extent, extent), random.uniform(-extent, extent));
  Rings rings = rings_of(whole);
  for (std::vector<Vec2>& ring : rings) {
    for (Vec2& v : ring) v = factor * v + shift;
  }
  return Polygon(polygon_of_rings(rings));
}

}  // namespace

TEST_CASE("fine coordinates: no map of the rings changes a bit of roof, faces and circle",
          "[skeleton]") {
  test::SeededRandom random(440);
  int fine = 0;
  for (int i = 0; i < (test::long_run() ? 5000 : test::scaled(100)); ++i) {
    const Polygon polygon = random_fine(random, i);
    INFO("polygon " << i);
    if (PlaceGrid(polygon).anchor() != polygon.origin()) ++fine;
    require_same_roof(polygon);
    require_same_circle(polygon);
  }
  CHECK(fine > test::least(10));
}

TEST_CASE("public rings: no map of the ring changes a bit of roof, faces and circle",
          "[skeleton]") {
  std::uint64_t number = 0;
  for (const auto& [name, line, ring] : test::public_rings(test::long_run() ? 2500 : 40)) {
    if (!test::long_run() && (++number + test::chosen_seed()) % 16 != 0) continue;
    std::optional<Polygon> polygon;
    try {
      polygon.emplace(ring);
      largest_inscribed_circle(*polygon);  // refuses what is too thin
    } catch (const InvalidPolygon&) {
      continue;
    }
    INFO(name);
    require_same_roof(*polygon);
    require_same_circle(*polygon);
  }
}

namespace {

struct TiedPair {
  Polygon a, b;
};
TiedPair tied_pair(test::SeededRandom& random, int i) {
  Polygon a = i % 3 == 0 ? test::random_tied_with_holes(random, i) : test::random_tied(random, i);
  const Polygon other = test::random_tied(random, i / 6);
  const double reach = .3 * (bounding_box(a).extent() + bounding_box(other).extent());
  const Vec2 shift(std::round(random.uniform(-reach, reach)),
                   std::round(random.uniform(-reach, reach)));
  // Some pairs are symmetric as a whole, about the origin or about a line.
  return {std::move(a), i % 7 == 0 ? other : samples::shifted(other, shift)};
}

// All numbers of a contact of a mapped pair, in the coordinates and the sense of the original.
std::vector<double> numbers_before(const Map& map, const Polygon& a, const Polygon& b,
                                   std::string_view method) {
  const PosedPair pair(a, b);
  const PairContact c = pair.contact(method, {});
  const Vec2 force = map.undo(c.force), point = map.undo(c.loading_point);
  const double s = map.scale, moment = (map.mirrored ? -1 : 1) / (s * s);
  return {force.x(),
          force.y(),
          moment * c.moment_a + 0,
          moment * c.moment_b + 0,
          point.x(),
          point.y(),
          c.energy / (s * s),
          c.overlap_area / (s * s),
          c.own_length_a / s,
          c.own_length_b / s,
          c.weight / s,
          c.largest_phi,
          pair.penetration() / s};
}

}  // namespace

TEST_CASE("tied events: no map of a pair changes a bit of its contact", "[skeleton]") {
  test::SeededRandom random(434);
  int touching = 0, symmetric = 0;
  for (int i = 0; i < (test::long_run() ? 1000 : test::scaled(100)); ++i) {
    const auto [a, b] = tied_pair(random, i);
    const std::string_view method = kPairMethods[i % 20 == 0 ? 2 : i % 2];
    const std::vector<double> numbers = numbers_before({}, a, b, method);
    if (numbers[6] > 0) ++touching;
    if (first_image({&a, &b}).maps.size() > 1) ++symmetric;
    for (const Map& map : test::maps()) {
      INFO("pair " << i << ", " << map.name << ", " << method << ": " << text(a) << text(b));
      REQUIRE(numbers_before(map, map(a), map(b), method) == numbers);
    }
  }
  CHECK(touching > test::least(10));
  if (test::long_run()) CHECK(symmetric > 10);
}

// In the pose at hand, as in runs, forces are sums in the order of the edges.
TEST_CASE("tied events: the pose in which a pair is computed changes forces by round-off only",
          "[skeleton]") {
  test::SeededRandom random(439);
  for (int i = 0; i < test::scaled(100); ++i) {
    const auto [a, b] = tied_pair(random, i);
    const PairIntegral pair = test::edge(a, b).integral;
    INFO("pair " << i);
    CHECK((PosedPair(a, b).contact("edge", {}).force - pair.force).norm() <= 1e-13 * pair.weight);
  }
}

TEST_CASE("without ties: both constructions have the same bits", "[skeleton]") {
  test::SeededRandom random(435);
  for (int i = 0; i < test::scaled(800); ++i) {
    const Polygon polygon = i % 2 == 0 ? samples::random_star_shaped(random, random.integer(4, 40),
                                                                     random.uniform(.1, 1))
                                       : test::random_drilled(random, random.integer(1, 20));
    const Skeleton skeleton = straight_skeleton(polygon);
    std::optional<SkeletonParts> parts = exact_skeleton(polygon, {});
    INFO("polygon " << i);
    REQUIRE(parts);
    REQUIRE(faces_before({}, polygon, skeleton) ==
            faces_before({}, polygon, assemble(std::move(*parts), polygon)));
  }
}

TEST_CASE("tied events: the skeleton is that of a wavefront in rational numbers", "[skeleton]") {
  test::SeededRandom random(432);
  for (int i = 0; i < (test::long_run() ? 500 : test::scaled(250)); ++i) {
    const Polygon polygon(test::random_rational(random, random.integer(2, i % 5 == 0 ? 30 : 12)));
    INFO("ring " << i << ": " << text(polygon));
    require_exact(polygon);
  }
}

TEST_CASE("tied events around holes: the skeleton is that of a wavefront in rational numbers",
          "[skeleton]") {
  test::SeededRandom random(438);
  for (int i = 0; i < (test::long_run() ? 500 : test::scaled(250)); ++i) {
    const Polygon polygon = test::random_rational_with_holes(random);
    INFO("polygon " << i << ": " << text(polygon));
    require_exact(polygon);
  }
}
