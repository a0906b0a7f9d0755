#include "lib/output/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace apothem {
namespace {

constexpr double kTick = 4;      // length of a tick, points
constexpr double kNumbers = 10;  // font size of numbers, points
constexpr double kNames = 11;    // font size of names, points
const Pen kFrame{{.25, .25, .25}, .8};

std::string superscript(int number) {
  static const char* const digits[]{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char c : std::to_string(number)) text += c == '-' ? "⁻" : digits[c - '0'];
  return text;
}

struct Ticks {
  std::vector<double> places;  // positions in the data
  std::vector<std::string> numbers;
  std::string name;  // name of the axis with its unit
};

// A round step between numbers of an axis, of which there are about `most`: a single number would
// not be a scale.
double step_of_ticks(double low, double high, int most) {
  double step = round_step(high - low, most);
  for (int more = most + 1; more <= 2 * most; ++more) {
    if (std::floor(high / step) - std::ceil(low / step) >= 1) break;
    step = round_step(high - low, more);
  }
  return step;
}

Ticks make_ticks(const Axis& axis, double low, double high, int most) {
  constexpr double kDigits = 2e4;  // more steps than that from zero would need too many digits
  const double step = step_of_ticks(low + axis.zero, high + axis.zero, most);
  const double middle = axis.zero + (low + high) / 2;
  double base = 0;
  if (std::abs(middle) > kDigits * step) {
    const double grid = std::pow(10, std::ceil(std::log10(high - low)) + 1);
    base = std::round(middle / grid) * grid;
  }
  const double shift = axis.zero - base;
  const double largest = std::max(std::abs(low + shift), std::abs(high + shift));
  const int power = largest >= 1e4 || largest < 1e-2
                        ? 3 * static_cast<int>(std::floor(std::log10(largest) / 3))
                        : 0;
  const double unit = std::pow(10, power);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step / unit) + 1e-9)));
  Ticks ticks;
  for (double k = std::ceil((low + shift) / step); k * step <= high + shift; ++k) {
    ticks.places.push_back(k * step - shift);
    ticks.numbers.push_back(
        fmt::format("{}{:.{}f}", k < 0 ? "−" : "", std::abs(k) * step / unit, decimals));
  }
  ticks.name = axis.name;
  if (base != 0) {
    ticks.name += fmt::format(" {} {:.15g}", base > 0 ? "−" : "+", std::abs(base));
    if (power != 0) ticks.name += " " + axis.unit;
  }
  if (power == 0 && axis.unit.empty()) return ticks;
  ticks.name += power == 0 ? fmt::format(" ({})", axis.unit)
                           : fmt::format(" (10{} {})", superscript(power), axis.unit);
  return ticks;
}

}  // namespace

std::string time_in_words(double time) {
  return time == 0 || time >= .1 ? fmt::format("{:.4g} s", time)
                                 : fmt::format("{:.4g} ms", 1e3 * time);
}

std::pair<std::string, double> prefixed(const std::string& unit, double largest) {
  static constexpr std::array kPrefixes{"n", "µ", "m", "", "k", "M", "G"};
  constexpr int kNone = 3;  // place of the empty prefix
  if (!(largest > 0) || unit.empty()) return {unit, 1};
  const int power = static_cast<int>(std::floor(std::log10(largest * (1 + 1e-9)) / 3));
  const int at = std::clamp(power + kNone, 0, static_cast<int>(kPrefixes.size()) - 1);
  return {kPrefixes[static_cast<size_t>(at)] + unit, std::pow(10, -3 * (at - kNone))};
}

double round_step(double range, int most) {
  const double least = range / most;
  const double ten = std::pow(10, std::floor(std::log10(least)));
  for (const double step : {1., 2., 5.}) {
    if (step * ten >= least * (1 - 1e-9)) return step * ten;
  }
  return 10 * ten;
}

Axes::Axes(const Box& frame, const Box& window, Axis x, Axis y)
    : frame_(frame), window_(window), x_(std::move(x)), y_(std::move(y)) {}

Vec2 Axes::operator()(const Vec2& data) const {
  const double u = (data.x() - window_.x0) / (window_.x1 - window_.x0);
  const double v = (data.y() - window_.y0) / (window_.y1 - window_.y0);
  return {frame_.x0 + u * (frame_.x1 - frame_.x0), frame_.y1 - v * (frame_.y1 - frame_.y0)};
}

std::vector<Vec2> Axes::operator()(std::vector<Vec2> data) const {
  for (Vec2& p : data) p = (*this)(p);
  return data;
}

void Axes::draw(Canvas& canvas, bool below, bool left) const {
  canvas.stroke(box_ring(frame_), true, kFrame);
  const Ticks x = make_ticks(x_, window_.x0, window_.x1,
                             std::max(2, static_cast<int>((frame_.x1 - frame_.x0) / 60)));
  for (size_t i = 0; i < x.places.size(); ++i) {
    const double at = (*this)({x.places[i], window_.y0}).x();
    canvas.stroke({{at, frame_.y1}, {at, frame_.y1 + kTick}}, false, kFrame);
    if (below) canvas.text({at, frame_.y1 + 12}, x.numbers[i], {kNumbers, Align::centre});
  }
  if (below) {
    canvas.text({(frame_.x0 + frame_.x1) / 2, frame_.y1 + 29}, x.name, {kNames, Align::centre});
  }
  const Ticks y = make_ticks(y_, window_.y0, window_.y1,
                             std::max(2, static_cast<int>((frame_.y1 - frame_.y0) / 35)));
  double widest = 0;
  for (size_t i = 0; i < y.places.size(); ++i) {
    const double at = (*this)({window_.x0, y.places[i]}).y();
    canvas.stroke({{frame_.x0 - kTick, at}, {frame_.x0, at}}, false, kFrame);
    if (left) canvas.text({frame_.x0 - 7, at}, y.numbers[i], {kNumbers, Align::right});
    widest = std::max(widest, canvas.text_width(y.numbers[i], kNumbers));
  }
  if (!left) return;
  canvas.text({frame_.x0 - 18 - widest, (frame_.y0 + frame_.y1) / 2}, y.name,
              {kNames, Align::centre, true});
}

namespace {

Ticks scale_ticks(const Axis& axis, double low, double high, double height) {
  return make_ticks(axis, low, high, std::max(2, static_cast<int>(height / 25)));
}

}  // namespace

double colour_scale_width(const Canvas& ruler, const Axis& axis, double low, double high,
                          double height) {
  return ruler.text_width(scale_ticks(axis, low, high, height).name, kNames);
}

void draw_colour_scale(Canvas& canvas, const Box& frame, const Axis& axis, double low, double high,
                       bool values_below, bool values_above) {
  constexpr int kColours = 256;
  std::vector<Colour> colours;
  colours.reserve(kColours);
  for (int i = 0; i < kColours; ++i) colours.push_back(viridis((kColours - .5 - i) / kColours));
  canvas.image(frame, 1, kColours, colours);
  canvas.stroke(box_ring(frame), true, kFrame);
  const double height = (frame.x1 - frame.x0) * .8;
  const auto point = [&](double from, double to, const Colour& colour) {
    const std::vector<Vec2> ring{
        {frame.x0, from}, {frame.x1, from}, {(frame.x0 + frame.x1) / 2, to}};
    canvas.fill(ring, colour);
    canvas.stroke(ring, true, kFrame);
  };
  if (values_below) point(frame.y1, frame.y1 + height, viridis(0));
  if (values_above) point(frame.y0, frame.y0 - height, viridis(1));
  const Ticks ticks = scale_ticks(axis, low, high, frame.y1 - frame.y0);
  for (size_t i = 0; i < ticks.places.size(); ++i) {
    const double at = frame.y1 - (ticks.places[i] - low) / (high - low) * (frame.y1 - frame.y0);
    canvas.stroke({{frame.x1, at}, {frame.x1 + kTick, at}}, false, kFrame);
    canvas.text({frame.x1 + 7, at}, ticks.numbers[i], {kNumbers});
  }
  canvas.text({frame.x0, frame.y0 - height - 10}, ticks.name, {kNames});
}

void draw_colour_bar(Canvas& canvas, const Box& frame, const std::vector<double>& bounds,
                     const std::vector<Colour>& colours, size_t stride, const std::string& name) {
  const double low = bounds.front();
  const double high = bounds.back();
  const auto place = [&](double value) {
    return frame.y1 - (value - low) / (high - low) * (frame.y1 - frame.y0);
  };
  // Each band reaches up to the top, and the next one covers the rest: no seams are visible.
  for (size_t i = 0; i + 1 < bounds.size(); ++i) {
    const double bottom = place(bounds[i]);
    canvas.fill(
        {{frame.x0, bottom}, {frame.x1, bottom}, {frame.x1, frame.y0}, {frame.x0, frame.y0}},
        colours[i]);
  }
  canvas.stroke(box_ring(frame), true, kFrame);
  for (size_t i = 0; i < bounds.size(); i += stride) {
    const double at = place(bounds[i]);
    canvas.stroke({{frame.x1, at}, {frame.x1 + kTick, at}}, false, kFrame);
    canvas.text({frame.x1 + 7, at}, fmt::format("{:.6g}", bounds[i]), {kNumbers});
  }
  canvas.text({(frame.x0 + frame.x1) / 2, frame.y0 - 12}, name, {kNames, Align::centre});
}

}  // namespace apothem
