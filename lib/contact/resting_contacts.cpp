#include "lib/contact/resting_contacts.hpp"

#include <array>
#include <vector>

namespace apothem {
namespace {

// Distributes records to two lists: those that belong to the second one go there.
template <class Record, class Belongs>
std::array<std::vector<Record>, 2> distribute(std::span<const Record> records,
                                              const Belongs& belongs) {
  std::array<std::vector<Record>, 2> lists;
  for (const Record& record : records) lists[belongs(record.key) ? 1 : 0].push_back(record);
  return lists;
}

}  // namespace

RestingContacts::RestingContacts(const Surfaces& surfaces, const ContactLaw& law,
                                 const PairTable& table, double thickness)
    : surfaces_(surfaces), kernel_(surfaces, law, table, memory_, thickness, 1) {}

void RestingContacts::exchange(FrictionMemory& others) {
  const auto belongs = [&](const ContactKey& key) {
    return key.law == polygon_kernel && has(key.a, key.b);
  };
  others.absorb(memory_);
  auto springs = distribute<Spring>(others.springs(), belongs);
  auto segments = distribute<PatchSegment>(others.segments().now(), belongs);
  others.restore(std::move(springs[0]), std::move(segments[0]));
  memory_.restore(std::move(springs[1]), std::move(segments[1]));
  memory_.forget_pushes();
}

void RestingContacts::evaluate(std::span<const BoxPair> near, const Kinematics& now) {
  std::vector<BoxPair> pairs;
  for (const BoxPair& pair : near) {
    const bool held = !surfaces_.responsive(pair.first) && !surfaces_.responsive(pair.second);
    if (has(pair.first, pair.second) && !held) pairs.push_back(pair);
  }
  records_.reset();
  kernel_.set_pairs(pairs);
  kernel_.evaluate();
  memory_.begin_step();
  memory_.end_step(kernel_.update_friction(now, 0, memory_));
  const size_t size = 3 * static_cast<size_t>(surfaces_.rigid_count());
  std::vector<double> sum(size, 0), rates(size / 3, 0);
  kernel_.add_forces({.rigid = sum, .nodes = {}, .lambda = rates, .lambda_limit = HUGE_VAL});
  forces_.clear();
  for (size_t c = 0; c < size; ++c) {
    if (sum[c] != 0) forces_.push_back({c, sum[c]});
  }
  energy_ = kernel_.energy() + memory_.energy();
}

const std::vector<ContactRecord>& RestingContacts::records() {
  if (!records_) kernel_.add_records(records_.emplace());
  return *records_;
}

void RestingContacts::add_forces(std::span<double> rigid) const {
  for (const Force& force : forces_) rigid[force.coordinate] += force.value;
}

}  // namespace apothem
