#include "lib/contact/law/friction_memory.hpp"

#include <algorithm>
#include <iterator>

namespace apothem {

void FrictionMemory::begin_step() {
  springs_.begin_step();
  segments_.begin_step();
  balanced_before_ = balanced_;
  sums_before_ = {energy_, balanced_, loss_, damping_loss_};
  energy_ = balanced_ = 0;
}

void FrictionMemory::undo_step() {
  springs_.undo_step();
  segments_.undo_step();
  energy_ = sums_before_.energy;
  balanced_ = sums_before_.balanced;
  loss_ = sums_before_.loss;
  damping_loss_ = sums_before_.damping_loss;
}

void FrictionMemory::restore(std::vector<Spring> springs, std::vector<PatchSegment> segments) {
  springs_.restore(std::move(springs));
  segments_.restore(std::move(segments));
  energy_ = balanced_ = 0;
  for (const Spring& spring : springs_.now()) {
    energy_ += spring.energy();
    if (spring.key.law != polygon_kernel) balanced_ += spring.energy();
  }
}

void FrictionMemory::absorb(const FrictionMemory& other) {
  const auto joined = []<class Record>(std::span<const Record> one, std::span<const Record> two) {
    std::vector<Record> all;
    std::ranges::merge(one, two, std::back_inserter(all), {}, &Record::key, &Record::key);
    return all;
  };
  restore(joined(std::span<const Spring>(springs_.now()), other.springs()),
          joined(std::span<const PatchSegment>(segments_.now()), other.segments().now()));
}

void FrictionMemory::end_step(double work) { loss_ -= work + (balanced_ - balanced_before_); }

}  // namespace apothem
