// Sees to it that no contact is missed because bodies move too far in a step, and that no body with
// a mesh passes through another one unseen.
//
// How far they may move depends on what they can run into: a body in free flight has nothing to
// miss, whatever its speed. So pairs of bodies are judged, and only those whose ways in the step
// meet. In most steps no body moves farther than the smallest of all could bear, which is soon
// known.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/surface/surfaces.hpp"
#include "lib/execution/parallel.hpp"
#include "lib/model/model.hpp"
#include "lib/model/state.hpp"

namespace apothem {

class StrideWatch {
 public:
  /// `inradius` of each body, rigid ones first, m.
  StrideWatch(const Model& model, std::span<const double> inradius, int threads);

  /// Two bodies one of which moves too far, and how far, m.
  struct Fault {
    BodyIndex fast, other;
    double stride;
    double length;  ///< that it is measured by, m
  };
  /// After a drift of dt (s) to `state`, before the surfaces follow: the pair that moves farthest
  /// for its size among those that may meet on the way; none if all of them move little enough.
  std::optional<Fault> look(const State& state, const Surfaces& before, double dt);

  /// True if the middle of one of two bodies is inside the other one. `now`: where they are. Not
  /// for every pair and step.
  bool are_passing(const State& state, const Surfaces& now, BodyIndex a, BodyIndex b);

 private:
  // The boundary of a mesh.
  struct Outline {
    std::vector<NodeIndex> nodes;  // in the numbers of all meshes
    std::vector<Vec2> places;      // in the mesh as given, m
    std::vector<int> next;         // of each node, among these
  };
  // A point that is farthest inside a body: in its frame, or the mean of nodes.
  struct Middle {
    Vec2 place = Vec2::Zero();
    std::vector<NodeIndex> nodes;
  };
  // A step at hand.
  struct Step {
    const State& state;
    const Surfaces& before;
    double dt;
  };
  [[nodiscard]] bool is_rigid(BodyIndex body) const { return body < rigid_count_; }
  [[nodiscard]] const Outline& outline(BodyIndex body) const {
    return outlines_[static_cast<size_t>(body - rigid_count_)];
  }
  // How far the boundary moves at most against a frame of some velocity, m.
  [[nodiscard]] double stride(const Step& step, BodyIndex body, const Vec2& frame) const;
  [[nodiscard]] Vec2 velocity(const Step& step, BodyIndex body) const;
  [[nodiscard]] Box way(const Step& step, BodyIndex body, const Vec2& frame) const;
  [[nodiscard]] bool meets(const Step& step, BodyIndex mover, BodyIndex target) const;
  [[nodiscard]] Middle middle_of(BodyIndex body) const;
  [[nodiscard]] Vec2 middle(const State& state, BodyIndex body);
  [[nodiscard]] bool contains(const State& state, const Surfaces& now, BodyIndex body,
                              const Vec2& point) const;
  void judge(const Step& step, BodyIndex a, BodyIndex b, std::optional<Fault>& worst) const;
  // False if a body is not at a finite place.
  bool find_ways(const Step& step);
  [[nodiscard]] bool are_all_slow(const Step& step, double least);

  const Model& model_;
  RigidIndex rigid_count_;
  std::vector<std::optional<Middle>> middles_;  // of each body, once it has been asked for
  std::vector<Outline> outlines_;
  std::vector<char> responsive_;  // of each body: forces can move it
  std::vector<double> length_;    // of each body, m: a stride is short against this
  double shortest_ = 0;           // of these
  Threads threads_;
  std::vector<double> strides_;  // of each body, m
  std::vector<char> is_fast_;    // what each thread has found
  std::vector<BodyIndex> fast_;
  std::vector<Box> ways_;  // of each body, in the step at hand
  BoxGrid grid_;
  std::vector<BoxPair> pairs_;
};

}  // namespace apothem
