// apothem.Scene: a scene file, or a dict with the same keys.
#include "lib/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/python/bindings.hpp"
#include "apps/python/scene_text.hpp"

namespace apothem::python {
namespace {

using Json = nlohmann::ordered_json;

std::string type_name(py::handle value) { return py::str(py::type::of(value).attr("__name__")); }

constexpr int kDeepest = 200;  // levels of dicts and lists in each other

// Makes JSON of Python values.
class JsonMaker {
 public:
  explicit JsonMaker(const std::string& file) : file_(file) {}

  Json make(py::handle value, const std::string& pointer, int depth = 0) const {
    if (depth > kDeepest) fail(pointer, "is nested too deeply, or contains itself");
    if (value.is_none()) return nullptr;
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
    if (py::isinstance<py::int_>(value)) return whole(value, pointer);
    if (py::isinstance<py::float_>(value)) return number(value.cast<double>(), pointer);
    if (py::isinstance<py::str>(value)) return text(value, pointer);
    if (py::isinstance<py::dict>(value)) return object(value.cast<py::dict>(), pointer, depth);
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
      return array(value.cast<py::sequence>(), pointer, depth);
    }
    // Arrays and numbers of NumPy.
    if (py::hasattr(value, "tolist")) return make(value.attr("tolist")(), pointer, depth + 1);
    if (py::hasattr(value, "__fspath__")) return text(value.attr("__fspath__")(), pointer);
    fail(pointer, "is a Python object of type \"" + type_name(value) +
                      "\"; must be a dict, list, array, number, string, True, False or None");
  }

 private:
  [[noreturn]] void fail(const std::string& pointer, const std::string& what) const {
    throw SceneError(file_, 0, pointer, what);
  }
  [[nodiscard]] Json whole(py::handle value, const std::string& pointer) const {
    const long long number = PyLong_AsLongLong(value.ptr());
    if (PyErr_Occurred() == nullptr) return number;
    PyErr_Clear();
    fail(pointer, "is too large a number");
  }
  [[nodiscard]] Json number(double value, const std::string& pointer) const {
    if (!std::isfinite(value)) fail(pointer, "must be a finite number");
    return value;
  }
  // Strings of Python may hold halves of characters, which UTF-8 has not.
  [[nodiscard]] std::string text(py::handle value, const std::string& pointer) const {
    const char* utf8 = PyUnicode_AsUTF8(value.ptr());
    if (utf8 != nullptr) return value.cast<std::string>();
    PyErr_Clear();
    fail(pointer, "is no text in valid Unicode");
  }
  [[nodiscard]] Json object(const py::dict& dict, const std::string& pointer, int depth) const {
    Json json = Json::object();
    for (const auto& [key, value] : dict) {
      if (!py::isinstance<py::str>(key)) {
        fail(pointer, "has the key " + py::repr(key).cast<std::string>() + ", which is no string");
      }
      const std::string name = text(key, pointer);
      json[name] = make(value, pointer + "/" + escaped_key(name), depth + 1);
    }
    return json;
  }
  [[nodiscard]] Json array(const py::sequence& list, const std::string& pointer, int depth) const {
    Json json = Json::array();
    for (size_t i = 0; i < list.size(); ++i) {
      json.push_back(make(list[i], pointer + "/" + std::to_string(i), depth + 1));
    }
    return json;
  }

  const std::string& file_;
};

std::vector<Setting> settings_of(const py::dict& values, const std::string& file) {
  std::vector<Setting> settings;
  for (const auto& [path, value] : values) {
    if (!py::isinstance<py::str>(path)) throw py::type_error("paths of values must be strings");
    const auto name = path.cast<std::string>();
    std::string pointer = "/" + name;
    std::ranges::replace(pointer, '.', '/');
    settings.push_back({name, json_text(value, file, pointer)});
  }
  return settings;
}

Scene scene_of_dict(const py::dict& document, const py::object& folder) {
  namespace fs = std::filesystem;
  const std::string file =
      folder.is_none() ? kDict : (fs::path(path_text(folder)) / kDict).string();
  std::string text = json_text(document, file);
  const py::gil_scoped_release release;
  return read_scene_text(std::move(text), file);
}

Scene scene_of_file(const py::object& path, const py::dict& settings) {
  const std::string file = path_text(path);
  const std::vector<Setting> values = settings_of(settings, file);
  const py::gil_scoped_release release;
  return read_scene(file, values);
}

py::object dict_of(const Scene& scene) {
  const Json json = Json::parse(scene.text, nullptr, true, true);  // with comments
  return py::module_::import("json").attr("loads")(json.dump());
}

}  // namespace

bool is_from_dict(const std::string& file) {
  return std::filesystem::path(file).filename() == kDict;
}

std::string json_text(py::handle value, const std::string& file, const std::string& pointer) {
  return JsonMaker(file).make(value, pointer).dump();
}

void bind_scene(py::module_& module) {
  py::class_<Scene>(module, "Scene", R"(A scene: bodies, materials, contact, time and output.

Scene(document, folder=None)
    document: dict with the keys of the scene format (docs/scene-format.md), one to one, in SI units
    and radians. Values may be dicts, lists, tuples, NumPy arrays and numbers, strings and paths.
    folder: what relative names of files in the scene are relative to; by default the working
    directory.

Raises SceneError if the scene is not valid; its pointer names the place in the document.
A scene is never changed, and may serve any number of simulations.)")
      .def(py::init(&scene_of_dict), py::arg("document"), py::arg("folder") = py::none())
      .def_property_readonly(
          "name", [](const Scene& s) { return s.model.name; }, "Name of the scene.")
      .def_property_readonly(
          "file", [](const Scene& s) { return s.file; },
          "File that the scene was read from; it ends in <dict> if it was a dict.")
      .def_property_readonly(
          "end", [](const Scene& s) { return s.time.end; }, "End of the run, s.")
      .def("to_dict", &dict_of,
           R"(The document as a new dict, as it stands in the file or was given:
without values that load() has set. Change it and make a new Scene of it.)")
      .def("__repr__", [](const Scene& s) {
        return "<apothem.Scene \"" + s.model.name + "\": " + std::to_string(s.model.bodies.size()) +
               " rigid and " + std::to_string(s.model.deformables.size()) + " deformable bodies>";
      });
  module.def("load", &scene_of_file, py::arg("path"), py::arg("set") = py::dict(),
             R"(Reads a scene file.

path: of the file; names of files in it are relative to its folder.
set: values that replace those of the file, by their paths of dots, as `apothem run --set` takes
them: {"contact.friction.coefficient": 0.3, "bodies.block.velocity": [0, -1]}.

Returns a Scene. Raises SceneError if the file cannot be read or is not a valid scene.)");
}

}  // namespace apothem::python
