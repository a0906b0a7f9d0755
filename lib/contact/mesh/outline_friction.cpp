#include "lib/contact/mesh/outline_friction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/contact/kernel.hpp"
#include "lib/execution/dispatch.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kSlipTime = 100, kVelocityTime = 5;  // ns

APOTHEM_INLINE SpringKey key_of(const EdgeFaceGroup& group) {
  return {outline_kernel, group.edge, group.partner, 0};
}

// Of two keys of this law.
APOTHEM_INLINE bool is_before(const SpringKey& one, const SpringKey& other) {
  const auto number = [](const SpringKey& key) APOTHEM_LAMBDA {
    return static_cast<std::uint64_t>(key.a) << 32 | static_cast<std::uint32_t>(key.b);
  };
  return number(one) < number(other);
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

void OutlineFriction::limit_damping(std::span<const double> node_mass, double thickness) {
  const Outlines& o = outlines_;
  std::vector<DampingTimes::Nodes> nodes(o.bodies.size());
  for (size_t b = 0; b < nodes.size(); ++b) nodes[b].slope = o.bodies[b].slope();
  for (int i = 0; i < o.size(); ++i) {
    const double mass = o.node[i] < 0 ? 0 : node_mass[o.node[i]];
    if (!(mass > 0)) continue;
    const double share = (o.given_length(o.previous[i]) + o.given_length(i)) / 2;
    nodes[o.body[i]].share = std::max(nodes[o.body[i]].share, share / mass);
  }
  times_.limit(std::move(nodes), thickness);
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
    const double spin = v[2] - (now.slip.empty() ? 0 : now.slip[3 * size_t(body.rigid) + 2]);
    const double angle = spin * step.dt, half = sine_cosine(angle / 2).sine;
    turned = sine_cosine(angle).sine / step.dt - spin, drawn = 2 * half * half / step.dt;
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

// The slip rate of contact that has closed within a long step, N m/s: what came before is no slip.
double OutlineFriction::damped_rate(const Step& step, const EdgeFaceUnit& unit,
                                    const EdgeFaceGroup& group, const Worker& worker,
                                    const std::array<double, 4>& sums) {
  double approach = 0, width = 0, depth = 0;
  for (std::int32_t i = group.first; i < group.end; ++i) {
    const std::int32_t block = unit.first + i / kBlock;
    const auto lane = static_cast<size_t>(i % kBlock);
    if ((step.blocks.met()[block] >> lane & 1U) == 0) continue;
    const EdgeFaceTouch& touch = step.blocks.touches()[block];
    approach += worker.slips[static_cast<size_t>(i / kBlock)].approach[lane];
    width += (touch.to[lane] - touch.from[lane]) * touch.edge_length[lane];
    depth += touch.sum[lane] * touch.edge_length[lane];
  }
  const double closed = approach / sums[SlipSums::normal] * step.dt;
  return sums[SlipSums::rate] * (closed > depth / width ? depth / width / closed : 1);
}

// What does not depend on springs.
APOTHEM_INLINE void OutlineFriction::find_slips(const Step& step, const EdgeFaceUnit& unit,
                                                Worker& worker) const {
  for (std::int32_t i = unit.first; i < unit.end; ++i) {
    const auto k = static_cast<size_t>(i - unit.first);
    if ((step.blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) {
      std::fill_n(&worker.addends[kBlock * k], kBlock, std::array<double, 4>{});
      continue;
    }
    const EdgeFaceBlock& block = step.blocks.blocks()[i];
    std::array<double, kBlock> times;
    for (size_t l = 0; step.dashpots && l < kBlock; ++l) {
      times[l] = law_times_[static_cast<size_t>(block.law[l])].normal;
    }
    find_slip(block, step.blocks.touches()[i], velocities_, step.dashpots ? &times : nullptr,
              worker.slips[k], &worker.addends[kBlock * k]);
  }
}

// Finds the springs and the dashpots along faces, four at a time. Returns the energy of the
// springs, J.
APOTHEM_INLINE double OutlineFriction::follow(const Step& step, const EdgeFaceUnit& unit,
                                              Worker& worker) const {
  constexpr std::array<double, 4> kNone{};
  const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
  FourOf<PackOf<kBlock>> rows, sums;
  SlipMemory memory;
  SlipSprings springs;
  EdgeFaceBlock::Numbers stiffness;
  double energy = 0;
  for (size_t first = 0; first < groups.size(); first += kBlock) {
    const size_t count = std::min<size_t>(kBlock, groups.size() - first);
    for (size_t l = 0; l < kBlock; ++l) {
      if (l >= count) {
        rows[l] = PackOf<kBlock>(0.), memory.coefficient[l] = memory.time[l] = memory.force[l] = 0;
        memory.stiffness[l] = 1;
        continue;
      }
      const EdgeFaceGroup& group = groups[first + l];
      // Most springs have one contact or two: these are summed without a branch.
      const std::array<double, 4>* const addends =
          &worker.addends[static_cast<size_t>(group.first)];
      const std::int32_t contacts = group.end - group.first;
      rows[l] = PackOf<4>::load(addends[0].data()) +
                PackOf<4>::load(contacts > 1 ? addends[1].data() : kNone.data());
      for (std::int32_t i = 2; i < contacts; ++i) rows[l] += PackOf<4>::load(addends[i].data());
      const SpringKey key = key_of(group);
      const std::span<const Spring> before = step.before;
      while (worker.next < before.size() && is_before(before[worker.next].key, key)) ++worker.next;
      const bool is_old = worker.next < before.size() && before[worker.next].key.a == key.a &&
                          before[worker.next].key.b == key.b;
      memory.force[l] = is_old ? before[worker.next].force : 0;
      memory.stiffness[l] = is_old ? before[worker.next].stiffness : 1;
      memory.coefficient[l] = step.blocks.laws()[static_cast<size_t>(group.law)].friction;
      memory.time[l] = law_times_[static_cast<size_t>(group.law)].tangential;
      if (step.finite && !is_old) {
        std::array<double, 4> row;
        rows[l].store(row.data());
        row[SlipSums::rate] = damped_rate(step, unit, group, worker, row);
        rows[l] = PackOf<4>::load(row.data());
      }
    }
    transpose(rows, sums);
    sums[SlipSums::stiffness].store(stiffness.data());
    find_springs(sums, memory, step.dt, step.limited ? 0 : HUGE_VAL, springs);
    for (size_t l = 0; l < count; ++l) {
      const EdgeFaceGroup& group = groups[first + l];
      energy += springs.energy[l];
      const auto share = [&](std::int32_t i) APOTHEM_LAMBDA {
        worker.friction[static_cast<size_t>(i)] = springs.friction[l];
        worker.dashpots[static_cast<size_t>(i)] = springs.dashpot[l];
      };
      share(group.first), share(group.end - 1);
      for (std::int32_t i = group.first + 1; i < group.end - 1; ++i) share(i);
      if ((springs.lanes >> l & 1U) == 0) continue;
      worker.springs.push_back(
          {.key = key_of(group), .force = springs.force[l], .stiffness = stiffness[l]});
    }
  }
  return energy;
}

// Adds the forces on the vertices. Returns the powers of these forces.
APOTHEM_INLINE OutlineFriction::Powers OutlineFriction::pull(const Step& step,
                                                             const EdgeFaceUnit& unit,
                                                             Worker& worker, bool divided) {
  using Pack = PackOf<kBlock>;
  Powers powers;
  for (std::int32_t i = unit.first; i < unit.end; ++i) {
    if ((step.blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) continue;
    const auto k = static_cast<size_t>(i - unit.first);
    const OutlineSlip& slip = worker.slips[k];
    const Pack spring = Pack::load(&worker.friction[kBlock * k]);
    const Pack dashpot = Pack::load(&worker.dashpots[kBlock * k]);
    const Pack rate = Pack::load(slip.rate.data());
    EdgeFaceBlock::Numbers friction, damping;  // W
    (spring * rate).store(friction.data());
    (dashpot * rate + Pack::load(slip.push_power.data())).store(damping.data());
    for (size_t l = 0; l < kBlock; ++l) {  // contact by contact, wherever they stand in blocks
      powers.friction += friction[l];
      powers.damping += damping[l];
    }
    BlockDrag& drag = block_drags_[static_cast<size_t>(i)];
    const Pack normal = Pack::load(slip.at_p.data()) + Pack::load(slip.at_q.data());
    ((spring + dashpot) * normal).store(drag.along.data());
    drag.push = slip.push;
    SlipForces forces;
    find_drags(step.blocks.touches()[i], slip, spring, dashpot, forces);
    const EdgeFaceBlock& block = step.blocks.blocks()[i];
    const auto add_at_once = [&](std::int32_t vertex, const PackOf<4>& force)
                                 APOTHEM_LAMBDA { add(force, drags_[vertex]); };
    if (!divided || !step.blocks.has_shared(i)) {
      each_drag(block, forces, add_at_once);
      continue;
    }
    each_drag(block, forces, [&](std::int32_t vertex, const PackOf<4>& force) APOTHEM_LAMBDA {
      if (step.blocks.is_shared(vertex)) {
        force.store(worker.late.emplace_back(vertex, VertexDrag{}).second.data());
      } else {
        add_at_once(vertex, force);
      }
    });
  }
  return powers;
}

// `divided`: several threads work. Forces on vertices that two of them have are added later.
void OutlineFriction::slide_unit(const Step& step, size_t index, Worker& worker, bool divided) {
  const EdgeFaceUnit& unit = step.blocks.units()[index];
  Unit& found = units_[index] = {};
  if (unit.touching == 0) return;
  // The last block may have lanes without a spring.
  const size_t lanes = kBlock * static_cast<size_t>(unit.end - unit.first);
  for (size_t l = lanes - kBlock; l < lanes; ++l) worker.friction[l] = worker.dashpots[l] = 0;
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    find_slips(step, unit, worker);
    found.energy = follow(step, unit, worker);
    found.powers = pull(step, unit, worker, divided);
    return 0.;
  });
}

double OutlineFriction::slide(const EdgeFaceBlocks& blocks, const Kinematics& now, double dt,
                              FrictionMemory& memory) {
  const Outlines& o = outlines_;
  const Step step{blocks,     memory.before(outline_kernel),   dt,
                  now.finite, damped_ && dt > 0 && !now.still, !now.restored};
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
    if (worker.slips.size() < most) {
      worker.slips.resize(most), worker.addends.resize(kBlock * most);
      worker.friction.resize(kBlock * most), worker.dashpots.resize(kBlock * most);
    }
    worker.springs.clear(), worker.late.clear();
  }
  const auto units = static_cast<int>(blocks.units().size());
  const double per_unit = static_cast<double>(blocks.blocks().size()) / std::max(units, 1);
  const bool divided = threads_.worth(units, kSlipTime * per_unit);
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int number) {
    Worker& worker = workers_[static_cast<size_t>(number)];
    if (first == end) return;
    const std::span<const EdgeFaceGroup> groups = blocks.groups(blocks.units()[first]);
    const auto place =
        std::ranges::lower_bound(step.before, key_of(groups.front()), {}, &Spring::key);
    worker.next = static_cast<size_t>(place - step.before.begin());
    for (int i = first; i < end; ++i) slide_unit(step, static_cast<size_t>(i), worker, divided);
  });
  // In the order of the units, as if one thread had worked on them.
  for (const Worker& worker : workers_) {
    for (const auto& [vertex, force] : worker.late) {
      add(PackOf<4>::load(force.data()), drags_[vertex]);
    }
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
  for (Worker& worker : workers_) {
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
