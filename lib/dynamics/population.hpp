// Bodies that come later and bodies that leave the world: who comes or goes, and when.
#pragma once

#include <vector>

#include "lib/archive/archive.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

/// What State::absent says of a body.
enum class Presence : std::uint8_t { present = 0, waiting = 1, left = 2 };

class Population {
 public:
  /// True if bodies can come or go, or stop a run by leaving the world.
  static bool needed(const Model& model);
  /// State::absent at the start; empty if all bodies are there.
  static std::vector<std::uint8_t> absent_at_start(const Model& model);

  explicit Population(const Model& model) : model_(model), inflows_(model.inflows.size()) {}

  struct Change {
    std::vector<BodyIndex> leave, come;
    [[nodiscard]] bool empty() const { return leave.empty() && come.empty(); }
  };
  /// Who leaves and who comes now. What comes counts as having come.
  Change look(const State& state);

  /// A body that has left a world that stops the run, or -1.
  [[nodiscard]] BodyIndex outside() const { return outside_; }
  /// How many bodies are outside of a world that they leave.
  [[nodiscard]] int count_outside(const State& state) const;
  [[nodiscard]] std::int64_t left() const { return left_; }
  [[nodiscard]] std::int64_t come() const { return come_; }

  void fields(Archive& archive) {
    archive("inflows", inflows_)("left", left_)("come", come_)("outside", outside_);
  }

 private:
  /// Of an inflow: its next batch, and when the last one has come.
  struct Progress {
    std::int64_t next = 0;
    double last = 0;  ///< s
    void fields(Archive& archive) { archive("next", next)("last", last); }
  };
  [[nodiscard]] Box box_of(const State& state, BodyIndex body) const;
  [[nodiscard]] bool is_outside(const State& state, BodyIndex body) const;
  [[nodiscard]] bool has_room(const State& state, const std::vector<BodyIndex>& batch) const;

  const Model& model_;
  std::vector<Progress> inflows_;
  std::int64_t left_ = 0, come_ = 0;
  BodyIndex outside_ = -1;
};

}  // namespace apothem
