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

// A spring whose contact is over.
void FrictionMemory::skip() {
  const Spring& spring = before_[next_++];
  if (spring.accounted) lose(spring.energy());
}

std::span<const Spring> FrictionMemory::before(int law, int a, int b) {
  const auto pair_of = [](const Spring& s) { return std::tuple(s.key.law, s.key.a, s.key.b); };
  const std::tuple pair(law, a, b);
  while (next_ < before_.size() && pair_of(before_[next_]) < pair) skip();
  const size_t first = next_;
  while (next_ < before_.size() && pair_of(before_[next_]) == pair) ++next_;
  return std::span<const Spring>(before_).subspan(first, next_ - first);
}

std::span<const Spring> FrictionMemory::springs_of(int law, int a, int b) const {
  const auto pair_of = [](const Spring& s) { return std::tuple(s.key.law, s.key.a, s.key.b); };
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
  while (next_ < before_.size()) skip();
  loss_ -= work + (balanced_ - balanced_before_);
}

}  // namespace apothem
