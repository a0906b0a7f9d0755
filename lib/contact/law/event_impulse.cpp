#include "lib/contact/law/event_impulse.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {
namespace {

constexpr std::array kSlope{-25. / 3, 48. / 3, -36. / 3, 16. / 3, -3. / 3};
// Slopes are taken over a part of the step without kinks that is at least this long; differences
// then keep 11 digits.
constexpr double kShortest = 1e-3;

// Where other forces reverse the motion within the step, the power of the mean force says little.
// This fraction of the other forces counts against it.
constexpr double kOthers = .25;
// Limit of the correction, relative to the term of J with the slopes.
constexpr double kLargestRest = .5;

// Returns x^2 y / (x^2 + y^2), which is close to x^2/y but stays finite where y is small.
double bounded_ratio(double x, double y) {
  const double scale = x * x + y * y;
  return scale > 0 ? x * x * y / scale : 0;
}

}  // namespace

int find_event_samples(std::span<const double> kinks, int panels,
                       std::vector<EventSample>& samples) {
  samples.assign(1, {0});
  double from = 0, last_part = 0;
  const auto integrate_until = [&](double until) {
    const double w = (until - from) / panels;
    if (!(w > 0)) return;
    last_part = w;
    for (int panel = 0; panel < panels; ++panel) {
      samples.back().mean += w * kBoole[0];
      for (size_t k = 1; k < 5; ++k) {
        samples.push_back({from + (panel + static_cast<double>(k) / 4) * w, w * kBoole[k]});
      }
    }
    from = samples.back().theta = until;
  };
  for (const double kink : kinks) integrate_until(kink);
  integrate_until(1);
  const size_t count = samples.size();

  // Each slope uses the samples of the panel at its end of the step, if that panel is long enough.
  // A kink exactly at the start, as where two bodies just touch at first, counts to this step, as
  // one exactly at the end does; so this step and the one before use the same slope. With many
  // panels the force may bend at once, and the slopes use samples of their own.
  const double first_part = (kinks.empty() ? 1 : kinks.front()) / panels;
  const bool own = panels >= kManyPanels;
  for (size_t k = 0; k < 5; ++k) {
    const double theta = static_cast<double>(k) * kShortest / 4;
    if (first_part > kShortest && !own) {
      samples[k].start_slope = kSlope[k] / first_part;
    } else {
      const double sign = first_part > kShortest ? 1 : -1;
      samples.push_back({sign * theta, 0, sign * kSlope[k] / kShortest, 0});
    }
    if (last_part > kShortest && !own) {
      samples[count - 1 - k].end_slope = -kSlope[k] / last_part;
    } else {
      const double sign = last_part > kShortest ? 1 : -1;
      samples.push_back({1 - sign * theta, 0, 0, -sign * kSlope[k] / kShortest});
    }
  }
  return static_cast<int>(count);
}

double Dynamics::lost_in_bend(double dt) const {
  double sum = 0;
  for (size_t c = 0; c < beside_after.size(); ++c) {
    const double g = weight.empty() ? 0 : weight[c];
    const double kept_before = before[c] + g - beside_before[c];
    const double kept_after = after[c] + g - beside_after[c];
    sum += inverse_mass[c] * (kept_after * beside_before[c] - kept_before * beside_after[c]);
  }
  return dt * dt / 12 * sum;
}

void EventResidual::add(const EventForces& f, const ImpulseParts& parts, const OtherForces& others,
                        double inverse_mass, double velocity) {
  const double first = f.first + others.first;
  const double last = f.last + others.last;
  const double p0 = -dt_ * first / 2;
  const double p1 = dt_ * (last / 2 + parts.missing);
  const double d0 = inverse_mass * p0;
  const double d1 = inverse_mass * p1;
  const double kept_first = first - others.beside_first;
  const double kept_last = last - others.beside_last;
  const double change = (others.last - others.beside_last) - (others.first - others.beside_first);
  energy_ += (p1 * d1 - p0 * d0) / 2 -
             dt_ / 6 *
                 ((f.end_slope + change) * (d1 + dt_ * inverse_mass * parts.beside) -
                  (f.start_slope + change) * d0) -
             dt_ * dt_ * inverse_mass *
                 ((last * last - first * first) / 8 - (kept_last * (last + others.beside_first) -
                                                       kept_first * (first + others.beside_last)) /
                                                          12);
  const double h = dt_ * inverse_mass;
  first_.along += f.start_slope * velocity;
  first_.aside += f.start_slope * d0;
  first_.pull += h * f.start_slope * first;
  last_.along += f.end_slope * velocity;
  last_.aside += f.end_slope * d1;
  last_.pull += h * f.end_slope * last;
  mean_ += inverse_mass * f.mean * f.mean;
  slopes_ += inverse_mass * (f.start_slope * f.start_slope + f.end_slope * f.end_slope);
  power_ += f.mean * (velocity + d1) - h / 6 * f.mean * (f.end_slope + change);
  gain_ += h * std::abs(f.mean) *
           (std::abs(f.mean) + kOthers * std::max(std::abs(others.first), std::abs(others.last)));
}

void EventResidual::End::add(const End& other) {
  along += other.along;
  aside += other.aside;
  pull += other.pull;
}

void EventResidual::add(const EventResidual& other) {
  energy_ += other.energy_;
  first_.add(other.first_);
  last_.add(other.last_);
  mean_ += other.mean_;
  slopes_ += other.slopes_;
  power_ += other.power_;
  gain_ += other.gain_;
}

double EventResidual::End::energy() const {
  return -bounded_ratio(aside, along) / 12 + bounded_ratio(pull, along) / 48;
}

double EventResidual::correction() const {
  const double energy = this->energy();
  // Where the motion is about to reverse, no impulse along the force changes the energy.
  const double scale = dt_ * std::max(power_ * power_, gain_ * gain_);
  if (!(scale > 0 && mean_ > 0)) return 0;
  const double once = -energy * power_ / scale;
  const double twice = -(energy + dt_ * dt_ * mean_ / 2 * once * once) * power_ / scale;
  const double most = kLargestRest / 12 * std::sqrt(slopes_ / mean_);
  return std::clamp(twice, -most, most);
}

}  // namespace apothem
