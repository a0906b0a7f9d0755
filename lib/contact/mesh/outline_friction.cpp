#include "lib/contact/mesh/outline_friction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lib/contact/kernel.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
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

// Calls f(block, lane) for the contacts of a spring.
template <class F>
void each_contact(const EdgeFaceBlocks& blocks, const EdgeFaceUnit& unit,
                  const EdgeFaceGroup& group, const F& f) {
  for (std::int32_t c = group.first; c < group.end; ++c) {
    const std::int32_t block = unit.first + c / kBlock;
    const auto lane = static_cast<size_t>(c % kBlock);
    if ((blocks.met()[block] >> lane & 1U) != 0) f(block, lane);
  }
}

}  // namespace

OutlineFriction::OutlineFriction(const Outlines& outlines, const PairTable& table,
                                 const std::vector<double>& inverse_mass, int threads)
    : outlines_(outlines),
      damped_(table.damped()),
      threads_(threads),
      times_(table, inverse_mass),
      normals_(outlines),
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

// What the contacts of springs add up to, without what springs remember.
void OutlineFriction::find_contacts(const Step& step, const EdgeFaceUnit& unit) {
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    for (std::int32_t i = unit.first; i < unit.end; ++i) {
      if ((step.blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) continue;
      find_slip(step.blocks.blocks()[i], step.blocks.touches()[i], velocities_,
                slips_[static_cast<size_t>(i)]);
    }
    return 0.;
  });
  const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
  for (size_t g = 0; g < groups.size(); ++g) {
    SpringContact& sum = contacts_[static_cast<size_t>(unit.first_group) + g] = {};
    sum.edge = groups[g].edge;
    each_contact(step.blocks, unit, groups[g], [&](std::int32_t i, size_t lane) {
      const EdgeFaceBlock& block = step.blocks.blocks()[i];
      const EdgeFaceTouch& touch = step.blocks.touches()[i];
      const OutlineSlip& slip = slips_[static_cast<size_t>(i)];
      sum.other = outlines_.body[block.a[lane]];
      sum.normal += slip.at_p[lane] + slip.at_q[lane];
      sum.place += slip.at_q[lane];
      sum.rate_x += slip.rate_x[lane], sum.rate_y += slip.rate_y[lane];
      sum.stiffness +=
          block.spring[lane] * ((touch.to[lane] - touch.from[lane]) * touch.edge_length[lane]);
      sum.deepest = std::max(sum.deepest, touch.deepest[lane]);
    });
  }
}

// What springs remember.
void OutlineFriction::find_before(const Step& step) {
  auto before = step.before.begin();
  for (const EdgeFaceUnit& unit : step.blocks.units()) {
    const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
    for (size_t g = 0; g < groups.size(); ++g) {
      SpringContact& contact = contacts_[static_cast<size_t>(unit.first_group) + g];
      if (!(contact.normal > 0)) continue;
      const SpringKey key = key_of(groups[g]);
      while (before != step.before.end() && is_before(before->key, key)) ++before;
      if (before == step.before.end() || before->key.a != key.a || before->key.b != key.b) continue;
      contact.is_old = true;
      contact.force_before = before->force, contact.stiffness_before = before->stiffness;
    }
  }
}

// Stiffness of the contacts of a spring along its normal, N/m: their pieces of faces resist by the
// cosine of their angle to it, and what cancels does not.
double OutlineFriction::resistance(const Step& step, const EdgeFaceUnit& unit,
                                   const EdgeFaceGroup& group, const SpringContact& contact) const {
  if (!(contact.normal > 0)) return 0;
  double sum = 0;
  each_contact(step.blocks, unit, group, [&](std::int32_t i, size_t lane) {
    const EdgeFaceTouch& touch = step.blocks.touches()[i];
    const double length = (touch.to[lane] - touch.from[lane]) * touch.edge_length[lane];
    const double along = touch.tx[lane] * -contact.ny + touch.ty[lane] * contact.nx;
    sum += step.blocks.blocks()[i].slope[lane] * length * std::max(0., along);
  });
  return contact.pressed / contact.normal * sum;
}

void OutlineFriction::find_times(const Step& step) {
  const std::span<const EdgeFaceLaw> laws = step.blocks.laws();
  law_times_.resize(laws.size());
  if (!step.dashpots) {
    std::ranges::fill(law_times_, LawTimes{0, 0});
    return;
  }
  resistances_.resize(contacts_.size());
  times_.begin_step();
  for (const EdgeFaceUnit& unit : step.blocks.units()) {
    const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
    for (size_t g = 0; g < groups.size(); ++g) {
      const size_t number = static_cast<size_t>(unit.first_group) + g;
      resistances_[number] = resistance(step, unit, groups[g], contacts_[number]);
      times_[laws[static_cast<size_t>(groups[g].law)].bodies].normal += resistances_[number];
    }
  }
  for (size_t i = 0; i < laws.size(); ++i) {
    times_[laws[i].bodies].tangential += laws[i].spring * step.blocks.lengths()[i];
  }
  times_.end_step(step.dt);
  for (size_t i = 0; i < laws.size(); ++i) {
    const DampingTimes::Pair& pair = times_[laws[i].bodies];
    law_times_[i] = {pair.normal_time, pair.tangential_time};
  }
}

// The part of a long step in which a new contact was closed: what came before is no slip.
double OutlineFriction::closed_share(const Step& step, const EdgeFaceUnit& unit,
                                     const EdgeFaceGroup& group, const SpringContact& contact) {
  double width = 0, depth = 0;
  each_contact(step.blocks, unit, group, [&](std::int32_t i, size_t lane) {
    const EdgeFaceTouch& touch = step.blocks.touches()[i];
    width += (touch.to[lane] - touch.from[lane]) * touch.edge_length[lane];
    depth += touch.sum[lane] * touch.edge_length[lane];
  });
  const double approach = -(contact.nx * contact.rate_x + contact.ny * contact.rate_y);
  const double closed = approach / contact.normal * step.dt;
  return closed > depth / width ? depth / width / closed : 1;
}

// Finds springs and dashpots. Returns the energy of the springs, J.
double OutlineFriction::follow(const Step& step, const EdgeFaceUnit& unit, Worker& worker) const {
  const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
  double energy = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    const EdgeFaceGroup& group = groups[g];
    const size_t number = static_cast<size_t>(unit.first_group) + g;
    const SpringContact& contact = contacts_[number];
    double friction = 0, dashpot = 0, push = 0;  // N
    if (contact.normal > 0) {
      const double coefficient = step.blocks.laws()[static_cast<size_t>(group.law)].friction;
      const LawTimes& times = law_times_[static_cast<size_t>(group.law)];
      const double per_normal = 1 / contact.normal;
      if (times.normal > 0) {
        const double closing =
            -(contact.nx * contact.rate_x + contact.ny * contact.rate_y) * per_normal;
        push = std::max(-contact.pressed, times.normal * resistances_[number] * closing);
      }
      if (coefficient > 0) {
        const CoulombSpring<double> spring{
            contact.stiffness,
            step.limited ? coefficient * std::max(0., contact.pressed + push) : HUGE_VAL};
        double slip = (contact.nx * contact.rate_y - contact.ny * contact.rate_x) * per_normal;
        if (step.finite && !contact.is_old) slip *= closed_share(step, unit, group, contact);
        friction = spring.after(contact.force_before, slip * step.dt);
        if (times.tangential > 0) dashpot = spring.dashpot(friction, times.tangential, slip);
        if (contact.stiffness > 0) energy += friction * friction / (2 * contact.stiffness);
        worker.springs.push_back(
            {.key = key_of(group), .force = friction, .stiffness = contact.stiffness});
      }
      friction *= per_normal, dashpot *= per_normal, push *= per_normal;
    }
    for (std::int32_t c = group.first; c < group.end; ++c) {
      SlipPull& pull = worker.pulls[static_cast<size_t>(c / kBlock)];
      const auto lane = static_cast<size_t>(c % kBlock);
      pull.friction_x[lane] = -friction * contact.ny;
      pull.friction_y[lane] = friction * contact.nx;
      pull.dashpot_x[lane] = push * contact.nx - dashpot * contact.ny;
      pull.dashpot_y[lane] = push * contact.ny + dashpot * contact.nx;
      SlipPush& pushes = worker.pushes[static_cast<size_t>(c / kBlock)];
      pushes.x[lane] = push * contact.nx, pushes.y[lane] = push * contact.ny;
    }
  }
  return energy;
}

// Adds the forces on the vertices. Returns the powers of these forces.
APOTHEM_INLINE OutlineFriction::Powers OutlineFriction::pull(const Step& step,
                                                             const EdgeFaceUnit& unit,
                                                             Worker& worker, bool divided) {
  Powers powers;
  for (std::int32_t i = unit.first; i < unit.end; ++i) {
    if ((step.blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) continue;
    const auto k = static_cast<size_t>(i - unit.first);
    const OutlineSlip& slip = slips_[static_cast<size_t>(i)];
    const SlipPull& pull = worker.pulls[k];
    const SlipPush& push = worker.pushes[k];
    BlockDrag& drag = block_drags_[static_cast<size_t>(i)];
    for (size_t l = 0; l < kBlock; ++l) {  // contact by contact, wherever they stand in blocks
      powers.friction += pull.friction_x[l] * slip.rate_x[l] + pull.friction_y[l] * slip.rate_y[l];
      powers.damping += pull.dashpot_x[l] * slip.rate_x[l] + pull.dashpot_y[l] * slip.rate_y[l];
      const double normal = slip.at_p[l] + slip.at_q[l];
      drag.push_x[l] = push.x[l] * normal, drag.push_y[l] = push.y[l] * normal;
      drag.drag_x[l] = (pull.friction_x[l] + pull.dashpot_x[l]) * normal - drag.push_x[l];
      drag.drag_y[l] = (pull.friction_y[l] + pull.dashpot_y[l]) * normal - drag.push_y[l];
    }
    SlipForces forces;
    find_drags(step.blocks.touches()[i], slip, pull, forces);
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
  const auto last = static_cast<size_t>(unit.end - unit.first) - 1;
  worker.pulls[last] = {}, worker.pushes[last] = {};
  found.energy = follow(step, unit, worker);
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
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
  units_.resize(blocks.units().size());
  block_drags_.resize(blocks.blocks().size());
  slips_.resize(blocks.blocks().size());
  contacts_.resize(blocks.group_count());
  for (Worker& worker : workers_) {
    const auto most = static_cast<size_t>(blocks.most_blocks());
    if (worker.pulls.size() < most) worker.pulls.resize(most), worker.pushes.resize(most);
    worker.springs.clear(), worker.late.clear();
  }
  const auto units = static_cast<int>(blocks.units().size());
  const double per_unit = static_cast<double>(blocks.blocks().size()) / std::max(units, 1);
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int) {
    for (int i = first; i < end; ++i) find_contacts(step, blocks.units()[i]);
  });
  find_before(step);
  normals_.find(contacts_);
  find_times(step);
  const bool divided = threads_.worth(units, kSlipTime * per_unit);
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int number) {
    Worker& worker = workers_[static_cast<size_t>(number)];
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
