#include "apothem/contact/outline_friction.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/kernel.hpp"
#include "apothem/execution/dispatch.hpp"
#include "apothem/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kSlipTime = 20, kFollowTime = 30, kGatherTime = 15;  // of a contact, ns
constexpr size_t kPart = 128;                                         // contacts of a part

// Of the spring that a contact belongs to: an edge has one for each body that it touches. Edges of
// rigid bodies are long: they have one for each face, which the face takes with it.
SpringKey key_of(const Outlines& o, const EdgeFaceContact& c) {
  return {outline_kernel, c.edge, o.bodies[o.body[c.edge]].is_rigid() ? c.face : o.body[c.face], 0};
}

double length_of(const Outlines& o, const EdgeFaceContact& c) {
  return (c.piece.to - c.piece.from) * o.length[c.edge];
}

}  // namespace

void OutlineFriction::find_velocities(const Kinematics& now, double dt) {
  const Outlines& o = outlines_;
  velocities_.resize(2 * static_cast<size_t>(o.size()));
  const auto find = [&](const Outlines::Body& body) {
    for (int i = body.first; i < body.end; ++i) {
      double* const to = &velocities_[2 * static_cast<size_t>(i)];
      if (!body.is_rigid()) {
        const double* v = now.node_velocity.data() + 2 * static_cast<size_t>(o.node[i]);
        to[0] = v[0], to[1] = v[1];
        continue;
      }
      const double* v = now.pose_rate.data() + 3 * static_cast<size_t>(body.rigid);
      const double x = o.x[i] - body.cx, y = o.y[i] - body.cy;
      to[0] = v[0] - v[2] * y;
      to[1] = v[1] + v[2] * x;
      if (!now.finite) continue;
      // From where the vertex was, along the chord of its arc.
      const double angle = v[2] * dt, half = sine_cosine(angle / 2).sine;
      const double turned = sine_cosine(angle).sine / dt - v[2], drawn = 2 * half * half / dt;
      to[0] += drawn * x - turned * y;
      to[1] += drawn * y + turned * x;
    }
  };
  if (everywhere_) {
    std::ranges::for_each(o.bodies, find);
  } else {
    for (const BodyIndex b : o.active()) find(o.bodies[b]);
  }
}

void OutlineFriction::find_times(const Step& step) {
  times_.begin_step();
  for (const EdgeFaceContact& c : step.contacts) {
    const EdgeFaceLaw& law = step.laws[static_cast<size_t>(c.pair)];
    DampingTimes::Pair& pair = times_[law.bodies];
    const double length = length_of(outlines_, c);
    pair.normal += c.slope * length;
    pair.tangential += law.spring * length;
  }
  times_.end_step(step.dt);
}

void OutlineFriction::find_groups(const Step& step, FrictionMemory& memory) {
  groups_.clear();
  for (size_t i = 0; i < step.contacts.size(); ++i) {
    const SpringKey key = key_of(outlines_, step.contacts[i]);
    if (!groups_.empty() && groups_.back().spring.key == key) {
      groups_.back().end = i + 1;
      continue;
    }
    Group& group = groups_.emplace_back(Group{i, i + 1, nullptr, {key}, false});
    if (!(step.laws[static_cast<size_t>(step.contacts[i].pair)].friction > 0)) continue;
    const std::span<const Spring> before = memory.before(key.law, key.a, key.b);
    if (!before.empty()) group.before = before.data();
  }
}

void OutlineFriction::find_slips(const Step& step, const Part& part) {
  with_widest([&](auto /*lanes*/) __attribute__((always_inline)) {
    constexpr size_t lanes = kComparedLanes;
    for (size_t i = part.first; i < part.end; i += lanes) {
      std::array<double, lanes> times{};
      for (size_t l = 0; step.dashpots && l < lanes && i + l < part.end; ++l) {
        const auto pair = static_cast<size_t>(step.contacts[i + l].pair);
        times[l] = times_[step.laws[pair].bodies].normal_time;
      }
      apothem::find_slips<lanes>(outlines_, step.contacts.first(part.end), step.laws, velocities_,
                                 times, i, part.place + i - part.first, slips_);
    }
    return 0.;
  });
}

// Finds the spring and the dashpot along the face of the contacts of a spring. `place` of the slip
// of the first of them.
void OutlineFriction::follow(const Step& step, Group& group, size_t place) {
  using S = OutlineSlips;
  const size_t count = group.end - group.first;
  const EdgeFaceLaw& law = step.laws[static_cast<size_t>(step.contacts[group.first].pair)];
  Spring& spring = group.spring;
  double pushes = 0, normal = 0, rate = 0, approach = 0, width = 0, depth = 0;
  for (size_t k = 0; k < count; ++k) {
    const size_t i = place + k;
    pushes_[group.first + k] = slips_.of(i, S::push);
    pushes += slips_.of(i, S::push);
    normal += slips_.of(i, S::normal);
    spring.stiffness += slips_.of(i, S::stiffness);
    rate += slips_.of(i, S::rate);
    approach += slips_.of(i, S::approach);
    width += slips_.of(i, S::length);
    depth += slips_.of(i, S::depth);
  }
  if (!(law.friction > 0 && normal > 0)) return;
  group.slides = true;
  // Contact that has closed within a long step: what came before is no slip.
  const Spring* const before = group.before;
  if (step.finite && !before && approach / normal * step.dt > depth / width) {
    rate *= depth / width / (approach / normal * step.dt);
  }
  // New contact joins without a slip of its own; contact that ends takes its share along.
  const double force =
      before ? before->force * std::min(1., spring.stiffness / before->stiffness) : 0;
  const double limit = law.friction * std::max(normal + pushes, 0.);
  const double slip = rate / normal;  // m/s
  spring.force = apothem::slide(force, slip * step.dt, spring.stiffness, limit);
  double dashpot = 0;
  const double time = step.dashpots ? times_[law.bodies].tangential_time : 0;
  if (time > 0) {
    const double resists = spring.force - time * spring.stiffness * slip;
    dashpot = std::clamp(resists, -limit, limit) - spring.force;
  }
  for (size_t k = 0; k < count; ++k) {
    const size_t i = place + k;
    *slips_.at(i, S::friction) = spring.force / normal;
    *slips_.at(i, S::dashpot) = dashpot / normal;
    shares_[group.first + k] = (spring.force + dashpot) / normal * slips_.of(i, S::normal);
  }
}

// Adds the forces on the vertices from `first` to `end` - 1, those of whole bodies, for every
// vertex in the order of the contacts.
void OutlineFriction::add_forces(const Part& part, int first, int end) {
  with_widest([&](auto /*lanes*/) __attribute__((always_inline)) {
    constexpr size_t lanes = kComparedLanes;
    const size_t count = part.end - part.first;
    for (size_t i = 0; i < count; i += lanes) {
      add_slip_forces<lanes>(slips_, part.place + i, std::min(lanes, count - i), first, end,
                             friction_, damping_);
    }
    return 0.;
  });
}

// One part after the other, each with all that is to be done, so that its slips stay in the cache.
void OutlineFriction::slide_by_parts(const Step& step, FrictionMemory& memory) {
  for (size_t g = 0; g < groups_.size();) {
    Part part{groups_[g].first, groups_[g].end, 0};
    size_t end = g + 1;
    while (end < groups_.size() && groups_[end].end - part.first <= kPart) {
      part.end = groups_[end++].end;
    }
    slips_.resize(part.end - part.first);
    find_slips(step, part);
    for (; g < end; ++g) {
      Group& group = groups_[g];
      follow(step, group, group.first - part.first);
      if (group.slides) memory.keep(group.spring);
    }
    add_forces(part, 0, outlines_.size());
  }
}

void OutlineFriction::slide_on_threads(const Step& step, FrictionMemory& memory) {
  const size_t count = step.contacts.size();
  slips_.resize(count);
  const auto blocks = static_cast<int>((count + kLanes - 1) / kLanes);
  threads_.chunks(blocks, kLanes * kSlipTime, [&](int first, int end, int) {
    const size_t begin = static_cast<size_t>(first) * kLanes;
    find_slips(step, {begin, std::min(static_cast<size_t>(end) * kLanes, count), begin});
  });
  threads_.chunks(static_cast<int>(groups_.size()), kFollowTime, [&](int first, int end, int) {
    for (int g = first; g < end; ++g) {
      Group& group = groups_[static_cast<size_t>(g)];
      follow(step, group, group.first);
    }
  });
  for (const Group& group : groups_) {
    if (group.slides) memory.keep(group.spring);
  }
  const std::span<const BodyIndex> active = outlines_.active();
  const int bodies = static_cast<int>(active.size());
  threads_.chunks(bodies, kGatherTime * static_cast<double>(count) / std::max(bodies, 1),
                  [&](int first, int end, int) {
                    if (first == end) return;
                    add_forces({0, count, 0}, outlines_.bodies[active[first]].first,
                               outlines_.bodies[active[end - 1]].end);
                  });
}

double OutlineFriction::slide(std::span<const EdgeFaceContact> contacts,
                              std::span<const EdgeFaceLaw> laws, const Kinematics& now, double dt,
                              FrictionMemory& memory) {
  const Outlines& o = outlines_;
  // A first look, perhaps with the memory of another run: as springs do, dashpots keep their force.
  const Step step{contacts, laws, dt, now.finite, damped_ && dt > 0};
  find_velocities(now, dt);
  const size_t n = 2 * static_cast<size_t>(o.size());
  friction_.resize(n);
  if (damped_) damping_.resize(n);
  std::swap(friction_, friction_before_);
  const Powers before = powers(friction_before_);
  friction_.assign(n, 0);
  if (step.dashpots) {
    damping_.assign(n, 0);
    find_times(step);
  }
  const size_t count = contacts.size();
  shares_.assign(count, 0);
  pushes_.resize(count);
  find_groups(step, memory);
  if (threads_.worth(static_cast<int>(count), kSlipTime)) {
    slide_on_threads(step, memory);
  } else {
    slide_by_parts(step, memory);
  }
  const Powers after = powers(friction_);
  everywhere_ = !(dt > 0);
  if (damped_) memory.damp(-dt / 2 * (before.damping + after.damping));
  return dt / 2 * (before.friction + after.friction);
}

// Both sums at once, so that neither waits for its own last addition only.
OutlineFriction::Powers OutlineFriction::powers(const VertexForces& friction) const {
  Powers sum;
  const auto add = [&](int first, int end) {
    for (size_t c = 2 * static_cast<size_t>(first); c < 2 * static_cast<size_t>(end); c += 2) {
      const double vx = velocities_[c], vy = velocities_[c + 1];
      sum.friction += friction[c] * vx + friction[c + 1] * vy;
      if (damped_) sum.damping += damping_[c] * vx + damping_[c + 1] * vy;
    }
  };
  if (everywhere_) {
    add(0, outlines_.size());
  } else {
    for (const BodyIndex b : outlines_.active()) {
      const Outlines::Body& body = outlines_.bodies[static_cast<size_t>(b)];
      add(body.first, body.end);
    }
  }
  return sum;
}

}  // namespace apothem
