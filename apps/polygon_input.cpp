#include "polygon_input.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "contact/law.hpp"
#include "scene/json.hpp"

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

std::vector<Vec2> read_ring(std::istream& line) {
  int n = 0;
  if (!(line >> n) || n < 0) throw InvalidPolygon("the number of vertices is missing", 0);
  std::vector<Vec2> ring;
  for (int i = 0; i < n; ++i) {
    std::string x, y;  // not as double: streams do not read nan or inf
    if (!(line >> x >> y)) throw InvalidPolygon("the line ends before the vertex", i);
    char* end_x = nullptr;
    char* end_y = nullptr;
    ring.emplace_back(std::strtod(x.c_str(), &end_x), std::strtod(y.c_str(), &end_y));
    if (*end_x != '\0' || *end_y != '\0') throw InvalidPolygon("is not a number", i);
  }
  return ring;
}

void for_each_line(const std::string& file,
                   const std::function<void(const std::string&, std::istream&)>& evaluate) {
  std::istringstream lines(read_text(file));
  for (std::string text; std::getline(lines, text);) {
    std::istringstream line(text);
    std::string name;
    if (line >> name) evaluate(name, line);
  }
}

void require_end(std::istream& line) {
  if (std::string rest; line >> rest) throw InvalidPolygon("text behind the last vertex", 0);
}

}  // namespace apothem
