// Reads back VTK files of unstructured grids.
#pragma once

#include <vtkNew.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <string>

namespace apothem::test {

inline vtkNew<vtkXMLUnstructuredGridReader> read_grid(const std::string& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader;
}

}  // namespace apothem::test
