#include "apothem/contact/body_loads.hpp"

#include <algorithm>

namespace apothem {
namespace {

constexpr double kAddTime = 10;  // of a body, ns

}  // namespace

BodyLoads::BodyLoads(const Surfaces& surfaces, int threads)
    : surfaces_(surfaces),
      threads_(threads),
      sums_(static_cast<size_t>(surfaces.rigid_count())),
      parts_(static_cast<size_t>(threads_.count())) {}

void BodyLoads::take(std::span<const BoxPair> pairs) {
  if (threads_.count() == 1) return;
  first_partner_.resize(sums_.size());
  for (size_t i = 0; i < sums_.size(); ++i) first_partner_[i] = static_cast<RigidIndex>(i);
  for (const BoxPair& pair : pairs) {
    RigidIndex& first = first_partner_[static_cast<size_t>(pair.second)];
    first = std::min(first, pair.first);
  }
}

void BodyLoads::end() {
  for (Part& part : parts_) {
    for (const LateLoad& late : part.late) sums_[static_cast<size_t>(late.body)].add(late.load);
    part.begin(-1);
  }
}

void BodyLoads::add_to(const ForceViews& forces) {
  threads_.chunks(static_cast<int>(sums_.size()), kAddTime, [&](int first, int end, int) {
    for (auto i = static_cast<size_t>(first); i < static_cast<size_t>(end); ++i) {
      BodyLoad& sum = sums_[i];
      double* const f = &forces.rigid[3 * i];
      f[0] += sum.x;
      f[1] += sum.y;
      f[2] += sum.moment;
      const std::array<double, 3>& inverse_mass =
          surfaces_.rigid(static_cast<RigidIndex>(i)).inverse_mass;
      double rate = rate_bound_of(sum.held, inverse_mass);
      // It is exact above the limit, so that it does not shorten the step in vain.
      if (rate > forces.lambda_limit) rate = rate_of(sum.held, inverse_mass);
      forces.lambda[i] += rate;
      sum = {};
    }
  });
}

}  // namespace apothem
