#include "lib/contact/surface/surfaces.hpp"

#include <algorithm>
#include <atomic>

namespace apothem {

namespace {

constexpr double kPlaceTime = 30;  // time for a polygon, ns

double angle_of(const Kinematics& now, RigidIndex i) {
  return now.pose[3 * static_cast<size_t>(i) + 2];
}

}  // namespace

void Surfaces::reserve_polygons(size_t polygons, size_t vertices) {
  shapes_.reserve(polygons, vertices);
  kinds_.reserve(polygons);
  bodies_.reserve(polygons);
  pose_.reserve(polygons);
  rigid_.reserve(polygons);
}

void Surfaces::add_polygon(const Potential& potential, const Rigid& rigid) {
  const SurfaceIndex i = shapes_.add(potential);
  kinds_.push_back(SurfaceKind::polygon);
  bodies_.push_back(body_count_++);
  pose_.push_back({});
  if (rigid.moves) moving_.push_back(i);
  rigid_.push_back(rigid);
  rigid_.back().slope = shapes_.slope(i);
  rigid_.back().radius = shapes_.radius(i);
  if (collars_) outlines_.add_rigid(potential.rings(), i, 1 / potential.steepest);
}

void Surfaces::add_outline(const Mesh& mesh, NodeIndex first_node, std::optional<double> reference,
                           MeshInertia inertia) {
  deformable_.push_back({std::move(inertia), first_node, mesh.nodes});
  outlines_.add_mesh(mesh, boundary(mesh), first_node, reference);
  kinds_.push_back(SurfaceKind::outline);
  bodies_.push_back(body_count_++);
}

void Surfaces::add_elements(const Mesh& mesh, NodeIndex first_node, const PotentialChoice& choice,
                            MeshInertia inertia) {
  deformable_.push_back({std::move(inertia), first_node, mesh.nodes});
  elements_.add(mesh, boundary(mesh), first_node, body_count_, choice, shapes_);
  kinds_.resize(shapes_.size(), SurfaceKind::element);
  bodies_.resize(shapes_.size(), body_count_);
  pose_.resize(shapes_.size());
  ++body_count_;
}

double Surfaces::mobility(BodyIndex body, const Kinematics& now, const Vec2& point,
                          const Vec2& along) const {
  if (body < rigid_count()) {
    const Vec2 centre(&now.pose[3 * static_cast<size_t>(body)]);
    return mobility_at(rigid_[static_cast<size_t>(body)].inverse_mass, point - centre, along);
  }
  const Body& mesh = deformable_[static_cast<size_t>(body - rigid_count())];
  Vec2 centre = Vec2::Zero();
  if (mesh.inertia.inverse_mass[2] > 0) {
    for (size_t i = 0; i < mesh.inertia.mass_fractions.size(); ++i) {
      const double* const u = &now.displacement[2 * (static_cast<size_t>(mesh.first_node) + i)];
      centre += mesh.inertia.mass_fractions[i] * (mesh.nodes[i] + Vec2(u[0], u[1]));
    }
  }
  return mobility_at(mesh.inertia.inverse_mass, point - centre, along);
}

std::vector<double> Surfaces::slopes() const {
  std::vector<double> slopes(static_cast<size_t>(body_count_));
  for (SurfaceIndex i = 0; i < size(); ++i) {
    double& slope = slopes[bodies_[i]];
    slope = std::max(
        slope, kinds_[i] == SurfaceKind::outline ? outlines_.bodies[i].slope() : shapes_.slope(i));
  }
  return slopes;
}

void Surfaces::set_absent(const std::vector<std::uint8_t>& absent) {
  absent_ = absent;
  find_moving();
}

void Surfaces::set_resting(const std::vector<std::uint8_t>& resting) {
  resting_ = resting;
  find_moving();
}

void Surfaces::find_moving() {
  moving_.clear();
  for (RigidIndex i = 0; i < rigid_count(); ++i) {
    if (moves(i) && is_present(i)) moving_.push_back(i);
  }
}

bool Surfaces::place_polygon(RigidIndex i, const Kinematics& now, const SineCosine& angle) {
  const double* x = &now.pose[3 * static_cast<size_t>(i)];
  if (0 * x[0] + 0 * x[1] + 0 * x[2] != 0) return false;
  pose_[i] = {x[0], x[1], x[2]};
  shapes_.place(i, x[0], x[1], angle);
  return true;
}

void Surfaces::place_meshes(const Kinematics& now, const Threads& threads) {
  if (elements_.size() > 0) {
    const auto first = static_cast<size_t>(rigid_count());
    elements_.place(now, rigid_count(), shapes_, std::span(pose_).subspan(first));
  }
  if (has_outlines()) outlines_.place(now, shapes_, threads);
}

void Surfaces::place_all(const Kinematics& now) {
  for (RigidIndex i = 0; i < rigid_count(); ++i) {
    if (!place_polygon(i, now, sine_cosine(angle_of(now, i)))) throw NotFinite(i);
  }
  place_meshes(now, Threads());
}

void Surfaces::place(const Kinematics& now, const Threads& threads) {
  std::atomic<bool> finite = true;
  threads.chunks(static_cast<int>(moving_.size()), kPlaceTime, [&](int first, int end, int) {
    for (int i = first; i < end; i += 2) {
      const RigidIndex one = moving_[static_cast<size_t>(i)];
      const RigidIndex other = moving_[static_cast<size_t>(std::min(i + 1, end - 1))];
      const auto angles = sine_cosine(std::array{angle_of(now, one), angle_of(now, other)});
      if (!place_polygon(one, now, angles[0])) finite = false;
      if (other != one && !place_polygon(other, now, angles[1])) finite = false;
    }
  });
  if (!finite) place_all(now);  // throws with the number of the body
  place_meshes(now, threads);
}

}  // namespace apothem
