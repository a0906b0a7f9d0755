#include "lib/output/body_grids.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <array>
#include <numeric>

#include "lib/mesh/measure.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/rotation.hpp"
#include "lib/output/convex_cells.hpp"

namespace apothem {
namespace {

// Names the components of a symmetric tensor of the plane.
void name_tensor(vtkDataArray* array) {
  array->SetComponentName(0, "xx");
  array->SetComponentName(1, "yy");
  array->SetComponentName(2, "xy");
}

// The stresses of elements or nodes as VTK arrays.
class StressArrays {
 public:
  StressArrays()
      : arrays_{doubles("stress", 3), doubles("stress_zz", 1), doubles("principal_stress", 2),
                doubles("von_mises", 1), doubles("strain_energy_density", 1)} {}
  void add(const CauchyStress& s) {
    arrays_[0]->InsertNextTuple3(s.xx, s.yy, s.xy);
    arrays_[1]->InsertNextValue(s.zz);
    const auto [major, minor] = principal_stresses(s);
    arrays_[2]->InsertNextTuple2(major, minor);
    arrays_[3]->InsertNextValue(von_mises(s));
    arrays_[4]->InsertNextValue(s.energy_density);
  }
  template <class Data>
  void add_to(Data* data) {
    name_tensor(arrays_[0]);
    arrays_[2]->SetComponentName(0, "major");
    arrays_[2]->SetComponentName(1, "minor");
    for (const auto& array : arrays_) data->AddArray(array);
  }

 private:
  std::array<vtkNew<vtkDoubleArray>, 5> arrays_;
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

vtkSmartPointer<vtkDataArray> array_of(const BodyQuantity& quantity) {
  if (quantity.kind == BodyQuantity::Kind::count) return integers(quantity.name);
  vtkSmartPointer<vtkDataArray> array = doubles(quantity.name, quantity.components());
  if (quantity.kind == BodyQuantity::Kind::tensor) name_tensor(array);
  return array;
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

  vtkNew<vtkUnstructuredGrid> grid() {
    vtkNew<vtkUnstructuredGrid> grid = grid_of(points_, VTK_POLYGON, cells_);
    if (!model_.deformables.empty()) {
      of_cells_.add_to(grid->GetCellData());
      of_points_.add_to(grid->GetPointData());
    }
    grid->GetPointData()->AddArray(displacement_);
    grid->GetPointData()->AddArray(velocity_);
    for (vtkDataArray* array : of_cells()) grid->GetCellData()->AddArray(array);
    return grid;
  }

 private:
  // Arrays that grow would take twice the memory.
  void reserve() {
    vtkIdType points = 0;
    auto cells = static_cast<vtkIdType>(model_.bodies.size());
    for (const RigidBody& body : model_.bodies) points += body.potential.size();
    for (const DeformableBody& body : model_.deformables) {
      points += static_cast<vtkIdType>(body.mesh.nodes.size());
      cells += body.mesh.element_count();
    }
    points_->Allocate(points);
    cells_->AllocateEstimate(cells, 4);
    for (vtkDataArray* array : {displacement_.Get(), velocity_.Get()}) array->Allocate(3 * points);
    for (vtkDataArray* array : of_cells()) array->Allocate(array->GetNumberOfComponents() * cells);
  }

  // The arrays that have a value for each cell, but those of stresses in deformable bodies.
  std::vector<vtkDataArray*> of_cells() {
    std::vector<vtkDataArray*> arrays{body_, part_, material_, motion_};
    for (const Quantity& quantity : quantities_) arrays.push_back(quantity.array);
    return arrays;
  }

  void add_rigid(RigidIndex i) {
    const RigidBody& body = model_.bodies[i];
    const auto x = frame_.state.pose(i), v = frame_.state.pose_rate(i);
    const Vec2 centre = x.head<2>();
    const vtkIdType first = points_->GetNumberOfPoints();
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
    const vtkIdType first = points_->GetNumberOfPoints();
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
    cells_->InsertNextCell(static_cast<int>(corners.size()));
    for (const int corner : corners) cells_->InsertCellPoint(point_of(corner));
  }

  // Of the body whose cells are added next.
  void find_quantities(BodyIndex body) {
    const ObservedBody record{
        motion_of(model_, frame_.state, body, frame_.forces[body], frame_.node_mass),
        frame_.bodies.empty() ? BodyStatistics() : frame_.bodies[static_cast<size_t>(body)]};
    for (Quantity& quantity : quantities_) quantity.value = quantity.of->value(record);
  }

  void add_point(const Vec2& place, const Vec2& u, const Vec2& v) {
    displacement_->InsertNextTuple3(u.x(), u.y(), 0);
    velocity_->InsertNextTuple3(v.x(), v.y(), 0);
    const Vec2 p = place + model_.origin;
    points_->InsertNextPoint(p.x(), p.y(), 0);
  }

  void add_cell(BodyIndex body, size_t part, MaterialIndex material, Motion motion,
                const CauchyStress& stress) {
    body_->InsertNextValue(body);
    part_->InsertNextValue(static_cast<int>(part));
    material_->InsertNextValue(material);
    motion_->InsertNextValue(static_cast<int>(motion));
    if (!model_.deformables.empty()) of_cells_.add(stress);
    for (const Quantity& quantity : quantities_) {
      quantity.array->InsertNextTuple(quantity.value.data());
    }
  }

  // One of kBodyQuantities.
  struct Quantity {
    const BodyQuantity* of;
    vtkSmartPointer<vtkDataArray> array;
    Components value;  // of the body at hand
  };

  const Model& model_;
  const FrameContents& frame_;
  const std::map<RigidIndex, Cells>& rigid_cells_;
  vtkNew<vtkPoints> points_ = double_points();
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkIntArray> body_ = integers("body");
  vtkNew<vtkIntArray> part_ = integers("part");
  vtkNew<vtkIntArray> material_ = integers("material");
  vtkNew<vtkIntArray> motion_ = integers("motion");  // as the enumeration Motion counts
  vtkNew<vtkDoubleArray> displacement_ = doubles("displacement", 3);
  vtkNew<vtkDoubleArray> velocity_ = doubles("velocity", 3);
  std::vector<Quantity> quantities_;
  StressArrays of_cells_, of_points_;
};

}  // namespace

vtkNew<vtkUnstructuredGrid> body_grid(const Model& model, const FrameContents& frame,
                                      const std::map<RigidIndex, Cells>& rigid_cells) {
  return BodyGrid(model, frame, rigid_cells).grid();
}

vtkNew<vtkUnstructuredGrid> outline_grid(const Model& model, const State& state,
                                         const std::vector<Cells>& loops) {
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> of_cells = integers("body");
  const auto add = [&](BodyIndex body, size_t corners, const auto& place_of) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (size_t i = 0; i < corners; ++i) {
      const Vec2 p = place_of(i) + model.origin;
      points->InsertNextPoint(p.x(), p.y(), 0);
      cells->InsertNextCell(
          {first + static_cast<vtkIdType>(i), first + static_cast<vtkIdType>((i + 1) % corners)});
      of_cells->InsertNextValue(body);
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
  return grid_of(points, VTK_LINE, cells, {of_cells});
}

}  // namespace apothem
