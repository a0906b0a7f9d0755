// Private header of the files that use VTK: named arrays, and a grid as XML text.
#pragma once

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkErrorCode.h>
#include <vtkIntArray.h>
#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cstdlib>
#include <new>
#include <string>

namespace apothem {

/// An empty array of doubles with that name and number of components.
inline vtkNew<vtkDoubleArray> doubles(const char* name, int components) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  return array;
}

/// An empty list of points in double precision.
inline vtkNew<vtkPoints> double_points() {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  return points;
}

/// An empty array of integers with that name.
inline vtkNew<vtkIntArray> integers(const char* name) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  return array;
}

/// A grid of cells of one kind. The arrays have a value for each cell.
inline vtkNew<vtkUnstructuredGrid> grid_of(vtkPoints* points, int kind, vtkCellArray* cells,
                                           std::initializer_list<vtkDataArray*> of_cells = {}) {
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(points);
  grid->SetCells(kind, cells);
  for (vtkDataArray* array : of_cells) grid->GetCellData()->AddArray(array);
  return grid;
}

/// Has VTK print nothing: what has failed is said by an exception.
inline void keep_vtk_silent() { vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF); }

/// Has VTK use one thread in all that it does. It would wake others for the extremes of every
/// array, which takes longer than to find them.
inline void keep_to_one_thread() {
  // The function that says so needs headers of TBB.
  [[maybe_unused]] static const int sequential =
      setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", /*overwrite=*/0);
}

/// Gives a grid without cells a polygon without points, because meshio reads no file without cells.
/// Its integers are -1 and its other values 0.
inline void add_cell_without_points(vtkUnstructuredGrid* grid) {
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(0);
  grid->SetCells(VTK_POLYGON, cells);
  for (int i = 0; i < grid->GetCellData()->GetNumberOfArrays(); ++i) {
    vtkDataArray* array = grid->GetCellData()->GetArray(i);
    array->SetNumberOfTuples(1);
    array->Fill(vtkIntArray::SafeDownCast(array) ? -1 : 0);
  }
}

/// The grid as the text of a .vtu file. Data are base64 and zlib, which readers other than VTK's
/// accept as well, or text where there are none.
inline std::string xml(vtkUnstructuredGrid* grid) {
  keep_to_one_thread();
  keep_vtk_silent();
  if (grid->GetNumberOfCells() == 0) add_cell_without_points(grid);
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  grid->GetNumberOfPoints() > 0 ? writer->SetDataModeToBinary() : writer->SetDataModeToAscii();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);  // higher ones take up to twice as long for 2 %
  writer->WriteToOutputStringOn();
  writer->Write();
  // A text can only fail for lack of memory. Zlib says so, and VTK passes it on as an error.
  if (writer->GetErrorCode() != vtkErrorCode::NoError) throw std::bad_alloc();
  return writer->GetOutputString();
}

}  // namespace apothem
