#include "lib/output/run_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/locale/encoding_utf.hpp>
#include <cmath>
#include <filesystem>

#include "lib/output/convex_cells.hpp"
#include "lib/output/frame_container.hpp"
#include "lib/output/vtu_file.hpp"
#include "lib/system/input_file.hpp"
#include "lib/text/csv.hpp"
#include "lib/text/error.hpp"

namespace apothem {
namespace {

std::vector<Vec2> vectors(const FileArray& array, size_t count) {
  std::vector<Vec2> result;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) result.push_back(array.vector(i));
  return result;
}

// The arrays of the cells of a frame.
struct CellArrays {
  explicit CellArrays(const GridFile& file)
      : body(file.cell_array("body")),
        part(file.cell_array("part")),
        material(file.cell_array("material")),
        motion(file.cell_array("motion")) {
    for (size_t i = 0; i < kBodyQuantities.size(); ++i) {
      const BodyQuantity& quantity = kBodyQuantities[i];
      const bool there = quantity.in_frames() && file.of_cells.contains(quantity.name);
      if (there) quantities[i] = &file.cell_array(quantity.name, quantity.components());
    }
  }
  const FileArray &body, &part, &material, &motion;
  std::array<const FileArray*, kBodyQuantities.size()> quantities{};  // null: not there
};

// The values of cell `c` for the body that it belongs to.
void read_body(const CellArrays& arrays, size_t c, FrameBody& body) {
  body.present = true;
  body.motion = static_cast<Motion>(std::lround(arrays.motion(c)));
  for (size_t i = 0; i < kBodyQuantities.size(); ++i) {
    if (!kBodyQuantities[i].in_frames()) continue;
    const FileArray* const values = arrays.quantities[i];
    if (!values) body.values[i].fill(std::nan(""));
    for (int k = 0; values && k < kBodyQuantities[i].components(); ++k) {
      body.values[i][static_cast<size_t>(k)] = (*values)(c, static_cast<size_t>(k));
    }
  }
}

void name_bodies(const FrameNames& names, Frame& frame) {
  for (const std::string& name : names.bodies) {
    FrameBody& body = frame.bodies.emplace_back();
    body.name = name;
    body.meshed = frame.bodies.size() > names.rigid_bodies;
  }
  frame.material_names = names.materials;
}

// Adds the element or rigid body of cell `c`.
void add_element(const GridFile& file, const CellArrays& arrays, size_t c, Frame& frame) {
  const int body = static_cast<int>(arrays.body(c));
  if (body < 0 || body >= static_cast<int>(frame.bodies.size())) {
    throw ResultsError(fmt::format("{}: there is no name of body {}", file.name, body));
  }
  frame.body.push_back(body);
  frame.material.push_back(static_cast<int>(arrays.material(c)));
  FrameBody& of_element = frame.bodies[body];
  if (!of_element.present) read_body(arrays, c, of_element);
}

// Adds the element that these cells are together. Only rigid bodies have holes.
void add_joined(const std::vector<std::vector<int>>& cells, bool rigid, Frame& frame) {
  if (!rigid) return frame.mesh.add_element(joined(cells));
  std::vector<std::vector<int>> rings = rings_around(cells);
  const auto extent = [&](const std::vector<int>& ring) {
    return box_of(frame.mesh.places(ring)).extent();
  };
  std::ranges::iter_swap(rings.begin(), std::ranges::max_element(rings, {}, extent));
  if (rings.size() > 1) {
    frame.holes[frame.mesh.element_count()].assign(rings.begin() + 1, rings.end());
  }
  frame.mesh.add_element(rings[0]);
}

// The stresses of the elements, of which each begins with one of these cells.
void read_stresses(const GridFile& file, const std::vector<size_t>& cells, Frame& frame) {
  frame.stress.resize(cells.size());
  if (all_rigid(frame)) return;
  const FileArray &in_plane = file.cell_array("stress", 3), &across = file.cell_array("stress_zz");
  for (size_t e = 0; e < cells.size(); ++e) {
    if (!frame.body_of(static_cast<int>(e)).meshed) continue;
    const size_t c = cells[e];
    frame.stress[e] = {in_plane(c, 0), in_plane(c, 1), in_plane(c, 2), across(c)};
  }
}

}  // namespace

Rings rings_of(std::span<const Vec2> places, std::span<const int> element,
               const ElementHoles& holes, int number) {
  Rings rings;
  const auto add = [&](std::span<const int> nodes) {
    std::vector<Vec2>& ring = rings.emplace_back();
    for (const int node : nodes) ring.push_back(places[static_cast<size_t>(node)]);
  };
  add(element);
  if (holes.empty()) return rings;
  if (const auto found = holes.find(number); found != holes.end()) {
    for (const std::vector<int>& hole : found->second) add(hole);
  }
  return rings;
}

bool all_rigid(const Frame& frame) {
  return std::ranges::none_of(frame.bodies, [](const FrameBody& body) { return body.meshed; });
}

FrameNames read_names(const std::string& file) {
  if (!refusal_of_input(file).empty()) {
    throw ResultsError(file +
                       ": there is no such file, which has the names of the bodies; these are no "
                       "results of a run, or those of an older version of the program");
  }
  std::vector<CsvRow> rows;
  try {
    rows = read_csv(file);
  } catch (const SceneError&) {
    rows.clear();
  }
  bool sound = !rows.empty() && rows[0].cells == std::vector<std::string>{"kind", "number", "name"};
  FrameNames names;
  for (size_t i = 1; sound && i < rows.size(); ++i) {
    sound = rows[i].cells.size() == 3;
    if (!sound) break;
    const std::string &kind = rows[i].cells[0], &name = rows[i].cells[2];
    (kind == "material" ? names.materials : names.bodies).push_back(name);
    names.rigid_bodies += kind == "rigid_body";
  }
  if (!sound) throw ResultsError(file + ": is no table of names, or a damaged one");
  return names;
}

RunFolder::RunFolder(std::string folder) : folder_(std::move(folder)) {
  if (!std::filesystem::is_directory(folder_)) {
    throw ResultsError(folder_ + ": there is no such folder");
  }
  std::string list = folder_ + "/frames.pvd";
  if (!has("frames.pvd") && has(FrameContainer::kNumbers)) {
    container_ = std::make_shared<ContainedFrames>(folder_);
    times_ = container_->times();
    list = folder_ + "/" + FrameContainer::kNumbers;
  } else if (!has("frames.pvd")) {
    throw ResultsError(list + ": there is no such file; give the folder of results of a run");
  } else {
    for (auto& [time, file] : read_pvd(list)) {
      times_.push_back(time);
      files_.push_back(std::move(file));
    }
  }
  if (times_.empty()) throw ResultsError(list + ": there is no frame in it yet");
  names_ = read_names(folder_ + "/names.csv");
}

size_t RunFolder::nearest(double time) const {
  const double margin = 1e-9 * (times_.back() - times_.front());
  if (!(time >= times_.front() - margin && time <= times_.back() + margin)) {
    throw ResultsError(fmt::format("{}: there is no frame at {} s; there are {} from {} s to {} s",
                                   folder_, time, times_.size(), times_.front(), times_.back()));
  }
  size_t best = 0;
  for (size_t i = 1; i < times_.size(); ++i) {
    if (std::abs(times_[i] - time) < std::abs(times_[best] - time)) best = i;
  }
  return best;
}

// All files of a frame are written before a .pvd file lists its bodies.
GridFile RunFolder::grid(const char* series, size_t number) const {
  if (container_) return container_->read(series, number);
  static const std::string kBodies = "/bodies_";
  std::string file = folder_ + "/" + files_.at(number);
  const size_t at = file.rfind(kBodies);
  if (at != std::string::npos) file.replace(at, kBodies.size(), fmt::format("/{}_", series));
  return read_vtu(file);
}

Frame RunFolder::frame(size_t number) const {
  const GridFile file = grid("bodies", number);
  Frame frame;
  frame.time = times_.at(number);
  name_bodies(names_, frame);
  frame.position = file.points;
  frame.displacement = vectors(file.point_array("displacement", 2), file.points.size());
  frame.velocity = vectors(file.point_array("velocity", 2), file.points.size());
  frame.mesh.nodes.reserve(file.points.size());
  for (size_t i = 0; i < file.points.size(); ++i) {
    frame.mesh.nodes.emplace_back(file.points[i] - frame.displacement[i]);
  }
  const CellArrays arrays(file);
  std::vector<size_t> first;  // cells of the elements
  for (size_t c = 0; c < file.cells();) {
    size_t end = c + 1;
    while (end < file.cells() && arrays.part(end) > 0) ++end;
    if (end == c + 1) {
      frame.mesh.add_element(
          std::span(file.corners)
              .subspan(file.first[c], static_cast<size_t>(file.first[c + 1] - file.first[c])));
    } else {
      std::vector<std::vector<int>> parts;
      for (size_t i = c; i < end; ++i) parts.push_back(file.cell(i));
      add_joined(parts, arrays.body(c) < static_cast<double>(names_.rigid_bodies), frame);
    }
    add_element(file, arrays, c, frame);
    first.push_back(c);
    c = end;
  }
  read_stresses(file, first, frame);
  return frame;
}

std::vector<ForceChain> RunFolder::chains(size_t number) const {
  const GridFile file = grid("chains", number);
  const FileArray &a = file.cell_array("body_a"), &b = file.cell_array("body_b");
  const FileArray& normal = file.cell_array("normal_force");
  const FileArray& chain = file.cell_array("chain");
  std::vector<ForceChain> chains;
  for (size_t c = 0; c < file.cells(); ++c) {
    const std::vector<Vec2> line = file.line(c);
    if (line.size() != 2) throw ResultsError(file.name + ": a part of a chain is no line");
    if (c > 0 && chain(c) == chain(c - 1)) {
      chains.back().line.push_back(line[1]);
    } else {
      chains.push_back({static_cast<int>(a(c)), static_cast<int>(b(c)), line, normal(c)});
    }
  }
  return chains;
}

std::vector<SurfaceRecord> RunFolder::surfaces(size_t number) const {
  const GridFile file = grid("surfaces", number);
  std::vector<SurfaceRecord> surfaces;
  for (size_t c = 0; c < file.cells(); ++c) {
    const std::vector<Vec2> ends = file.line(c);
    if (ends.size() != 2) throw ResultsError(file.name + ": a part of a surface is no line");
    surfaces.push_back({static_cast<int>(file.cell_array("body")(c)), ends[0], ends[1],
                        file.cell_array("contact_pressure")(c),
                        file.cell_array("tangential_traction")(c)});
  }
  return surfaces;
}

bool RunFolder::has_roses() const {
  return container_ ? container_->has("roses", 0) : has("roses.pvd");
}

bool RunFolder::has(const std::string& file) const {
  return std::filesystem::exists(folder_ + '/' + file);
}

std::vector<Rose> RunFolder::roses(size_t number) const {
  const GridFile file = grid("roses", number);
  const FileArray& frequency = file.point_array("frequency");
  const FileArray& region = file.cell_array("region");
  std::vector<Rose> roses;
  const auto add = [&](int point) {
    roses.back().line.push_back(file.points[static_cast<size_t>(point)]);
    roses.back().frequency.push_back(frequency(static_cast<size_t>(point)));
  };
  for (size_t c = 0; c < file.cells(); ++c) {
    const std::vector<int> edge = file.cell(c);
    if (edge.size() != 2) throw ResultsError(file.name + ": a part of a rose is no line");
    if (c == 0 || region(c) != region(c - 1)) {
      roses.emplace_back();
      add(edge[0]);
    }
    add(edge[1]);
  }
  return roses;
}

std::string folder_title(const std::string& folder) {
  const std::filesystem::path path =
      std::filesystem::absolute(std::filesystem::path(folder)).lexically_normal();
  const std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
  return boost::locale::conv::utf_to_utf<char>(name);  // pictures cannot have invalid UTF-8
}

HistoryTable read_table(const std::string& folder, const std::string& file) {
  const std::string path = folder + "/" + file;
  if (!std::filesystem::exists(path)) {
    throw ResultsError(path + ": there is no such file; give the folder of results of a run");
  }
  try {
    return read_history(path);
  } catch (const std::runtime_error& error) {
    throw ResultsError(error.what());
  }
}

namespace {

// The first frame not before `time` and not after `latest`, s.
size_t first_between(const RunFolder& run, double time, double latest) {
  const std::vector<double>& times = run.times();
  for (size_t i = 0; i < times.size(); ++i) {
    if (times[i] >= time - 1e-6 * (latest - time) && times[i] <= latest) return i;
  }
  throw ResultsError(fmt::format("{}: there is no frame at {} s", run.path(), time));
}

}  // namespace

Frame read_frame(const std::string& folder, double time, double latest) {
  const RunFolder run(folder);
  return run.frame(first_between(run, time, latest));
}

std::vector<SurfaceRecord> read_surfaces(const std::string& folder, double time, double latest) {
  const RunFolder run(folder);
  return run.surfaces(first_between(run, time, latest));
}

}  // namespace apothem
