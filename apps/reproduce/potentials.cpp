#include "apps/reproduce/potentials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Quantity = PotentialNumber::Quantity;

// The quantities by name, in the order of their enumeration, with their units.
struct NamedQuantity {
  const char* name;
  const char* words;
  const char* unit;
};
constexpr std::array kQuantities{
    NamedQuantity{"phi", "φ", "1"},
    NamedQuantity{"gradient", "size of the gradient", "1/m"},
    NamedQuantity{"steepness", "largest over smallest size of the gradient", "1"},
    NamedQuantity{"largest", "largest φ", "1"},
    NamedQuantity{"jump", "largest jump of φ between two parts", "1"},
    NamedQuantity{"parts", "number of parts in which φ is linear", "1"},
    NamedQuantity{"reference", "reference length r", "m"},
    NamedQuantity{"singular_area", "singular area", "m^2"},
    NamedQuantity{"singular_length", "length of the singular segment", "m"}};

const PotentialPiece* piece_of(const PotentialMap& map, int edge) {
  const auto found =
      std::ranges::find_if(map.pieces, [&](const PotentialPiece& p) { return p.edge == edge; });
  return found == map.pieces.end() ? nullptr : &*found;
}

double steepness(const PotentialMap& map) {
  double least = HUGE_VAL, most = 0;
  for (const PotentialPiece& piece : map.pieces) {
    least = std::min(least, piece.gradient.norm());
    most = std::max(most, piece.gradient.norm());
  }
  return most / least;
}

double singular_length(const PotentialMap& map) {
  double length = 0;
  for (const auto& [a, b] : map.singular->segments) length += (b - a).norm();
  return length;
}

double value_of(const PotentialNumber& number, const PotentialMap& map) {
  switch (number.quantity) {
    case Quantity::phi:
      return phi_at(map, number.at);
    case Quantity::gradient:
      return piece_of(map, number.edge)->gradient.norm();
    case Quantity::steepness:
      return steepness(map);
    case Quantity::largest:
      return largest_phi(map);
    case Quantity::jump:
      return largest_jump(map);
    case Quantity::parts:
      return static_cast<double>(map.pieces.size());
    case Quantity::reference:
      return map.reference;
    case Quantity::singular_area:
      return map.singular->area();
    case Quantity::singular_length:
      return singular_length(map);
  }
  return std::nan("");
}

class PanelReader {
 public:
  explicit PanelReader(const JsonReader& in) : in_(in) {}

  PotentialPanelSource read(const JsonValue& value) {
    JsonObject object(in_, value);
    PotentialPanelSource panel;
    object.read("title", panel.title, &JsonReader::string);
    const JsonValue& shapes = object.required("shapes", "array of polygons");
    for (const JsonValue& item : in_.array(shapes)) panel.shapes.push_back(shape(item));
    if (panel.shapes.empty()) in_.fail(shapes, "must hold at least one polygon");
    object.finish();
    return panel;
  }

 private:
  PotentialShape shape(const JsonValue& value) {
    JsonObject object(in_, value);
    PotentialShape result;
    object.read("label", result.shown.label, &JsonReader::string);
    auto kind = MapKind::distance;
    object.choose("potential", kind, kMapKinds);
    PotentialChoice choice;
    if (const JsonValue* v = object.optional("reference")) choice = reference(*v);
    const JsonValue& ring = object.required("polygon", "[[x, y], ...] in m");
    try {
      result.shown.map = potential_map(Polygon(in_.ring(ring)), kind, choice);
    } catch (const InvalidPolygon& error) {
      in_.fail(ring, std::string("the polygon is not usable: ") + error.what());
    }
    object.each("expect", [&](const JsonValue& item) { number(item, result); });
    object.finish();
    return result;
  }

  PotentialChoice reference(const JsonValue& value) {
    PotentialChoice choice;
    if (value.type() == JsonValue::Type::string) {
      choice.reference = kReferences[in_.choice(value, names_of(kReferences))].reference;
    } else {
      choice.reference = PotentialChoice::Reference::length;
      choice.length = in_.positive(value, "m");
    }
    return choice;
  }

  void number(const JsonValue& value, PotentialShape& shape) {
    JsonObject object(in_, value);
    PotentialNumber& n = shape.numbers.emplace_back();
    const JsonValue& quantity = object.required("quantity", "a quantity of a potential");
    n.quantity = in_.choice<Quantity>(quantity, names_of(kQuantities));
    if (n.quantity >= Quantity::reference && !shape.shown.map.singular) {
      in_.fail(quantity, "only the distance potential has a reference length");
    }
    object.read("label", n.label, &JsonReader::string);
    if (n.quantity == Quantity::phi) point(object, n, shape);
    if (n.quantity == Quantity::gradient) {
      const JsonValue& edge = object.required("edge", "the number of an edge, from 0");
      n.edge = in_.count(edge);
      if (!piece_of(shape.shown.map, n.edge))
        in_.fail(edge, "no part of the polygon has this edge");
    }
    n.expected = read_expected(in_, object);
    object.finish();
  }

  void point(JsonObject& object, PotentialNumber& number, PotentialShape& shape) {
    number.at = in_.vec2(object.required("at", "[x, y] in m"), "m");
    const JsonValue* name = object.optional("point");
    if (!name) return;
    shape.shown.points.push_back({in_.string(*name), number.at});
    if (number.label.empty()) number.label = "at " + name->string();
  }

  const JsonReader& in_;
};

}  // namespace

PotentialPanelSource read_potential_panel(const JsonReader& in, const JsonValue& value) {
  return PanelReader(in).read(value);
}

PotentialFigure potential_figure(const std::string& title,
                                 const std::vector<PotentialPanelSource>& panels) {
  PotentialFigure figure{title, {}};
  for (const PotentialPanelSource& source : panels) {
    PotentialPanel& panel = figure.panels.emplace_back(PotentialPanel{source.title, {}});
    for (const PotentialShape& shape : source.shapes) panel.maps.push_back(shape.shown);
  }
  return figure;
}

std::vector<ReportNumber> potential_numbers(const std::vector<PotentialPanelSource>& panels) {
  std::vector<ReportNumber> numbers;
  for (const PotentialPanelSource& panel : panels) {
    for (const PotentialShape& shape : panel.shapes) {
      for (const PotentialNumber& n : shape.numbers) {
        const NamedQuantity& quantity = kQuantities[static_cast<size_t>(n.quantity)];
        const std::string what =
            n.label.empty() ? quantity.words : fmt::format("{} {}", quantity.words, n.label);
        numbers.push_back(n.expected.beside(shape.shown.label, what, quantity.unit,
                                            value_of(n, shape.shown.map)));
      }
    }
  }
  return numbers;
}

}  // namespace apothem
