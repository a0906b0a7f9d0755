#include "lib/scene/wkt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "lib/scene/json.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// The text in pieces: words, and the characters ( ) , ; for themselves. An empty piece is the end.
class Pieces {
 public:
  explicit Pieces(std::string_view text) : text_(text) { next(); }

  [[nodiscard]] std::string_view now() const { return now_; }
  [[nodiscard]] int line() const { return line_; }  // of the piece, counted from 1
  [[nodiscard]] std::string_view rest() const { return text_.substr(start_); }  // with the piece
  [[nodiscard]] bool is_word() const { return !now_.empty() && kMarks.find(now_[0]) == npos; }

  void next() {
    for (; at_ < text_.size() && kSpace.find(text_[at_]) != npos; ++at_)
      line_ += text_[at_] == '\n';
    start_ = at_;
    if (at_ < text_.size() && kMarks.find(text_[at_]) != npos) {
      ++at_;
    } else {
      at_ = std::min(text_.find_first_of("(),; \t\r\n\f\v", at_), text_.size());
    }
    now_ = text_.substr(start_, at_ - start_);
  }
  bool take(char mark) {
    if (now_.size() != 1 || now_[0] != mark) return false;
    next();
    return true;
  }

 private:
  static constexpr auto npos = std::string_view::npos;
  static constexpr std::string_view kMarks = "(),;", kSpace = " \t\r\n\f\v";
  std::string_view text_, now_;
  size_t start_ = 0, at_ = 0;  // of the piece, and behind it
  int line_ = 1;
};

constexpr std::array kOtherShapes{"POINT",           "LINESTRING",         "MULTIPOINT",
                                  "MULTILINESTRING", "GEOMETRYCOLLECTION", "CURVEPOLYGON",
                                  "MULTISURFACE",    "POLYHEDRALSURFACE",  "TIN",
                                  "TRIANGLE"};

class Reader {
 public:
  Reader(std::string_view text, const std::string& file) : in_(text), file_(file) {}

  PolygonText read_all() {
    PolygonText polygon = read();
    if (in_.now() == ";") in_.next();
    if (in_.is_word() && upper_case(in_.now()).find("POLYGON") != std::string::npos) {
      fail(std::string("holds more than one polygon; ") + kOnePolygon);
    }
    if (!in_.now().empty()) fail(fmt::format("text behind the polygon: \"{}\"", in_.now()));
    return polygon;
  }

  PolygonText read() {
    skip_coordinate_system();
    const bool several = read_shape() == "MULTIPOLYGON";
    read_dimension();
    if (several) {
      expect('(', "(((x y, ...)))");
      int polygons = 0;
      do {
        PolygonText next = polygon();
        if (polygons++ == 0) polygon_ = std::move(next);
      } while (in_.take(','));
      expect(')', "a , or the ) that ends the MULTIPOLYGON");
      if (polygons > 1) fail(fmt::format("holds {} polygons; {}", polygons, kOnePolygon));
    } else {
      polygon_ = polygon();
    }
    return std::move(polygon_);
  }

  [[nodiscard]] std::string_view rest() const { return in_.rest(); }

 private:
  [[noreturn]] void fail(const std::string& what, int vertex = -1) const {
    throw PolygonError(file_, in_.line(), what, vertex, hole_);
  }
  [[nodiscard]] std::string found() const {
    return in_.now().empty() ? "the text ends" : fmt::format("here stands \"{}\"", in_.now());
  }
  void expect(char mark, const char* wanted) {
    if (!in_.take(mark)) fail(fmt::format("{} where it needs {}", found(), wanted));
  }

  void skip_coordinate_system() {
    if (!upper_case(in_.now()).starts_with("SRID=")) return;
    try {
      parse_count(in_.now().substr(5));
    } catch (const BadNumber& error) {
      fail(std::string("SRID: ") + error.what());
    }
    in_.next();
    expect(';', "a ; behind the SRID");
  }

  // The kind of shape, in capitals. A letter for Z or M may be attached to it.
  std::string read_shape() {
    std::string shape = upper_case(in_.now());
    const bool known = shape.starts_with("POLYGON") || shape.starts_with("MULTIPOLYGON");
    for (const char* suffix : {"ZM", "Z", "M"}) {
      if (known && shape.ends_with(suffix)) refuse_dimension();
    }
    if (shape != "POLYGON" && shape != "MULTIPOLYGON") {
      const bool other = std::ranges::any_of(
          kOtherShapes, [&](const char* name) { return shape.starts_with(name); });
      fail(other ? fmt::format("is a {}; give a POLYGON ((x y, x y, ...))", shape)
                 : "is not a polygon as WKT or JSON" + meant());
    }
    in_.next();
    return shape;
  }

  // Only a word that looks like the name of a shape is quoted: the file may be any other one.
  [[nodiscard]] std::string meant() const {
    const std::string quoted = suggest(in_.now().substr(0, 40), {"POLYGON", "MULTIPOLYGON"});
    return quoted.ends_with('?') ? ": it begins with " + quoted : "";
  }

  void read_dimension() {
    const std::string word = upper_case(in_.now());
    if (word == "Z" || word == "M" || word == "ZM") refuse_dimension();
    if (word == "EMPTY") fail("the polygon is EMPTY; give it three vertices or more");
  }

  [[noreturn]] void refuse_dimension() const {
    fail("has Z or M coordinates, and bodies are two-dimensional: write POLYGON ((x y, x y, ...))");
  }

  PolygonText polygon() {
    if (upper_case(in_.now()) == "EMPTY")
      fail("the polygon is EMPTY; give it three vertices or more");
    expect('(', "(( in front of the first vertex");
    expect('(', "(( in front of the first vertex");
    PolygonText result;
    result.outer = ring();
    while (in_.take(',')) {
      hole_ = static_cast<int>(result.holes.size());
      expect('(', "the ( in front of the first vertex of a hole");
      result.holes.push_back(ring());
    }
    hole_.reset();
    expect(')', "the second ) behind the last vertex");
    return result;
  }

  // The vertices behind a (, and the ) behind them.
  RingText ring() {
    RingText result;
    do {
      vertex(result);
    } while (in_.take(','));
    if (!in_.take(')')) {
      const int n = static_cast<int>(result.ring.size());
      fail(fmt::format("{} behind {}vertex {} where it needs a , or a )", found(), ring_name(),
                       n - 1),
           n - 1);
    }
    leave_out_closing_vertex(result.ring);
    return result;
  }

  [[nodiscard]] std::string ring_name() const {
    return hole_ ? fmt::format("hole {}, ", *hole_) : "";
  }

  void vertex(RingText& to) {
    const int i = static_cast<int>(to.ring.size());
    const int line = in_.line();
    const auto refuse = [&](const std::string& what) {
      throw PolygonError(file_, line, fmt::format("{}vertex {}{}", ring_name(), i, what), i, hole_);
    };
    std::vector<double> numbers;
    for (; in_.is_word(); in_.next()) {
      try {
        numbers.push_back(parse_decimal(in_.now()));
      } catch (const BadNumber& error) {
        refuse(std::string(": ") + error.what());
      }
    }
    if (numbers.empty()) {
      refuse(std::string(" has no coordinates: give x y") +
             (i == 0 ? "" : ", or take away the comma in front of it"));
    }
    if (numbers.size() == 1) {
      refuse(
          fmt::format(" has one coordinate, {}: give x y, with a space between them and a "
                      "point, not a comma, in decimals",
                      numbers[0]));
    }
    if (numbers.size() > 2) {
      refuse(fmt::format(" has {} coordinates, and bodies are two-dimensional: give x y",
                         numbers.size()));
    }
    to.ring.emplace_back(numbers[0], numbers[1]);
    to.lines.push_back(line);
  }

  Pieces in_;
  const std::string& file_;
  PolygonText polygon_;
  std::optional<int> hole_;  // that is being read; none in the outer ring
};

}  // namespace

PolygonText parse_wkt(std::string_view text, const std::string& file) {
  return Reader(text, file).read_all();
}

PolygonText take_wkt(std::string_view& text, const std::string& file) {
  Reader reader(text, file);
  PolygonText polygon = reader.read();
  text = reader.rest();
  return polygon;
}

}  // namespace apothem
