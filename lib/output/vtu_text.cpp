#include "lib/output/vtu_text.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <span>
#include <string_view>

#include "lib/output/html.hpp"

namespace apothem {
namespace {

constexpr size_t kBlock = 1 << 15;   // bytes that are compressed at a time
constexpr size_t kSample = 1 << 12;  // bytes that tell whether it is worth while
constexpr size_t kWorth = kSample * 7 / 8;

// Compresses blocks as zlib does, with the memory for it kept.
class Deflater {
 public:
  Deflater(int level, int strategy) {
    constexpr int kWindow = 15, kMemory = 8;  // zlib's own choice
    if (deflateInit2(&stream_, level, Z_DEFLATED, kWindow, kMemory, strategy) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  // Adds the compressed bytes to a text. Returns how many these are.
  size_t add_to(std::string& text, std::string_view bytes) {
    deflateReset(&stream_);
    const size_t before = text.size();
    text.resize(before + deflateBound(&stream_, bytes.size()));
    // Zlib does not write there, but has no const in this place.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    stream_.next_out = reinterpret_cast<Bytef*>(text.data() + before);
    stream_.avail_out = static_cast<uInt>(text.size() - before);
    deflate(&stream_, Z_FINISH);
    text.resize(text.size() - stream_.avail_out);
    return text.size() - before;
  }

 private:
  z_stream stream_{};
};

// Writes the arrays of a file.
class VtuText {
 public:
  std::string text;

  // The numbers of an array with this name and so many components.
  template <class Number>
  void add(const char* type, std::string_view name, std::span<const Number> numbers,
           std::string_view attributes = "") {
    fmt::format_to(std::back_inserter(text), "<DataArray type=\"{}\" Name=\"{}\"{} format=\"{}\">",
                   type, name, attributes, numbers.empty() ? "ascii" : "binary");
    if (numbers.empty()) {
      text += '\n';  // meshio wants some text
    } else {
      add_bytes({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
    }
    text += "</DataArray>\n";
  }

 private:
  // Numbers with much chance in their digits are stored as they are, which zlib would pack by a
  // tenth at best, in most of the time that a file takes. Of other numbers often nothing can be
  // packed but the zeros along z, for which it is enough to look for runs.
  [[nodiscard]] Deflater& fit_for(std::string_view bytes) {
    if (bytes.size() < 2 * kSample) return fast_;
    const std::string_view sample = bytes.substr(bytes.size() / 2, kSample);
    packed_.clear();
    const size_t packed = fast_.add_to(packed_, sample);
    if (packed > kWorth) return none_;
    return runs_.add_to(packed_, sample) < packed + packed / 8 ? runs_ : fast_;
  }

  void add_bytes(std::string_view bytes) {
    Deflater& deflater = fit_for(bytes);
    packed_.clear();
    std::vector<std::uint32_t> head{
        static_cast<std::uint32_t>((bytes.size() + kBlock - 1) / kBlock),
        static_cast<std::uint32_t>(kBlock), static_cast<std::uint32_t>(bytes.size() % kBlock)};
    for (size_t at = 0; at < bytes.size(); at += kBlock) {
      head.push_back(
          static_cast<std::uint32_t>(deflater.add_to(packed_, bytes.substr(at, kBlock))));
    }
    add_base64(text, {reinterpret_cast<const char*>(head.data()), head.size() * sizeof head[0]});
    add_base64(text, packed_);
  }

  // Higher levels take up to twice as long for 2 %.
  Deflater fast_{1, Z_DEFAULT_STRATEGY}, runs_{1, Z_RLE}, none_{0, Z_DEFAULT_STRATEGY};
  std::string packed_;
};

// Vectors of the plane, as those of space that VTK knows.
void add_vectors(VtuText& out, std::string_view name, std::span<const double> plane) {
  std::vector<double> space(plane.size() / 2 * 3, 0);
  for (size_t i = 0; i < plane.size() / 2; ++i) {
    space[3 * i] = plane[2 * i];
    space[3 * i + 1] = plane[2 * i + 1];
  }
  out.add<double>("Float64", name, space, " NumberOfComponents=\"3\"");
}

void add_array(VtuText& out, const GridArray& array) {
  if (array.is_whole) return out.add<std::int32_t>("Int32", array.name, array.integers);
  if (array.is_vector()) return add_vectors(out, array.name, array.reals);
  std::string attributes;
  if (array.columns > 1) attributes = fmt::format(" NumberOfComponents=\"{}\"", array.columns);
  for (size_t k = 0; k < array.parts.size(); ++k) {
    attributes += fmt::format(" ComponentName{}=\"{}\"", k, array.parts[k]);
  }
  out.add<double>("Float64", array.name, array.reals, attributes);
}

// One row for the polygon without points, as text.
void add_row_of_nothing(std::string& text, const GridArray& array) {
  const size_t columns = array.is_vector() ? 3 : array.columns;
  text +=
      fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">",
                  array.is_whole ? "Int32" : "Float64", array.name, columns);
  for (size_t k = 0; k < columns; ++k) text += array.is_whole ? "-1 " : "0 ";
  text += "</DataArray>\n";
}

void add_cells_of_nothing(VtuText& out, const FrameGrid& grid) {
  out.text += "<PointData>\n";
  for (const GridArray& array : grid.of_points) add_array(out, array);
  out.text += "</PointData>\n<CellData>\n";
  for (const GridArray& array : grid.of_cells) add_row_of_nothing(out.text, array);
  out.text +=
      "</CellData>\n"
      "<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" "
      "format=\"ascii\">\n</DataArray></Points>\n"
      "<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n</DataArray>\n"
      "<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">0</DataArray>\n"
      "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">7</DataArray>\n</Cells>\n";
}

void add_cells(VtuText& out, const FrameGrid& grid) {
  constexpr std::array<std::uint8_t, 3> kTypes{1, 3, 7};  // VTK_VERTEX, VTK_LINE, VTK_POLYGON
  out.text += "<PointData>\n";
  for (const GridArray& array : grid.of_points) add_array(out, array);
  out.text += "</PointData>\n<CellData>\n";
  for (const GridArray& array : grid.of_cells) add_array(out, array);
  out.text += "</CellData>\n<Points>\n";
  add_vectors(out, "Points", {grid.points.data()->data(), 2 * grid.points.size()});
  out.text += "</Points>\n<Cells>\n";
  out.add<std::int32_t>("Int32", "connectivity", grid.corners);
  out.add<std::int32_t>("Int32", "offsets", grid.ends);
  const std::vector<std::uint8_t> types(grid.ends.size(), kTypes[static_cast<size_t>(grid.kind)]);
  out.add<std::uint8_t>("UInt8", "types", types);
  out.text += "</Cells>\n";
}

}  // namespace

std::string vtu_text(const FrameGrid& grid, double time) {
  VtuText out;
  const bool empty = grid.ends.empty();
  out.text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt32\" "
      "compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n<FieldData>\n"
      "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}"
      "</DataArray>\n</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      time, grid.points.size(), empty ? 1 : grid.ends.size());
  empty ? add_cells_of_nothing(out, grid) : add_cells(out, grid);
  out.text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return std::move(out.text);
}

}  // namespace apothem
