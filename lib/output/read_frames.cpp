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
#include "apothem/output/convex_cells.hpp"
#include "apothem/output/files.hpp"
#include "apothem/output/vtk_grid.hpp"

namespace apothem {
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
  // Only scenes with meshes have stresses.
  vtkDataArray* stress = grid->GetCellData()->GetArray("stress");
  vtkDataArray* across = stress ? array(grid->GetCellData(), "stress_zz") : nullptr;
  vtkDataArray* part = array(grid->GetCellData(), "part");
  vtkNew<vtkIdList> corners;
  std::vector<std::vector<int>> parts;  // of the body or element at hand
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    grid->GetCellPoints(c, corners);
    parts.emplace_back(corners->begin(), corners->end());
    if (c + 1 < grid->GetNumberOfCells() && part->GetTuple1(c + 1) > 0) continue;
    frame.mesh.add_element(joined(parts));
    parts.clear();
    frame.body.push_back(static_cast<int>(body->GetTuple1(c)));
    if (!stress) {
      frame.stress.emplace_back();
      continue;
    }
    frame.stress.push_back({stress->GetComponent(c, 0), stress->GetComponent(c, 1),
                            stress->GetComponent(c, 2), across->GetTuple1(c)});
  }
  return frame;
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

}  // namespace apothem
