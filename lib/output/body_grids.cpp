#include "lib/output/body_grids.hpp"

#include <array>
#include <numeric>

#include "lib/mesh/measure.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/rotation.hpp"
#include "lib/output/convex_cells.hpp"

namespace apothem {
namespace {

// The stresses of elements or nodes as arrays.
class StressArrays {
 public:
  StressArrays()
      : arrays_{GridArray::tensors("stress"),
                GridArray::numbers("stress_zz"),
                {.name = "principal_stress", .columns = 2, .parts = {"major", "minor"}},
                GridArray::numbers("von_mises"),
                GridArray::numbers("strain_energy_density")} {}
  void add(const CauchyStress& s) {
    arrays_[0].reals.insert(arrays_[0].reals.end(), {s.xx, s.yy, s.xy});
    arrays_[1].reals.push_back(s.zz);
    const auto [major, minor] = principal_stresses(s);
    arrays_[2].reals.insert(arrays_[2].reals.end(), {major, minor});
    arrays_[3].reals.push_back(von_mises(s));
    arrays_[4].reals.push_back(s.energy_density);
  }
  void move_to(std::vector<GridArray>& arrays) {
    for (GridArray& array : arrays_) arrays.push_back(std::move(array));
  }

 private:
  std::array<GridArray, 5> arrays_;
};

// The stress at each node: the mean over the elements around it, weighted with their areas.
std::vector<CauchyStress> nodal_means(const DeformableBody& body, const CauchyStress* stress) {
  std::vector<CauchyStress> mean(body.mesh.nodes.size());
  std::vector<double> weight(mean.size(), 0);
  constexpr std::array kParts{&CauchyStress::xx, &CauchyStress::yy, &CauchyStress::xy,
                              &CauchyStress::zz, &CauchyStress::energy_density};
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const double share = element_area(body.mesh, e);
    for (const int node : body.mesh.element(e)) {
      weight[node] += share;
      for (const auto part : kParts) mean[node].*part += share * stress[e].*part;
    }
  }
  for (size_t i = 0; i < mean.size(); ++i) {
    for (const auto part : kParts) mean[i].*part /= weight[i];
  }
  return mean;
}

GridArray array_of(const BodyQuantity& quantity) {
  switch (quantity.kind) {
    case BodyQuantity::Kind::count:
      return GridArray::whole_numbers(quantity.name);
    case BodyQuantity::Kind::vector:
      return GridArray::vectors(quantity.name);
    case BodyQuantity::Kind::tensor:
      return GridArray::tensors(quantity.name);
    default:
      return GridArray::numbers(quantity.name);
  }
}

// Adds the value of a quantity.
void add_value(GridArray& array, const Components& value) {
  if (array.is_whole) {
    array.integers.push_back(static_cast<std::int32_t>(value[0]));
  } else {
    array.reals.insert(array.reals.end(), value.begin(),
                       value.begin() + static_cast<std::ptrdiff_t>(array.columns));
  }
}

// The bodies of a frame: a rigid one is a cell, and so is an element, or several if it is not
// convex, as none with holes is. `rigid_cells` are those of the rigid bodies that are not convex.
class BodyGrid {
 public:
  BodyGrid(const Model& model, const FrameContents& frame,
           const std::map<RigidIndex, Cells>& rigid_cells)
      : model_(model), frame_(frame), rigid_cells_(rigid_cells) {
    for (const BodyQuantity& quantity : kBodyQuantities) {
      if (quantity.in_frames()) quantities_.push_back({&quantity, array_of(quantity), {}});
    }
    reserve();
    for (RigidIndex i = 0; i < static_cast<RigidIndex>(model.bodies.size()); ++i) {
      if (!frame.state.is_absent(i)) add_rigid(i);
    }
    const CauchyStress* stress = frame.stresses.data();
    for (DeformableIndex i = 0; i < static_cast<DeformableIndex>(model.deformables.size()); ++i) {
      if (!frame.state.is_absent(static_cast<BodyIndex>(model.bodies.size()) + i)) {
        add_deformable(i, stress);
      }
      stress += model.deformables[i].mesh.element_count();
    }
  }

  FrameGrid grid() {
    if (!model_.deformables.empty()) {
      of_cells_.move_to(grid_.of_cells);
      of_points_.move_to(grid_.of_points);
    }
    for (GridArray* array : {&displacement_, &velocity_}) {
      grid_.of_points.push_back(std::move(*array));
    }
    for (GridArray* array : of_cells()) grid_.of_cells.push_back(std::move(*array));
    return std::move(grid_);
  }

 private:
  // Arrays that grow would take twice the memory.
  void reserve() {
    size_t points = 0, cells = model_.bodies.size();
    for (const RigidBody& body : model_.bodies) {
      points += static_cast<size_t>(body.potential.size());
    }
    size_t corners = points;
    for (const DeformableBody& body : model_.deformables) {
      points += body.mesh.nodes.size();
      cells += static_cast<size_t>(body.mesh.element_count());
      corners += 4 * static_cast<size_t>(body.mesh.element_count());
    }
    grid_.points.reserve(points);
    grid_.corners.reserve(corners);
    grid_.ends.reserve(cells);
    for (GridArray* array : {&displacement_, &velocity_}) array->reserve(points);
    for (GridArray* array : of_cells()) array->reserve(cells);
  }

  // The arrays that have a value for each cell, but those of stresses in deformable bodies.
  std::vector<GridArray*> of_cells() {
    std::vector<GridArray*> arrays{&body_, &part_, &material_, &motion_};
    for (Quantity& quantity : quantities_) arrays.push_back(&quantity.array);
    return arrays;
  }

  void add_rigid(RigidIndex i) {
    const RigidBody& body = model_.bodies[i];
    const auto x = frame_.state.pose(i), v = frame_.state.pose_rate(i);
    const Vec2 centre = x.head<2>();
    const auto first = static_cast<std::int32_t>(grid_.points.size());
    for (const Vec2& vertex : body.potential.vertices) {
      const Vec2 arm = turned(vertex, x[2]);
      const Vec2 u = (centre - body.position) + (arm - turned(vertex, body.angle));
      add_point(centre + arm, u, v.head<2>() + cross(v[2], arm));
      if (!model_.deformables.empty()) of_points_.add({});
    }
    find_quantities(i);
    const auto add = [&](size_t part, const auto& corners) {
      add_corners(corners, [&](int corner) { return first + corner; });
      add_cell(i, part, body.material, body.motion, {});
    };
    const auto several = rigid_cells_.find(i);
    if (several == rigid_cells_.end()) {
      std::vector<int> corners(static_cast<size_t>(body.potential.size()));
      std::iota(corners.begin(), corners.end(), 0);
      add(0, corners);
      return;
    }
    for (size_t part = 0; part < several->second.size(); ++part) add(part, several->second[part]);
  }

  void add_deformable(DeformableIndex i, const CauchyStress* stress) {
    const DeformableBody& body = model_.deformables[i];
    const auto first = static_cast<std::int32_t>(grid_.points.size());
    for (int n = 0; n < static_cast<int>(body.mesh.nodes.size()); ++n) {
      const Vec2 u = frame_.state.node(body.first_node + n);
      add_point(body.mesh.nodes[n] + u, u, frame_.state.node_velocity(body.first_node + n));
    }
    for (const CauchyStress& s : nodal_means(body, stress)) of_points_.add(s);
    const BodyIndex b = static_cast<BodyIndex>(model_.bodies.size()) + i;
    find_quantities(b);
    std::vector<Vec2> ring;
    for (ElementIndex e = 0; e < body.mesh.element_count(); ++e) {
      const std::span<const int> nodes = body.mesh.element(e);
      ring.clear();
      for (const int n : nodes) {
        ring.emplace_back(body.mesh.nodes[n] + frame_.state.node(body.first_node + n));
      }
      const Cells cells = convex_cells(ring);
      for (size_t part = 0; part < cells.size(); ++part) {
        add_corners(cells[part], [&](int corner) { return first + nodes[corner]; });
        add_cell(b, part, body.material_of(e), Motion::free, stress[e]);
      }
    }
  }

  template <class Corners, class PointOf>
  void add_corners(const Corners& corners, const PointOf& point_of) {
    for (const int corner : corners) grid_.corners.push_back(point_of(corner));
    grid_.end_cell();
  }

  // Of the body whose cells are added next.
  void find_quantities(BodyIndex body) {
    const ObservedBody record{
        motion_of(model_, frame_.state, body, frame_.forces[body], frame_.node_mass),
        frame_.bodies.empty() ? BodyStatistics() : frame_.bodies[static_cast<size_t>(body)]};
    for (Quantity& quantity : quantities_) quantity.value = quantity.of->value(record);
  }

  void add_point(const Vec2& place, const Vec2& u, const Vec2& v) {
    displacement_.add(u);
    velocity_.add(v);
    grid_.points.emplace_back(place + model_.origin);
  }

  void add_cell(BodyIndex body, size_t part, MaterialIndex material, Motion motion,
                const CauchyStress& stress) {
    body_.integers.push_back(body);
    part_.integers.push_back(static_cast<std::int32_t>(part));
    material_.integers.push_back(material);
    motion_.integers.push_back(static_cast<std::int32_t>(motion));
    if (!model_.deformables.empty()) of_cells_.add(stress);
    for (Quantity& quantity : quantities_) add_value(quantity.array, quantity.value);
  }

  // One of kBodyQuantities.
  struct Quantity {
    const BodyQuantity* of;
    GridArray array;
    Components value;  // of the body at hand
  };

  const Model& model_;
  const FrameContents& frame_;
  const std::map<RigidIndex, Cells>& rigid_cells_;
  FrameGrid grid_;
  GridArray body_ = GridArray::whole_numbers("body"), part_ = GridArray::whole_numbers("part");
  GridArray material_ = GridArray::whole_numbers("material");
  GridArray motion_ = GridArray::whole_numbers("motion");  // as the enumeration Motion counts
  GridArray displacement_ = GridArray::vectors("displacement");
  GridArray velocity_ = GridArray::vectors("velocity");
  std::vector<Quantity> quantities_;
  StressArrays of_cells_, of_points_;
};

}  // namespace

FrameGrid body_grid(const Model& model, const FrameContents& frame,
                    const std::map<RigidIndex, Cells>& rigid_cells) {
  return BodyGrid(model, frame, rigid_cells).grid();
}

FrameGrid outline_grid(const Model& model, const State& state, const std::vector<Cells>& loops) {
  FrameGrid grid{FrameGrid::Kind::lines};
  GridArray of_cells = GridArray::whole_numbers("body");
  const auto add = [&](BodyIndex body, size_t corners, const auto& place_of) {
    const auto first = static_cast<std::int32_t>(grid.points.size());
    for (size_t i = 0; i < corners; ++i) {
      const std::int32_t point = grid.add_point(place_of(i) + model.origin);
      grid.add_cell({point, i + 1 < corners ? point + 1 : first});
      of_cells.integers.push_back(body);
    }
  };
  const auto rigid = static_cast<RigidIndex>(model.bodies.size());
  for (RigidIndex i = 0; i < rigid; ++i) {
    if (state.is_absent(i)) continue;
    const auto pose = state.pose(i);
    const Vec2 centre = pose.head<2>();
    const double angle = pose[2];
    for (const std::vector<Vec2>& ring : model.bodies[i].rings()) {
      add(i, ring.size(), [&](size_t k) { return Vec2(centre + turned(ring[k], angle)); });
    }
  }
  for (DeformableIndex i = 0; i < static_cast<DeformableIndex>(model.deformables.size()); ++i) {
    if (state.is_absent(rigid + i)) continue;
    const DeformableBody& body = model.deformables[i];
    for (const std::vector<int>& loop : loops[i]) {
      add(rigid + i, loop.size(), [&](size_t k) {
        return Vec2(body.mesh.nodes[loop[k]] + state.node(body.first_node + loop[k]));
      });
    }
  }
  grid.of_cells = {std::move(of_cells)};
  return grid;
}

}  // namespace apothem
