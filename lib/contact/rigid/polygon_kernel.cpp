#include "lib/contact/rigid/polygon_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {

namespace {

// Time for a touching pair, ns.
constexpr double kLoadTime = 100;

// The pairs that friction and damping need to be split.
PairIntegrals::Split split(const ContactLaw& law, const PairTable& table) {
  if (!table.rough() && !table.damped()) return PairIntegrals::Split::none;
  return law.friction_law == FrictionLaw::per_edge ? PairIntegrals::Split::all
                                                   : PairIntegrals::Split::not_convex;
}

}  // namespace

PolygonKernel::PolygonKernel(const Surfaces& surfaces, const ContactLaw& law,
                             const PairTable& table, FrictionMemory& memory, double thickness,
                             int threads)
    : surfaces_(surfaces),
      table_(table),
      thickness_(thickness),
      pairs_(surfaces, threads, split(law, table)),
      events_(surfaces, table, thickness, threads),
      threads_(threads),
      found_(static_cast<size_t>(threads_.count())),
      loads_(surfaces, threads) {
  if (table.rough()) {
    tangential_.emplace(surfaces, pairs_, law, table, memory, thickness, threads);
  }
}

void PolygonKernel::evaluate() {
  for (Found& found : found_) found.summary = {.inradius_ratio = 0};
  pairs_.evaluate([&](const PairInTouch& pair, const PairIntegral& integral, int worker) {
    found_[static_cast<size_t>(worker)].summary.include(
        pairs_.deepest(pair, integral),
        std::min(surfaces_.inradius(pair.a), surfaces_.inradius(pair.b)),
        pairs_.too_deep(pair, integral) ? 1 : integral.largest_phi);
  });
  summary_ = {.inradius_ratio = 0};
  for (const Found& found : found_) summary_.include(found.summary);
}

void PolygonKernel::visit_contacts(double least, const ContactVisitor& visit) const {
  for (const PairInTouch& pair : pairs_.touching()) {
    if (!(pairs_.deepest(pair, pairs_.integral(pair)) <= least)) visit(contact_of(pair));
  }
}

Contact PolygonKernel::contact_of(const PairInTouch& pair) const {
  Contact contact = pairs_.contact(KernelKind::polygon_kernel, pair, stiffness(pair.a, pair.b));
  if (pairs_.too_deep(pair, pairs_.integral(pair))) contact.relative_depth = 1;
  return contact;
}

double PolygonKernel::penetration(const Contact& c, double floor) {
  const PlacedPotential view_a = surfaces_.shapes().view(c.a);
  const PlacedPotential view_b = surfaces_.shapes().view(c.b);
  const Vec2 between = surfaces_.between(c.a, c.b);
  contact_patches(view_a, view_b, between, patch_workspace_, segments_, patches_);
  deepest_.assign(patches_.size(), floor);
  find_penetrations(view_a, view_b, between, segments_, penetration_workspace_, deepest_);
  return deepest_.empty() ? floor : *std::max_element(deepest_.begin(), deepest_.end());
}

ContactFault PolygonKernel::fault(const Contact& c) const {
  const auto found = std::ranges::find_if(
      pairs_.touching(), [&](const PairInTouch& p) { return p.a == c.a && p.b == c.b; });
  const PairIntegral& pair = pairs_.integral(*found);
  return {pair.largest_phi > kDeepestPhi ? ContactFault::Kind::singular_area
                                         : ContactFault::Kind::centre,
          c.a, c.b, surfaces_.reference(c.a) + loading_point(pair)};
}

void PolygonKernel::set_pairs(std::span<const BoxPair> pairs) {
  pairs_.set_pairs(pairs);
  loads_.set_pairs(pairs);
}

double PolygonKernel::update_friction(const Kinematics& now, double dt,
                                      FrictionMemory& /*memory*/) {
  if (!tangential_) return 0;
  tangential_->begin_step(now, dt);
  sum_loads([&](int first, int end, int worker) {
    tangential_->step(first, end, worker,
                      [&](std::span<const PairLoad> loads) { add_block(loads, worker); });
  });
  tangential_->end_step();
  return 0;  // the losses of the springs have been booked
}

void PolygonKernel::add_forces(const ForceViews& forces) {
  if (!tangential_) {
    sum_loads([&](int first, int end, int worker) { find_normal_loads(first, end, worker); });
  }
  loads_.add_to(forces, pairs_.touching());
}

// Calls part(first, end, worker) for the blocks of touching pairs of each thread.
template <class Part>
void PolygonKernel::sum_loads(const Part& part) {
  const std::vector<PairInTouch>& touching = pairs_.touching();
  const int count = static_cast<int>(touching.size());
  for (Found& found : found_) found.largest_force = {};
  const int blocks = (count + PatchTangential::kBlock - 1) / PatchTangential::kBlock;
  threads_.chunks(blocks, PatchTangential::kBlock * kLoadTime,
                  [&](int first_block, int end_block, int worker) {
                    if (first_block == end_block && count > 0) return;
                    const int first = first_block * PatchTangential::kBlock;
                    const int end = std::min(end_block * PatchTangential::kBlock, count);
                    loads_.begin(worker, first > 0 ? touching[static_cast<size_t>(first)].a : -1);
                    part(first, end, worker);
                  });
  loads_.end();
  largest_force_ = {};
  for (const Found& found : found_) {
    if (found.largest_force.value > largest_force_.value) largest_force_ = found.largest_force;
  }
}

// Finds the loads of pairs in scenes without friction.
void PolygonKernel::find_normal_loads(int first, int end, int worker) {
  const PairScene scene{surfaces_, thickness_};
  Found& found = found_[static_cast<size_t>(worker)];
  for (int block = first; block < end; block += PatchTangential::kBlock) {
    found.loads.resize(static_cast<size_t>(std::min(PatchTangential::kBlock, end - block)));
    for (size_t k = 0; k < found.loads.size(); ++k) {
      const PairInTouch& pair = pairs_.touching()[static_cast<size_t>(block) + k];
      found.batch.add(scene, false,
                      {.a = pair.a,
                       .b = pair.b,
                       .integral = &pairs_.integral(pair),
                       .law = &table_.between(pair.a, pair.b),
                       .load = &found.loads[k]});
    }
    found.batch.flush(scene);
    add_block(found.loads, worker);
  }
}

// Calls f(pair, index of the patch, integrals) for all patches of damped pairs.
template <class F>
void PolygonKernel::each_patch(const F& f) const {
  for (const PairInTouch& pair : pairs_.touching()) {
    if (!table_.between(pair.a, pair.b).damped()) continue;
    if (pair.list_index < 0) {
      f(pair, size_t{0}, pairs_.integral(pair));
      continue;
    }
    const std::span<const PairIntegral> patches = pairs_.patches(pair);
    for (size_t i = 0; i < patches.size(); ++i) f(pair, i, patches[i]);
  }
}

void PolygonKernel::add_dashpots(const Kinematics& /*now*/, Dashpots& dashpots) {
  const PairScene scene{surfaces_, thickness_};
  damped_.clear();
  each_patch([&](const PairInTouch& pair, size_t i, const PairIntegral& patch) {
    const PairLaw& law = table_.between(pair.a, pair.b);
    const double spring = tangential_ && law.rough() ? tangential_->spring_in(pair, i) : 0;
    damped_.push_back(add_dashpot(scene, {pair.a, pair.b}, patch, law, spring, dashpots));
  });
}

void PolygonKernel::keep_pushes(const Dashpots& dashpots, size_t& next,
                                FrictionMemory& /*memory*/) {
  auto damped = damped_.begin();
  pushes_.clear(), drags_.clear();
  each_patch([&](const PairInTouch& pair, size_t i, const PairIntegral&) {
    const bool known = *damped++ != 0;
    pushes_.push_back(known ? dashpots.normal_force(next) : 0);
    drags_.push_back(known ? dashpots.tangential_force(next) : 0);
    if (tangential_) tangential_->keep_push(pair, i, pushes_.back());
    next += known;
  });
}

void PolygonKernel::add_block(std::span<const PairLoad> loads, int worker) {
  PairPeak& largest = found_[static_cast<size_t>(worker)].largest_force;
  for (const PairLoad& load : loads) {
    if (load.normal > largest.value) largest = {load.normal, load.a, load.b};
    loads_.add(worker, load.a, load.on_a);
    loads_.add(worker, load.b, load.on_b);
  }
}

void PolygonKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (const PairInTouch& pair : pairs_.touching()) {
    const double size = stiffness(pair.a, pair.b) * pairs_.integral(pair).force.norm();
    of_bodies[static_cast<size_t>(pair.a)] += size;
    of_bodies[static_cast<size_t>(pair.b)] += size;
  }
}

bool PolygonKernel::add_tangent(size_t /*first_node*/, Tangent& tangent) const {
  PairDerivative derivative;
  for (const PairInTouch& pair : pairs_.touching()) {
    const PairLaw& law = table_.between(pair.a, pair.b);
    const PlacedPotential view_a = surfaces_.shapes().view(pair.a);
    const PlacedPotential view_b = surfaces_.shapes().view(pair.b);
    const Vec2 between = surfaces_.between(pair.a, pair.b);
    std::span<const MovingIntegral> patches =
        derivative.find(view_a, view_b, between, pairs_.segments(pair));
    // Where round-off finds other segments, the whole pair has the friction of its first patch.
    if (patches.empty()) patches = derivative.find(view_a, view_b, between, {});
    for (size_t i = 0; i < patches.size(); ++i) {
      TriedFriction friction;
      const bool rubs = tangential_ && law.rough();
      if (rubs && !tangential_->tried(pair, i, friction)) return false;
      friction.sticks = tangent.friction_sticks();
      add_pair_tangent(pair.a, pair.b,
                       patch_force(surfaces_, thickness_, law, pair.a, pair.b, patches[i],
                                   rubs ? &friction : nullptr),
                       tangent);
    }
  }
  return true;
}

void PolygonKernel::add_records(std::vector<ContactRecord>& records) const {
  PatchWorkspace workspace;
  PenetrationWorkspace penetration_workspace;
  std::vector<BoundarySegment> segments;
  std::vector<PairIntegral> patches;
  std::vector<double> deepest;
  size_t dashpot = 0;
  for (const PairInTouch& pair : pairs_.touching()) {
    const RigidIndex a = pair.a, b = pair.b;
    const PlacedPotential view_a = surfaces_.shapes().view(a);
    const PlacedPotential view_b = surfaces_.shapes().view(b);
    const Vec2 between = surfaces_.between(a, b);
    contact_patches(view_a, view_b, between, workspace, segments, patches);
    deepest.assign(patches.size(), 0);
    find_penetrations(view_a, view_b, between, segments, penetration_workspace, deepest);
    const size_t first = records.size();
    for (size_t i = 0; i < patches.size(); ++i) {
      const PairIntegral& patch = patches[i];
      records.push_back({a, b, surfaces_.reference(a) + loading_point(patch),
                         stiffness(a, b) * patch.force, Vec2::Zero(), deepest[i],
                         patch.largest_phi});
    }
    const std::span<ContactRecord> of_pair = std::span(records).subspan(first);
    if (tangential_) tangential_->add_to(of_pair, segments, pair);
    if (!table_.between(a, b).damped()) continue;
    for (ContactRecord& record : of_pair) {
      if (dashpot == pushes_.size()) break;
      const double size = record.normal.norm();
      const Vec2 normal = size > 0 ? Vec2(record.normal / size) : Vec2(Vec2::Zero());
      record.damping += pushes_[dashpot] * normal;
      record.tangential += drags_[dashpot] * Vec2(-normal.y(), normal.x());
      ++dashpot;
    }
  }
}

}  // namespace apothem
