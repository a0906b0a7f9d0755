// Private header of the VTK writers: named arrays, and a grid as XML text.
#pragma once

#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <cstdlib>
#include <string>

namespace apothem {

/// An empty array of doubles with that name and number of components.
inline vtkNew<vtkDoubleArray> doubles(const char* name, int components) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  return array;
}

/// An empty array of integers with that name.
inline vtkNew<vtkIntArray> integers(const char* name) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  return array;
}

/// Has VTK use one thread in all that it does. It would wake others for the extremes of every
/// array, which takes longer than to find them.
inline void keep_to_one_thread() {
  // The function that says so needs headers of TBB.
  [[maybe_unused]] static const int sequential =
      setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", /*overwrite=*/0);
}

/// The grid as the text of a .vtu file. Data are base64 and zlib, which readers other than VTK's
/// accept as well.
inline std::string xml(vtkUnstructuredGrid* grid) {
  keep_to_one_thread();
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);  // higher ones take up to twice as long for 2 %
  writer->WriteToOutputStringOn();
  writer->Write();
  return writer->GetOutputString();
}

}  // namespace apothem
