#include "lib/output/frame_container.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>

#include "lib/output/run_folder.hpp"
#include "lib/system/input_file.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

constexpr std::string_view kEnd = "</Grid>\n</Domain>\n</Xdmf>\n";

// A frame has a name that sorts.
std::string name_of_frame(size_t number) { return fmt::format("{:06}", number); }

// The beginning of an entry, by which it is found again.
std::string start_of_entry(size_t number) {
  return fmt::format("<Grid Name=\"{}\"", name_of_frame(number));
}

// Of a frame: when it is; of a series: that it has no cells.
constexpr const char *kTimeOfFrame = "time", *kWithoutCells = "empty";
constexpr std::string_view kPolygons = "bodies";       // the series whose cells are polygons
constexpr size_t kLargestContainer = size_t{1} << 40;  // bytes

// Kinds of cells in the mixed lists of XDMF.
constexpr std::int32_t kTriangle = 4, kQuadrilateral = 5;

// The cells of a grid with its polygons cut into triangles and quadrilaterals, which all readers
// know, and where each of them comes from.
struct CutCells {
  std::vector<std::int32_t> list;  // kind and corners of each
  std::vector<size_t> source;
  bool cut = false;  // some have been
};

CutCells cut_cells(const FrameGrid& grid) {
  CutCells cells;
  cells.list.reserve(grid.corners.size() + grid.ends.size());
  size_t first = 0;
  for (size_t c = 0; c < grid.ends.size(); ++c) {
    const auto end = static_cast<size_t>(grid.ends[c]);
    for (size_t at = first + 1; at + 1 < end;) {
      const bool four = at + 2 < end;
      cells.list.push_back(four ? kQuadrilateral : kTriangle);
      cells.list.push_back(grid.corners[first]);
      for (size_t k = 0; k < (four ? 3 : 2); ++k) cells.list.push_back(grid.corners[at + k]);
      at += four ? 2 : 1;
      cells.source.push_back(c);
    }
    cells.cut = cells.cut || end - first > 4;
    first = end;
  }
  return cells;
}

GridArray array_of(Hdf5Array array) {
  GridArray result{.name = "", .columns = array.columns, .is_whole = array.is_whole};
  if (array.is_whole) {
    for (const double value : array.values) {
      result.integers.push_back(static_cast<std::int32_t>(value));
    }
  } else {
    result.reals = std::move(array.values);
  }
  return result;
}

template <class Number>
std::vector<Number> chosen(const std::vector<Number>& values, size_t columns,
                           const std::vector<size_t>& rows) {
  std::vector<Number> result;
  result.reserve(rows.size() * columns);
  for (const size_t row : rows) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(row * columns);
    result.insert(result.end(), from, from + static_cast<std::ptrdiff_t>(columns));
  }
  return result;
}

// The values of cells that have been cut. What a body or an element consists of is counted anew.
GridArray of_cut_cells(const GridArray& array, const CutCells& cells) {
  GridArray result = array;
  result.integers =
      array.is_whole ? chosen(array.integers, 1, cells.source) : std::vector<std::int32_t>();
  if (!array.is_whole) result.reals = chosen(array.reals, array.columns, cells.source);
  if (array.name != "part") return result;
  for (size_t i = 1; i < cells.source.size(); ++i) {
    const bool begins =
        array.integers[cells.source[i]] == 0 && cells.source[i] != cells.source[i - 1];
    result.integers[i] = begins ? 0 : result.integers[i - 1] + 1;
  }
  return result;
}

bool same_bits(const GridArray& a, const GridArray& b) {
  return a.is_whole == b.is_whole && a.columns == b.columns && a.integers == b.integers &&
         a.reals.size() == b.reals.size() &&
         (a.reals.empty() ||
          std::memcmp(a.reals.data(), b.reals.data(), a.reals.size() * sizeof(double)) == 0);
}

std::string data_item(const GridArray& array, const std::string& path) {
  const size_t rows = (array.is_whole ? array.integers.size() : array.reals.size()) / array.columns;
  return fmt::format(
      "<DataItem DataType=\"{}\" Precision=\"{}\" Dimensions=\"{}{}\" "
      "Format=\"HDF\">{}:/{}</DataItem>",
      array.is_whole ? "Int" : "Float", array.is_whole ? 4 : 8, rows,
      array.columns > 1 ? fmt::format(" {}", array.columns) : "", FrameContainer::kNumbers, path);
}

// A grid without cells has one cell without size, because not all readers know grids of none. Its
// whole numbers are -1 and its other values 0, as in .vtu files.
FrameGrid with_cell(FrameGrid grid, const Vec2& place) {
  const std::int32_t point = grid.add_point(place);
  grid.kind == FrameGrid::Kind::points  ? grid.add_cell({point})
  : grid.kind == FrameGrid::Kind::lines ? grid.add_cell({point, point})
                                        : grid.add_cell({point, point, point});
  for (std::vector<GridArray>* arrays : {&grid.of_points, &grid.of_cells}) {
    for (GridArray& array : *arrays) {
      array.is_whole ? array.integers.assign(1, -1) : array.reals.assign(array.columns, 0);
    }
  }
  return grid;
}

}  // namespace

XdmfList::XdmfList(std::string file, std::string_view name, size_t frames)
    : file_(std::move(file)),
      descriptor_(::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw SystemFailure(file_, errno);
  std::string text;
  if (frames == 0) {
    text = fmt::format(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"{}\" "
        "GridType=\"Collection\" CollectionType=\"Temporal\">\n",
        name);
  } else {
    text = read_bytes(file_);
    const bool there = text.find(start_of_entry(frames - 1)) != std::string::npos;
    const size_t end = std::min(text.find(start_of_entry(frames)), text.rfind(kEnd));
    if (!there || end == std::string::npos) {
      throw SystemFailure(file_,
                          "is not as the run has written it; put it back, or run anew with "
                          "--overwrite");
    }
    text.resize(end);
  }
  write(text);
}

XdmfList::~XdmfList() { ::close(descriptor_); }

void XdmfList::add(std::string_view entry) {
  require_untouched(file_, descriptor_, size_ + static_cast<std::int64_t>(kEnd.size()));
  write(entry);
}

void XdmfList::take_back() {
  size_ = before_;
  write("");
}

// The text and the end of the file, at once, so that readers may come at any moment.
void XdmfList::write(std::string_view text) {
  std::string all(text);
  all += kEnd;
  if (::pwrite(descriptor_, all.data(), all.size(), size_) != static_cast<ssize_t>(all.size()) ||
      ::ftruncate(descriptor_, size_ + static_cast<off_t>(all.size())) != 0) {
    const int error = errno;
    if (::pwrite(descriptor_, kEnd.data(), kEnd.size(), size_) > 0) {
      static_cast<void>(::ftruncate(descriptor_, size_ + static_cast<off_t>(kEnd.size())));
    }
    throw SystemFailure(file_, error);
  }
  before_ = size_;
  size_ += static_cast<std::int64_t>(text.size());
}

FrameContainer::FrameContainer(const std::string& folder, size_t frames)
    : bodies_(folder + "/" + kBodies, "bodies", frames),
      others_(folder + "/" + kOthers, "others", frames) {
  const std::string file = folder + "/" + kNumbers;
  Hdf5State kept;
  if (frames > 0) {
    try {
      const Hdf5Reader reader(file);
      if (reader.root().size() < frames) throw std::runtime_error("has lost frames");
      kept = reader.state(frames);
      remember(reader, reader.root()[frames - 1].address);
    } catch (const std::runtime_error& error) {
      throw SystemFailure(file, fmt::format("{}; put it back as the run has written it, or run "
                                            "anew with --overwrite",
                                            error.what()));
    }
  }
  numbers_.emplace(file, kept);
  count_ = frames;
}

// The arrays of a frame, as if it had just been written.
void FrameContainer::remember(const Hdf5Reader& reader, std::uint64_t frame) {
  for (const Hdf5Link& series : reader.group(frame)) {
    if (series.name == kTimeOfFrame) continue;
    for (const Hdf5Link& part : reader.group(series.address)) {
      const std::string key = series.name + "/" + part.name;
      if (!part.name.ends_with("_data")) {
        before_[key] = {array_of(reader.array(part.address)), part.address};
        continue;
      }
      for (const Hdf5Link& data : reader.group(part.address)) {
        before_[key + "/" + data.name] = {array_of(reader.array(data.address)), data.address};
      }
    }
  }
}

std::uint64_t FrameContainer::add_array(const std::string& key, GridArray array) {
  const auto before = before_.find(key);
  Kept kept{std::move(array)};
  if (before != before_.end() && same_bits(before->second.array, kept.array)) {
    kept.address = before->second.address;
  } else {
    const size_t columns = kept.array.columns > 1 ? kept.array.columns : 0;
    kept.address = kept.array.is_whole ? numbers_->add(kept.array.integers, columns)
                                       : numbers_->add(kept.array.reals, columns);
  }
  const std::uint64_t address = kept.address;
  now_[key] = std::move(kept);
  return address;
}

// Adds the numbers of a grid, and to `entry` how to read them. Returns the group's address.
std::uint64_t FrameContainer::add_grid(const NamedGrid& of, const std::string& frame,
                                       const Vec2& place, std::string& entry) {
  const bool empty = of.grid.ends.empty();
  const FrameGrid grid = empty ? with_cell(of.grid, place) : of.grid;
  const std::string path = frame + "/" + of.name;
  std::vector<Hdf5Link> links;
  const auto item = [&](const std::string& place_in, const char* name, GridArray array,
                        std::vector<Hdf5Link>& group) {
    const std::string text = data_item(array, path + place_in + name);
    group.push_back({name, add_array(of.name + place_in + name, std::move(array))});
    return text;
  };
  const auto out = std::back_inserter(entry);
  GridArray cells = GridArray::whole_numbers("cells"), points = GridArray::vectors("points");
  const CutCells cut = grid.kind == FrameGrid::Kind::polygons ? cut_cells(grid) : CutCells();
  cells.columns = grid.kind == FrameGrid::Kind::lines ? 2 : 1;
  cells.integers = grid.kind == FrameGrid::Kind::polygons ? cut.list : grid.corners;
  const size_t count =
      grid.kind == FrameGrid::Kind::polygons ? cut.source.size() : grid.ends.size();
  points.reals.assign(grid.points.data()->data(),
                      grid.points.data()->data() + 2 * grid.points.size());
  constexpr std::array kTopologies{"Polyvertex\" NodesPerElement=\"1",
                                   "Polyline\" NodesPerElement=\"2", "Mixed"};
  fmt::format_to(out, "<Topology TopologyType=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                 kTopologies[static_cast<size_t>(grid.kind)], count,
                 item("/", "cells", std::move(cells), links));
  fmt::format_to(out, "<Geometry GeometryType=\"XY\">{}</Geometry>\n",
                 item("/", "points", std::move(points), links));
  const auto add_data = [&](const char* where, const char* centre,
                            const std::vector<GridArray>& arrays) {
    std::vector<Hdf5Link> group;
    for (const GridArray& array : arrays) {
      const bool cells_cut = cut.cut && arrays.data() == grid.of_cells.data();
      const std::string text = item(fmt::format("/{}/", where), array.name.c_str(),
                                    cells_cut ? of_cut_cells(array, cut) : array, group);
      fmt::format_to(out,
                     "<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
                     array.name, array.columns > 1 ? "Vector" : "Scalar", centre, text);
    }
    if (!group.empty()) links.push_back({where, numbers_->add_group(group)});
  };
  add_data("point_data", "Node", grid.of_points);
  add_data("cell_data", "Cell", grid.of_cells);
  if (empty) links.push_back({kWithoutCells, links.front().address});
  return numbers_->add_group(links);
}

void FrameContainer::add(double time, const std::vector<NamedGrid>& grids) {
  const std::string name = name_of_frame(count_), start = start_of_entry(count_);
  const std::string at = fmt::format("<Time Value=\"{}\"/>\n", time);
  std::string bodies = start + " GridType=\"Uniform\">" + at;
  std::string others = start + " GridType=\"Collection\" CollectionType=\"Spatial\">" + at;
  const std::vector<Vec2>& places = grids.front().grid.points;
  const Vec2 place = places.empty() ? Vec2(0, 0) : places.front();
  now_.clear();
  std::vector<Hdf5Link> links{{kTimeOfFrame, numbers_->add(std::span(&time, 1))}};
  for (const NamedGrid& of : grids) {
    const bool first = &of == grids.data();
    std::string entry;
    links.push_back({of.name, add_grid(of, name, place, entry)});
    if (!first) others += fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">\n", of.name);
    (first ? bodies : others) += entry + "</Grid>\n";
  }
  const Hdf5State earlier = numbers_->state();
  numbers_->commit({name, numbers_->add_group(links)});
  try {
    others_.add(others + "</Grid>\n");
    try {
      bodies_.add(bodies);
    } catch (...) {
      others_.take_back();
      throw;
    }
  } catch (...) {
    numbers_->cut_off(earlier);
    throw;
  }
  before_ = std::move(now_);
  ++count_;
}

void FrameContainer::make_last() const {
  numbers_->make_last();
  bodies_.make_last();
  others_.make_last();
}

ContainedFrames::ContainedFrames(const std::string& folder)
    : file_(folder + "/" + FrameContainer::kNumbers) {
  const std::string refusal = refusal_of_input(file_, kLargestContainer);
  if (!refusal.empty()) throw ResultsError(file_ + ": " + refusal);
  guarded([&] {
    reader_.emplace(file_);
    for (const Hdf5Link& frame : reader_->root()) {
      frames_.push_back(frame.address);
      times_.push_back(reader_->array(linked(frame.address, kTimeOfFrame)).values.at(0));
    }
  });
}

// Calls read() and says in which file it has found something wrong.
template <class Read>
void ContainedFrames::guarded(const Read& read) const {
  try {
    read();
  } catch (const ResultsError&) {
    throw;
  } catch (const std::exception& error) {
    throw ResultsError(fmt::format("{}: {}", file_, error.what()));
  }
}

// The address of what has this name in a group; 0: there is none.
std::uint64_t ContainedFrames::find(std::uint64_t group, std::string_view name) const {
  const std::vector<Hdf5Link> links = reader_->group(group);
  const auto found = std::ranges::find(links, name, &Hdf5Link::name);
  return found == links.end() ? 0 : found->address;
}

std::uint64_t ContainedFrames::linked(std::uint64_t group, std::string_view name) const {
  const std::uint64_t address = find(group, name);
  if (address == 0) throw ResultsError(fmt::format("{}: has no \"{}\"", file_, name));
  return address;
}

bool ContainedFrames::has(const std::string& series, size_t frame) const {
  bool there = false;
  guarded([&] { there = find(frames_.at(frame), series) != 0; });
  return there;
}

GridFile::Arrays ContainedFrames::arrays(std::uint64_t group, std::string_view name) const {
  GridFile::Arrays arrays;
  const std::uint64_t address = find(group, name);
  if (address == 0) return arrays;
  for (const Hdf5Link& link : reader_->group(address)) {
    Hdf5Array array = reader_->array(link.address);
    FileArray& result = arrays[link.name];
    result.components = array.columns == 2 ? 3 : static_cast<int>(array.columns);
    if (array.columns != 2) {
      result.values = std::move(array.values);
      continue;
    }
    // As vectors are in .vtu files.
    for (size_t i = 0; i + 1 < array.values.size(); i += 2) {
      result.values.insert(result.values.end(), {array.values[i], array.values[i + 1], 0});
    }
  }
  return arrays;
}

void ContainedFrames::read_cells(std::uint64_t group, bool mixed, GridFile& into) const {
  const Hdf5Array cells = reader_->array(linked(group, "cells"));
  const auto points = static_cast<double>(into.points.size());
  const auto add = [&](size_t at, size_t count) {
    if (count > cells.values.size() - at) throw std::runtime_error("is damaged");
    for (size_t k = at; k < at + count; ++k) {
      const double corner = cells.values[k];
      if (!(corner >= 0 && corner < points)) throw std::runtime_error("is damaged");
      into.corners.push_back(static_cast<int>(corner));
    }
    into.first.push_back(static_cast<int>(into.corners.size()));
  };
  for (size_t at = 0; at < cells.values.size();) {
    const size_t count = !mixed ? cells.columns : cells.values[at] == kTriangle ? 3 : 4;
    at += mixed;
    add(at, count);
    at += count;
  }
}

GridFile ContainedFrames::read(const std::string& series, size_t frame) const {
  GridFile file;
  file.name = fmt::format("{}:/{}/{}", file_, name_of_frame(frame), series);
  guarded([&] {
    const std::uint64_t group = linked(frames_.at(frame), series);
    file.of_file["TimeValue"] = {1, {times_.at(frame)}};
    if (find(group, kWithoutCells) != 0) return;
    const Hdf5Array points = reader_->array(linked(group, "points"));
    if (points.columns != 2) throw std::runtime_error("is damaged");
    for (size_t i = 0; i + 1 < points.values.size(); i += 2) {
      file.points.emplace_back(points.values[i], points.values[i + 1]);
    }
    read_cells(group, series == kPolygons, file);
    file.of_points = arrays(group, "point_data");
    file.of_cells = arrays(group, "cell_data");
  });
  return file;
}

}  // namespace apothem
