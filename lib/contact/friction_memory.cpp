#include "apothem/contact/friction_memory.hpp"

#include <tuple>
#include <utility>

namespace apothem {

void FrictionMemory::begin_step() {
  std::swap(now_, before_);
  now_.clear();
  next_ = 0;
  balanced_before_ = balanced_;
  sums_before_ = {energy_, balanced_, loss_, damping_loss_};
  energy_ = balanced_ = 0;
}

void FrictionMemory::undo_step() {
  std::swap(now_, before_);
  energy_ = sums_before_.energy;
  balanced_ = sums_before_.balanced;
  loss_ = sums_before_.loss;
  damping_loss_ = sums_before_.damping_loss;
}

namespace {

auto pair_of(const Spring& s) { return std::tuple(s.key.law, s.key.a, s.key.b); }

// The springs of a pair, from `next` on; leaves `next` behind them. over(spring) for those whose
// contact is over.
template <class Over>
std::span<const Spring> find(const std::vector<Spring>& springs, size_t& next,
                             const std::tuple<int, int, int>& pair, const Over& over) {
  while (next < springs.size() && pair_of(springs[next]) < pair) over(springs[next++]);
  const size_t first = next;
  while (next < springs.size() && pair_of(springs[next]) == pair) ++next;
  return std::span(springs).subspan(first, next - first);
}

}  // namespace

void SpringRange::begin(const std::vector<Spring>& before, size_t next) {
  before_ = &before;
  next_ = next;
  losses_.clear();
  damping_losses_.clear();
}

std::span<const Spring> SpringRange::before(int law, int a, int b) {
  return find(*before_, next_, {law, a, b}, [&](const Spring& spring) {
    if (spring.accounted) losses_.push_back(spring.energy());
  });
}

void FrictionMemory::begin(SpringRange& range, const std::pair<int, int>& behind) {
  const std::tuple pair(0, behind.first, behind.second);
  const auto place = std::partition_point(before_.begin(), before_.end(),
                                          [&](const Spring& s) { return pair_of(s) <= pair; });
  range.begin(before_, static_cast<size_t>(place - before_.begin()));
}

void FrictionMemory::add(const SpringRange& range) {
  next_ = std::max(next_, range.next_);
  for (const double energy : range.losses_) loss_ += energy;
  for (const double energy : range.damping_losses_) damping_loss_ += energy;
}

std::span<const Spring> FrictionMemory::before(int law, int a, int b) {
  return find(before_, next_, {law, a, b}, [&](const Spring& spring) {
    if (spring.accounted) lose(spring.energy());
  });
}

std::span<const Spring> FrictionMemory::before(int law) {
  const auto behind = [&](int last) {
    return std::ranges::partition_point(before_,
                                        [&](const Spring& s) { return s.key.law <= last; });
  };
  const auto first = static_cast<size_t>(behind(law - 1) - before_.begin());
  for (; next_ < first; ++next_) {
    if (before_[next_].accounted) lose(before_[next_].energy());
  }
  next_ = static_cast<size_t>(behind(law) - before_.begin());
  return std::span(before_).subspan(first, next_ - first);
}

std::span<const Spring> FrictionMemory::springs_of(int law, int a, int b) const {
  const auto [first, end] =
      std::equal_range(now_.begin(), now_.end(), Spring{.key = {law, a, b, 0}},
                       [&](const Spring& s, const Spring& t) { return pair_of(s) < pair_of(t); });
  return {first, end};
}

void FrictionMemory::inherit(std::vector<Spring> springs) {
  now_ = std::move(springs);
  energy_ = balanced_ = 0;
  for (const Spring& spring : now_) {
    energy_ += spring.energy();
    if (!spring.accounted) balanced_ += spring.energy();
  }
}

void FrictionMemory::end_step(double work) {
  for (; next_ < before_.size(); ++next_) {
    if (before_[next_].accounted) lose(before_[next_].energy());
  }
  loss_ -= work + (balanced_ - balanced_before_);
}

}  // namespace apothem
