#include "lib/contact/mesh/outline_friction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "lib/contact/kernel.hpp"
#include "lib/contact/law/coulomb_spring.hpp"
#include "lib/contact/mesh/outline_friction_tangent.hpp"
#include "lib/contact/mesh/outline_spring.hpp"
#include "lib/execution/dispatch.hpp"
#include "lib/execution/elementary.hpp"

namespace apothem {
namespace {

constexpr double kSlipTime = 100, kVelocityTime = 5;  // ns

APOTHEM_INLINE ContactKey key_of(const EdgeFaceGroup& group) {
  return {outline_kernel, group.edge, group.partner, 0};
}

}  // namespace

OutlineFriction::OutlineFriction(const Surfaces& surfaces, const PairTable& table, int threads)
    : surfaces_(surfaces),
      table_(table),
      outlines_(surfaces.outlines()),
      threads_(threads),
      normals_(outlines_),
      all_(outlines_.bodies.size()),
      workers_(static_cast<size_t>(threads_.count())) {
  std::iota(all_.begin(), all_.end(), 0);
}

// Finds the velocities of the vertices of a body and clears their new forces. Returns the power of
// the old forces, W.
double OutlineFriction::begin(BodyIndex b, const Kinematics& now, const Step& step) {
  const OutlineSurfaces& o = outlines_;
  const OutlineSurfaces::Body& body = o.bodies[b];
  double power = 0;
  const auto put = [&](int i, double vx, double vy) {
    velocities_[2 * static_cast<size_t>(i)] = vx;
    velocities_[2 * static_cast<size_t>(i) + 1] = vy;
    const VertexDrag& before = drags_before_[static_cast<size_t>(i)];
    power += before[0] * vx + before[1] * vy;
    drags_[static_cast<size_t>(i)] = {};
  };
  if (!body.is_rigid()) {
    for (int i = body.first; i < body.end; ++i) {
      const double* v = now.node_velocity.data() + 2 * static_cast<size_t>(o.node[i]);
      put(i, v[0], v[1]);
    }
    return power;
  }
  const double* v = now.pose_rate.data() + 3 * static_cast<size_t>(body.rigid);
  double drawn = 0, turned = 0;
  if (now.finite) {  // mean velocity along the chord of the vertex's path
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
  return power;
}

// Sums the contacts of the springs of a unit, without the memory of the springs.
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
    sum.tx = outlines_.tx[sum.edge], sum.ty = outlines_.ty[sum.edge];
    sum.ratio = step.blocks.laws()[static_cast<size_t>(groups[g].law)].law->spread_ratio();
    step.blocks.each_contact(unit, groups[g], [&](size_t i, size_t lane) {
      const EdgeFaceBlock& block = step.blocks.blocks()[i];
      const EdgeFaceTouch& touch = step.blocks.touches()[i];
      const OutlineSlip& slip = slips_[i];
      sum.other = outlines_.body[block.a[lane]];
      sum.normal += slip.at_p[lane] + slip.at_q[lane];
      sum.place += slip.at_q[lane];
      sum.rate_x += slip.rate_x[lane], sum.rate_y += slip.rate_y[lane];
      const double slope =
          block.slope[lane] * ((touch.to[lane] - touch.from[lane]) * touch.edge_length[lane]);
      sum.slope_x += slope * touch.tx[lane], sum.slope_y += slope * touch.ty[lane];
      sum.deepest = std::max(sum.deepest, touch.deepest[lane]);
    });
  }
}

// Looks up the springs of the step before.
void OutlineFriction::find_before(const Step& step, ContactWalk<const Spring> walk) {
  step.blocks.each_group([&](const EdgeFaceUnit&, const EdgeFaceGroup& group, size_t i) {
    SpringContact& contact = contacts_[i];
    if (!(contact.normal > 0)) return;
    const std::span<const Spring> before = walk.find(key_of(group));
    if (before.empty()) return;
    contact.is_old = true;
    contact.force_before = before[0].force, contact.stiffness_before = before[0].stiffness;
    contact.push_before = before[0].push;
  });
}

// The part of the slip of a step that the spring of a contact follows.
double OutlineFriction::followed_fraction(const Step& step, const EdgeFaceUnit& unit,
                                          const EdgeFaceGroup& group,
                                          const SpringContact& contact) {
  if (!step.finite || contact.is_old) return 1;
  double width = 0, depth = 0;
  step.blocks.each_contact(unit, group, [&](size_t i, size_t lane) {
    const EdgeFaceTouch& touch = step.blocks.touches()[i];
    width += (touch.to[lane] - touch.from[lane]) * touch.edge_length[lane];
    depth += touch.sum[lane] * touch.edge_length[lane];
  });
  return closed_fraction(contact, width, depth, step.dt);
}

// Updates the springs of a unit and finds their forces. Returns their energy, J.
double OutlineFriction::follow(const Step& step, const EdgeFaceUnit& unit,
                               FrictionWorkspace& worker) {
  const std::span<const EdgeFaceGroup> groups = step.blocks.groups(unit);
  double energy = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    const EdgeFaceGroup& group = groups[g];
    SpringContact& contact = contacts_[static_cast<size_t>(unit.first_group) + g];
    const PairLaw& law = *step.blocks.laws()[static_cast<size_t>(group.law)].law;
    double pull = 0;
    if (contact.normal > 0 && law.rough()) {
      follow_slip<double>({law, step.dt, step.limited},
                          followed_fraction(step, unit, group, contact), contact);
      energy += spring_energy(contact.friction, contact.stiffness);
      worker.springs.push_back({.key = key_of(group),
                                .force = contact.friction,
                                .stiffness = contact.stiffness,
                                .push = contact.push_before});
      pull = contact.friction / contact.normal;
    }
    for (std::int32_t c = group.first; c < group.end; ++c) {
      SlipPull& pulls = worker.pulls[static_cast<size_t>(c / kBlock)];
      const auto lane = static_cast<size_t>(c % kBlock);
      pulls.x[lane] = -pull * contact.ny, pulls.y[lane] = pull * contact.nx;
    }
  }
  return energy;
}

// Adds the forces of a unit's springs to the vertices. Returns their power, W.
APOTHEM_INLINE double OutlineFriction::pull(const Step& step, const EdgeFaceUnit& unit,
                                            FrictionWorkspace& worker, bool divided) {
  double power = 0;
  for (std::int32_t i = unit.first; i < unit.end; ++i) {
    if ((step.blocks.met()[i] & EdgeFaceBlocks::kContacts) == 0) continue;
    const OutlineSlip& slip = slips_[static_cast<size_t>(i)];
    const SlipPull& pull = worker.pulls[static_cast<size_t>(i - unit.first)];
    for (size_t l = 0; l < kBlock; ++l) {  // in the order of the contacts, whatever their blocks
      power += pull.x[l] * slip.rate_x[l] + pull.y[l] * slip.rate_y[l];
    }
    SlipForces forces;
    find_drags(step.blocks.touches()[i], slip, pull, forces);
    const bool shared = divided && step.blocks.has_shared(i);
    each_drag(step.blocks.blocks()[i], forces,
              [&](std::int32_t vertex, double x, double y) APOTHEM_LAMBDA {
                if (shared && step.blocks.is_shared(vertex)) {
                  worker.deferred.push_back({vertex, {x, y}});
                  return;
                }
                VertexDrag& drag = drags_[static_cast<size_t>(vertex)];
                drag[0] += x, drag[1] += y;
              });
  }
  return power;
}

// Updates the springs of a unit. If `divided`, several threads work, and forces on vertices that
// two of them share are deferred.
void OutlineFriction::update_unit(const Step& step, size_t index, FrictionWorkspace& worker,
                                  bool divided) {
  const EdgeFaceUnit& unit = step.blocks.units()[index];
  UnitResult& found = units_[index] = {};
  if (unit.touching == 0) return;
  // The last block may have padding, which has no spring.
  const auto last = static_cast<size_t>(unit.end - unit.first) - 1;
  worker.pulls[last] = {};
  found.energy = follow(step, unit, worker);
  with_widest([&](auto /*lanes*/) APOTHEM_LAMBDA {
    found.power = pull(step, unit, worker, divided);
    return 0.;
  });
}

double OutlineFriction::update_friction(const EdgeFaceBlocks& blocks, const Kinematics& now,
                                        double dt, FrictionMemory& memory) {
  const OutlineSurfaces& o = outlines_;
  const Step step{blocks, dt, now.finite, !now.restored};
  tried_dt_ = dt;
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
  slips_.resize(blocks.blocks().size());
  contacts_.resize(blocks.group_count());
  for (FrictionWorkspace& worker : workers_) {
    const auto most = static_cast<size_t>(blocks.most_blocks());
    if (worker.pulls.size() < most) worker.pulls.resize(most);
    worker.springs.clear(), worker.deferred.clear();
  }
  const auto units = static_cast<int>(blocks.units().size());
  const double per_unit = static_cast<double>(blocks.blocks().size()) / std::max(units, 1);
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int) {
    for (int i = first; i < end; ++i) find_contacts(step, blocks.units()[i]);
  });
  find_before(step, memory.before(outline_kernel));
  normals_.find(contacts_);
  const bool divided = threads_.worth(units, kSlipTime * per_unit);
  threads_.chunks(units, kSlipTime * per_unit, [&](int first, int end, int number) {
    FrictionWorkspace& worker = workers_[static_cast<size_t>(number)];
    for (int i = first; i < end; ++i) update_unit(step, static_cast<size_t>(i), worker, divided);
  });
  // Deferred forces are added in the order of the units, as if one thread had worked on all of
  // them.
  for (const FrictionWorkspace& worker : workers_) {
    for (const auto& [vertex, force] : worker.deferred) {
      VertexDrag& drag = drags_[static_cast<size_t>(vertex)];
      drag[0] += force[0], drag[1] += force[1];
    }
  }
  double power = 0, energy = 0;
  for (const double of_body : body_powers_) power += of_body;
  for (const UnitResult& unit : units_) {
    power += unit.power;
    energy += unit.energy;
  }
  for (FrictionWorkspace& worker : workers_) {
    memory.keep(worker.springs, energy);
    energy = 0;
  }
  everywhere_ = dt > 0 ? std::max(everywhere_ - 1, 0) : kBothVectors;
  return dt / 2 * power;
}

// Sums the contacts of each pair of bodies. The ratio of critical damping refers to the two bodies
// as rigid ones, with the stiffness of all contacts between them.
void OutlineFriction::find_pairs(const EdgeFaceBlocks& blocks, const Kinematics& now) {
  const OutlineSurfaces& o = outlines_;
  for (PairSum& pair : pairs_) pair = {};
  blocks.each_group([&](const EdgeFaceUnit&, const EdgeFaceGroup& group, size_t i) {
    const SpringContact& contact = contacts_[i];
    if (!(contact.normal > 0)) return;
    PairSum& pair = pairs_[static_cast<size_t>(blocks.laws()[group.law].pair)];
    const BodyIndex own = o.body[contact.edge];
    std::tie(pair.a, pair.b) = std::minmax(own, contact.other);
    const Vec2 start = o.point(contact.edge);
    const Vec2 place =
        start + contact.place / contact.normal * (o.point(o.next[contact.edge]) - start);
    const Vec2 force =
        (own == pair.a ? contact.pressed : -contact.pressed) * Vec2(contact.nx, contact.ny);
    pair.force += force;
    pair.moment += cross(place, force);
    pair.places += contact.pressed * place;
    pair.sizes += contact.pressed;
    pair.resistance += contact.resistance;
    pair.stiffness += contact.stiffness;
  });
  for (PairSum& pair : pairs_) {
    const double size = pair.force.norm();
    if (pair.a < 0 || !(size > 0)) continue;
    const PairLaw& law = table_.between(pair.a, pair.b);
    const Vec2 normal = pair.force / size;
    // The point is the mean of the points of the forces, moved to the line of action.
    const Vec2 middle = pair.places / pair.sizes;
    const Vec2 point =
        middle + (pair.moment - cross(middle, pair.force)) / size * Vec2(normal.y(), -normal.x());
    const auto time = [&](double value, double k, const Vec2& along) {
      const double mobility = surfaces_.mobility(pair.a, now, point, along) +
                              surfaces_.mobility(pair.b, now, point, along);
      return dashpot_time(value, law.damping.are_times, k, mobility);
    };
    pair.normal_time = time(law.damping.normal, pair.resistance, normal);
    pair.tangential_time =
        time(law.damping.tangential, pair.stiffness, Vec2(-normal.y(), normal.x()));
  }
}

// Calls f(unit, group, law, contact) for the contacts with dashpots, in their order.
template <class F>
void OutlineFriction::each_dashpot(const EdgeFaceBlocks& blocks, const F& f) {
  blocks.each_group([&](const EdgeFaceUnit& unit, const EdgeFaceGroup& group, size_t i) {
    const PairLaw& law = *blocks.laws()[static_cast<size_t>(group.law)].law;
    if (law.damped() && contacts_[i].resistance > 0) f(unit, group, law, contacts_[i]);
  });
}

void OutlineFriction::add_dashpots(const EdgeFaceBlocks& blocks, const Kinematics& now,
                                   Dashpots& dashpots) {
  find_pairs(blocks, now);
  each_dashpot(blocks, [&](const EdgeFaceUnit& unit, const EdgeFaceGroup& group, const PairLaw& law,
                           const SpringContact& contact) {
    const PairSum& pair = pairs_[static_cast<size_t>(blocks.laws()[group.law].pair)];
    dashpots.add({outlines_.body[contact.edge],
                  contact.other,
                  Vec2(contact.nx, contact.ny),
                  {Dashpot::Normal::of(pair.normal_time * contact.resistance, contact.pressed,
                                       contact.resistance, contact.deepest)},
                  pair.tangential_time * contact.stiffness,
                  contact.friction,
                  FrictionLimit<double>::of(law)});
    const OutlineSurfaces& o = outlines_;
    each_coordinate(blocks, unit, group, contact,
                    [&](std::int32_t vertex, const Vec2& normal, const Vec2& tangential) {
                      const OutlineSurfaces::Body& body = o.bodies[o.body[vertex]];
                      if (body.is_rigid()) {
                        dashpots.add_point(body.rigid, o.point(vertex) - Vec2(body.cx, body.cy),
                                           normal, tangential);
                      } else {
                        dashpots.add_node(o.node[vertex], normal, tangential);
                      }
                    });
  });
}

// Calls add(vertex, normal, tangential) for what the vertices contribute to the rates along the
// normal and the tangent.
template <class Add>
void OutlineFriction::each_coordinate(const EdgeFaceBlocks& blocks, const EdgeFaceUnit& unit,
                                      const EdgeFaceGroup& group, const SpringContact& contact,
                                      const Add& add) const {
  const Vec2 n(contact.nx, contact.ny), t(-contact.ny, contact.nx);
  blocks.each_contact(unit, group, [&](size_t i, size_t lane) {
    const EdgeFaceBlock& block = blocks.blocks()[i];
    const EdgeFaceTouch& touch = blocks.touches()[i];
    const OutlineSlip& slip = slips_[i];
    const double per_normal = 1 / contact.normal;
    const double at_p = slip.at_p[lane] * per_normal, at_q = slip.at_q[lane] * per_normal;
    const double at_b = slip.at_b[lane] * per_normal, at_a = at_b - (at_p + at_q);
    const Vec2 face(touch.tx[lane], touch.ty[lane]), across(face.y(), -face.x());
    const auto turned = [&](const Vec2& e) -> Vec2 {
      return slip.turn[lane] * per_normal * e.dot(face) * across;
    };
    add(block.p[lane], at_p * n, at_p * t);
    add(block.q[lane], at_q * n, at_q * t);
    add(block.a[lane], at_a * n + turned(n), at_a * t + turned(t));
    add(block.b[lane], -(at_b * n + turned(n)), -(at_b * t + turned(t)));
  });
}

void OutlineFriction::add_tangent(const EdgeFaceBlocks& blocks, size_t first_node,
                                  Tangent& tangent) const {
  if (tangent.friction_sticks()) {
    add_sticking_tangent(blocks, first_node, tangent);
  } else {
    add_friction_tangent({outlines_, blocks, contacts_, velocities_, tried_dt_}, first_node,
                         tangent);
  }
}

void OutlineFriction::add_sticking_tangent(const EdgeFaceBlocks& blocks, size_t first_node,
                                           Tangent& tangent) const {
  CoordinateSum along;
  blocks.each_group([&](const EdgeFaceUnit& unit, const EdgeFaceGroup& group, size_t i) {
    const SpringContact& contact = contacts_[i];
    const PairLaw& law = *blocks.laws()[static_cast<size_t>(group.law)].law;
    if (!law.rough() || !(contact.normal > 0)) return;
    along.clear();
    each_coordinate(blocks, unit, group, contact,
                    [&](std::int32_t vertex, const Vec2&, const Vec2& tangential) {
                      along.add(coordinates_of(outlines_, first_node, vertex), tangential);
                    });
    along.add_square(contact.followed, tangent);
  });
}

void OutlineFriction::keep_pushes(const EdgeFaceBlocks& blocks, const Dashpots& dashpots,
                                  size_t& next, FrictionMemory& memory) {
  auto spring = memory.springs_of(outline_kernel).begin();
  each_dashpot(blocks, [&](const EdgeFaceUnit&, const EdgeFaceGroup& group, const PairLaw& law,
                           SpringContact& contact) {
    contact.push = dashpots.normal_force(next);
    contact.drag = dashpots.tangential_force(next);
    ++next;
    if (!law.rough()) return;
    while (is_before(spring->key, key_of(group))) ++spring;
    spring->push = contact.push;
  });
}

void OutlineFriction::add_to(const EdgeFaceBlocks& blocks,
                             std::span<EdgeFaceContact> contacts) const {
  if (contacts_.size() < blocks.group_count() || slips_.size() < blocks.blocks().size()) return;
  auto next = contacts.begin();
  blocks.each_group([&](const EdgeFaceUnit& unit, const EdgeFaceGroup& group, size_t g) {
    const SpringContact& contact = contacts_[g];
    const Vec2 n(contact.nx, contact.ny), t(-contact.ny, contact.nx);
    blocks.each_contact(unit, group, [&](size_t i, size_t lane) {
      EdgeFaceContact& result = *next++;
      if (!(contact.normal > 0)) return;
      const double fraction = (slips_[i].at_p[lane] + slips_[i].at_q[lane]) / contact.normal;
      result.drag = fraction * (contact.friction + contact.drag) * t;
      result.push = fraction * contact.push * n;
    });
  });
}

}  // namespace apothem
