#include "lib/contact/law/onset_damping.hpp"

#include <array>
#include <cmath>

namespace apothem {
namespace {

// Slopes of a polynomial of degree 4 at five equidistant places, over 1/12 of their distance.
constexpr std::array<std::array<double, 5>, 5> kSlopes{{{-25, 48, -36, 16, -3},
                                                        {-3, -10, 18, -6, 1},
                                                        {1, -8, 0, 8, -1},
                                                        {-1, 6, -18, 10, 3},
                                                        {3, -16, 36, -48, 25}}};

constexpr double kRoom = 10;             // of the bound, which is not sharp where bodies turn
constexpr double kShortestPanel = 1e-6;  // of the step: a panel that has no slopes, and no share

PairForce elastic_of(const DampedPair& pair, const PairIntegral& i) {
  return pair.stiffness * PairForce{i.force.x(), i.force.y(), i.moment_a, i.moment_b};
}

// 2 ratio/omega at a sample, s, and the largest force that it can make of the speed there, N: where
// hardly any boundary is inside, differences of forces say little of the rate.
struct Dashpot {
  double time = 0, most = 0;
};
Dashpot dashpot_of(const DampedPair& pair, const DampedSample& sample) {
  const PairIntegral& i = sample.integral;
  PatchStep<double> p;
  p.force = {i.force.x(), i.force.y()};
  p.moment_a = i.moment_a;
  p.weight = i.weight;
  p.centre = {i.centre.x(), i.centre.y()};
  p.between = {sample.between.x(), sample.between.y()};
  p.inverse_mass_a = pair.inverse_mass_a;
  p.inverse_mass_b = pair.inverse_mass_b;
  p.find_direction();
  if (!p.has_direction) return {};
  const double slopes = i.own_length_a * pair.slope_b + i.own_length_b * pair.slope_a;
  const double stiffness = pair.stiffness * slopes;
  const double time = p.damping_time(pair.ratio, stiffness, p.normal);
  return {time, kRoom * time * stiffness * p.slip(pair.rate).size()};
}

}  // namespace

PathDamping damping_along(const DampedPair& pair, std::span<const OnsetSample> samples,
                          std::span<const DampedSample> at) {
  PathDamping result{};
  for (size_t first = 0; first + 4 < samples.size(); first += 4) {
    const double width = samples[first + 4].theta - samples[first].theta;
    if (width < kShortestPanel) continue;
    std::array<PairForce, 5> elastic;
    for (size_t k = 0; k < 5; ++k) elastic[k] = elastic_of(pair, at[first + k].integral);
    for (size_t k = 0; k < 5; ++k) {
      PairForce rate{};
      for (size_t j = 0; j < 5; ++j)
        rate = rate + kSlopes[k][j] / (3 * width * pair.dt) * elastic[j];
      const Dashpot dashpot = dashpot_of(pair, at[first + k]);
      PairForce damping = dashpot.time * rate;
      const double strength = damping.plane().size();
      if (strength > dashpot.most) damping = (dashpot.most / strength) * damping;
      const double size = elastic[k].plane().size();
      const double pull = size > 0 ? -damping.plane().dot((1 / size) * elastic[k].plane()) : 0;
      if (pull > size) damping = (size / pull) * damping;
      if (size == 0) damping = {};
      result.mean = result.mean + width * kBoole[k] * damping;
      result.net_mean += width * kBoole[k] * (elastic[k] + damping).plane().size();
    }
  }
  return result;
}

}  // namespace apothem
