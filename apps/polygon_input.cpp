#include "polygon_input.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "apothem/contact/law.hpp"
#include "apothem/scene/json.hpp"

namespace apothem {

void set_reference(PotentialChoice& choice, const std::string& text) {
  for (const NamedReference& r : kReferences) {
    if (text == r.name) {
      choice.reference = r.reference;
      return;
    }
  }
  choice.reference = PotentialChoice::Reference::length;
  char* end = nullptr;
  choice.length = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !(choice.length > 0) || !std::isfinite(choice.length)) {
    throw SceneError(
        "--reference", 0, "",
        fmt::format("must be roof, inscribed_circle or a positive length in m, not \"{}\"", text));
  }
}

void for_each_line(const std::string& file,
                   const std::function<void(const std::string&, const std::string&)>& evaluate) {
  std::istringstream lines(read_text(file));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    if (std::string name; words >> name) evaluate(name, line);
  }
}

}  // namespace apothem
