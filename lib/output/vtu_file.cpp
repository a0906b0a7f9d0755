#include "lib/output/vtu_file.hpp"

#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string_view>

#include "lib/output/run_folder.hpp"
#include "lib/output/vtk_grid.hpp"
#include "lib/system/input_file.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

constexpr size_t kMostComponents = 64, kMostInCharacter = 1000;

// For a missing file VTK would print a message of its own.
void require_file(const std::string& file) {
  if (!std::filesystem::exists(file)) throw ResultsError(file + ": there is no such file");
  const std::string refusal = refusal_of_input(file);
  if (!refusal.empty()) throw ResultsError(file + ": " + refusal);
}

// Counts the errors of a reader in place of printing them.
class Errors {
 public:
  Errors() {
    command_->SetClientData(&count_);
    command_->SetCallback(
        [](vtkObject*, unsigned long, void* count, void*) { ++*static_cast<int*>(count); });
  }
  [[nodiscard]] vtkCommand* observer() const { return command_; }
  [[nodiscard]] bool none() const { return count_ == 0; }

 private:
  int count_ = 0;
  vtkNew<vtkCallbackCommand> command_;
};

ResultsError damaged(const std::string& file) {
  return ResultsError(file + ": is no VTK file, or a damaged one");
}

// The value of an attribute in a tag, empty if there is none.
std::string_view attribute(std::string_view tag, std::string_view name) {
  const size_t at = tag.find(name);
  if (at == std::string_view::npos) return {};
  const size_t begin = at + name.size(), end = tag.find('"', begin);
  return end == std::string_view::npos ? std::string_view() : tag.substr(begin, end - begin);
}

// Whether an attribute is not there or a number from 0 to `most`.
bool is_count(std::string_view tag, std::string_view name, size_t most) {
  if (tag.find(name) == std::string_view::npos) return true;
  const auto value = find_integer<size_t>(attribute(tag, name));
  return value && *value <= most;
}

// VTK's reader does not survive an array of a kind that it does not know, or numbers of items that
// are none.
void require_known_arrays(const std::string& file) {
  static const std::set<std::string_view> known{"Int8",    "Int16",   "Int32",  "Int64",
                                                "UInt8",   "UInt16",  "UInt32", "UInt64",
                                                "Float32", "Float64", "String", "Bit"};
  const std::string text = read_bytes(file);
  const auto each = [&](std::string_view name, const auto& judge) {
    for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
      const size_t end = std::min(text.find('>', at), text.size());
      if (!judge(std::string_view(text).substr(at, end - at))) throw damaged(file);
    }
  };
  each("Array ", [&](std::string_view tag) {
    return known.contains(attribute(tag, " type=\"")) &&
           is_count(tag, " NumberOfComponents=\"", kMostComponents) &&
           is_count(tag, " NumberOfTuples=\"", text.size());
  });
  // Every point and every cell has numbers of its own, of which a file packs a few hundred in a
  // character at most.
  each("<Piece ", [&](std::string_view tag) {
    return is_count(tag, " NumberOfPoints=\"", kMostInCharacter * text.size()) &&
           is_count(tag, " NumberOfCells=\"", kMostInCharacter * text.size());
  });
}

// The arrays that tell where the corners of each cell begin in the list of all corners.
void require_order(const std::string& file, vtkUnstructuredGrid* grid) {
  vtkCellArray* const cells = grid->GetCells();
  vtkDataArray* const offsets = cells ? cells->GetOffsetsArray() : nullptr;
  if (!offsets || offsets->GetNumberOfTuples() != grid->GetNumberOfCells() + 1) {
    throw damaged(file);
  }
  double before = 0;
  for (vtkIdType c = 0; c < offsets->GetNumberOfTuples(); ++c) {
    const double offset = offsets->GetComponent(c, 0);
    if (offset < before || offset > static_cast<double>(cells->GetNumberOfConnectivityIds())) {
      throw damaged(file);
    }
    before = offset;
  }
}

FileArray array_of(vtkDataArray* data) {
  FileArray array{data->GetNumberOfComponents(), {}};
  const vtkIdType count = data->GetNumberOfValues();
  if (auto* reals = vtkDoubleArray::SafeDownCast(data)) {
    array.values.assign(reals->GetPointer(0), reals->GetPointer(0) + count);
    return array;
  }
  array.values.reserve(static_cast<size_t>(count));
  for (vtkIdType i = 0; i < data->GetNumberOfTuples(); ++i) {
    for (int k = 0; k < array.components; ++k) array.values.push_back(data->GetComponent(i, k));
  }
  return array;
}

GridFile::Arrays arrays_of(vtkFieldData* data) {
  GridFile::Arrays arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = data->GetArray(i);  // null where it has no numbers
    if (array && array->GetName()) arrays[array->GetName()] = array_of(array);
  }
  return arrays;
}

const FileArray& find(const GridFile& file, const GridFile::Arrays& arrays, const char* name,
                      int components, size_t count) {
  static const FileArray nothing;
  const auto found = arrays.find(name);
  if (found != arrays.end() && found->second.components >= components &&
      found->second.values.size() >= count * static_cast<size_t>(found->second.components)) {
    return found->second;
  }
  if (file.cells() == 0) return nothing;  // VTK may leave out arrays without values
  throw ResultsError(fmt::format(
      "{}: has no array \"{}\"; it is no frame of a run, or one of an older version of the program",
      file.name, name));
}

}  // namespace

std::vector<Vec2> GridFile::line(size_t c) const {
  std::vector<Vec2> places;
  for (int i = first[c]; i < first[c + 1]; ++i) places.push_back(points[corners[i]]);
  return places;
}

const FileArray& GridFile::point_array(const char* array, int components) const {
  return find(*this, of_points, array, components, points.size());
}

const FileArray& GridFile::cell_array(const char* array, int components) const {
  return find(*this, of_cells, array, components, cells());
}

GridFile read_vtu(const std::string& file) {
  require_file(file);
  require_known_arrays(file);
  keep_vtk_silent();
  const Errors errors;
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  for (const unsigned long event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent}) {
    reader->AddObserver(event, errors.observer());
  }
  reader->SetReaderErrorObserver(errors.observer());
  reader->SetParserErrorObserver(errors.observer());
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, errors.observer());
  reader->SetFileName(file.c_str());
  reader->Update();
  if (!errors.none()) throw damaged(file);
  vtkUnstructuredGrid* grid = reader->GetOutput();
  if (grid->GetNumberOfCells() > 0) require_order(file, grid);
  GridFile result;
  result.name = file;
  const auto count = static_cast<size_t>(grid->GetNumberOfPoints());
  result.points.reserve(count);
  if (count > 0) {
    const FileArray places = array_of(grid->GetPoints()->GetData());
    for (size_t i = 0; i < count; ++i) result.points.push_back(places.vector(i));
  }
  // A file without points has a cell for readers that need one, see vtk_grid.hpp.
  const auto cells = count > 0 ? static_cast<size_t>(grid->GetNumberOfCells()) : 0;
  result.first.reserve(cells + 1);
  const vtkIdType* corners = nullptr;
  for (size_t c = 0; c < cells; ++c) {
    vtkIdType of_cell = 0;
    grid->GetCellPoints(static_cast<vtkIdType>(c), of_cell, corners);
    for (vtkIdType k = 0; k < of_cell; ++k) {
      if (corners[k] < 0 || corners[k] >= static_cast<vtkIdType>(count)) throw damaged(file);
      result.corners.push_back(static_cast<int>(corners[k]));
    }
    result.first.push_back(static_cast<int>(result.corners.size()));
  }
  result.of_points = arrays_of(grid->GetPointData());
  result.of_cells = arrays_of(grid->GetCellData());
  result.of_file = arrays_of(grid->GetFieldData());
  return result;
}

std::vector<std::pair<double, std::string>> read_pvd(const std::string& file) {
  require_file(file);
  const Errors errors;
  vtkNew<vtkXMLDataParser> parser;
  parser->AddObserver(vtkCommand::ErrorEvent, errors.observer());
  parser->SetFileName(file.c_str());
  const bool parsed = parser->Parse() != 0;
  vtkXMLDataElement* root = parsed ? parser->GetRootElement() : nullptr;
  vtkXMLDataElement* list = root ? root->FindNestedElementWithName("Collection") : nullptr;
  if (!list) throw ResultsError(file + ": is no VTK collection, or a damaged one");
  std::vector<std::pair<double, std::string>> entries;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* entry = list->GetNestedElement(i);
    double time = 0;
    if (!entry->GetScalarAttribute("timestep", time) || !entry->GetAttribute("file")) continue;
    entries.emplace_back(time, entry->GetAttribute("file"));
  }
  return entries;
}

}  // namespace apothem
