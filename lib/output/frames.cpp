#include "apothem/output/frames.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "apothem/mesh/measure.hpp"
#include "apothem/model/columns.hpp"
#include "apothem/output/files.hpp"
#include "apothem/output/vtk_grid.hpp"

namespace apothem {
namespace {

void add_time(vtkUnstructuredGrid* grid, double time) {
  vtkNew<vtkDoubleArray> value = doubles("TimeValue", 1);  // the name that VTK's readers know
  value->InsertNextValue(time);
  grid->GetFieldData()->AddArray(value);
}

void add_names(vtkUnstructuredGrid* grid, const char* name, const std::vector<std::string>& names) {
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  for (const std::string& n : names) array->InsertNextValue(n);
  grid->GetFieldData()->AddArray(array);
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
    arrays_[0]->SetComponentName(0, "xx");
    arrays_[0]->SetComponentName(1, "yy");
    arrays_[0]->SetComponentName(2, "xy");
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

// The bodies of a frame: a rigid one is a cell, and so is an element.
class BodyGrid {
 public:
  BodyGrid(const Model& model, const FrameContents& frame) : model_(model), frame_(frame) {
    points_->SetDataTypeToDouble();
    for (const BodyQuantity& quantity : kBodyQuantities) {
      if (quantity.in_frames) quantities_.push_back({&quantity, doubles(quantity.name, 1)});
    }
    for (RigidIndex i = 0; i < static_cast<RigidIndex>(model.bodies.size()); ++i) add_rigid(i);
    const CauchyStress* stress = frame.stresses.data();
    for (DeformableIndex i = 0; i < static_cast<DeformableIndex>(model.deformables.size()); ++i) {
      add_deformable(i, stress);
      stress += model.deformables[i].mesh.element_count();
    }
  }

  vtkNew<vtkUnstructuredGrid> grid() {
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(points_);
    grid->SetCells(VTK_POLYGON, cells_);
    if (!model_.deformables.empty()) {
      of_cells_.add_to(grid->GetCellData());
      of_points_.add_to(grid->GetPointData());
    }
    grid->GetPointData()->AddArray(displacement_);
    grid->GetPointData()->AddArray(velocity_);
    for (vtkDataArray* array :
         std::initializer_list<vtkDataArray*>{body_, material_, rotation_, spin_, force_}) {
      grid->GetCellData()->AddArray(array);
    }
    for (const auto& [quantity, array] : quantities_) grid->GetCellData()->AddArray(array);
    add_time(grid, frame_.state.time);
    std::vector<std::string> names;
    const auto bodies = static_cast<BodyIndex>(model_.bodies.size() + model_.deformables.size());
    for (BodyIndex b = 0; b < bodies; ++b) names.push_back(model_.name_of(b));
    add_names(grid, "body_names", names);
    names.clear();
    for (const Material& m : model_.materials) names.push_back(m.name);
    add_names(grid, "material_names", names);
    return grid;
  }

 private:
  void add_rigid(RigidIndex i) {
    const RigidBody& body = model_.bodies[i];
    const auto x = frame_.state.pose(i), v = frame_.state.pose_rate(i);
    const Vec2 centre = x.head<2>();
    const auto turned = [](const Vec2& p, double angle) -> Vec2 {
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
    };
    cells_->InsertNextCell(body.potential.size());
    for (const Vec2& vertex : body.potential.vertices) {
      const Vec2 arm = turned(vertex, x[2]);
      const Vec2 u = (centre - body.position) + (arm - turned(vertex, body.angle));
      cells_->InsertCellPoint(add_point(centre + arm, u, v.head<2>() + cross(v[2], arm)));
      of_points_.add({});
    }
    const auto f = frame_.state.force(i);
    add_cell(i, x[2] - body.angle, v[2], f.head<2>(), {}, motion(i));
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
    const BodyMotion of_body = motion(b);
    for (ElementIndex e = 0; e < body.mesh.element_count(); ++e) {
      cells_->InsertNextCell(static_cast<int>(body.mesh.element(e).size()));
      for (const int node : body.mesh.element(e)) cells_->InsertCellPoint(first + node);
      add_cell(b, 0, 0, Vec2::Zero(), stress[e], of_body);
    }
  }

  [[nodiscard]] BodyMotion motion(BodyIndex body) const {
    return motion_of(model_, frame_.state, body, frame_.forces[body], frame_.node_mass);
  }

  vtkIdType add_point(const Vec2& place, const Vec2& u, const Vec2& v) {
    displacement_->InsertNextTuple3(u.x(), u.y(), 0);
    velocity_->InsertNextTuple3(v.x(), v.y(), 0);
    const Vec2 p = place + model_.origin;
    return points_->InsertNextPoint(p.x(), p.y(), 0);
  }

  void add_cell(BodyIndex body, double rotation, double spin, const Vec2& force,
                const CauchyStress& stress, const BodyMotion& of_body) {
    body_->InsertNextValue(body);
    material_->InsertNextValue(model_.material_of(body));
    rotation_->InsertNextValue(rotation);
    spin_->InsertNextValue(spin);
    force_->InsertNextTuple3(force.x(), force.y(), 0);
    of_cells_.add(stress);
    for (const auto& [quantity, array] : quantities_) {
      array->InsertNextValue(quantity->value(of_body));
    }
  }

  const Model& model_;
  const FrameContents& frame_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkIntArray> body_ = integers("body");
  vtkNew<vtkIntArray> material_ = integers("material");
  vtkNew<vtkDoubleArray> displacement_ = doubles("displacement", 3);
  vtkNew<vtkDoubleArray> velocity_ = doubles("velocity", 3);
  vtkNew<vtkDoubleArray> rotation_ = doubles("rotation", 1);
  vtkNew<vtkDoubleArray> spin_ = doubles("spin", 1);
  vtkNew<vtkDoubleArray> force_ = doubles("contact_force", 3);
  std::vector<std::pair<const BodyQuantity*, vtkSmartPointer<vtkDoubleArray>>> quantities_;
  StressArrays of_cells_, of_points_;
};

vtkNew<vtkUnstructuredGrid> patches(const Model& model, double time,
                                    const std::vector<ContactRecord>& contacts) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> a = integers("body_a");
  vtkNew<vtkIntArray> b = integers("body_b");
  vtkNew<vtkDoubleArray> force = doubles("force_on_a", 3);
  vtkNew<vtkDoubleArray> normal = doubles("normal_force_on_a", 3);
  vtkNew<vtkDoubleArray> tangential = doubles("tangential_force_on_a", 3);
  vtkNew<vtkDoubleArray> penetration = doubles("penetration", 1);
  vtkNew<vtkDoubleArray> phi = doubles("phi", 1);
  for (const ContactRecord& contact : contacts) {
    const Vec2 p = contact.point + model.origin;
    cells->InsertNextCell(1);
    cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
    a->InsertNextValue(contact.a);
    b->InsertNextValue(contact.b);
    for (const auto& [array, value] :
         {std::pair<vtkDoubleArray*, Vec2>(force, contact.normal + contact.tangential),
          {normal, contact.normal},
          {tangential, contact.tangential}}) {
      array->InsertNextTuple3(value.x(), value.y(), 0);
    }
    penetration->InsertNextValue(contact.penetration);
    phi->InsertNextValue(contact.phi);
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_VERTEX, cells);
  for (vtkDataArray* array :
       std::initializer_list<vtkDataArray*>{a, b, force, normal, tangential, penetration, phi}) {
    grid->GetPointData()->AddArray(array);
  }
  add_time(grid, time);
  return grid;
}

vtkNew<vtkUnstructuredGrid> boundaries(const Model& model, double time,
                                       const std::vector<SurfaceRecord>& surfaces) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> body = integers("body");
  vtkNew<vtkDoubleArray> pressure = doubles("contact_pressure", 1);
  vtkNew<vtkDoubleArray> traction = doubles("tangential_traction", 1);
  for (const SurfaceRecord& surface : surfaces) {
    cells->InsertNextCell(2);
    for (const Vec2& end : {surface.from, surface.to}) {
      const Vec2 p = end + model.origin;
      cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
    }
    body->InsertNextValue(surface.body);
    pressure->InsertNextValue(surface.pressure);
    traction->InsertNextValue(surface.traction);
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_LINE, cells);
  for (vtkDataArray* array : std::initializer_list<vtkDataArray*>{body, pressure, traction}) {
    grid->GetCellData()->AddArray(array);
  }
  add_time(grid, time);
  return grid;
}

std::string file_name(const char* series, size_t frame) {
  return fmt::format("frames/{}_{:06}.vtu", series, frame);
}

std::string collection(const char* series, const std::vector<double>& times) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  for (size_t i = 0; i < times.size(); ++i) {
    text += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", times[i],
                        file_name(series, i));
  }
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace

FrameWriter::FrameWriter(std::string folder, const Model& model, std::vector<double> times)
    : folder_(std::move(folder)), model_(model), times_(std::move(times)) {
  create_folder(folder_ + "/frames");
}

void FrameWriter::write(const FrameContents& frame) {
  const size_t number = times_.size();
  const double time = frame.state.time;
  write_file(folder_ + "/" + file_name("bodies", number), xml(BodyGrid(model_, frame).grid()));
  write_file(folder_ + "/" + file_name("contacts", number),
             xml(patches(model_, time, frame.contacts)));
  if (!frame.surfaces.empty()) {
    write_file(folder_ + "/" + file_name("surfaces", number),
               xml(boundaries(model_, time, frame.surfaces)));
  }
  times_.push_back(time);
  if (!frame.surfaces.empty()) {
    write_file(folder_ + "/surfaces.pvd", collection("surfaces", times_));
  }
  write_file(folder_ + "/frames.pvd", collection("bodies", times_));
  write_file(folder_ + "/contacts.pvd", collection("contacts", times_));
}

void write_mesh(const std::string& file, const PolygonMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec2& p : mesh.points) points->InsertNextPoint(p.x(), p.y(), 0);
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> index = integers("cell");
  vtkNew<vtkDoubleArray> area = doubles("area", 1);
  for (const std::vector<int>& cell : mesh.cells) {
    index->InsertNextValue(static_cast<int>(cells->GetNumberOfCells()));
    area->InsertNextValue(area_moments(Polygon(cell_ring(mesh, cell))).area);
    cells->InsertNextCell(static_cast<int>(cell.size()));
    for (const int node : cell) cells->InsertCellPoint(node);
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_POLYGON, cells);
  grid->GetCellData()->AddArray(index);
  grid->GetCellData()->AddArray(area);
  write_file(file, xml(grid));
}

}  // namespace apothem
