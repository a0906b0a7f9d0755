#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apothem/contact/kernel.hpp"
#include "apothem/execution/dispatch.hpp"
#include "apothem/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kSlipTime = 100, kDragTime = 30, kVelocityTime = 5;  // ns

SpringKey key_of(const EdgeFaceGroup& group) {
  return {outline_kernel, group.edge, group.partner, 0};
}

}  // namespace

OutlineFriction::OutlineFriction(const Outlines& outlines, const PairTable& table,
                                 const std::vector<double>& inverse_mass, int threads)
    : outlines_(outlines),
      damped_(table.damped()),
      threads_(threads),
      times_(table, inverse_mass),
      all_(outlines.bodies.size()),
      workers_(static_cast<size_t>(threads_.count())) {
  std::iota(all_.begin(), all_.end(), 0);
}

// Finds the velocities of the vertices, and makes room for the new forces. Returns the powers of
// the old ones.
OutlineFriction::Powers OutlineFriction::begin(BodyIndex b, const Kinematics& now,
                                               const Step& step) {
  const Outlines& o = outlines_;
  const Outlines::Body& body = o.bodies[b];
  Powers sum;
  const auto put = [&](int i, double vx, double vy) {
    velocities_[2 * static_cast<size_t>(i)] = vx;
    velocities_[2 * static_cast<size_t>(i) + 1] = vy;
    const VertexDrag& before = drags_before_[static_cast<size_t>(i)];
    sum.friction += before[0] * vx + before[1] * vy;
    sum.damping += before[2] * vx + before[3] * vy;
    VertexDrag& drag = drags_[static_cast<size_t>(i)];
    // A first look, perhaps with the memory of another run: as springs do, dashpots keep their
    // force.
    drag = step.dashpots ? VertexDrag{} : VertexDrag{0, 0, before[2], before[3]};
  };
  if (!body.is_rigid()) {
    for (int i = body.first; i < body.end; ++i) {
      const double* v = now.node_velocity.data() + 2 * static_cast<size_t>(o.node[i]);
      put(i, v[0], v[1]);
    }
    return sum;
  }
  const double* v = now.pose_rate.data() + 3 * static_cast<size_t>(body.rigid);
  double drawn = 0, turned = 0;
  if (now.finite) {  // from where the vertex was, along the chord of its arc
    const double angle = v[2] * step.dt, half = sine_cosine(angle / 2).sine;
    turned = sine_cosine(angle).sine / step.dt - v[2], drawn = 2 * half * half / step.dt;
  }
  for (int i = body.first; i < body.end; ++i) {
    const double x = o.x[i] - body.cx, y = o.y[i] - body.cy;
    const double vx = v[0] - v[2] * y, vy = v[1] + v[2] * x;
    if (now.finite) {
      put(i, vx + (drawn * x - turned * y), vy + (drawn * y + turned * x));
    } else {
      put(i, vx, vy);
    }
  }
  return sum;
}

void OutlineFriction::find_times(const Step& step) {
  const std::span<const EdgeFaceLaw> laws = step.blocks.laws();
  law_times_.resize(laws.size());
  if (!step.dashpots) {
    std::ranges::fill(law_times_, LawTimes{0, 0});
    return;
  }
  times_.begin_step();
  for (size_t i = 0; i < laws.size(); ++i) {
    const double length = step.blocks.lengths()[i];
    DampingTimes::Pair& pair = times_[laws[i].bodies];
    pair.normal += laws[i].slope * length;
    pair.tangential += laws[i].spring * length;
  }
  times_.end_step(step.dt);
  for (size_t i = 0; i < laws.size(); ++i) {
    const DampingTimes::Pair& pair = times_[laws[i].bodies];
    law_times_[i] = {pair.normal_time, pair.tangential_time};
  }
}

// Finds the spring and the dashpot along the face of the contacts of a spring.
void OutlineFriction::follow(const Step& step, const EdgeFaceUnit& unit, const EdgeFaceGroup& group,
                             Worker& worker, Unit& found) {
  const EdgeFaceLaw& law = step.blocks.laws()[static_cast<size_t>(group.law)];
  // Most springs have one contact or two: these are summed without a branch.
  constexpr std::array<double, 4> kNone{};
  const std::array<double, 4>* const addends = &worker.addends[static_cast<size_t>(group.first)];
  const std::int32_t count = group.end - group.first;
  const std::array<double, 4>& second = count > 1 ? addends[1] : kNone;
  std::array<double, 4> sums;
  for (size_t k = 0; k < 4; ++k) sums[k] = addends[0][k] + second[k];
  for (std::int32_t i = 2; i < count; ++i) {
    for (size_t k = 0; k < 4; ++k) sums[k] += addends[i][k];
  }
  const double normal = sums[SlipSums::normal];
  if (!(law.friction > 0 && normal > 0)) return;
  const SpringKey key = key_of(group);
  while (worker.next < step.before.size() && step.before[worker.next].key < key) ++worker.next;
  const bool is_old = worker.next < step.before.size() && step.before[worker.next].key == key;
  const Spring* const before = is_old ? &step.before[worker.next] : nullptr;

  double rate = sums[SlipSums::rate];
  if (step.finite && !before) {
    // Contact that has closed within a long step: what came before is no slip.
    double approach = 0, width = 0, depth = 0;
    for (std::int32_t i = group.first; i < group.end; ++i) {
      const EdgeFaceTouch& touch = step.blocks.touches()[unit.first + i / kBlock];
      const size_t lane = static_cast<size_t>(i % kBlock);
      approach += worker.slips[static_cast<size_t>(i / kBlock)].approach[lane];
      width += (touch.to[lane] - touch.from[lane]) * touch.edge_length[lane];
      depth += touch.sum[lane] * touch.edge_length[lane];
    }
    if (approach / normal * step.dt > depth / width) {
      rate *= depth / width / (approach / normal * step.dt);
    }
  }
  Spring& spring = worker.springs.emplace_back(Spring{.key = key});
  spring.stiffness = sums[SlipSums::stiffness];
  // New contact joins without a slip of its own; contact that ends takes its share along.
  const double force =
      before ? before->force * std::min(1., spring.stiffness / before->stiffness) : 0;
  const double limit = law.friction * std::max(normal + sums[SlipSums::push], 0.);
  const double per_normal = 1 / normal, slip = rate * per_normal;  // m/s
  spring.force = apothem::slide(force, slip * step.dt, spring.stiffness, limit);
  found.energy += spring.energy();
  double dashpot = 0;
  const double time = law_times_[static_cast<size_t>(group.law)].tangential;
  if (time > 0) {
    const double resists = spring.force - time * spring.stiffness * slip;
    dashpot = std::clamp(resists, -limit, limit) - spring.force;
  }
  const std::array<double, 2> share{spring.force * per_normal, dashpot * per_normal};
  std::array<double, 2>* const shares = &worker.shares[static_cast<size_t>(group.first)];
  shares[0] = shares[count - 1] = share;
  for (std::int32_t i = 1; i < count - 1; ++i) shares[i] = share;
}

// `keep_forces`: several threads work, and the forces are added to those on the vertices later.
void OutlineFriction::slide_unit(const Step& step, size_t index, Worker& worker, bool keep_forces) {
  const EdgeFaceUnit& unit = step.blocks.units()[index];
  Unit& found = units_[index] = {};
  if (unit.touching == 0) return;
  const auto blocks = static_cast<size_t>(unit.end - unit.first);
  worker.addends.assign(kBlock * blocks, {});
  worker.shares.assign(kBlock * blocks, {});
  const auto touches = [&](size_t i) {
    return (step.blocks.met()[unit.first + i] & EdgeFaceBlocks::kContacts) != 0;
  };
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    for (size_t i = 0; i < blocks; ++i) {
      if (!touches(i)) continue;
      const EdgeFaceBlock& block = step.blocks.blocks()[unit.first + i];
      std::array<double, kBlock> times;
      for (size_t l = 0; step.dashpots && l < kBlock; ++l) {
        times[l] = law_times_[static_cast<size_t>(block.law[l])].normal;
      }
      find_slip(block, step.blocks.touches()[unit.first + i], velocities_,
                step.dashpots ? &times : nullptr, worker.slips[i], &worker.addends[kBlock * i]);
    }
    return 0.;
  });
  for (const EdgeFaceGroup& group : step.blocks.groups(unit)) {
    follow(step, unit, group, worker, found);
  }
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    using Pack = PackOf<kBlock>;
    for (size_t i = 0; i < blocks; ++i) {
      if (!touches(i)) continue;
      const auto at = static_cast<size_t>(unit.first) + i;
      const OutlineSlip& slip = worker.slips[i];
      const auto share = [&](size_t number) APOTHEM_LAMBDA {
        return pack_of<kBlock>(
            [&](size_t l) APOTHEM_LAMBDA { return worker.shares[kBlock * i + l][number]; });
      };
      const Pack spring = share(0), dashpot = share(1), rate = Pack::load(slip.rate.data());
      EdgeFaceBlock::Numbers friction, damping;  // W
      (spring * rate).store(friction.data());
      (dashpot * rate + Pack::load(slip.push_power.data())).store(damping.data());
      for (size_t l = 0; l < kBlock; ++l) {  // contact by contact, wherever they stand in blocks
        found.powers.friction += friction[l];
        found.powers.damping += damping[l];
      }
      BlockDrag& drag = block_drags_[at];
      const Pack normal = Pack::load(slip.at_p.data()) + Pack::load(slip.at_q.data());
      ((spring + dashpot) * normal).store(drag.along.data());
      drag.push = slip.push;
      SlipForces& forces = keep_forces ? forces_[at] : worker.forces;
      find_drags(step.blocks.touches()[at], slip, spring, dashpot, forces);
      if (!keep_forces) add_drags(step.blocks.blocks()[at], forces, drags_.data());
    }
    return 0.;
  });
}

double OutlineFriction::slide(const EdgeFaceBlocks& blocks, const Kinematics& now, double dt,
                              FrictionMemory& memory) {
  const Outlines& o = outlines_;
  const Step step{blocks, memory.before(outline_kernel), dt, now.finite, damped_ && dt > 0};
  const auto n = static_cast<size_t>(o.size());
  velocities_.resize(2 * n);
  drags_.resize(n), drags_before_.resize(n);
  std::swap(drags_, drags_before_);
  const std::span<const BodyIndex> bodies =
      everywhere_ > 0 ? std::span<const BodyIndex>(all_) : o.active();
  body_powers_.resize(bodies.size());
  threads_.chunks(static_cast<int>(bodies.size()),
                  kVelocityTime * o.size() / static_cast<double>(o.bodies.size()),
                  [&](int first, int end, int) {
                    for (int i = first; i < end; ++i) {
                      body_powers_[static_cast<size_t>(i)] = begin(bodies[i], now, step);
                    }
                  });
  find_times(step);
  units_.resize(blocks.units().size());
  block_drags_.resize(blocks.blocks().size());
  for (Worker& worker : workers_) {
    const auto most = static_cast<size_t>(blocks.most_blocks());
    if (worker.slips.size() < most) worker.slips.resize(most);
    worker.springs.clear();
  }
  const auto units = static_cast<int>(blocks.units().size());
  const double per_unit = static_cast<double>(blocks.blocks().size()) / std::max(units, 1);
  const bool shared = threads_.worth(units, kSlipTime * per_unit);
  if (shared) forces_.resize(blocks.blocks().size());
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int number) {
    Worker& worker = workers_[static_cast<size_t>(number)];
    if (first == end) return;
    const std::span<const EdgeFaceGroup> groups = blocks.groups(blocks.units()[first]);
    const auto place =
        std::ranges::lower_bound(step.before, key_of(groups.front()), {}, &Spring::key);
    worker.next = static_cast<size_t>(place - step.before.begin());
    for (int i = first; i < end; ++i) slide_unit(step, static_cast<size_t>(i), worker, shared);
  });
  if (shared) {
    threads_.chunks(
        o.size(), kDragTime * per_unit * units / o.size(), [&](int first, int end, int) {
          for (const EdgeFaceUnit& unit : blocks.units()) {
            if (unit.end_vertex <= first || unit.first_vertex >= end || unit.touching == 0)
              continue;
            for (std::int32_t i = unit.first; i < unit.end; ++i) {
              if ((blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) continue;
              add_drags(blocks.blocks()[i], forces_[static_cast<size_t>(i)], drags_.data(), first,
                        end);
            }
          }
        });
  }
  Powers powers;
  for (const Powers& of_body : body_powers_) {
    powers.friction += of_body.friction;
    powers.damping += of_body.damping;
  }
  double energy = 0;
  for (const Unit& unit : units_) {
    powers.friction += unit.powers.friction;
    powers.damping += unit.powers.damping;
    energy += unit.energy;
  }
  for (const Worker& worker : workers_) {
    memory.keep(worker.springs, energy);
    energy = 0;
  }
  everywhere_ = dt > 0 ? std::max(everywhere_ - 1, 0) : kBothVectors;
  if (damped_) memory.damp(-dt / 2 * powers.damping);
  return dt / 2 * powers.friction;
}

void OutlineFriction::fields(Archive& archive) {
  if (!damped_) return;
  std::vector<double> damping;
  for (const VertexDrag& drag : drags_) damping.insert(damping.end(), {drag[2], drag[3]});
  archive("damping", damping);
  drags_.resize(damping.size() / 2);
  for (size_t i = 0; i < drags_.size(); ++i) {
    drags_[i][2] = damping[2 * i], drags_[i][3] = damping[2 * i + 1];
  }
}

}  // namespace apothem
