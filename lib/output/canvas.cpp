#include "lib/output/canvas.hpp"

#include <cairo-svg.h>
#include <cairo.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace apothem {
namespace {

constexpr int kPixelsPerPoint = 2;
constexpr int kPixelsPerPointInSvg = 4;

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void set_colour(cairo_t* cairo, const Colour& c) {
  cairo_set_source_rgba(cairo, c.red, c.green, c.blue, c.alpha);
}

void set_pen(cairo_t* cairo, const Pen& pen) {
  set_colour(cairo, pen.colour);
  cairo_set_line_width(cairo, pen.width);
  cairo_set_dash(cairo, pen.dashes.data(), static_cast<int>(pen.dashes.size()), 0);
}

void add_path(cairo_t* cairo, const std::vector<Vec2>& line, bool closed) {
  cairo_new_path(cairo);
  for (const Vec2& p : line) cairo_line_to(cairo, p.x(), p.y());
  if (closed) cairo_close_path(cairo);
}

}  // namespace

std::optional<PictureFormat> picture_format(const std::string& file) {
  if (file.ends_with(".png")) return PictureFormat::png;
  if (file.ends_with(".svg")) return PictureFormat::svg;
  return std::nullopt;
}

Colour viridis(double share) {
  static constexpr std::array<std::uint32_t, 20> kTable{
      0x440154, 0x481567, 0x482677, 0x453781, 0x404788, 0x39568c, 0x33638d,
      0x2d708e, 0x287d8e, 0x238a8d, 0x1f968b, 0x20a387, 0x29af7f, 0x3cbb75,
      0x55c667, 0x73d055, 0x95d840, 0xb8de29, 0xdce319, 0xfde725};
  const double place = std::clamp(share, 0.0, 1.0) * (kTable.size() - 1);
  const auto low = std::min(static_cast<size_t>(place), kTable.size() - 2);
  const double w = place - static_cast<double>(low);
  const auto mix = [&](int shift) {
    const auto part = [&](size_t i) {
      return static_cast<double>(kTable[i] >> shift & 0xff) / 255;
    };
    return (1 - w) * part(low) + w * part(low + 1);
  };
  return {mix(16), mix(8), mix(0)};
}

Colour okabe_ito(size_t index) {
  static constexpr std::array<std::uint32_t, 7> kTable{0xe69f00, 0x56b4e9, 0x009e73, 0xf0e442,
                                                       0x0072b2, 0xd55e00, 0xcc79a7};
  const std::uint32_t code = kTable[index % kTable.size()];
  const double white = index / kTable.size() % 2 == 1 ? .5 : 0;
  const auto part = [&](int shift) {
    return white + (1 - white) * static_cast<double>(code >> shift & 0xff) / 255;
  };
  return {part(16), part(8), part(0)};
}

struct Canvas::Surface {
  PictureFormat format;
  std::string bytes;
  cairo_surface_t* surface;
  cairo_t* cairo;
};

std::vector<Vec2> box_ring(const Box& box) {
  return {{box.x0, box.y0}, {box.x1, box.y0}, {box.x1, box.y1}, {box.x0, box.y1}};
}

std::vector<Vec2> circle_ring(const Vec2& centre, double radius) {
  constexpr int kCorners = 180;
  std::vector<Vec2> ring;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * M_PI * i / kCorners;
    ring.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

Canvas::Canvas(PictureFormat format, double width, double height)
    : surface_(std::make_unique<Surface>()) {
  Surface& s = *surface_;
  s.format = format;
  if (format == PictureFormat::svg) {
    s.surface = cairo_svg_surface_create_for_stream(append, &s.bytes, width, height);
    cairo_svg_surface_restrict_to_version(s.surface, CAIRO_SVG_VERSION_1_2);
  } else {
    const auto pixels = [](double points) {
      return static_cast<int>(std::ceil(kPixelsPerPoint * points));
    };
    s.surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels(width), pixels(height));
  }
  s.cairo = cairo_create(s.surface);
  if (format == PictureFormat::png) cairo_scale(s.cairo, kPixelsPerPoint, kPixelsPerPoint);
  cairo_select_font_face(s.cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_line_join(s.cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(s.cairo, CAIRO_LINE_CAP_ROUND);
  set_colour(s.cairo, {1, 1, 1});
  cairo_paint(s.cairo);
}

Canvas::~Canvas() {
  cairo_destroy(surface_->cairo);
  cairo_surface_destroy(surface_->surface);
}

void Canvas::fill(const std::vector<Vec2>& ring, const Colour& colour) {
  add_path(surface_->cairo, ring, true);
  set_colour(surface_->cairo, colour);
  cairo_fill(surface_->cairo);
}

void Canvas::fill_even_odd(const std::vector<std::vector<Vec2>>& rings, const Colour& colour) {
  cairo_t* cairo = surface_->cairo;
  cairo_new_path(cairo);
  for (const std::vector<Vec2>& ring : rings) {
    cairo_new_sub_path(cairo);
    for (const Vec2& p : ring) cairo_line_to(cairo, p.x(), p.y());
    cairo_close_path(cairo);
  }
  set_colour(cairo, colour);
  cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_fill(cairo);
  cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_WINDING);
}

void Canvas::stroke(const std::vector<Vec2>& line, bool closed, const Pen& pen) {
  add_path(surface_->cairo, line, closed);
  set_pen(surface_->cairo, pen);
  cairo_stroke(surface_->cairo);
}

void Canvas::image(const Box& frame, int width, int height, const std::vector<Colour>& colours) {
  cairo_t* cairo = surface_->cairo;
  cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height);
  cairo_surface_flush(image);
  unsigned char* data = cairo_image_surface_get_data(image);
  const auto stride = static_cast<size_t>(cairo_image_surface_get_stride(image));
  const auto byte = [](double part) { return static_cast<std::uint32_t>(std::lround(255 * part)); };
  for (size_t i = 0; data && i < colours.size(); ++i) {
    const Colour& c = colours[i];
    const std::uint32_t pixel = byte(c.alpha) << 24U | byte(c.alpha * c.red) << 16U |
                                byte(c.alpha * c.green) << 8U | byte(c.alpha * c.blue);
    std::memcpy(data + i / width * stride + i % width * sizeof pixel, &pixel, sizeof pixel);
  }
  cairo_surface_mark_dirty(image);
  cairo_save(cairo);
  cairo_translate(cairo, frame.x0, frame.y0);
  cairo_scale(cairo, (frame.x1 - frame.x0) / width, (frame.y1 - frame.y0) / height);
  cairo_set_source_surface(cairo, image, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
  cairo_paint(cairo);
  cairo_restore(cairo);
  cairo_surface_destroy(image);
}

void Canvas::clip(const Box& frame) {
  cairo_save(surface_->cairo);
  cairo_rectangle(surface_->cairo, frame.x0, frame.y0, frame.x1 - frame.x0, frame.y1 - frame.y0);
  cairo_clip(surface_->cairo);
}

void Canvas::unclip() { cairo_restore(surface_->cairo); }

void Canvas::circle(const Vec2& centre, double radius, const Colour& inside, const Pen& rim) {
  cairo_new_path(surface_->cairo);
  cairo_arc(surface_->cairo, centre.x(), centre.y(), radius, 0, 2 * M_PI);
  set_colour(surface_->cairo, inside);
  cairo_fill_preserve(surface_->cairo);
  set_pen(surface_->cairo, rim);
  cairo_stroke(surface_->cairo);
}

void Canvas::text(const Vec2& at, const std::string& text, const Font& font) {
  // Height of the capital letters of the font DejaVu over the font size.
  constexpr double kCapitals = .73;
  const double width = text_width(text, font.size);
  const double start = font.align == Align::left ? 0 : font.align == Align::centre ? .5 : 1;
  cairo_t* cairo = surface_->cairo;
  cairo_save(cairo);
  cairo_translate(cairo, at.x(), at.y());
  if (font.upwards) cairo_rotate(cairo, -M_PI / 2);
  set_colour(cairo, {0, 0, 0});
  cairo_move_to(cairo, -start * width, kCapitals / 2 * font.size);
  cairo_show_text(cairo, text.c_str());
  cairo_restore(cairo);
}

int Canvas::pixels_per_point() const {
  return surface_->format == PictureFormat::svg ? kPixelsPerPointInSvg : kPixelsPerPoint;
}

double Canvas::text_width(const std::string& text, double size) const {
  cairo_set_font_size(surface_->cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(surface_->cairo, text.c_str(), &extents);
  return extents.x_advance;
}

std::string Canvas::finish() {
  Surface& s = *surface_;
  cairo_status_t status = cairo_status(s.cairo);
  if (s.format == PictureFormat::png && status == CAIRO_STATUS_SUCCESS) {
    status = cairo_surface_write_to_png_stream(s.surface, append, &s.bytes);
  }
  cairo_surface_finish(s.surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(s.surface);
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(std::string("the picture cannot be drawn: ") +
                             cairo_status_to_string(status));
  }
  return std::move(s.bytes);
}

}  // namespace apothem
