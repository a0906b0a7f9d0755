#include "lib/contact/law/event_impulse.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace apothem;

namespace {

template <class Force>
EventForces sampled(const std::vector<double>& events, int panels, const Force& force) {
  std::vector<EventSample> samples;
  const int inside = find_event_samples(events, panels, samples);
  EventForces f;
  for (const EventSample& s : samples) f.add(s, force(s.theta));
  f.first = force(samples.front().theta);
  f.last = force(samples[static_cast<size_t>(inside) - 1].theta);
  return f;
}

}  // namespace

TEST_CASE("samples of a step integrate and differentiate polynomials between kinks exactly",
          "[onset]") {
  for (const int panels : {1, 2}) {
    for (const double kink : {.01, .3, .5, .97}) {
      CAPTURE(panels, kink);
      // A quartic before the kink, and another one with the same value behind it.
      const auto force = [&](double t) {
        const double u = t - kink;
        return t < kink ? 2 + u * u * u * u - 3 * u : 2 + 5 * u - u * u * u * u;
      };
      const EventForces f = sampled({kink}, panels, force);
      const double a = kink, b = 1 - kink;
      const double before = 2 * a + std::pow(a, 5) / 5 + 1.5 * a * a;
      const double behind = 2 * b + 2.5 * b * b - std::pow(b, 5) / 5;
      CHECK(f.mean == Approx(before + behind).epsilon(1e-13));
      CHECK(f.start_slope == Approx(-4 * a * a * a - 3).epsilon(1e-11));
      CHECK(f.end_slope == Approx(5 - 4 * b * b * b).epsilon(1e-11));
      CHECK(f.first == force(0));
      CHECK(f.last == force(1));
    }
  }
}

TEST_CASE("a smooth step misses no impulse", "[onset]") {
  const EventForces f = sampled({}, 1, [](double t) { return 1 + 2 * t - 3 * t * t; });
  CHECK(f.missing() == Approx(0).margin(1e-14));
  const EventForces g = sampled({.4, .4, .7}, 1, [](double t) { return 1 + 2 * t; });
  CHECK(g.missing() == Approx(0).margin(1e-14));
}

// A mass that runs into a spring, or leaves it: Verlet keeps v^2 + w^2 x^2 (1 - (w h)^2/4) with
// the spring and v^2 without it. The energies agree if the first is multiplied by a constant, which
// is 1 + (w h)^2/6 to the order h^2.
TEST_CASE("the rest of a linear onset and release is removed to the order 6", "[onset]") {
  const auto error = [](double h, double fraction) {
    const double w2 = 1, speed = 1;
    // The contact begins at 1 - fraction of the step.
    double v = speed, x = fraction * h * v;
    const auto spring = [&](double place) { return place > 0 ? -w2 * place : 0; };
    const auto step = [&](double from, double velocity, double event) {
      const EventForces f =
          sampled({event}, 1, [&](double t) { return spring(from + t * h * velocity); });
      EventResidual rest(h);
      rest.add(f, {f.missing()}, {0, 0}, 1, velocity);
      return h * (f.last / 2 + f.missing() + rest.correction() * f.mean);
    };
    v += step(x - h * v, v, 1 - fraction);
    double fx = spring(x);
    // The whole contact, and its release.
    for (int i = 0; i < 100000; ++i) {
      const double middle = v + h / 2 * fx, next = x + h * middle;
      if (next < 0) {
        v = middle + step(x, middle, x / (x - next));
        break;
      }
      x = next, fx = spring(x), v = middle + h / 2 * fx;
    }
    return std::abs(v * v / (speed * speed) - 1);
  };
  for (const double fraction : {.1, .37, .62, .9}) {
    CAPTURE(fraction);
    const double coarse = error(.4, fraction), fine = error(.1, fraction);
    CHECK(coarse < 3e-5);
    CHECK(fine < 1e-8);
  }
}
