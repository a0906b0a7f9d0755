#include "apps/reproduce/text.hpp"

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

}  // namespace apothem
