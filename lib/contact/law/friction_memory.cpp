#include "lib/contact/law/friction_memory.hpp"

#include <tuple>
#include <utility>

namespace apothem {
namespace {

std::span<Spring> of_law(std::vector<Spring>& springs, int law) {
  const auto of = [](const Spring& spring) { return spring.key.law; };
  const auto first = std::ranges::lower_bound(springs, law, {}, of);
  const auto end = std::ranges::upper_bound(springs, law, {}, of);
  return {first, end};
}

}  // namespace

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

std::span<const Spring> FrictionMemory::before(int law, int a, int b) {
  const std::tuple pair(law, a, b);
  const auto pair_of = [](const Spring& s) { return std::tuple(s.key.law, s.key.a, s.key.b); };
  while (next_ < before_.size() && pair_of(before_[next_]) < pair) ++next_;
  const size_t first = next_;
  while (next_ < before_.size() && pair_of(before_[next_]) == pair) ++next_;
  return std::span(before_).subspan(first, next_ - first);
}

std::span<const Spring> FrictionMemory::before(int law) {
  const std::span<Spring> springs = of_law(before_, law);
  next_ = static_cast<size_t>(springs.data() + springs.size() - before_.data());
  return springs;
}

std::span<Spring> FrictionMemory::springs_of(int law) { return of_law(now_, law); }

void FrictionMemory::inherit(std::vector<Spring> springs) {
  now_ = std::move(springs);
  balanced_ = 0;
  for (const Spring& spring : now_) balanced_ += spring.energy();
  energy_ = balanced_;
}

void FrictionMemory::end_step(double work) { loss_ -= work + (balanced_ - balanced_before_); }

}  // namespace apothem
