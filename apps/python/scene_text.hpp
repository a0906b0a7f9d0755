// Scenes that are Python dicts.
#pragma once

#include <string>

#include "apps/python/bindings.hpp"

namespace apothem::python {

/// What stands in place of the name of a file.
inline constexpr const char* kDict = "<dict>";

/// True for the file of a scene that was a dict.
bool is_from_dict(const std::string& file);

/// The JSON of a Python value: dicts, lists, tuples, arrays, numbers, strings, paths, True, False
/// and None. Throws SceneError, with `file` and places below `pointer`, for anything else.
std::string json_text(py::handle value, const std::string& file, const std::string& pointer = "");

}  // namespace apothem::python
