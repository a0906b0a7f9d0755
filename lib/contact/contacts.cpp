#include "lib/contact/contacts.hpp"

#include <algorithm>
#include <cmath>

#include "lib/contact/element/element_kernel.hpp"
#include "lib/contact/mesh/outline_kernel.hpp"
#include "lib/contact/rigid/polygon_kernel.hpp"

namespace apothem {
namespace {

constexpr double kRoundOff = 1 - 1e-12;

// Returns a depth, m, below which no contact can exceed `floors`. `shortest` is the smallest of the
// lengths that relative penetrations refer to, m.
double least_of(const Penetrations& floors, double shortest) {
  return std::min(floors.largest.value, kRoundOff * floors.relative.value * shortest);
}

}  // namespace

Contacts::Contacts(const ContactLaw& law, double thickness, Surfaces surfaces, PairTable table,
                   int threads)
    : threads_(threads),
      surfaces_(std::move(surfaces)),
      table_(std::move(table)),
      friction_law_(law.friction_law),
      tangential_(table_.rough() || table_.damped()),
      dashpots_(surfaces_.rigid_count()) {
  std::array<bool, kernel_kinds> needed{};
  needed[polygon_kernel] = surfaces_.rigid_count() > 0;
  needed[element_kernel] = surfaces_.elements().size() > 0;
  needed[outline_kernel] = surfaces_.size() > surfaces_.shapes().size();
  if (needed[polygon_kernel]) {
    kernels_[polygon_kernel] =
        std::make_unique<PolygonKernel>(surfaces_, law, table_, memory_, thickness, threads);
  }
  if (needed[element_kernel]) {
    kernels_[element_kernel] =
        std::make_unique<ElementKernel>(surfaces_, law, table_, thickness, threads);
  }
  if (needed[outline_kernel]) {
    kernels_[outline_kernel] =
        std::make_unique<OutlineKernel>(surfaces_, thickness, table_, threads);
  }
}

bool Contacts::search_if_stale() {
  if (!search_.stale(surfaces_, threads_)) return false;
  search_.search(surfaces_, threads_);
  ++searches_;
  hand_out_pairs();
  return true;
}

// Hands the pairs of the last search to the kernels that serve them.
void Contacts::hand_out_pairs() {
  std::array<std::vector<BoxPair>, kernel_kinds> pairs_of;
  disturbs_rest_ = false;
  for (const BoxPair& pair : search_.pairs()) {
    disturbs_rest_ = disturbs_rest_ || is_between_rest_and_motion(pair);
    pairs_of[kernel_of(surfaces_.kind(pair.first), surfaces_.kind(pair.second))].push_back(pair);
  }
  for (SurfaceIndex i = 0; table_.self() && i < surfaces_.size(); ++i) {
    if (surfaces_.kind(i) == SurfaceKind::outline && surfaces_.is_present(i))
      pairs_of[outline_kernel].push_back({i, i});
  }
  if (surfaces_.has_outlines()) surfaces_.outlines().activate(pairs_of[outline_kernel]);
  for (size_t k = 0; k < kernels_.size(); ++k) {
    if (kernels_[k]) kernels_[k]->set_pairs(pairs_of[k]);
  }
}

bool Contacts::is_between_rest_and_motion(const BoxPair& pair) const {
  const auto between = [&](SurfaceIndex a, SurfaceIndex b) {
    return surfaces_.is_resting(a) && surfaces_.moves(b);
  };
  return between(pair.first, pair.second) || between(pair.second, pair.first);
}

void Contacts::let_bodies_rest(const ContactLaw& law, double thickness) {
  resting_ = std::make_unique<RestingContacts>(surfaces_, law, table_, thickness);
}

void Contacts::set_resting(const std::vector<std::uint8_t>& resting, const Kinematics& now) {
  surfaces_.set_resting(resting);
  search_.choose(surfaces_, threads_);
  hand_out_pairs();
  resting_->exchange(memory_);
  resting_->evaluate(search_.near(), now);
}

void Contacts::evaluate() {
  each([](Kernel& kernel) { kernel.evaluate(); });
}

void Contacts::visit(double least, const ContactVisitor& show) const {
  each([&](const Kernel& kernel) { kernel.visit_contacts(least, show); });
}

std::vector<Contact> Contacts::contacts() const {
  std::vector<Contact> list;
  visit(-HUGE_VAL, [&](const Contact& contact) { list.push_back(contact); });
  return list;
}

int Contacts::count() const {
  return sum<int>([](const Kernel& kernel) { return kernel.summary().count; }) +
         (resting_ ? resting_->kernel().summary().count : 0);
}

std::optional<ContactFault> Contacts::fault() const {
  const auto is_out = [](const Contact& contact) {
    return !(contact.relative_depth < 1) &&
           contact.kernel != outline_kernel;  // a NaN counts as out of range
  };
  bool out = false;
  each([&](const Kernel& kernel) { out = out || kernel.summary().relative_depth >= 1; });
  if (!out) return {};
  for (const Contact& contact : contacts()) {
    if (!is_out(contact)) continue;
    ContactFault fault = kernels_[contact.kernel]->fault(contact);
    fault.depth = kernels_[contact.kernel]->penetration(contact, 0);
    return fault;
  }
  return {};
}

void Contacts::update_friction(const Kinematics& now, double dt) {
  if (!tangential_) return;
  tried_ = false;
  memory_.begin_step();
  double work = 0;
  each([&](Kernel& kernel) { work += kernel.update_friction(now, dt, memory_); });
  memory_.end_step(work);
}

void Contacts::try_friction(const Kinematics& now, double dt) {
  drop_trial();
  update_friction(now, dt);
  tried_ = tangential_;
}

void Contacts::drop_trial() {
  if (!tried_) return;
  tried_ = false;
  memory_.undo_step();
  each([](Kernel& kernel) { kernel.undo_friction(); });
}

void Contacts::add_forces(ForceViews forces) {
  if (tangential_) {
    std::swap(beside_, beside_before_);
    beside_.assign(forces.rigid.size(), 0.);
    forces.beside = beside_;
  }
  each([&](Kernel& kernel) { kernel.add_forces(forces); });
  if (resting_) resting_->add_forces(forces.rigid);
}

void Contacts::add_dashpots(const Kinematics& now, const Dashpots::Motion& motion, double dt,
                            bool first, std::span<double> forces) {
  if (!first) memory_.damp(dashpots_.lost_after(motion.velocity, dt));
  dashpots_.clear();
  each([&](Kernel& kernel) { kernel.add_dashpots(now, dashpots_); });
  dashpots_.solve(motion, dt);
  if (!first) memory_.damp(dashpots_.lost_before());
  size_t next = 0;
  each([&](Kernel& kernel) { kernel.keep_pushes(dashpots_, next, memory_); });
  dashpots_.add_forces(beside_);
  dashpots_.add_forces(forces);
}

void Contacts::silence_dashpots(const Kinematics& now) {
  if (!table_.damped()) return;
  dashpots_.clear();
  each([&](Kernel& kernel) { kernel.add_dashpots(now, dashpots_); });
  size_t next = 0;
  each([&](Kernel& kernel) { kernel.keep_pushes(dashpots_, next, memory_); });
}

void Contacts::add_bend_losses(Dynamics dynamics, double dt) {
  dynamics.beside_before = beside_before_, dynamics.beside_after = beside_;
  const double lost = dynamics.lost_in_bend(dt);
  if (table_.damped()) {
    memory_.damp(lost);
  } else {
    memory_.lose(lost);
  }
}

bool Contacts::find_event_impulses(const Kinematics& now, Dynamics dynamics, double dt) {
  dynamics.beside_before = beside_before_, dynamics.beside_after = beside_;
  bool found = false;
  each([&](Kernel& kernel) {
    found = kernel.find_event_impulses(now, dynamics, dt, memory_) || found;
  });
  return found;
}

void Contacts::add_event_impulses(double scale, const ForceViews& forces) const {
  each([&](const Kernel& kernel) { kernel.add_event_impulses(scale, forces); });
}

std::pair<BodyIndex, BodyIndex> Contacts::bodies(const Contact& contact) const {
  if (contact.kernel != outline_kernel) {
    return {surfaces_.body(contact.a), surfaces_.body(contact.b)};
  }
  const std::vector<BodyIndex>& body = surfaces_.outlines().body;
  return std::minmax({body[contact.a], body[contact.b]});
}

std::pair<BodyIndex, BodyIndex> Contacts::bodies(const ContactKey& key) const {
  if (key.law != outline_kernel) return {surfaces_.body(key.a), surfaces_.body(key.b)};
  // The partner of a mesh edge is a body. The partner of an edge of a rigid body is a face of a
  // mesh.
  const OutlineSurfaces& o = surfaces_.outlines();
  const BodyIndex own = o.body[key.a];
  return {own, o.bodies[own].is_rigid() ? o.body[key.b] : key.b};
}

double Contacts::energy() const {
  const double moving = sum<double>([](const Kernel& k) { return k.energy(); }) + memory_.energy();
  return resting_ ? moving + resting_->energy() : moving;
}

size_t Contacts::candidates() const {
  return sum<size_t>([](const Kernel& k) { return k.candidates(); });
}

// The first pass uses the lower bounds that the kernels know anyway. The second pass measures only
// those contacts exactly whose upper bounds exceed the result of the first pass.
Penetrations Contacts::penetrations(std::span<const double> lengths,
                                    const Penetrations& floors) const {
  constexpr double kKnown = 1 + 1e-6;
  Penetrations found = floors;
  const auto length = [&](const Contact& c) {
    const auto [a, b] = bodies(c);
    return std::min(lengths[a], lengths[b]);
  };
  const auto raise = [&](const Contact& c, double depth, PairPeak& peak) {
    if (!(depth > peak.value)) return;
    const auto [a, b] = bodies(c);
    peak = {depth, a, b};
  };
  const double shortest = *std::ranges::min_element(lengths);
  visit(least_of(floors, shortest), [&](const Contact& c) {
    raise(c, c.depth, found.largest);
    raise(c, c.depth / length(c), found.relative);
  });
  visit(least_of(found, shortest), [&](const Contact& c) {
    if (c.at_most <= kKnown * c.depth) return;
    const double known = std::min(found.largest.value, found.relative.value * length(c));
    if (!(c.at_most > known)) return;
    const double depth = kernels_[c.kernel]->penetration(c, known);
    if (!(depth > known)) return;
    raise(c, depth, found.largest);
    raise(c, depth / length(c), found.relative);
  });
  return found;
}

bool Contacts::may_be_deeper(const Penetrations& floors, double shortest) const {
  const double least = least_of(floors, shortest);
  bool deeper = false;
  each([&](const Kernel& kernel) {
    const ContactSummary all = kernel.summary();
    if (!(all.deepest > least)) return;
    deeper = deeper || all.deepest > floors.largest.value ||
             all.inradius_ratio > kRoundOff * floors.relative.value;
  });
  return deeper;
}

PairPeak Contacts::largest_force() const {
  PairPeak largest;
  each([&](const Kernel& kernel) {
    const PairPeak found = kernel.largest_force();
    if (found.value > largest.value) largest = found;
  });
  return largest;
}

double Contacts::node_rate(std::span<const double> node_mass) const {
  double rate = 0;
  each([&](const Kernel& kernel) { rate = std::max(rate, kernel.rate(node_mass)); });
  return rate;
}

void Contacts::add_stiffness(std::span<double> nodes, std::span<double> rigid) const {
  each([&](const Kernel& kernel) { kernel.add_stiffness(nodes, rigid); });
}

Vec2 Contacts::force_on(BodyIndex body) const {
  Vec2 force = Vec2::Zero();
  each([&](const Kernel& kernel) { force += kernel.force_on(body); });
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    if (dashpots_[i].a == body) force += dashpots_.force_on_a(i);
    if (dashpots_[i].b == body) force -= dashpots_.force_on_a(i);
  }
  return force;
}

void Contacts::add_force_sizes(std::span<double> of_bodies) const {
  each([&](const Kernel& kernel) { kernel.add_force_sizes(of_bodies); });
}

std::vector<double> Contacts::friction_sizes() const {
  std::vector<double> sizes(static_cast<size_t>(surfaces_.body_count()));
  for (const Spring& spring : springs()) {
    const auto [a, b] = bodies(spring.key);
    sizes[a] += std::abs(spring.force);
    sizes[b] += std::abs(spring.force);
  }
  return sizes;
}

std::vector<ContactRecord> Contacts::records() const {
  std::vector<ContactRecord> records;
  for (size_t k = 0; k < kernels_.size(); ++k) {
    if (kernels_[k]) kernels_[k]->add_records(records);
    if (k != polygon_kernel || !resting_) continue;
    const auto middle = static_cast<std::ptrdiff_t>(records.size());
    const std::vector<ContactRecord>& resting = resting_->records();
    records.insert(records.end(), resting.begin(), resting.end());
    const auto pair = [](const ContactRecord& record) { return std::pair(record.a, record.b); };
    std::ranges::inplace_merge(records, records.begin() + middle, {}, pair);
  }
  return records;
}

std::vector<Spring> Contacts::springs() const {
  const std::span<const Spring> moving = memory_.springs();
  if (!resting_) return {moving.begin(), moving.end()};
  std::vector<Spring> all;
  std::ranges::merge(moving, resting_->memory().springs(), std::back_inserter(all), {},
                     &Spring::key, &Spring::key);
  return all;
}

std::vector<SurfaceRecord> Contacts::surface_records() const {
  std::vector<SurfaceRecord> records;
  each([&](const Kernel& kernel) { kernel.add_surfaces(records); });
  return records;
}

void Contacts::forget_search() {
  search_.forget();
  surfaces_.outlines().forget();
}

void Contacts::refresh(const Kinematics& now) {
  Kinematics kinematics = now;
  kinematics.restored = kept_search_.has_value();
  if (kept_search_) {
    search_.search_at(*kept_search_, surfaces_, threads_);
    hand_out_pairs();
    kept_search_.reset();
    place_all(now);
  } else {
    place_all(now);
    forget_search();
    search_if_stale();
  }
  evaluate();
  if (resting_) resting_->evaluate(search_.near(), now);
  if (!tangential_) return;
  FrictionMemory memory = memory_;
  memory.begin_step();
  each([&](Kernel& kernel) { kernel.refresh(kinematics, memory); });
}

ContactNumbers Contacts::numbers() const {
  ContactNumbers numbers{friction_law_, {}};
  numbers.bodies.resize(static_cast<size_t>(surfaces_.body_count()));
  for (SurfaceIndex i = 0; i < surfaces_.size(); ++i) {
    ContactNumbers::Body& body = numbers.bodies[static_cast<size_t>(surfaces_.body(i))];
    if (body.surfaces++ == 0) body.first_surface = i;
    if (!surfaces_.is_rigid(i)) continue;
    body.rigid = true;
    body.edges = surfaces_.shapes().view(i).size;
  }
  const std::vector<OutlineSurfaces::Body>& outlines = surfaces_.outlines().bodies;
  for (size_t i = 0; i < outlines.size(); ++i) {
    numbers.bodies[i].first_vertex = outlines[i].first;
    numbers.bodies[i].vertices = outlines[i].end - outlines[i].first;
  }
  return numbers;
}

void Contacts::set_memory(const FrictionMemory& memory) {
  if (!tangential_) return;
  memory_ = memory;
  if (!table_.damped()) memory_.forget_pushes();
}

void Contacts::fields(Archive& archive) {
  archive("friction", memory_);
  if (tangential_) archive("beside", beside_);
  if (table_.damped()) archive("dashpots", dashpots_);
  each([&](Kernel& kernel) { kernel.fields(archive); });
  if (resting_) archive("resting", *resting_);
  SearchPlaces places = search_.places(surfaces_);
  archive("search", places);
  if (archive.loads()) kept_search_ = std::move(places);
}

}  // namespace apothem
