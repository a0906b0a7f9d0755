// Private to the writers of VTK files: arrays with a name, a grid as text.
#pragma once

#include <vtkDoubleArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <string>

namespace apothem {

inline vtkNew<vtkDoubleArray> doubles(const char* name, int components) {
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  return array;
}

inline vtkNew<vtkIntArray> integers(const char* name) {
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  return array;
}

/// XML as text: base64 and zlib, so that other readers than VTK's take it as well.
inline std::string xml(vtkUnstructuredGrid* grid) {
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToZLib();
  writer->WriteToOutputStringOn();
  writer->Write();
  return writer->GetOutputString();
}

}  // namespace apothem
