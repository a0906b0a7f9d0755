#include "apothem/contact/polygon_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apothem/contact/stiffness.hpp"

namespace apothem {

namespace {

// Of a touching pair, ns.
constexpr double kLoadTime = 40, kGatherTime = 20;

// What friction and damping need.
PairIntegrals::Split split(const ContactLaw& law, const PairTable& table) {
  if (!table.rough() && !table.damped()) return PairIntegrals::Split::none;
  return law.friction_law == FrictionLaw::per_edge ? PairIntegrals::Split::all
                                                   : PairIntegrals::Split::not_convex;
}

}  // namespace

PolygonKernel::PolygonKernel(const Surfaces& surfaces, const ContactLaw& law,
                             const PairTable& table, double thickness, int threads)
    : surfaces_(surfaces),
      table_(table),
      thickness_(thickness),
      pairs_(surfaces, threads, split(law, table)),
      onset_(surfaces, table, thickness),
      threads_(threads),
      found_(static_cast<size_t>(threads_.count())),
      body_stiffness_(static_cast<size_t>(surfaces.rigid_count())),
      rate_bounds_(body_stiffness_.size()) {
  if (table.rough() || table.damped()) {
    tangential_.emplace(surfaces, law, table, thickness, threads);
  }
}

void PolygonKernel::evaluate(std::vector<Contact>& contacts) {
  for (Found& found : found_) found.contacts.clear();
  // The first thread has the first pairs.
  pairs_.evaluate([&](const PairInTouch& pair, int worker) {
    (worker == 0 ? contacts : found_[static_cast<size_t>(worker)].contacts)
        .push_back(contact_of(pair));
  });
  for (const Found& found : found_) {
    contacts.insert(contacts.end(), found.contacts.begin(), found.contacts.end());
  }
}

Contact PolygonKernel::contact_of(const PairInTouch& pair) const {
  Contact contact = pairs_.contact(KernelKind::polygon_kernel, pair, stiffness(pair.a, pair.b));
  if (pairs_.too_deep(pair)) contact.share = 1;
  return contact;
}

double PolygonKernel::penetration(const Contact& c, double floor) {
  const PlacedPotential view_a = surfaces_.shapes().view(c.a);
  const PlacedPotential view_b = surfaces_.shapes().view(c.b);
  const Vec2 between = surfaces_.between(c.a, c.b);
  contact_patches(view_a, view_b, between, patch_workspace_, runs_, patches_);
  deepest_.assign(patches_.size(), floor);
  find_penetrations(view_a, view_b, between, runs_, penetration_workspace_, deepest_);
  return deepest_.empty() ? floor : *std::max_element(deepest_.begin(), deepest_.end());
}

ContactFault PolygonKernel::fault(const Contact& c) const {
  const auto found = std::ranges::find_if(
      pairs_.touching(), [&](const PairInTouch& p) { return p.a == c.a && p.b == c.b; });
  const PairIntegral& pair = *found->integral;
  return {pair.largest_phi > kDeepestPhi ? ContactFault::Kind::singular_area
                                         : ContactFault::Kind::centre,
          c.a, c.b, surfaces_.reference(c.a) + loading_point(pair)};
}

double PolygonKernel::slide(const Kinematics& now, double dt, FrictionMemory& memory) {
  if (!tangential_) return 0;
  pair_stiffness_.resize(pairs_.touching().size());
  tangential_->slide(pairs_, now, dt, memory, pair_stiffness_);
  return 0;  // its springs are accounted
}

// Each thread adds what acts on a range of bodies, for every body in the order of its pairs.
void PolygonKernel::add_forces(const ForceViews& forces) {
  find_loads();
  const int pairs = static_cast<int>(loads_.size());
  const int bodies = surfaces_.rigid_count();
  threads_.chunks(bodies, kGatherTime * pairs / std::max(bodies, 1),
                  [&](int first, int end, int) { add_loads(forces, first, end); });
  add_rates(forces.lambda, forces.lambda_limit);
}

void PolygonKernel::find_loads() {
  const std::vector<PairInTouch>& touching = pairs_.touching();
  loads_.resize(touching.size());
  if (!tangential_) pair_stiffness_.resize(touching.size());
  for (Found& found : found_) found.largest_force = {};
  const TouchingPairs all{
      surfaces_, table_, thickness_, touching,
      tangential_ ? std::span(tangential_->forces()) : std::span<const TangentialForce>()};
  threads_.chunks(static_cast<int>(touching.size()), kLoadTime,
                  [&](int first, int end, int worker) {
                    found_[static_cast<size_t>(worker)].largest_force =
                        apothem::find_loads(all, first, end, loads_, pair_stiffness_);
                  });
  largest_force_ = {};
  for (const Found& found : found_) {
    if (found.largest_force.value > largest_force_.value) largest_force_ = found.largest_force;
  }
}

void PolygonKernel::add_loads(const ForceViews& forces, RigidIndex first, RigidIndex end) {
  const auto here = [&](RigidIndex body) { return body >= first && body < end; };
  const auto add = [&](RigidIndex body, double fx, double fy, double moment) {
    double* const f = &forces.rigid[3 * static_cast<size_t>(body)];
    f[0] += fx;
    f[1] += fy;
    f[2] += moment;
  };
  for (RigidIndex i = first; i < end; ++i) body_stiffness_[static_cast<size_t>(i)] = {};
  for (size_t i = 0; i < loads_.size(); ++i) {
    const PairLoad& load = loads_[i];
    const PairForce& f = load.force;
    if (here(load.a)) {
      add(load.a, f.x, f.y, f.a);
      body_stiffness_[static_cast<size_t>(load.a)].add(pair_stiffness_[i].a, 1);
    }
    if (here(load.b)) {
      add(load.b, -f.x, -f.y, f.b);
      body_stiffness_[static_cast<size_t>(load.b)].add(pair_stiffness_[i].b, 1);
    }
  }
  for (RigidIndex i = first; i < end; ++i) {
    rate_bounds_[static_cast<size_t>(i)] =
        rate_bound_of(body_stiffness_[static_cast<size_t>(i)], surfaces_.rigid(i).inverse_mass);
  }
}

// The largest one is exact above the limit, so that it does not shorten the step in vain.
void PolygonKernel::add_rates(std::span<double> rates, double limit) {
  double largest = 0;
  for (const PairLoad& load : loads_) {
    for (const RigidIndex body : {load.a, load.b}) {
      const auto i = static_cast<size_t>(body);
      double rate = std::exchange(rate_bounds_[i], 0);
      if (rate > limit && rate > largest) {
        rate = rate_of(body_stiffness_[i], surfaces_.rigid(body).inverse_mass);
        largest = std::max(largest, rate);
      }
      rates[i] += rate;
    }
  }
}

void PolygonKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (const PairInTouch& pair : pairs_.touching()) {
    const double size = stiffness(pair.a, pair.b) * pair.integral->force.norm();
    of_bodies[static_cast<size_t>(pair.a)] += size;
    of_bodies[static_cast<size_t>(pair.b)] += size;
  }
}

void PolygonKernel::add_records(const FrictionMemory& memory,
                                std::vector<ContactRecord>& records) const {
  PatchTangential::Cursor cursor;
  PatchWorkspace workspace;
  PenetrationWorkspace penetration_workspace;
  std::vector<BoundaryRun> runs;
  std::vector<PairIntegral> patches;
  std::vector<double> deepest;
  for (const PairInTouch& pair : pairs_.touching()) {
    const RigidIndex a = pair.a, b = pair.b;
    const std::span<const Spring> springs = memory.springs_of(polygon_kernel, a, b);
    const PlacedPotential view_a = surfaces_.shapes().view(a);
    const PlacedPotential view_b = surfaces_.shapes().view(b);
    const Vec2 between = surfaces_.between(a, b);
    contact_patches(view_a, view_b, between, workspace, runs, patches);
    deepest.assign(patches.size(), 0);
    find_penetrations(view_a, view_b, between, runs, penetration_workspace, deepest);
    const size_t first = records.size();
    for (size_t i = 0; i < patches.size(); ++i) {
      const PairIntegral& patch = patches[i];
      records.push_back({a, b, surfaces_.reference(a) + loading_point(patch),
                         stiffness(a, b) * patch.force, Vec2::Zero(), deepest[i],
                         patch.largest_phi});
    }
    if (tangential_) tangential_->add_to(std::span(records).subspan(first), runs, springs, cursor);
  }
}

}  // namespace apothem
