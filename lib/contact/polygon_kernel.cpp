#include "apothem/contact/polygon_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "apothem/contact/stiffness.hpp"

namespace apothem {

namespace {

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
      body_stiffness_(static_cast<size_t>(surfaces.rigid_count())) {
  if (table.rough() || table.damped()) {
    tangential_.emplace(surfaces, law, table, thickness);
  }
}

void PolygonKernel::evaluate(std::vector<Contact>& contacts) {
  pairs_.evaluate();
  touching_.clear();
  contact_stiffness_.clear();
  stiffness_.clear();
  for (size_t p = 0; p < pairs_.pairs().size(); ++p) {
    const PairIntegral& pair = pairs_[p];
    if (!pair.touching()) continue;
    const auto [a, b] = pairs_.pairs()[p];
    stiffness_.push_back(stiffness(a, b));
    contacts.push_back(pairs_.contact(KernelKind::polygon_kernel, p, stiffness_.back()));
    touching_.push_back(static_cast<int>(p));
    contact_stiffness_.push_back(contacts.back().stiffness);
    if (pairs_.too_deep(p)) contacts.back().share = 1;
  }
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
  const auto touching = std::find_if(touching_.begin(), touching_.end(), [&](int p) {
    return pairs_.pairs()[static_cast<size_t>(p)] == BoxPair{c.a, c.b};
  });
  const PairIntegral& pair = pairs_[static_cast<size_t>(*touching)];
  return {pair.largest_phi > kDeepestPhi ? ContactFault::Kind::singular_area
                                         : ContactFault::Kind::centre,
          c.a, c.b, surfaces_.reference(c.a) + loading_point(pair)};
}

double PolygonKernel::slide(const Kinematics& now, double dt, FrictionMemory& memory) {
  if (tangential_) tangential_->slide(pairs_, touching_, now, dt, memory);
  return 0;  // its springs are accounted
}

void PolygonKernel::add_forces(const ForceViews& forces) {
  add_normal(forces);
  if (tangential_) add_tangential(forces);
}

void PolygonKernel::add_normal(const ForceViews& forces) {
  largest_force_ = {};
  auto spring =
      tangential_ ? tangential_->forces().begin() : std::vector<TangentialForce>::const_iterator{};
  for (size_t i = 0; i < touching_.size(); ++i) {
    const auto p = static_cast<size_t>(touching_[i]);
    const PairIntegral& pair = pairs_[p];
    const auto [a, b] = pairs_.pairs()[p];
    double* fa = &forces.rigid[3 * static_cast<size_t>(a)];
    double* fb = &forces.rigid[3 * static_cast<size_t>(b)];
    const double k = stiffness_[i];
    const double fx = k * pair.force.x();
    const double fy = k * pair.force.y();
    fa[0] += fx;
    fa[1] += fy;
    fa[2] += k * pair.moment_a;
    fb[0] -= fx;
    fb[1] -= fy;
    fb[2] += k * pair.moment_b;
    const double force = std::sqrt(fx * fx + fy * fy);
    const TangentialForce* springs = nullptr;
    if (tangential_ && spring != tangential_->forces().end() && spring->a == a && spring->b == b) {
      springs = &*spring++;
    }
    if (force > largest_force_.value) largest_force_ = {force, a, b};
    add_stiffness(pair, a, b, contact_stiffness_[i], springs);
  }
  find_rates(forces.lambda, forces.lambda_limit);
}

// The displacements of both bodies add: K (x_a - x_b)^2 <= 2 K (x_a^2 + x_b^2).
void PolygonKernel::add_stiffness(const PairIntegral& pair, RigidIndex a, RigidIndex b,
                                  double stiffness, const TangentialForce* springs) {
  const double size = pair.force.norm();
  // Of the pushes of the edges: 1 if all have one direction.
  const double aligned = std::min(size / pair.weight, 1.);
  const Vec2 normal = size > 0 ? Vec2(pair.force / size) : Vec2(1, 0);
  const Vec2 tangent(-normal.y(), normal.x());
  const double across = (1 - aligned * aligned) * stiffness;
  const double times = surfaces_.responsive(a) && surfaces_.responsive(b) ? 2 : 1;
  // Where the resultant acts says little: boundary that is hardly inside is as stiff as any other.
  const Vec2 middle = pair.middle * tangent;
  const auto add = [&](RigidIndex body, const Vec2& point, const Vec2& centre,
                       const BodyStiffness* tangential) {
    BodyStiffness sum;
    sum.add(stiffness, normal, cross(point, normal));
    sum.add(across, tangent, cross(centre, tangent));
    sum.add_rotation(stiffness * pair.breadth * pair.breadth / 12);
    if (tangential) sum.add(*tangential, 1);
    body_stiffness_[static_cast<size_t>(body)].add(sum, times);
  };
  const Vec2 between = surfaces_.between(a, b);
  add(a, middle, pair.centre, springs ? &springs->stiffness_a : nullptr);
  add(b, middle + between, pair.centre + between, springs ? &springs->stiffness_b : nullptr);
}

// The largest one is exact above the limit, so that it does not shorten the step in vain. Takes the
// stiffness of the bodies that touch, and leaves none for the next step.
void PolygonKernel::find_rates(std::span<double> rates, double limit) {
  double largest = 0;
  for (const int p : touching_) {
    const BoxPair pair = pairs_.pairs()[static_cast<size_t>(p)];
    for (const RigidIndex body : {pair.first, pair.second}) {
      const std::array<double, 3>& w = surfaces_.rigid(body).inverse_mass;
      BodyStiffness& stiffness = body_stiffness_[static_cast<size_t>(body)];
      double rate = stiffness.rate_bound(w);
      if (rate > limit && rate > largest) {
        rate = stiffness.rate(w);
        largest = std::max(largest, rate);
      }
      rates[static_cast<size_t>(body)] += rate;
      stiffness = {};
    }
  }
}

void PolygonKernel::add_tangential(const ForceViews& forces) const {
  for (const TangentialForce& t : tangential_->forces()) t.all.add_to(t.a, t.b, forces.rigid);
}

void PolygonKernel::add_force_sizes(std::span<double> of_bodies) const {
  for (size_t i = 0; i < touching_.size(); ++i) {
    const auto p = static_cast<size_t>(touching_[i]);
    const double size = stiffness_[i] * pairs_[p].force.norm();
    of_bodies[static_cast<size_t>(pairs_.pairs()[p].first)] += size;
    of_bodies[static_cast<size_t>(pairs_.pairs()[p].second)] += size;
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
  for (const int touching : touching_) {
    const auto p = static_cast<size_t>(touching);
    const auto [a, b] = pairs_.pairs()[p];
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
