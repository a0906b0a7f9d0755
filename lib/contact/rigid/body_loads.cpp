#include "lib/contact/rigid/body_loads.hpp"

#include <algorithm>

namespace apothem {
namespace {

constexpr double kAddTime = 10;  // time for a body, ns

}  // namespace

BodyLoads::BodyLoads(const Surfaces& surfaces, int threads)
    : surfaces_(surfaces),
      threads_(threads),
      sums_(static_cast<size_t>(surfaces.rigid_count())),
      workers_(static_cast<size_t>(threads_.count())) {}

void BodyLoads::set_pairs(std::span<const BoxPair> pairs) {
  std::vector<std::uint8_t> has_pairs(sums_.size(), 0);
  for (const BoxPair& pair : pairs) {
    has_pairs[static_cast<size_t>(pair.first)] = has_pairs[static_cast<size_t>(pair.second)] = 1;
  }
  busy_.clear();
  for (size_t i = 0; i < has_pairs.size(); ++i) {
    if (has_pairs[i] != 0) busy_.push_back(static_cast<RigidIndex>(i));
  }
  if (threads_.count() == 1) return;
  first_partner_.resize(sums_.size());
  for (size_t i = 0; i < sums_.size(); ++i) first_partner_[i] = static_cast<RigidIndex>(i);
  for (const BoxPair& pair : pairs) {
    RigidIndex& first = first_partner_[static_cast<size_t>(pair.second)];
    first = std::min(first, pair.first);
  }
}

void BodyLoads::end() {
  for (DeferredLoads& deferred_loads : workers_) {
    for (const DeferredLoad& deferred : deferred_loads.deferred)
      sums_[static_cast<size_t>(deferred.body)].add(deferred.load);
    deferred_loads.begin(-1);
  }
}

void BodyLoads::add_to(const ForceViews& forces, std::span<const PairInTouch> touching) {
  rates_.resize(sums_.size());
  fastest_.assign(workers_.size(), 0.);
  threads_.chunks(static_cast<int>(busy_.size()), kAddTime, [&](int first, int end, int worker) {
    double fastest = 0;
    for (int k = first; k < end; ++k) {
      const auto i = static_cast<size_t>(busy_[static_cast<size_t>(k)]);
      const BodyLoad& sum = sums_[i];
      double* const f = &forces.rigid[3 * i];
      f[0] += sum.x;
      f[1] += sum.y;
      f[2] += sum.moment;
      if (!forces.beside.empty()) std::ranges::copy(sum.beside, &forces.beside[3 * i]);
      rates_[i].own = rate_bound_of(sum.stiffness, inverse_mass(i));
      fastest = std::max(fastest, rates_[i].own);
    }
    fastest_[static_cast<size_t>(worker)] = fastest;
  });
  // In most steps no pair is near the limit, and the rates of partners are not needed.
  const double most = 2 * *std::ranges::max_element(fastest_);
  if (most > forces.lambda_limit) find_rates(forces.lambda_limit, touching);
  threads_.chunks(static_cast<int>(busy_.size()), kAddTime, [&](int first, int end, int) {
    for (int k = first; k < end; ++k) {
      const auto i = static_cast<size_t>(busy_[static_cast<size_t>(k)]);
      Rate& rate = rates_[i];
      forces.lambda[i] += rate.own + (most > forces.lambda_limit ? rate.partner : rate.own);
      rate = {};
      sums_[i] = {};
    }
  });
}

// Finds for each body the largest rate of its partners that can move, see stiffness.hpp. Rates are
// exact above the limit, so that bounds do not shorten the step without need.
void BodyLoads::find_rates(double limit, std::span<const PairInTouch> touching) {
  const auto sharpen = [&](size_t i) {
    if (rates_[i].exact) return;
    rates_[i].own = rate_of(sums_[i].stiffness, inverse_mass(i));
    rates_[i].exact = true;
  };
  for (const PairInTouch& pair : touching) {
    const auto a = static_cast<size_t>(pair.a), b = static_cast<size_t>(pair.b);
    if (rates_[a].own + rates_[b].own > limit) sharpen(a), sharpen(b);
  }
  for (const PairInTouch& pair : touching) {
    Rate& a = rates_[static_cast<size_t>(pair.a)];
    Rate& b = rates_[static_cast<size_t>(pair.b)];
    a.partner = std::max(a.partner, b.own);
    b.partner = std::max(b.partner, a.own);
  }
}

}  // namespace apothem
