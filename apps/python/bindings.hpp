// What the parts of the Python module share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "geometry/potential/potential.hpp"
#include "lib/run/run.hpp"

namespace apothem::python {

namespace py = pybind11;

void bind_scene(py::module_& module);
void bind_simulation(py::module_& module);
void bind_views(py::module_& module);
void bind_geometry(py::module_& module);

/// An array (n, 2) of these points moved by `shift`, m.
py::array_t<double> array_of(const std::vector<Vec2>& points, const Vec2& shift = Vec2::Zero());
/// The name of a file or folder: str, bytes or os.PathLike; empty for None. Throws TypeError for
/// anything else, and ValueError if it cannot be a name.
std::string path_text(const py::object& path);
/// A list of arrays of whole numbers, one for each list.
py::list index_lists(const std::vector<std::vector<int>>& lists);
/// An object of the class of this name in apothem/_results.py.
template <class... Fields>
py::object result(const char* name, Fields&&... fields) {
  return py::module_::import("apothem._results").attr(name)(std::forward<Fields>(fields)...);
}

}  // namespace apothem::python
