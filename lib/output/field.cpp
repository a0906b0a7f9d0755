#include "lib/output/field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

constexpr double kFarthest = 1e9;  // largest distance along an axis, cells

// Column and row of the cell that contains `p`, in the lattice of cells of which one is centred at
// `start`.
std::pair<long, long> lattice_cell(const Vec2& p, const Vec2& start, const Vec2& size) {
  return {std::lround((p.x() - start.x()) / size.x()), std::lround((p.y() - start.y()) / size.y())};
}

FieldSample node_sample(const Frame& frame, int node) {
  FieldSample sample;
  sample.displacement = frame.displacement[node];
  sample.velocity = frame.velocity[node];
  return sample;
}

// Of an element, or of the rigid body that it is.
FieldSample element_sample(const Frame& frame, int element) {
  FieldSample sample;
  sample.body = &frame.body_of(element);
  sample.stress = sample.body->meshed ? frame.stress[element] : sample.body->mean_stress();
  sample.material = frame.material[element];
  return sample;
}

// Adds `weight` times the stress and the mean displacement and velocity of an element.
void add(FieldSample& sum, const Frame& frame, int element, double weight) {
  constexpr std::array kParts{&CauchyStress::xx, &CauchyStress::yy, &CauchyStress::xy,
                              &CauchyStress::zz};
  for (const auto part : kParts) sum.stress.*part += weight * frame.stress[element].*part;
  const std::span<const int> nodes = frame.mesh.element(element);
  for (const int node : nodes) {
    sum.displacement += weight / static_cast<double>(nodes.size()) * frame.displacement[node];
    sum.velocity += weight / static_cast<double>(nodes.size()) * frame.velocity[node];
  }
}

std::vector<FieldQuantity> all_quantities() {
  using enum FieldKind;
  using S = const FieldSample&;
  std::vector<FieldQuantity> all{
      {"speed", "speed", "|v|", "m/s", node, [](S s) { return s.velocity.norm(); }},
      {"vx", "velocity along x", "vx", "m/s", node, [](S s) { return s.velocity.x(); }},
      {"vy", "velocity along y", "vy", "m/s", node, [](S s) { return s.velocity.y(); }},
      {"u", "displacement", "|u|", "m", node, [](S s) { return s.displacement.norm(); }},
      {"ux", "displacement along x", "ux", "m", node, [](S s) { return s.displacement.x(); }},
      {"uy", "displacement along y", "uy", "m", node, [](S s) { return s.displacement.y(); }}};
  for (size_t i = 0; i < kBodyQuantities.size(); ++i) {
    const BodyQuantity& q = kBodyQuantities[i];
    if (!q.in_pictures()) continue;
    const char* const unit = q.kind == BodyQuantity::Kind::count ? "" : q.unit;
    all.push_back(
        {q.name, q.meaning, q.symbol, unit, body, [i](S s) { return s.body->values[i][0]; }});
  }
  const std::vector<FieldQuantity> others{
      {"material", "material", "", "", category, [](S s) { return 1. * s.material; }},
      {"pressure", "pressure, −(σ₁ + σ₂)/2", "p", "Pa", stress,
       [](S s) { return -(s.stress.xx + s.stress.yy) / 2; }},
      {"s1", "major principal stress", "σ₁", "Pa", stress,
       [](S s) { return principal_stresses(s.stress)[0]; }},
      {"s2", "minor principal stress", "σ₂", "Pa", stress,
       [](S s) { return principal_stresses(s.stress)[1]; }},
      {"sxx", "stress xx", "σxx", "Pa", stress, [](S s) { return s.stress.xx; }},
      {"syy", "stress yy", "σyy", "Pa", stress, [](S s) { return s.stress.yy; }},
      {"sxy", "stress xy", "σxy", "Pa", stress, [](S s) { return s.stress.xy; }},
      {"szz", "stress zz", "σzz", "Pa", stress_of_elements, [](S s) { return s.stress.zz; }},
      {"von_mises", "von Mises stress", "σᵥ", "Pa", stress_of_elements,
       [](S s) { return von_mises(s.stress); }}};
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

}  // namespace

const std::vector<FieldQuantity>& field_quantities() {
  static const std::vector<FieldQuantity> all = all_quantities();
  return all;
}

const FieldQuantity* field_quantity(const std::string& name) {
  for (const FieldQuantity& quantity : field_quantities()) {
    if (quantity.name == name) return &quantity;
  }
  return nullptr;
}

bool has_value(const FrameBody& body, FieldKind kind, bool rigid_only) {
  if (kind == FieldKind::category) return true;
  if (body.motion == Motion::fixed) return false;
  if (kind == FieldKind::stress_of_elements) return body.meshed;
  return kind != FieldKind::stress || body.meshed || rigid_only;
}

Field field_of(const Frame& frame, const FieldQuantity& quantity) {
  Field field;
  field.mesh = frame.mesh;
  field.mesh.nodes = frame.position;
  field.holes = frame.holes;
  field.nodal = quantity.kind == FieldKind::node;
  if (quantity.kind == FieldKind::category) field.names = frame.material_names;
  const bool rigid_only = all_rigid(frame);
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    const double value = field.nodal ? 0 : quantity.value(element_sample(frame, e));
    field.blank.push_back(!has_value(frame.body_of(e), quantity.kind, rigid_only) ||
                          std::isnan(value));
    if (!field.nodal) field.values.push_back(value);
  }
  for (size_t i = 0; field.nodal && i < frame.position.size(); ++i) {
    field.values.push_back(quantity.value(node_sample(frame, static_cast<int>(i))));
  }
  return field;
}

CellTable cell_table(const HistoryTable& table, const std::string& column, const Vec2& size) {
  CellTable cells{size, {}, *table.column(column)};
  const std::vector<double>& x = *table.column("x");
  const std::vector<double>& y = *table.column("y");
  std::set<std::pair<long, long>> known;
  for (size_t i = 0; i < x.size(); ++i) {
    const Vec2 steps = (Vec2(x[i], y[i]) - Vec2(x[0], y[0])).cwiseQuotient(size);
    if (!(std::abs(steps.x()) < kFarthest && std::abs(steps.y()) < kFarthest)) {
      throw std::runtime_error(
          fmt::format("the cell around ({}, {}) lies more than {:g} cells from the first", x[i],
                      y[i], kFarthest));
    }
    cells.centres.emplace_back(x[i], y[i]);
    if (!known.insert(lattice_cell(cells.centres[i], cells.centres[0], size)).second) {
      throw std::runtime_error(fmt::format(
          "the cell around ({}, {}) has two rows: give the size of the table's cells", x[i], y[i]));
    }
  }
  return cells;
}

Field field_of(const CellTable& cells) {
  Field field;
  std::map<std::pair<long, long>, int> nodes;  // by column and row of the corner
  const Vec2 half = cells.size / 2;
  for (const Vec2& centre : cells.centres) {
    std::array<int, 4> corners{};
    constexpr std::array<std::array<int, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (size_t k = 0; k < 4; ++k) {
      const Vec2 corner = centre + Vec2(kSigns[k][0] * half.x(), kSigns[k][1] * half.y());
      const auto [at, is_new] =
          nodes.try_emplace(lattice_cell(corner, cells.centres[0] - half, cells.size),
                            static_cast<int>(field.mesh.nodes.size()));
      if (is_new) field.mesh.nodes.push_back(corner);
      corners[k] = at->second;
    }
    field.mesh.add_element(corners);
  }
  field.values = cells.values;
  field.blank.assign(cells.values.size(), false);
  return field;
}

FieldError field_error(const Frame& frame, const FieldQuantity& quantity,
                       const CellTable& reference) {
  struct Sum {
    FieldSample sample;
    double area = 0;
  };
  std::map<std::pair<long, long>, Sum> sums;
  const auto cell_at = [&](const Vec2& p) {
    return lattice_cell(p, reference.centres[0], reference.size);
  };
  for (int e = 0; e < frame.mesh.element_count(); ++e) {
    if (!frame.body_of(e).meshed) continue;
    const std::span<const int> nodes = frame.mesh.element(e);
    Vec2 middle = Vec2::Zero();
    for (const int node : nodes) middle += frame.mesh.nodes[node];
    Sum& sum = sums[cell_at(middle / static_cast<double>(nodes.size()))];
    const double area = element_area(frame.mesh, e);
    add(sum.sample, frame, e, area);
    sum.area += area;
  }
  double squares = 0, worst = 0, scale = 0;
  for (size_t i = 0; i < reference.centres.size(); ++i) {
    const Vec2& centre = reference.centres[i];
    const auto found = sums.find(cell_at(centre));
    if (found == sums.end()) {
      throw std::runtime_error(fmt::format(
          "no element to compare has its centroid in the cell around ({}, {}) of the reference",
          centre.x(), centre.y()));
    }
    FieldSample mean = found->second.sample;
    const double share = 1 / found->second.area;
    mean.stress = {share * mean.stress.xx, share * mean.stress.yy, share * mean.stress.xy,
                   share * mean.stress.zz};
    mean.displacement *= share;
    mean.velocity *= share;
    const double error = std::abs(quantity.value(mean) - reference.values[i]);
    squares += error * error;
    worst = std::max(worst, error);
    scale = std::max(scale, std::abs(reference.values[i]));
  }
  const double cells = static_cast<double>(reference.values.size());
  return {std::sqrt(squares / cells) / scale, worst / scale};
}

}  // namespace apothem
