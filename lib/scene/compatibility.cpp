#include "lib/scene/compatibility.hpp"

#include <fmt/format.h>

#include <algorithm>

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

// Where a body stands among values, or where it would. Bodies mostly come in their order.
template <class Values>
auto place_of(Values& values, int body) {
  if (values.empty() || values.back().first < body) return values.end();
  return std::ranges::lower_bound(values, body, {}, &std::pair<int, const JsonValue*>::first);
}

}  // namespace

std::string message_of(const Incompatibility& pair) {
  return fmt::format("{} {}: {}; {}", text_of(pair.refusal), text_of(pair.with).where, pair.why,
                     pair.instead);
}

void UsedFeatures::add(Feature feature, const JsonValue* at, int body) {
  Values& values = values_[static_cast<size_t>(feature)];
  const auto place = place_of(values, body);
  if (place == values.end() || place->first != body) values.insert(place, {body, at});
}

const UsedFeatures::Values& UsedFeatures::values(Feature feature) const {
  return values_[static_cast<size_t>(feature)];
}

bool UsedFeatures::uses(Feature feature, int body) const {
  const Values& bodies = values(feature);
  if (body == kWholeScene) return !bodies.empty();
  const auto contains = [&](int wanted) {
    const auto place = place_of(bodies, wanted);
    return place != bodies.end() && place->first == wanted;
  };
  return contains(body) || contains(kWholeScene);
}

void refuse_incompatible(const JsonReader& in, const UsedFeatures& features) {
  for (const Incompatibility& pair : kIncompatible) {
    for (const auto& [body, at] : features.values(pair.asked)) {
      if (features.uses(pair.with, body)) in.fail(*at, message_of(pair));
    }
  }
}

bool goes_with(const UsedFeatures& features, Feature other) {
  return std::ranges::none_of(kIncompatible, [&](const Incompatibility& pair) {
    return (pair.asked == other && features.uses(pair.with)) ||
           (pair.with == other && features.uses(pair.asked));
  });
}

}  // namespace apothem
