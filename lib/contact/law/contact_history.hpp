// The memory of contacts from one step to the next (contact matching): an ordered list of each kind
// of record.
//
// All contact methods use it. It is the only place that knows what contacts were like before, for
// the next step, for a trial state, for a checkpoint, and for a simulation that continues another
// one.
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/execution/pack.hpp"

namespace apothem {

/// The key of a record: which surfaces touch. Records with the same `law`, `a` and `b` belong to
/// one pair.
struct ContactKey {
  int law;   ///< number of the kernel whose contact it is, see kernel.hpp
  int a, b;  ///< two surfaces, or an edge and its partner
  int part;  ///< patch of the pair, or edge of its overlap; 0 where a pair has only one record
  auto operator<=>(const ContactKey&) const = default;
  void fields(Archive& archive) { archive("law", law)("a", a)("b", b)("part", part); }
};

/// True if the pair of the key `one` comes before the pair of the key `other`.
APOTHEM_INLINE bool is_before(const ContactKey& one, const ContactKey& other) {
  const auto number = [](const ContactKey& key) APOTHEM_LAMBDA {
    return static_cast<std::uint64_t>(key.a) << 32 | static_cast<std::uint32_t>(key.b);
  };
  return one.law == other.law ? number(one) < number(other) : one.law < other.law;
}

/// The records of all pairs from that of `first` up to, but not including, that of `end`.
template <class Record>
std::span<Record> records_between(std::span<Record> records, const ContactKey& first,
                                  const ContactKey& end) {
  const auto before = [](const ContactKey& one, const ContactKey& other) {
    return is_before(one, other);
  };
  const auto position_of = [&](const ContactKey& key) {
    return std::ranges::lower_bound(records, key, before, &Record::key);
  };
  return {position_of(first), position_of(end)};
}
/// The records of the pair of a key.
template <class Record>
std::span<Record> records_of_pair(std::span<Record> records, const ContactKey& pair) {
  return records_between(records, pair, {pair.law, pair.a, pair.b + 1, 0});
}
/// The records of the pair of a key, which probably begin at the index `guess`.
template <class Record>
std::span<Record> records_of_pair(std::span<Record> records, const ContactKey& pair, size_t guess) {
  const auto of_pair = [&](size_t i) {
    return i < records.size() && !is_before(records[i].key, pair) &&
           !is_before(pair, records[i].key);
  };
  if (!of_pair(guess) || (guess > 0 && of_pair(guess - 1))) return records_of_pair(records, pair);
  size_t end = guess + 1;
  while (of_pair(end)) ++end;
  return records.subspan(guess, end - guess);
}
template <class Record>
std::span<Record> records_of_law(std::span<Record> records, int law) {
  return records_between(records, {law, 0, 0, 0}, {law + 1, 0, 0, 0});
}

/// Finds the records of pairs that are asked for in ascending order, in one pass over the list.
template <class Record>
class ContactWalk {
 public:
  explicit ContactWalk(std::span<Record> records = {}) : rest_(records) {}

  /// The records of the pair of a key, in the order of their parts; empty if there are none. Calls
  /// passed(records) for each earlier pair of the list that was not asked for.
  template <class F>
  APOTHEM_INLINE std::span<Record> find(const ContactKey& pair, const F& passed) {
    while (!rest_.empty() && is_before(rest_.front().key, pair)) passed(next());
    if (rest_.empty() || is_before(pair, rest_.front().key)) return {};
    return next();
  }
  APOTHEM_INLINE std::span<Record> find(const ContactKey& pair) {
    return find(pair, [](std::span<Record>) APOTHEM_LAMBDA {});
  }
  /// Calls passed(records) for each remaining pair.
  template <class F>
  void finish(const F& passed) {
    while (!rest_.empty()) passed(next());
  }

 private:
  APOTHEM_INLINE std::span<Record> next() {
    size_t count = 1;
    while (count < rest_.size() && !is_before(rest_.front().key, rest_[count].key)) ++count;
    const std::span<Record> pair = rest_.first(count);
    rest_ = rest_.subspan(count);
    return pair;
  }

  std::span<Record> rest_;
};

/// The records of this step and of the step before, each list in ascending order of the keys.
/// Memory is allocated only if there are more records than ever before.
template <class Record>
class ContactHistory {
 public:
  /// The records of this step become those of the step before.
  void begin_step() {
    std::swap(now_, before_);
    now_.size = 0;
  }
  /// Undoes the last step, which can then be repeated.
  void undo_step() { std::swap(now_, before_); }

  /// Stores a record for the next step.
  void keep(const Record& record) {
    if (now_.size == now_.records.size()) {
      now_.records.push_back(record);
    } else {
      now_.records[now_.size] = record;
    }
    ++now_.size;
  }
  /// Stores several records. The content of `records` afterwards is unspecified.
  void keep(std::vector<Record>& records) {
    if (now_.size == 0) {
      now_.records.swap(records);
      now_.size = now_.records.size();
    } else {
      now_.records.resize(now_.size);
      now_.records.insert(now_.records.end(), records.begin(), records.end());
      now_.size = now_.records.size();
    }
  }
  /// Makes room for `count` records, which several threads may fill. Until then their values are
  /// unspecified.
  std::span<Record> make_room(size_t count) {
    const size_t first = now_.size, needed = first + count;
    if (needed > now_.records.capacity()) now_.records.reserve(needed + needed / 8);
    if (needed > now_.records.size()) now_.records.resize(needed);
    now_.size = needed;
    return now_.all().subspan(first);
  }

  [[nodiscard]] std::span<Record> now() { return now_.all(); }
  [[nodiscard]] std::span<const Record> now() const { return now_.all(); }
  [[nodiscard]] std::span<const Record> before() const { return before_.all(); }

  /// Replaces the records of this step, at a restart.
  void restore(std::vector<Record> records) {
    now_.records = std::move(records);
    now_.size = now_.records.size();
  }
  void fields(Archive& archive, const char* name) {
    now_.records.resize(now_.size);
    archive(name, now_.records);
    now_.size = now_.records.size();
  }

 private:
  // Records behind the first `size` ones are left over from earlier steps and are not used.
  struct List {
    std::vector<Record> records;
    size_t size = 0;
    [[nodiscard]] std::span<Record> all() { return std::span(records).first(size); }
    [[nodiscard]] std::span<const Record> all() const { return std::span(records).first(size); }
  };
  List now_, before_;
};

}  // namespace apothem
