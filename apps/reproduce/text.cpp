#include "apps/reproduce/text.hpp"

#include <cmath>

namespace apothem {

FigureText read_figure_text(const JsonReader& in, JsonObject& figure) {
  FigureText text;
  figure.read("about", text.about, &JsonReader::string);
  figure.read("paper", text.paper, &JsonReader::string);
  figure.each("open", [&](const JsonValue& item) {
    JsonObject object(in, item);
    OpenQuestion& open = text.open.emplace_back();
    open.question = in.string(object.required("question", "what the paper leaves open"));
    open.choice = in.string(object.required("choice", "what is done here, and why"));
    object.finish();
  });
  if (const JsonValue* v = figure.optional("verdict")) {
    JsonObject object(in, *v);
    text.verdict = in.choice<Verdict>(object.required("is", "a verdict"), kVerdicts);
    text.because = in.string(object.required("because", "why"));
    object.finish();
  }
  return text;
}

ReportNumber ExpectedNumber::beside(const std::string& scene, const std::string& what,
                                    const std::string& unit, double found) const {
  return {scene, what,  unit, value, found, tolerance, std::abs(found - value) <= tolerance,
          basis, source};
}

ExpectedNumber read_expected(const JsonReader& in, JsonObject& object) {
  ExpectedNumber expected;
  expected.value = in.number(object.required("value", "the number to expect"), "");
  expected.tolerance = in.positive(object.required("tolerance", "allowed difference"), "");
  expected.basis = in.choice<Basis>(object.required("basis", "what the value rests on"), kBases);
  expected.source = in.string(object.required("source", "where the value comes from"));
  return expected;
}

}  // namespace apothem
