#include "lib/output/frames.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <array>
#include <atomic>
#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "lib/mesh/boundary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/rotation.hpp"
#include "lib/output/convex_cells.hpp"
#include "lib/output/files.hpp"
#include "lib/output/force_lines.hpp"
#include "lib/output/vtk_grid.hpp"

namespace apothem {
namespace {

constexpr double kFileTime = 1e5;  // of a small file, ns

void add_time(vtkUnstructuredGrid* grid, double time) {
  vtkNew<vtkDoubleArray> value = doubles("TimeValue", 1);  // the name that VTK's readers know
  value->InsertNextValue(time);
  grid->GetFieldData()->AddArray(value);
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

using Cells = std::vector<std::vector<int>>;

// The bodies of a frame: a rigid one is a cell, and so is an element, or several if it is not
// convex. `rigid_cells` are those of the rigid bodies that are not convex.
class BodyGrid {
 public:
  BodyGrid(const Model& model, const FrameContents& frame,
           const std::map<RigidIndex, Cells>& rigid_cells)
      : model_(model), frame_(frame), rigid_cells_(rigid_cells) {
    points_->SetDataTypeToDouble();
    for (const BodyQuantity& quantity : kBodyQuantities) {
      if (quantity.in_frames) quantities_.push_back({&quantity, doubles(quantity.name, 1)});
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
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(points_);
    grid->SetCells(VTK_POLYGON, cells_);
    if (!model_.deformables.empty()) {
      of_cells_.add_to(grid->GetCellData());
      of_points_.add_to(grid->GetPointData());
    }
    mean_stress_->SetComponentName(0, "xx");
    mean_stress_->SetComponentName(1, "yy");
    mean_stress_->SetComponentName(2, "xy");
    grid->GetPointData()->AddArray(displacement_);
    grid->GetPointData()->AddArray(velocity_);
    for (vtkDataArray* array : of_cells()) grid->GetCellData()->AddArray(array);
    add_time(grid, frame_.state.time);
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
    std::vector<vtkDataArray*> arrays{body_, part_,  material_,     motion_,     rotation_,
                                      spin_, force_, coordination_, mean_stress_};
    for (const auto& [quantity, array] : quantities_) arrays.push_back(array);
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
    const BodyMotion of_body = motion(i);
    const auto add = [&](size_t part, const auto& corners) {
      add_corners(corners, [&](int corner) { return first + corner; });
      add_cell(i, part, body.material, body.motion, x[2] - body.angle, {}, of_body);
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
    const BodyMotion of_body = motion(b);
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
        add_cell(b, part, body.material_of(e), Motion::free, of_body.angle, stress[e], of_body);
      }
    }
  }

  template <class Corners, class PointOf>
  void add_corners(const Corners& corners, const PointOf& point_of) {
    cells_->InsertNextCell(static_cast<int>(corners.size()));
    for (const int corner : corners) cells_->InsertCellPoint(point_of(corner));
  }

  [[nodiscard]] BodyMotion motion(BodyIndex body) const {
    return motion_of(model_, frame_.state, body, frame_.forces[body], frame_.node_mass);
  }

  void add_point(const Vec2& place, const Vec2& u, const Vec2& v) {
    displacement_->InsertNextTuple3(u.x(), u.y(), 0);
    velocity_->InsertNextTuple3(v.x(), v.y(), 0);
    const Vec2 p = place + model_.origin;
    points_->InsertNextPoint(p.x(), p.y(), 0);
  }

  void add_cell(BodyIndex body, size_t part, MaterialIndex material, Motion motion, double rotation,
                const CauchyStress& stress, const BodyMotion& of_body) {
    body_->InsertNextValue(body);
    part_->InsertNextValue(static_cast<int>(part));
    material_->InsertNextValue(material);
    motion_->InsertNextValue(static_cast<int>(motion));
    rotation_->InsertNextValue(rotation);
    spin_->InsertNextValue(of_body.spin);
    force_->InsertNextTuple3(of_body.contact.fx, of_body.contact.fy, 0);
    if (!model_.deformables.empty()) of_cells_.add(stress);
    const BodyStatistics own =
        frame_.bodies.empty() ? BodyStatistics() : frame_.bodies[static_cast<size_t>(body)];
    coordination_->InsertNextValue(own.coordination);
    mean_stress_->InsertNextTuple3(own.stress.xx, own.stress.yy, own.stress.xy);
    for (const auto& [quantity, array] : quantities_) {
      array->InsertNextValue(quantity->value(of_body));
    }
  }

  const Model& model_;
  const FrameContents& frame_;
  const std::map<RigidIndex, Cells>& rigid_cells_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkIntArray> body_ = integers("body");
  vtkNew<vtkIntArray> part_ = integers("part");
  vtkNew<vtkIntArray> material_ = integers("material");
  vtkNew<vtkIntArray> motion_ = integers("motion");  // as the enumeration Motion counts
  vtkNew<vtkDoubleArray> displacement_ = doubles("displacement", 3);
  vtkNew<vtkDoubleArray> velocity_ = doubles("velocity", 3);
  vtkNew<vtkDoubleArray> rotation_ = doubles("rotation", 1);
  vtkNew<vtkDoubleArray> spin_ = doubles("spin", 1);
  vtkNew<vtkDoubleArray> force_ = doubles("contact_force", 3);
  vtkNew<vtkIntArray> coordination_ = integers("coordination");
  vtkNew<vtkDoubleArray> mean_stress_ = doubles("mean_stress", 3);
  std::vector<std::pair<const BodyQuantity*, vtkSmartPointer<vtkDoubleArray>>> quantities_;
  StressArrays of_cells_, of_points_;
};

// The lines around all bodies: around the polygon of a rigid one, and along each of the `loops`
// around a mesh. Each edge is a cell, because not all readers know lines of several edges.
vtkNew<vtkUnstructuredGrid> outlines(const Model& model, const State& state,
                                     const std::vector<Cells>& loops) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
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
    const std::vector<Vec2>& vertices = model.bodies[i].potential.vertices;
    const auto pose = state.pose(i);
    const Vec2 centre = pose.head<2>();
    const double angle = pose[2];
    add(i, vertices.size(), [&](size_t k) { return Vec2(centre + turned(vertices[k], angle)); });
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
  grid->SetPoints(points);
  grid->SetCells(VTK_LINE, cells);
  grid->GetCellData()->AddArray(of_cells);
  add_time(grid, state.time);
  return grid;
}

// A quantity of a contact patch in the frames. Scalars stand in x.
struct PatchQuantity {
  const char* name;
  bool is_vector;
  Vec2 (*value)(const ContactRecord&);
};
constexpr std::array kPatchQuantities{
    PatchQuantity{
        "force_on_a", true,
        [](const ContactRecord& c) -> Vec2 { return c.normal + c.damping + c.tangential; }},
    PatchQuantity{"normal_force_on_a", true,
                  [](const ContactRecord& c) -> Vec2 { return c.normal + c.damping; }},
    PatchQuantity{"damping_force_on_a", true, [](const ContactRecord& c) { return c.damping; }},
    PatchQuantity{"tangential_force_on_a", true,
                  [](const ContactRecord& c) { return c.tangential; }},
    PatchQuantity{"penetration", false,
                  [](const ContactRecord& c) { return Vec2(c.penetration, 0); }},
    PatchQuantity{"phi", false, [](const ContactRecord& c) { return Vec2(c.phi, 0); }}};

vtkNew<vtkUnstructuredGrid> patches(const Model& model, double time,
                                    const std::vector<ContactRecord>& contacts) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> a = integers("body_a");
  vtkNew<vtkIntArray> b = integers("body_b");
  for (const ContactRecord& contact : contacts) {
    const Vec2 p = contact.point + model.origin;
    cells->InsertNextCell(1);
    cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
    a->InsertNextValue(contact.a);
    b->InsertNextValue(contact.b);
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_VERTEX, cells);
  grid->GetPointData()->AddArray(a);
  grid->GetPointData()->AddArray(b);
  for (const PatchQuantity& quantity : kPatchQuantities) {
    vtkNew<vtkDoubleArray> values = doubles(quantity.name, quantity.is_vector ? 3 : 1);
    for (const ContactRecord& contact : contacts) {
      const Vec2 value = quantity.value(contact);
      if (quantity.is_vector) {
        values->InsertNextTuple3(value.x(), value.y(), 0);
      } else {
        values->InsertNextValue(value.x());
      }
    }
    grid->GetPointData()->AddArray(values);
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

// Calls write(i) for i below `count`, which a thread takes when it is free. Throws what the first
// of those threw that have failed; no other one is begun after a failure.
template <class Write>
void work_on(const Threads& threads, size_t count, const Write& write) {
  keep_to_one_thread();  // before there are several, since it changes the environment
  std::vector<std::exception_ptr> failures(count);
  std::atomic<size_t> next = 0;
  std::atomic<bool> failed = false;
  threads.chunks(threads.count(), kFileTime, [&](int, int, int) {
    for (size_t i = next++; i < count && !failed; i = next++) {
      try {
        write(i);
      } catch (...) {
        failures[i] = std::current_exception();
        failed = true;
      }
    }
  });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

std::string csv_text(const std::string& name) {
  std::string result = "\"";
  for (const char c : name) result.append(c == '"' ? 2 : 1, c);
  return result + '"';
}

// The names of the bodies and materials that frames number. Frames hold numbers only, because not
// all readers of VTK files read text in them.
std::string names_table(const Model& model) {
  std::string text = "kind,number,name\n";
  const size_t rigid = model.bodies.size();
  for (size_t i = 0; i < rigid + model.deformables.size(); ++i) {
    text += fmt::format("{},{},{}\n", i < rigid ? "rigid_body" : "deformable_body", i,
                        csv_text(model.name_of(static_cast<BodyIndex>(i))));
  }
  for (size_t i = 0; i < model.materials.size(); ++i) {
    text += fmt::format("material,{},{}\n", i, csv_text(model.materials[i].name));
  }
  return text;
}

// The names of all series of files that frames have.
constexpr std::array kSeries{"bodies", "contacts", "chains", "outlines", "roses", "surfaces"};

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

FrameWriter::FrameWriter(std::string folder, const Model& model, std::vector<double> times,
                         int threads, FileList* list)
    : folder_(std::move(folder)),
      model_(model),
      threads_(threads),
      times_(std::move(times)),
      list_(list) {
  create_folder(folder_ + "/frames");
  write_file(folder_ + "/names.csv", names_table(model_));
  for (RigidIndex i = 0; i < static_cast<RigidIndex>(model_.bodies.size()); ++i) {
    Cells cells = convex_cells(model_.bodies[i].potential.vertices);
    if (cells.size() > 1 || cells[0].size() < model_.bodies[i].potential.vertices.size()) {
      cells_[i] = std::move(cells);
    }
  }
  for (const DeformableBody& body : model_.deformables) {
    Cells& loops = loops_.emplace_back();
    for (BoundaryLoop& loop : boundary(body.mesh).loops) loops.push_back(std::move(loop.nodes));
  }
}

void FrameWriter::write(const FrameContents& frame) {
  const size_t number = times_.size();
  const double time = frame.state.time;
  struct Series {
    const char* name;
    std::function<std::string()> text;
  };
  const auto lines = [&](vtkUnstructuredGrid* grid) {
    add_time(grid, time);
    return xml(grid);
  };
  // Those that take longest begin first.
  std::vector<Series> all{{"bodies", [&] { return xml(BodyGrid(model_, frame, cells_).grid()); }},
                          {"contacts", [&] { return xml(patches(model_, time, frame.contacts)); }},
                          {"chains", [&] { return lines(force_chains(model_, frame)); }},
                          {"outlines", [&] { return xml(outlines(model_, frame.state, loops_)); }}};
  if (!model_.regions.empty()) {
    all.push_back({"roses", [&] { return lines(roses(model_, frame)); }});
  }
  if (!frame.surfaces.empty()) {
    all.push_back({"surfaces", [&] { return xml(boundaries(model_, time, frame.surfaces)); }});
  }
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const Series& series : all) names.push_back(file_name(series.name, number));
  if (list_) list_->add(names);
  work_on(threads_, all.size(),
          [&](size_t i) { write_file(folder_ + "/" + names[i], all[i].text()); });
  fresh_.insert(fresh_.end(), names.begin(), names.end());
  times_.push_back(time);
  if (!frame.surfaces.empty()) {
    write_file(folder_ + "/surfaces.pvd", collection("surfaces", times_));
  }
  write_file(folder_ + "/frames.pvd", collection("bodies", times_));
  write_file(folder_ + "/outlines.pvd", collection("outlines", times_));
  write_file(folder_ + "/contacts.pvd", collection("contacts", times_));
  write_file(folder_ + "/chains.pvd", collection("chains", times_));
  if (!model_.regions.empty()) write_file(folder_ + "/roses.pvd", collection("roses", times_));
}

void FrameWriter::make_last() {
  if (fresh_.empty()) return;
  std::error_code ignored;
  for (const std::string& name : fresh_) {
    const std::string file = folder_ + "/" + name;
    if (std::filesystem::exists(file, ignored)) apothem::make_last(file);
  }
  apothem::make_last(folder_ + "/frames");
  fresh_.clear();
}

bool is_frame_file(const std::string& name) {
  constexpr std::string_view kDigits = "0123456789", kStart = "frames/", kEnd = ".vtu";
  if (!name.starts_with(kStart) || !name.ends_with(kEnd)) return false;
  const size_t line = name.rfind('_');
  if (line == std::string::npos || line < kStart.size()) return false;
  const std::string series = name.substr(kStart.size(), line - kStart.size());
  const std::string number = name.substr(line + 1, name.size() - kEnd.size() - line - 1);
  return std::ranges::find(kSeries, series) != kSeries.end() && number.size() >= 6 &&
         number.find_first_not_of(kDigits) == std::string::npos;
}

void write_mesh(const std::string& file, const PolygonMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const Vec2& p : mesh.points) points->InsertNextPoint(p.x(), p.y(), 0);
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> index = integers("cell");
  vtkNew<vtkIntArray> part = integers("part");
  vtkNew<vtkDoubleArray> area = doubles("area", 1);
  for (size_t i = 0; i < mesh.cells.size(); ++i) {
    const std::vector<Vec2> ring = cell_ring(mesh, mesh.cells[i]);
    const double of_cell = area_moments(Polygon(ring)).area;
    const Cells parts = convex_cells(ring);
    for (size_t k = 0; k < parts.size(); ++k) {
      index->InsertNextValue(static_cast<int>(i));
      part->InsertNextValue(static_cast<int>(k));
      area->InsertNextValue(of_cell);
      cells->InsertNextCell(static_cast<int>(parts[k].size()));
      for (const int corner : parts[k]) cells->InsertCellPoint(mesh.cells[i][corner]);
    }
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_POLYGON, cells);
  grid->GetCellData()->AddArray(index);
  grid->GetCellData()->AddArray(part);
  grid->GetCellData()->AddArray(area);
  write_file(file, xml(grid));
}

}  // namespace apothem
