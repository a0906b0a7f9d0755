#include "apps/cases/hard_pairs.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "apps/cases/samples.hpp"

namespace apothem {
namespace {

using namespace samples;

std::string text(const char* format, double x) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, x);
  return buffer.data();
}

// Moves every coordinate by one unit in the last place up or down, or not at all, at random.
Polygon one_ulp_off(Random& random, const Polygon& polygon) {
  const auto move = [&](double x) {
    const int step = random.integer(-1, 1);
    return step == 0 ? x : std::nextafter(x, step * HUGE_VAL);
  };
  return mapped(polygon, [&](const Vec2& v) {
    const double x = move(v.x());
    return Vec2(x, move(v.y()));
  });
}

class Generator {
 public:
  std::vector<HardPair> run() {
    vertex_on_vertex();
    vertex_on_edge();
    collinear_edges();
    coincident();
    shallow();
    near_parallel();
    needle_on_needle();
    comb_in_comb();
    spiral_in_spiral();
    many_sided();
    offset();
    one_ulp();
    return std::move(pairs_);
  }

 private:
  void add(const std::string& variant, const Polygon& a, const Polygon& b) {
    pairs_.push_back({kind_, kind_ + "/" + variant, a, b});
  }

  // Apex on apex, for which a closed form exists (docs/theory.md, Sec. 2).
  void vertex_on_vertex() {
    kind_ = "vertex-on-vertex";
    for (const double degrees : {10.0, 30.0, 60.0}) {
      for (const double depth : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
        const double angle = degrees * M_PI / 180;
        add(text("%.0f-deg", degrees) + text("-depth-%g", depth),
            shifted(wedge_down(angle), {0, -depth}), wedge_up(angle));
      }
    }
    const Polygon cross = cross_of_squares();
    add("crosses-at-their-corners", shifted(cross, {1, 1}), cross);
    add("crosses-at-their-tips", shifted(cross, {1, 3}), cross);
    add("stars-tip-to-tip", shifted(star(5, .4), {1.999, 0}), turned(star(6, .4), M_PI / 6));
    add("stars-notch-to-tip", turned(shifted(star(5, .4), {1.39, 0}), M_PI / 5), star(5, .4));
  }

  // Apex on a flat edge, for which a closed form exists.
  void vertex_on_edge() {
    kind_ = "vertex-on-edge";
    for (const double depth : {1e-1, 1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
      add(text("30-deg-depth-%g", depth), shifted(wedge_down(M_PI / 6), {0, -depth}),
          block(-3, -2, 3, 0));
      add(text("turned-depth-%g", depth), turned(shifted(wedge_down(M_PI / 6), {0, -depth}), .7),
          turned(block(-3, -2, 3, 0), .7));
    }
    for (const double length : {40.0, 4000.0, 4e6}) {
      add(text("edge-of-%g-m", length), shifted(wedge_down(.25), {0, -6.1e-5}),
          Polygon({{-.47 * length, 0}, {-.3 * length, -1}, {.53 * length, 0}}));
    }
    add("corner-of-a-cross-on-a-block", shifted(turned(cross_of_squares(), .3), {0, 1.5}),
        block(-3, -2, 3, 0));
    add("from-inside", Polygon({{.25, 0}, {.75, .25}, {.5, .75}}), block(0, 0, 1, 1));
  }

  // Flat on flat, for which a closed form exists.
  void collinear_edges() {
    kind_ = "collinear-edges";
    const Polygon square = block(-.5, 0, .5, 1);
    for (const double depth : {.25, 1e-1, 1e-3, 1e-6, 1e-9}) {
      add(text("inside-a-wider-edge-depth-%g", depth), shifted(square, {0, -depth}),
          block(-2, -1, 2, 0));
    }
    for (const double shift : {.5, .125, .75}) {
      for (const double angle : {0.0, .3, 1.1}) {
        add(text("side-by-side-%g", shift) + text("-turned-%g", angle),
            turned(shifted(square, {shift, 0}), angle), turned(square, angle));
      }
    }
    add("flush-on-two-sides", block(0, 0, .5, .5), block(0, 0, 1, 1));
    add("flush-on-three-sides", block(0, 0, 1, .5), block(0, 0, 1, 1));
    add("flush-and-touching", block(1, 0, 2, 1), block(0, 0, 1, 1));
    add("part-of-an-edge", block(1, .25, 2, 3), block(0, 0, 1, 1));
    add("crosses-along-an-arm", shifted(cross_of_squares(), {.75, 0}), cross_of_squares());
    add("L-on-L", shifted(l_shape(), {.5, 0}), l_shape());
    add("turned-L-on-L", turned(shifted(l_shape(), {.5, 0}), .4), turned(l_shape(), .4));
  }

  void coincident() {
    kind_ = "coincident";
    Random random(1);
    const std::pair<const char*, Polygon> shapes[] = {{"square", block(-.5, -.5, .5, .5)},
                                                      {"triangle", wedge_up(M_PI / 6)},
                                                      {"needle", needle(1, 1e-3)},
                                                      {"hexagon", regular(6)},
                                                      {"cross", cross_of_squares()},
                                                      {"star", star(5, .4)},
                                                      {"comb", comb(3)},
                                                      {"convex", random_convex(random, 9)},
                                                      {"any", random_star_shaped(random, 9, .3)}};
    for (const auto& [name, shape] : shapes) {
      add(name, shape, shape);
      std::vector<Vec2> ring = turned(shape, .3).vertices();
      const Polygon first(ring);
      std::rotate(ring.begin(), ring.begin() + 1, ring.end());
      add(std::string(name) + "-turned-and-from-another-vertex", first, Polygon(ring));
    }
  }

  // Overlaps of decreasing depth in random directions.
  void shallow() {
    kind_ = "shallow";
    Random random(2);
    // Pushes the foremost vertex of `a` into the middle of edge e of `b`, perpendicular to it.
    const auto pair = [&](const std::string& shape, const Polygon& a, const Polygon& b, int e) {
      const Vec2 edge = (b.after(e) - b[e]).normalized();
      const Vec2 normal(edge.y(), -edge.x());
      Vec2 tip = a[0];
      for (const Vec2& v : a.vertices()) {
        if (normal.dot(v) < normal.dot(tip)) tip = v;
      }
      const Vec2 middle = (b[e] + b.after(e)) / 2;
      for (const double depth : {1e-6, 1e-9, 1e-12, 1e-15}) {
        add(shape + text("-%g", depth), shifted(a, middle - depth * normal - tip), b);
      }
    };
    for (int i = 1; i <= 4; ++i) {
      const Polygon a = random_convex(random, random.integer(3, 8));
      pair("convex-" + std::to_string(i), a, random_convex(random, random.integer(3, 8)), 1);
    }
    // Edge 3 of the cross is the end of an arm.
    pair("star-on-cross", turned(star(7, .3), .1), turned(cross_of_squares(), .6), 3);
    for (const double depth : {1e-6, 1e-9, 1e-12, 1e-15}) {
      add(text("flat-%g", depth), turned(block(-.5, -depth, .5, 1 - depth), .3),
          turned(block(-2, -1, 2, 0), .3));
      add(text("upright-flat-%g", depth), block(-.5, -depth, .5, 1 - depth), block(-2, -1, 2, 0));
    }
  }

  void near_parallel() {
    kind_ = "near-parallel";
    for (const double tilt : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
      add(text("flat-tilted-%g", tilt), shifted(turned(block(-.5, 0, .5, 1), tilt), {0, -1e-2}),
          block(-2, -1, 2, 0));
      add(text("crossing-edges-%g", tilt), turned(block(-1, 0, 1, 1), tilt), block(-1, -1, 1, 0));
      add(text("slabs-%g", tilt), turned(block(-5, -.05, 5, .05), 1 + tilt),
          turned(block(-5, 0, 5, .1), 1));
      add(text("crosses-%g", tilt), turned(cross_of_squares(), .2 + tilt),
          turned(cross_of_squares(), .2));
    }
  }

  void needle_on_needle() {
    kind_ = "needle-on-needle";
    for (const double width : {1e-2, 1e-4, 1e-6}) {
      const Polygon n = needle(1, width);
      const std::string name = text("width-%g", width);
      add(name + "-crossed", shifted(turned(shifted(n, {-.5, 0}), 1), {.4, 0}), n);
      add(name + "-tip-to-tip", shifted(turned(n, M_PI), {1.5, width / 10}), n);
      add(name + "-alongside", shifted(n, {.1, width / 5}), n);
      add(name + "-on-a-square", n, turned(block(.5, -.5, 1.5, .5), .3));
    }
  }

  void comb_in_comb() {
    kind_ = "comb-in-comb";
    const Polygon c = comb(4);
    // The other comb hangs from above, with its teeth between those of the first.
    const Polygon hanging = shifted(turned(c, M_PI), {7, 6});
    for (const double bite : {.5, 1e-3, 1e-9}) {
      add(text("side-of-teeth-%g", bite), shifted(hanging, {1 + bite, -1.5}), c);
      add(text("tip-of-teeth-%g", bite), shifted(hanging, {0, -bite}), c);
      add(text("ground-of-gaps-%g", bite), shifted(hanging, {1, -2 - bite}), c);
    }
    add("flush", shifted(hanging, {1, -1.5}), c);
    add("turned", shifted(turned(hanging, .03), {1, -1.5}), c);
  }

  void spiral_in_spiral() {
    kind_ = "spiral-in-spiral";
    const Polygon s = spiral(2, 12);
    add("between", turned(s, M_PI), s);
    add("overlapping", turned(s, M_PI / 2), s);
    add("turned-by-1e-9", turned(s, 1e-9), s);
    add("shifted", shifted(s, {.3, .1}), s);
    add("mirrored", mapped(s, [](const Vec2& v) { return Vec2(-v.x(), v.y()); }), s);
  }

  void many_sided() {
    kind_ = "many-sided";
    const Polygon round = regular(96);
    add("96-gons-half-a-side-off", turned(round, M_PI / 96), round);
    add("96-gons-side-by-side", shifted(round, {1.9, 0}), round);
    add("96-gons-shallow", shifted(turned(round, .01), {2 - 2e-3, 0}), round);
    add("96-gon-in-64-gon", scaled(round, 1.0005), regular(64));
    add("star-of-30-tips-on-itself", shifted(turned(star(30, .9), .05), {.01, 0}), star(30, .9));
    add("star-of-30-tips-on-96-gon", scaled(star(30, .9), 1.05), round);
  }

  void offset() {
    kind_ = "offset";
    Random random(3);
    for (const double far : {1e6, 1e7, 1e8, 1e9}) {
      for (int i = 1; i <= 2; ++i) {
        const Polygon a = random_convex(random, random.integer(3, 8));
        const Polygon b = posed(random_convex(random, random.integer(3, 8)),
                                world_centroid(a) + Vec2(.4, .3), random.uniform(0, 6));
        add(text("convex-%g", far) + "-" + std::to_string(i), shifted(a, {far, -far}),
            shifted(b, {far, -far}));
      }
      const Polygon cross = turned(cross_of_squares(), random.uniform(0, 6));
      add(text("crosses-%g", far), shifted(cross, {far, far}),
          shifted(shifted(cross_of_squares(), {1.3, .7}), {far, far}));
      // 2^-13 m is the smallest depth that double precision resolves at all of these distances.
      add(text("flat-%g", far), shifted(block(-.5, -0x1p-13, .5, 1 - 0x1p-13), {far, far}),
          shifted(block(-2, -1, 2, 0), {far, far}));
    }
  }

  void one_ulp() {
    kind_ = "one-ulp";
    Random random(4);
    const std::tuple<const char*, Polygon, Polygon> degenerate[] = {
        {"vertex-on-vertex", turned(wedge_down(M_PI / 6), .3), turned(wedge_up(M_PI / 6), .3)},
        {"vertex-on-edge", turned(wedge_down(M_PI / 6), .3), turned(block(-3, -2, 3, 0), .3)},
        {"shared-edge", turned(block(1, 0, 2, 1), .3), turned(block(0, 0, 1, 1), .3)},
        {"collinear", turned(block(.5, 0, 1.5, 1), .3), turned(block(0, 0, 1, 1), .3)},
        {"coincident", turned(regular(5), .3), turned(regular(5), .3)},
        {"cross", turned(cross_of_squares(), .3), turned(cross_of_squares(), .3)}};
    for (const auto& [name, a, b] : degenerate) {
      for (int i = 1; i <= 3; ++i) {
        const Vec2 away_from_zero(.7, .4);
        add(name + std::string("-") + std::to_string(i),
            one_ulp_off(random, shifted(a, away_from_zero)), shifted(b, away_from_zero));
      }
    }
  }

  std::string kind_;
  std::vector<HardPair> pairs_;
};

}  // namespace

std::vector<HardPair> hard_pairs() { return Generator().run(); }

}  // namespace apothem
