#include "lib/solver/linear_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/solver/eigen_pairs.hpp"
#include "lib/solver/frontal_factors.hpp"

namespace apothem {
namespace {

// Entries that differ from those across the diagonal by less are round-off of symmetric sums.
constexpr double kSkew = 1e-12;

}  // namespace

struct LinearSolver::Factors {
  // A coordinate as one of a block.
  struct Slot {
    int block = -1;  // -1: it is not in the system
    int offset = 0;
  };
  std::vector<Slot> slots;
  // Those of blocks that have no coordinate of the system: they get an equation of their own.
  std::vector<Slot> spare;
  std::vector<std::uint8_t> moved;
  size_t bodies = 0;  // coordinates of rigid bodies
  int size = 0;       // blocks
  // Places of the entries, as they came, and where they are summed, or null; likewise of D.
  std::vector<std::pair<std::int32_t, std::int32_t>> places;
  std::vector<double*> sum_of, diagonal_of, spare_of;
  bool symmetric = true, points = false;
  FrontalFactors<3> of_bodies;  // of scenes without nodes
  FrontalFactors<2> of_points;  // of others, where the angle of a body is a block of its own
  std::vector<double> parts;

  template <class F>
  decltype(auto) use(const F& f) {
    return points ? f(of_points) : f(of_bodies);
  }
  [[nodiscard]] size_t breadth() const { return points ? 2 : 3; }

  // Numbers the blocks that have a coordinate of the system.
  void number(std::span<const std::uint8_t> moves, size_t rigid) {
    if (std::ranges::equal(moves, moved) && rigid == bodies) return;
    moved.assign(moves.begin(), moves.end());
    bodies = rigid;
    points = moves.size() > rigid;
    places.clear();
    slots.assign(moves.size(), {});
    spare.clear();
    size = 0;
    for (size_t c = 0; c < moves.size();) {
      const bool angle = points && c < rigid && c % 3 == 2;
      const size_t count = angle ? 1 : points ? 2 : 3;
      number_block(c, count);
      c += count;
    }
    parts.resize(static_cast<size_t>(size) * breadth());
  }
  void number_block(size_t first, size_t count) {
    const auto moves = [&](size_t i) { return i < count && moved[first + i] != 0; };
    bool any = false;
    for (size_t i = 0; i < count; ++i) any = any || moves(i);
    if (!any) return;
    for (size_t i = 0; i < breadth(); ++i) {
      const Slot slot{size, static_cast<int>(i)};
      if (moves(i)) {
        slots[first + i] = slot;
      } else {
        spare.push_back(slot);
      }
    }
    ++size;
  }
  [[nodiscard]] bool same_places(std::span<const Tangent::Entry> entries) const {
    return entries.size() == places.size() &&
           std::equal(entries.begin(), entries.end(), places.begin(),
                      [](const Tangent::Entry& e, const auto& place) {
                        return e.row == place.first && e.column == place.second;
                      });
  }
  template <class Blocks>
  void find_places(Blocks& blocks, std::span<const Tangent::Entry> entries) {
    std::vector<std::pair<int, int>> pairs;
    places.clear();
    for (const Tangent::Entry& e : entries) {
      places.emplace_back(e.row, e.column);
      const int row = slots[static_cast<size_t>(e.row)].block;
      const int column = slots[static_cast<size_t>(e.column)].block;
      if (row >= 0 && column >= 0 && row != column) pairs.emplace_back(row, column);
    }
    blocks.analyse(size, std::move(pairs));
    const auto sum_at = [&](const Slot& row, const Slot& column) -> double* {
      if (row.block < 0 || column.block < 0) return nullptr;
      return &blocks.at(row.block, column.block)(row.offset, column.offset);
    };
    sum_of.clear();
    for (const Tangent::Entry& e : entries) {
      sum_of.push_back(
          sum_at(slots[static_cast<size_t>(e.row)], slots[static_cast<size_t>(e.column)]));
    }
    diagonal_of.clear();
    for (const Slot& slot : slots) diagonal_of.push_back(sum_at(slot, slot));
    spare_of.clear();
    for (const Slot& slot : spare) spare_of.push_back(sum_at(slot, slot));
  }
};

LinearSolver::LinearSolver() : factors_(std::make_unique<Factors>()) {}
LinearSolver::~LinearSolver() = default;

bool LinearSolver::factorise(const Tangent& tangent, size_t rigid,
                             std::span<const std::uint8_t> moves,
                             std::span<const double> diagonal) {
  Factors& f = *factors_;
  f.number(moves, rigid);
  if (f.size == 0) return true;
  return f.use([&](auto& blocks) {
    if (f.places.empty() || !f.same_places(tangent.entries())) {
      f.find_places(blocks, tangent.entries());
    }
    blocks.set_zero();
    for (size_t i = 0; i < f.sum_of.size(); ++i) {
      if (f.sum_of[i]) *f.sum_of[i] += tangent.entries()[i].value;
    }
    for (size_t c = 0; c < diagonal.size(); ++c) {
      if (f.diagonal_of[c]) *f.diagonal_of[c] += diagonal[c];
    }
    for (double* const one : f.spare_of) *one = 1;
    if (!blocks.is_finite()) return false;
    f.symmetric = blocks.is_symmetric(kSkew);
    return blocks.factorise(f.symmetric);
  });
}

void LinearSolver::solve(std::span<const double> b, std::span<double> x) const {
  Factors& f = *factors_;
  const auto part = [&](const Factors::Slot& slot) -> double& {
    return f
        .parts[f.breadth() * static_cast<size_t>(slot.block) + static_cast<size_t>(slot.offset)];
  };
  std::ranges::fill(f.parts, 0.);
  for (size_t c = 0; c < f.slots.size(); ++c) {
    if (f.slots[c].block >= 0) part(f.slots[c]) = b[c];
  }
  if (f.size > 0) f.use([&](auto& blocks) { blocks.solve(f.parts); });
  for (size_t c = 0; c < f.slots.size(); ++c) x[c] = f.slots[c].block >= 0 ? part(f.slots[c]) : 0;
}

int LinearSolver::negative_pivots(double noise) const {
  Factors& f = *factors_;
  if (!f.symmetric) return -1;
  if (f.size == 0) return 0;
  std::vector<double> pivots;
  f.use([&](auto& blocks) {
    blocks.each_pivot([&](const auto& d) {
      const Eigen::VectorXd values = dense_pairs((d + d.transpose()) / 2).values;
      pivots.insert(pivots.end(), values.begin(), values.end());
    });
  });
  double largest = 0;
  for (const double pivot : pivots) largest = std::max(largest, std::abs(pivot));
  return static_cast<int>(
      std::ranges::count_if(pivots, [&](double pivot) { return pivot < -noise * largest; }));
}

}  // namespace apothem
