// The Python module: its parts, and what becomes of the library's exceptions.
#include "apps/python/driver.hpp"
#include "apps/python/scene_text.hpp"
#include "geometry/skeleton/skeleton.hpp"
#include "lib/dynamics/unstable.hpp"
#include "lib/output/files.hpp"
#include "lib/text/error.hpp"
#include "version.hpp"

namespace apothem::python {
namespace {

void raise(const char* name, const py::object& value) {
  PyErr_SetObject(py::module_::import("apothem._errors").attr(name).ptr(), value.ptr());
}

py::object text_or_none(const std::string& text) {
  return text.empty() ? py::object(py::none()) : py::object(py::str(text));
}
py::object number_or_none(int number, int least) {
  return number < least ? py::object(py::none()) : py::object(py::int_(number));
}

void raise_scene_error(const SceneError& error) {
  // What comes from a dict stands in no line.
  const bool has_line = error.line() > 0 && !is_from_dict(error.file());
  const SceneError shown(error.file(), has_line ? error.line() : 0, error.pointer(),
                         error.reason());
  const auto* polygon = dynamic_cast<const PolygonError*>(&error);
  const py::object type = py::module_::import("apothem._errors").attr("SceneError");
  raise("SceneError", type(shown.what(), error.reason(), text_or_none(error.file()),
                           number_or_none(shown.line(), 1), text_or_none(error.pointer()),
                           number_or_none(polygon ? polygon->vertex() : -1, 0),
                           number_or_none(polygon ? polygon->hole().value_or(-1) : -1, 0)));
}

void raise_bad_polygon(const std::string& what, int vertex, int hole) {
  const py::object type = py::module_::import("apothem._errors").attr("SceneError");
  raise("SceneError", type(what, what, py::none(), py::none(), py::none(),
                           number_or_none(vertex, 0), number_or_none(hole, 0)));
}

void translate(std::exception_ptr exception) {
  try {
    std::rethrow_exception(std::move(exception));
  } catch (const SceneError& error) {
    raise_scene_error(error);
  } catch (const InvalidPolygon& error) {
    raise_bad_polygon(error.what(), error.vertex(), error.hole().value_or(-1));
  } catch (const SkeletonFailure& error) {
    raise_bad_polygon(error.what(), -1, -1);
  } catch (const Unstable& error) {
    raise("Unstable", py::str(error.what()));
  } catch (const SystemFailure& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace

py::array_t<double> array_of(const std::vector<Vec2>& points, const Vec2& shift) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
  auto at = array.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const Vec2 p = points[static_cast<size_t>(i)] + shift;
    at(i, 0) = p.x();
    at(i, 1) = p.y();
  }
  return array;
}

std::string path_text(const py::object& path) {
  if (path.is_none()) return "";
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(path.ptr(), &bytes) == 0) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes).cast<std::string>();
}

py::list index_lists(const std::vector<std::vector<int>>& lists) {
  py::list arrays;
  for (const std::vector<int>& list : lists) {
    arrays.append(py::array_t<int>(static_cast<py::ssize_t>(list.size()), list.data()));
  }
  return arrays;
}

}  // namespace apothem::python

PYBIND11_MODULE(_apothem, module) {
  using namespace apothem::python;
  module.attr("__version__") = apothem::kVersion;
  py::register_exception_translator(translate);
  bind_scene(module);
  bind_views(module);
  bind_simulation(module);
  bind_geometry(module);
  const auto at_exit = pybind11::module_::import("atexit").attr("register");
  at_exit(pybind11::cpp_function(&Driver::stop_all));
}
