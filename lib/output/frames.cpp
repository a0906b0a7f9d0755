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

vtkNew<vtkUnstructuredGrid> bodies(const Model& model, const State& state,
                                   const std::vector<CauchyStress>& stresses) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> body_id = integers("body");
  vtkNew<vtkIntArray> material = integers("material");
  vtkNew<vtkDoubleArray> displacement = doubles("displacement", 3);
  vtkNew<vtkDoubleArray> velocity = doubles("velocity", 3);
  vtkNew<vtkDoubleArray> rotation = doubles("rotation", 1);
  vtkNew<vtkDoubleArray> spin = doubles("spin", 1);
  vtkNew<vtkDoubleArray> force = doubles("contact_force", 3);
  StressArrays of_cells, of_points;
  std::vector<std::string> names;
  for (size_t i = 0; i < model.bodies.size(); ++i) {
    const RigidBody& body = model.bodies[i];
    const double* x = &state.position[3 * i];
    const double* v = &state.velocity[3 * i];
    const Vec2 centre(x[0], x[1]);
    const auto turned = [](const Vec2& p, double angle) -> Vec2 {
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      return {c * p.x() - s * p.y(), s * p.x() + c * p.y()};
    };
    cells->InsertNextCell(body.potential.size());
    for (const Vec2& vertex : body.potential.vertices) {
      const Vec2 arm = turned(vertex, x[2]);
      const Vec2 u = (centre - body.position) + (arm - turned(vertex, body.angle));
      const Vec2 w = Vec2(v[0], v[1]) + cross(v[2], arm);
      const Vec2 p = centre + arm + model.origin;
      cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
      displacement->InsertNextTuple3(u.x(), u.y(), 0);
      velocity->InsertNextTuple3(w.x(), w.y(), 0);
      of_points.add({});
    }
    of_cells.add({});
    body_id->InsertNextValue(static_cast<int>(i));
    material->InsertNextValue(body.material);
    rotation->InsertNextValue(x[2] - body.angle);
    spin->InsertNextValue(v[2]);
    force->InsertNextTuple3(state.force[3 * i], state.force[3 * i + 1], 0);
    names.push_back(body.name);
  }
  const CauchyStress* stress = stresses.data();
  for (const DeformableBody& body : model.deformables) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      const size_t c = 2 * (body.first_node + i);
      const Vec2 u(state.displacement[c], state.displacement[c + 1]);
      const Vec2 p = body.mesh.nodes[i] + u + model.origin;
      points->InsertNextPoint(p.x(), p.y(), 0);
      displacement->InsertNextTuple3(u.x(), u.y(), 0);
      velocity->InsertNextTuple3(state.node_velocity[c], state.node_velocity[c + 1], 0);
    }
    for (const CauchyStress& s : nodal_means(body, stress)) of_points.add(s);
    for (int e = 0; e < body.mesh.element_count(); ++e, ++stress) {
      cells->InsertNextCell(static_cast<int>(body.mesh.element(e).size()));
      for (const int node : body.mesh.element(e)) cells->InsertCellPoint(first + node);
      body_id->InsertNextValue(static_cast<int>(names.size()));
      material->InsertNextValue(body.material);
      rotation->InsertNextValue(0);
      spin->InsertNextValue(0);
      force->InsertNextTuple3(0, 0, 0);
      of_cells.add(*stress);
    }
    names.push_back(body.name);
  }
  grid->SetPoints(points);
  grid->SetCells(VTK_POLYGON, cells);
  if (!model.deformables.empty()) {
    of_cells.add_to(grid->GetCellData());
    of_points.add_to(grid->GetPointData());
  }
  grid->GetPointData()->AddArray(displacement);
  grid->GetPointData()->AddArray(velocity);
  for (vtkDataArray* array :
       std::initializer_list<vtkDataArray*>{body_id, material, rotation, spin, force}) {
    grid->GetCellData()->AddArray(array);
  }
  add_time(grid, state.time);
  add_names(grid, "body_names", names);
  names.clear();
  for (const Material& m : model.materials) names.push_back(m.name);
  add_names(grid, "material_names", names);
  return grid;
}

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

namespace {

// Throws std::runtime_error for a missing file, for which VTK would print its own message.
void require_file(const std::string& file) {
  if (!std::filesystem::exists(file)) throw std::runtime_error(file + ": there is no such file");
}

// Time and file of the first frame of a series not before `time` and not after `latest`, s. Throws
// std::runtime_error if there is none.
std::pair<double, std::string> frame_file(const std::string& folder, const char* series,
                                          double time, double latest) {
  const std::string file = fmt::format("{}/{}.pvd", folder, series);
  require_file(file);
  vtkSmartPointer<vtkXMLDataElement> document;
  document.TakeReference(vtkXMLUtilities::ReadElementFromFile(file.c_str()));
  vtkXMLDataElement* list = document ? document->FindNestedElementWithName("Collection") : nullptr;
  if (!list) throw std::runtime_error(file + ": cannot be read");
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* entry = list->GetNestedElement(i);
    double at = 0;
    if (!entry->GetScalarAttribute("timestep", at) || !entry->GetAttribute("file")) continue;
    if (at < time - 1e-6 * (latest - time) || at > latest) continue;
    const std::string frame = folder + "/" + entry->GetAttribute("file");
    require_file(frame);
    return {at, frame};
  }
  throw std::runtime_error(fmt::format("{}: there is no frame at {} s", folder, time));
}

// The array with that name. Throws std::runtime_error if there is none.
vtkDataArray* array_of(vtkDataSetAttributes* data, const char* name, const std::string& file) {
  vtkDataArray* found = data->GetArray(name);
  if (!found) throw std::runtime_error(fmt::format("{}: has no array \"{}\"", file, name));
  return found;
}

}  // namespace

Frame read_frame(const std::string& folder, double time, double latest) {
  Frame frame;
  std::string file;
  std::tie(frame.time, file) = frame_file(folder, "frames", time, latest);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  const auto array = [&](vtkDataSetAttributes* data, const char* name) {
    return array_of(data, name, file);
  };
  const auto vectors = [&](const char* name) {
    vtkDataArray* values = array(grid->GetPointData(), name);
    std::vector<Vec2> result;
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) {
      result.emplace_back(values->GetComponent(i, 0), values->GetComponent(i, 1));
    }
    return result;
  };
  frame.displacement = vectors("displacement");
  frame.velocity = vectors("velocity");
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    const double* p = grid->GetPoint(i);
    frame.mesh.nodes.emplace_back(Vec2(p[0], p[1]) - frame.displacement[i]);
  }
  vtkDataArray* body = array(grid->GetCellData(), "body");
  vtkDataArray* stress = array(grid->GetCellData(), "stress");
  vtkDataArray* across = array(grid->GetCellData(), "stress_zz");
  vtkNew<vtkIdList> corners;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    grid->GetCellPoints(c, corners);
    frame.mesh.add_element(std::vector<int>(corners->begin(), corners->end()));
    frame.body.push_back(static_cast<int>(body->GetTuple1(c)));
    frame.stress.push_back({stress->GetComponent(c, 0), stress->GetComponent(c, 1),
                            stress->GetComponent(c, 2), across->GetTuple1(c)});
  }
  return frame;
}

FrameWriter::FrameWriter(std::string folder, const Model& model, std::vector<double> times)
    : folder_(std::move(folder)), model_(model), times_(std::move(times)) {
  create_folder(folder_ + "/frames");
}

void FrameWriter::write(const State& state, const std::vector<ContactRecord>& contacts,
                        const std::vector<CauchyStress>& stresses,
                        const std::vector<SurfaceRecord>& surfaces) {
  const size_t frame = times_.size();
  write_file(folder_ + "/" + file_name("bodies", frame), xml(bodies(model_, state, stresses)));
  write_file(folder_ + "/" + file_name("contacts", frame),
             xml(patches(model_, state.time, contacts)));
  if (!surfaces.empty()) {
    write_file(folder_ + "/" + file_name("surfaces", frame),
               xml(boundaries(model_, state.time, surfaces)));
  }
  times_.push_back(state.time);
  if (!surfaces.empty()) {
    write_file(folder_ + "/surfaces.pvd", collection("surfaces", times_));
  }
  write_file(folder_ + "/frames.pvd", collection("bodies", times_));
  write_file(folder_ + "/contacts.pvd", collection("contacts", times_));
}

std::vector<SurfaceRecord> read_surfaces(const std::string& folder, double time, double latest) {
  const std::string file = frame_file(folder, "surfaces", time, latest).second;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  vtkDataArray* body = array_of(grid->GetCellData(), "body", file);
  vtkDataArray* pressure = array_of(grid->GetCellData(), "contact_pressure", file);
  vtkDataArray* traction = array_of(grid->GetCellData(), "tangential_traction", file);
  std::vector<SurfaceRecord> surfaces;
  vtkNew<vtkIdList> ends;
  const auto end = [&](vtkIdType i) {
    const double* p = grid->GetPoint(ends->GetId(i));
    return Vec2(p[0], p[1]);
  };
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    grid->GetCellPoints(c, ends);
    surfaces.push_back({static_cast<int>(body->GetTuple1(c)), end(0), end(1),
                        pressure->GetTuple1(c), traction->GetTuple1(c)});
  }
  return surfaces;
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
