#include "apothem/scene/compatibility.hpp"

#include <fmt/format.h>

namespace apothem {
namespace {

constexpr bool texts_are_in_order() {
  for (size_t i = 0; i < kFeatureTexts.size(); ++i) {
    if (kFeatureTexts[i].feature != static_cast<Feature>(i)) return false;
  }
  return kFeatureTexts.back().feature == Feature::tracked_surface;
}
static_assert(texts_are_in_order(), "kFeatureTexts must list every Feature, in its order");

constexpr bool texts_are_complete() {
  for (const Incompatibility& pair : kIncompatible) {
    if (text_of(pair.asked).what.empty() || text_of(pair.with).where.empty()) return false;
    if (pair.why.empty() || pair.instead.empty()) return false;
  }
  return true;
}
static_assert(texts_are_complete(), "a feature in kIncompatible lacks a text");

}  // namespace

std::string message_of(const Incompatibility& pair) {
  return fmt::format("{} {}: {}; {}", text_of(pair.verdict), text_of(pair.with).where, pair.why,
                     pair.instead);
}

void UsedFeatures::add(Feature feature, const JsonValue* at, int body) {
  values_[static_cast<size_t>(feature)].emplace(body, at);
}

const std::map<int, const JsonValue*>& UsedFeatures::values(Feature feature) const {
  return values_[static_cast<size_t>(feature)];
}

bool UsedFeatures::uses(Feature feature, int body) const {
  const std::map<int, const JsonValue*>& bodies = values(feature);
  if (body == kWholeScene) return !bodies.empty();
  return bodies.contains(body) || bodies.contains(kWholeScene);
}

void refuse_incompatible(const JsonReader& in, const UsedFeatures& features) {
  for (const Incompatibility& pair : kIncompatible) {
    for (const auto& [body, at] : features.values(pair.asked)) {
      if (features.uses(pair.with, body)) in.fail(*at, message_of(pair));
    }
  }
}

}  // namespace apothem
