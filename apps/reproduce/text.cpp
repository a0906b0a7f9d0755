#include "apps/reproduce/text.hpp"

namespace apothem {

FigureText read_figure_text(const JsonReader& in, JsonObject& figure) {
  FigureText text;
  if (const JsonValue* v = figure.optional("about")) text.about = in.string(*v);
  if (const JsonValue* v = figure.optional("paper")) text.paper = in.string(*v);
  if (const JsonValue* v = figure.optional("open")) {
    for (const JsonValue& item : in.array(*v)) {
      JsonObject object(in, item);
      OpenQuestion& open = text.open.emplace_back();
      open.question = in.string(object.required("question", "what the paper leaves open"));
      open.choice = in.string(object.required("choice", "what is done here, and why"));
      object.finish();
    }
  }
  if (const JsonValue* v = figure.optional("verdict")) {
    JsonObject object(in, *v);
    text.verdict = static_cast<Verdict>(
        in.choice(object.required("is", "a verdict"), {kVerdicts.begin(), kVerdicts.end()}));
    text.because = in.string(object.required("because", "why"));
    object.finish();
  }
  return text;
}

}  // namespace apothem
