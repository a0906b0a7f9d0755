#include "lib/contact/mesh/outline_friction_tangent.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/contact/mesh/outline_spring.hpp"
#include "lib/contact/mesh/outline_tangent.hpp"
#include "lib/execution/sparse_dual.hpp"

namespace apothem {
namespace {

using Number = MovingEdgeFace::Number;
using MovingSpring = SpringContactOf<SparseDual>;

// The sums over the contacts of a spring that its force depends on.
enum SpringSum : size_t {
  kNormal,
  kPlace,
  kRateX,
  kRateY,
  kSlopeX,
  kSlopeY,
  kDeepest,
  kTangentX,
  kTangentY,
  kWidth,
  kDepth,
  kSums
};

// Derivatives of the sums of a spring by x and y of a vertex.
struct ByVertex {
  int vertex;
  std::array<Vec2, kSums> of;
};

struct ByCoordinate {
  size_t coordinate;
  double x, y;
};

// A contact, as coefficients of the force of its spring over the normal force (see OutlineSlip).
struct MovingSlip {
  size_t spring;
  std::array<int, MovingEdgeFace::kVertices> vertex;
  Number at_p, at_q, at_b, turn;
  Number tx, ty;  // unit tangent of the face
};

class FrictionTangent {
 public:
  FrictionTangent(const TriedOutlineFriction& tried, size_t first_node, Tangent& tangent)
      : tried_(tried), first_node_(first_node), tangent_(tangent), normals_(tried.outlines) {}

  void add() {
    const EdgeFaceBlocks& blocks = tried_.blocks;
    springs_.resize(blocks.group_count());
    values_.resize(springs_.size()), sums_.resize(springs_.size());
    blocks.each_group([&](const EdgeFaceUnit& unit, const EdgeFaceGroup& group, size_t i) {
      find_sums(unit, group, i);
    });
    normals_.find(springs_);
    blocks.each_group(
        [&](const EdgeFaceUnit&, const EdgeFaceGroup& group, size_t i) { find_force(group, i); });
    for (size_t first = 0, end = 0; first < slips_.size(); first = end) {
      while (end < slips_.size() && slips_[end].spring == slips_[first].spring) ++end;
      add_spring(std::span(slips_).subspan(first, end - first));
    }
  }

 private:
  // The sums of a spring as variables, and their derivatives by the vertices.
  void find_sums(const EdgeFaceUnit& unit, const EdgeFaceGroup& group, size_t i) {
    const SpringContact& tried = tried_.contacts[i];
    if (!(tried.normal > 0)) return;
    values_[i] = {};
    tried_.blocks.each_contact(unit, group, [&](size_t block, size_t lane) {
      add_contact(tried_.blocks.blocks()[block], lane, i);
    });
    MovingSpring& spring = springs_[i];
    spring.normal = variable(i, kNormal, tried.normal);
    spring.place = variable(i, kPlace, tried.place);
    spring.rate_x = variable(i, kRateX, tried.rate_x);
    spring.rate_y = variable(i, kRateY, tried.rate_y);
    spring.slope_x = variable(i, kSlopeX, tried.slope_x);
    spring.slope_y = variable(i, kSlopeY, tried.slope_y);
    spring.deepest = variable(i, kDeepest, tried.deepest);
    spring.tx = variable(i, kTangentX, tried.tx), spring.ty = variable(i, kTangentY, tried.ty);
    spring.ratio = tried.ratio, spring.edge = tried.edge, spring.other = tried.other;
    spring.is_old = tried.is_old, spring.force_before = tried.force_before;
    spring.stiffness_before = tried.stiffness_before, spring.push_before = tried.push_before;
  }

  static SparseDual variable(size_t spring, SpringSum which, double value) {
    return SparseDual::variable(value, static_cast<std::int32_t>(kSums * spring + which));
  }

  void add_contact(const EdgeFaceBlock& block, size_t lane, size_t i) {
    const MovingEdgeFace m(tried_.outlines, block.p[lane], block.a[lane]);
    if (!m.meet) return;
    const auto& [p, q, a, b, before, after] = m.spots;
    const Number weight = Number(block.slope[lane]) * m.edge.length;
    const Number scale = Number(1.) / m.base.length;
    const Number sum = weight * m.piece.sum, at_q = weight * m.piece.first, at_p = sum - at_q;
    const Number x = p.x - a.x, y = p.y - a.y, ex = q.x - p.x, ey = q.y - p.y;
    const Number& tx = m.base.tx;
    const Number& ty = m.base.ty;
    const Number height = (tx * y - ty * x) * scale, climb = (tx * ey - ty * ex) * scale;
    const Number at_b = (tx * x + ty * y) * scale * sum + (tx * ex + ty * ey) * scale * at_q;
    const Number turn = height * sum + climb * at_q, at_a = at_b - sum;
    slips_.push_back({i, m.vertex, at_p, at_q, at_b, turn, tx, ty});
    const auto velocity = [&](MovingEdgeFace::Place at) -> MovingEdgeFace::Spot {
      const double* const v = &tried_.velocities[2 * static_cast<size_t>(m.vertex[at])];
      MovingEdgeFace::Spot moving{v[0], v[1]};
      moving.x.d.v[2 * at] = moving.y.d.v[2 * at + 1] = 1 / tried_.dt;
      return moving;
    };
    const auto vp = velocity(MovingEdgeFace::at_p), vq = velocity(MovingEdgeFace::at_q);
    const auto va = velocity(MovingEdgeFace::at_a), vb = velocity(MovingEdgeFace::at_b);
    const Number turning = turn * (tx * (vb.y - va.y) - ty * (vb.x - va.x));
    const Number length = (m.piece.to - m.piece.from) * m.edge.length;
    add_sum(m, i, kNormal, sum), add_sum(m, i, kPlace, at_q);
    add_sum(m, i, kRateX, at_p * vp.x + at_q * vq.x + at_a * va.x - at_b * vb.x + turning * tx);
    add_sum(m, i, kRateY, at_p * vp.y + at_q * vq.y + at_a * va.y - at_b * vb.y + turning * ty);
    const Number slope = Number(block.slope[lane]) * length;
    add_sum(m, i, kSlopeX, slope * tx), add_sum(m, i, kSlopeY, slope * ty);
    add_sum(m, i, kWidth, length), add_sum(m, i, kDepth, m.piece.sum * m.edge.length);
    if (values_[i][kTangentX] == 0 && values_[i][kTangentY] == 0) {
      add_sum(m, i, kTangentX, m.edge.tx), add_sum(m, i, kTangentY, m.edge.ty);
    }
    raise_depth(m, i, (height + m.piece.from * climb) * m.base.length);
    raise_depth(m, i, (height + m.piece.to * climb) * m.base.length);
  }

  ByVertex& by_vertex(size_t i, int vertex) {
    std::vector<ByVertex>& list = sums_[i];
    const auto found = std::ranges::find(list, vertex, &ByVertex::vertex);
    if (found != list.end()) return *found;
    ByVertex& added = list.emplace_back();
    added.vertex = vertex;
    added.of.fill(Vec2::Zero());
    return added;
  }

  void add_sum(const MovingEdgeFace& m, size_t i, SpringSum which, const Number& number) {
    values_[i][which] += number.v;
    for (size_t k = 0; k < m.vertex.size(); ++k) {
      by_vertex(i, m.vertex[k]).of[which] += Vec2(number.d.v[2 * k], number.d.v[2 * k + 1]);
    }
  }

  void raise_depth(const MovingEdgeFace& m, size_t i, const Number& number) {
    if (!(number.v > values_[i][kDeepest])) return;
    values_[i][kDeepest] = 0;
    for (ByVertex& by : sums_[i]) by.of[kDeepest].setZero();
    add_sum(m, i, kDeepest, number);
  }

  void find_force(const EdgeFaceGroup& group, size_t i) {
    MovingSpring& spring = springs_[i];
    if (!(spring.normal > SparseDual(0.))) return;
    const PairLaw& law = *tried_.blocks.laws()[static_cast<size_t>(group.law)].law;
    const SparseDual fraction =
        spring.is_old ? SparseDual(1.)
                      : closed_fraction(spring, variable(i, kWidth, values_[i][kWidth]),
                                        variable(i, kDepth, values_[i][kDepth]), tried_.dt);
    follow_slip<SparseDual>({law, tried_.dt, true}, fraction, spring);
  }

  // Adds a number's derivatives by the coordinates, as x or as y.
  void add_derivatives(const SparseDual& number, double ByCoordinate::*component) {
    for (const SparseDual::Derivative& d : number.derivatives()) {
      const size_t spring = static_cast<size_t>(d.variable) / kSums;
      const size_t which = static_cast<size_t>(d.variable) % kSums;
      for (const ByVertex& by : sums_[spring]) {
        const Vec2 part = d.value * by.of[which];
        if (part == Vec2::Zero()) continue;
        const VertexCoordinates moves = coordinates_of(tried_.outlines, first_node_, by.vertex);
        for (int k = 0; k < moves.count; ++k) {
          const auto at = static_cast<size_t>(k);
          column(moves.coordinate[at]).*component += part.dot(moves.along[at]);
        }
      }
    }
  }

  ByCoordinate& column(size_t coordinate) {
    const auto found = std::ranges::find(columns_, coordinate, &ByCoordinate::coordinate);
    if (found != columns_.end()) return *found;
    columns_.push_back({coordinate, 0, 0});
    return columns_.back();
  }

  // The contacts of one spring.
  void add_spring(std::span<const MovingSlip> contacts) {
    const MovingSpring& spring = springs_[contacts.front().spring];
    const SparseDual pull = spring.friction / spring.normal;
    const SparseDual pull_x = -pull * spring.ny, pull_y = pull * spring.nx;
    columns_.clear();
    add_derivatives(pull_x, &ByCoordinate::x);
    add_derivatives(pull_y, &ByCoordinate::y);
    const Number x(pull_x.value()), y(pull_y.value());
    for (const MovingSlip& c : contacts) {
      const Number at_a = c.at_b - (c.at_p + c.at_q), along = (x * c.tx + y * c.ty) * c.turn;
      add_tangent_of_forces(tried_.outlines, first_node_, c.vertex,
                            {{{x * c.at_p, y * c.at_p},
                              {x * c.at_q, y * c.at_q},
                              {x * at_a + along * c.ty, y * at_a - along * c.tx},
                              {-(x * c.at_b + along * c.ty), along * c.tx - y * c.at_b}}},
                            tangent_);
      const Vec2 face(c.tx.v, c.ty.v), across(face.y(), -face.x());
      add_pull(c.vertex[MovingEdgeFace::at_p], c.at_p.v, Vec2::Zero(), face);
      add_pull(c.vertex[MovingEdgeFace::at_q], c.at_q.v, Vec2::Zero(), face);
      add_pull(c.vertex[MovingEdgeFace::at_a], at_a.v, c.turn.v * across, face);
      add_pull(c.vertex[MovingEdgeFace::at_b], -c.at_b.v, -c.turn.v * across, face);
    }
  }

  // The force on a vertex is `factor` times the pull, and `turned` times that along the face.
  void add_pull(int vertex, double factor, const Vec2& turned, const Vec2& face) {
    const VertexCoordinates on = coordinates_of(tried_.outlines, first_node_, vertex);
    for (int r = 0; r < on.count; ++r) {
      const Vec2& arm = on.along[static_cast<size_t>(r)];
      const Vec2 by = factor * arm + turned.dot(arm) * face;
      for (const ByCoordinate& c : columns_) {
        tangent_.add(on.coordinate[static_cast<size_t>(r)], c.coordinate,
                     -(by.x() * c.x + by.y() * c.y));
      }
    }
  }

  const TriedOutlineFriction& tried_;
  size_t first_node_;
  Tangent& tangent_;
  CommonNormals<SparseDual> normals_;
  std::vector<MovingSpring> springs_;              // one for each group
  std::vector<std::array<double, kSums>> values_;  // likewise
  std::vector<std::vector<ByVertex>> sums_;        // likewise
  std::vector<MovingSlip> slips_;                  // in the order of their springs
  std::vector<ByCoordinate> columns_;              // derivatives of the pull of a spring
};

}  // namespace

void add_friction_tangent(const TriedOutlineFriction& tried, size_t first_node, Tangent& tangent) {
  FrictionTangent(tried, first_node, tangent).add();
}

}  // namespace apothem
