#include "lib/scene/time_reader.hpp"

#include <fmt/format.h>

#include <array>

namespace apothem {
namespace {

class TimeReader {
 public:
  TimeReader(const JsonReader& in, UsedFeatures& features) : in_(in), features_(features) {}

  TimeSettings read(const JsonValue& value) {
    JsonObject object(in_, value);
    time_.end = in_.positive(object.required("end", "in s"), "s");
    const JsonValue* mode = object.optional("mode");
    time_.statics = mode && in_.choice(*mode, {"dynamic", "static"}) == 1;
    features_.add(time_.statics ? Feature::static_run : Feature::dynamic_run, mode);
    if (const JsonValue* v = object.optional("load_steps")) load_steps(*v);
    if (const JsonValue* v = object.optional("tolerance")) tolerance(*v);
    if (const JsonValue* v = object.optional("scheme")) scheme(*v);
    if (const JsonValue* v = object.optional("step")) step(*v);
    if (const JsonValue* v = object.optional("start")) start(*v);
    if (const JsonValue* v = object.optional("accuracy")) accuracy(*v);
    if (const JsonValue* v = object.optional("safety")) safety(*v);
    if (const JsonValue* v = object.optional("onsets")) onsets(*v);
    object.finish();
    return time_;
  }

 private:
  void load_steps(const JsonValue& value) {
    features_.add(Feature::load_steps, &value);
    if (value.type() == JsonValue::Type::string) {
      in_.choice(value, {"auto"});
      time_.automatic_load_steps = true;
      return;
    }
    features_.add(Feature::counted_load_steps, &value);
    time_.load_steps = in_.count(value);
    if (time_.load_steps < 1) in_.fail(value, "must be at least 1");
  }

  void tolerance(const JsonValue& value) {
    features_.add(Feature::tolerance, &value);
    time_.tolerance = in_.positive(value, "parts of the loads");
    if (!(time_.tolerance >= 1e-12 && time_.tolerance <= 1e-2)) {
      in_.fail(value, fmt::format("must lie between 1e-12 and 1e-2, not {}", time_.tolerance));
    }
  }

  void scheme(const JsonValue& value) {
    features_.add(Feature::scheme, &value);
    constexpr std::array kSchemes{TimeScheme::verlet, TimeScheme::implicit, TimeScheme::automatic};
    time_.scheme = kSchemes[in_.choice(value, {"verlet", "implicit", "auto"})];
    if (time_.scheme == TimeScheme::implicit) features_.add(Feature::implicit_scheme, &value);
    if (time_.scheme == TimeScheme::automatic) features_.add(Feature::automatic_scheme, &value);
    if (time_.scheme != TimeScheme::verlet) features_.add(Feature::implicit_steps, &value);
  }

  void step(const JsonValue& value) {
    features_.add(Feature::time_step, &value);
    if (value.type() == JsonValue::Type::string) {
      in_.choice(value, {"auto"});
      return;
    }
    features_.add(Feature::fixed_step, &value);
    time_.fixed_step = in_.positive(value, "s");
    if (*time_.fixed_step > time_.end) in_.fail(value, "is longer than the whole run");
  }

  void start(const JsonValue& value) {
    features_.add(Feature::start, &value);
    time_.settled = in_.choice(value, {"as_given", "settled"}) == 1;
    if (time_.settled) features_.add(Feature::settled_start, &value);
  }

  void accuracy(const JsonValue& value) {
    features_.add(Feature::accuracy, &value);
    time_.accuracy = in_.positive(value, "parts of the energy of an impact");
    if (!(time_.accuracy >= 1e-12 && time_.accuracy <= 0.1)) {
      in_.fail(value, fmt::format("must lie between 1e-12 and 0.1, not {}", time_.accuracy));
    }
  }

  void safety(const JsonValue& value) {
    features_.add(Feature::safety, &value);
    const double safety = in_.positive(value, "parts of the stability limit");
    if (safety > 0.8) {
      in_.fail(value, fmt::format("must not exceed 0.8 of the stability limit, is {}", safety));
    }
    time_.safety = time_.element_safety = safety;
  }

  void onsets(const JsonValue& value) {
    features_.add(Feature::onsets, &value);
    time_.onsets = in_.choice(value, {"corrected", "plain"}) == 0;
  }

  const JsonReader& in_;
  UsedFeatures& features_;
  TimeSettings time_;
};

}  // namespace

TimeSettings read_time(const JsonReader& in, const JsonValue& value, UsedFeatures& features) {
  return TimeReader(in, features).read(value);
}

}  // namespace apothem
