// A picture's pixels back from its file.
#pragma once

#include <cairo.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "lib/output/canvas.hpp"

namespace apothem::test {

struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint32_t> colours;  // RGB, by rows
  [[nodiscard]] std::uint32_t at(int x, int y) const { return colours[y * width + x]; }
};

inline Pixels decode(const std::string& png) {
  struct Source {
    const std::string& bytes;
    size_t at;
  } source{png, 0};
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(
      [](void* from, unsigned char* data, unsigned int length) {
        auto& s = *static_cast<Source*>(from);
        if (s.bytes.size() - s.at < length) return CAIRO_STATUS_READ_ERROR;
        s.bytes.copy(reinterpret_cast<char*>(data), length, s.at);
        s.at += length;
        return CAIRO_STATUS_SUCCESS;
      },
      &source);
  REQUIRE(cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS);
  Pixels pixels{
      cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {}};
  const unsigned char* data = cairo_image_surface_get_data(surface);
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      std::uint32_t colour;
      std::memcpy(&colour, data + y * cairo_image_surface_get_stride(surface) + 4 * x, 4);
      pixels.colours.push_back(colour & 0xffffff);
    }
  }
  cairo_surface_destroy(surface);
  return pixels;
}

/// Up to the rounding of the surface.
inline bool has_colour(std::uint32_t pixel, const Colour& c) {
  const auto near = [&](int shift, double part) {
    return std::abs(static_cast<double>(pixel >> shift & 0xff) - 255 * part) <= 1;
  };
  return near(16, c.red) && near(8, c.green) && near(0, c.blue);
}

}  // namespace apothem::test
