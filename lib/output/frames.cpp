#include "lib/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <filesystem>
#include <string_view>

#include "lib/mesh/boundary.hpp"
#include "lib/output/body_grids.hpp"
#include "lib/output/contact_grids.hpp"
#include "lib/output/convex_cells.hpp"
#include "lib/output/files.hpp"
#include "lib/output/force_lines.hpp"
#include "lib/output/frame_container.hpp"
#include "lib/output/vtu_text.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

constexpr double kFileTime = 1e5;  // of a small file, ns

// A frame to be written.
struct FrameView {
  const Model& model;
  const FrameContents& frame;
  const BodyShapes& shapes;
};

// Files frames/NAME_NUMBER.vtu, one for each frame, and the list of them.
struct Series {
  std::string_view name, list;
  bool (*needed)(const FrameView&);
  FrameGrid (*make)(const FrameView&);
};

bool always(const FrameView& /*of*/) { return true; }

// Those that take longest begin first.
constexpr std::array kSeries{
    Series{"bodies", "frames.pvd", always,
           [](const FrameView& v) { return body_grid(v.model, v.frame, v.shapes.cells); }},
    Series{"contacts", "contacts.pvd", always,
           [](const FrameView& v) { return contact_patches(v.model, v.frame.contacts); }},
    Series{"chains", "chains.pvd", always,
           [](const FrameView& v) { return force_chains(v.model, v.frame); }},
    Series{"outlines", "outlines.pvd", always,
           [](const FrameView& v) { return outline_grid(v.model, v.frame.state, v.shapes.loops); }},
    Series{"roses", "roses.pvd", [](const FrameView& v) { return !v.model.regions.empty(); },
           [](const FrameView& v) { return roses(v.model, v.frame); }},
    Series{"surfaces", "surfaces.pvd", [](const FrameView& v) { return !v.frame.surfaces.empty(); },
           [](const FrameView& v) { return contact_surfaces(v.model, v.frame.surfaces); }}};

constexpr std::string_view kListHead =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
constexpr std::string_view kListEnd = "</Collection>\n</VTKFile>\n";

std::string file_name(const Series& series, size_t frame) {
  return fmt::format("frames/{}_{:06}.vtu", series.name, frame);
}

std::string list_entry(const Series& series, size_t frame, double time) {
  return fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time,
                     file_name(series, frame));
}

// Calls write(i) for i below `count`, which a thread takes when it is free. Throws what the first
// of those threw that have failed; no other one is begun after a failure.
template <class Write>
void work_on(const Threads& threads, size_t count, const Write& write) {
  std::vector<std::exception_ptr> failures(count);
  std::atomic<size_t> next = 0;
  std::atomic<bool> failed = false;
  threads.chunks(threads.count(), kFileTime, [&](int, int, int) {
    for (size_t i = next++; i < count && !failed; i = next++) {
      try {
        write(i);
      } catch (...) {
        failures[i] = std::current_exception();
        failed = true;
      }
    }
  });
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

std::string csv_text(const std::string& name) { return "\"" + replaced(name, "\"", "\"\"") + "\""; }

// The names of the bodies and materials that frames number. Frames hold numbers only, because not
// all readers of VTK files read text in them.
std::string names_table(const Model& model) {
  std::string text = "kind,number,name\n";
  const size_t rigid = model.bodies.size();
  for (size_t i = 0; i < rigid + model.deformables.size(); ++i) {
    text += fmt::format("{},{},{}\n", i < rigid ? "rigid_body" : "deformable_body", i,
                        csv_text(model.name_of(static_cast<BodyIndex>(i))));
  }
  for (size_t i = 0; i < model.materials.size(); ++i) {
    text += fmt::format("material,{},{}\n", i, csv_text(model.materials[i].name));
  }
  return text;
}

}  // namespace

FrameWriter::FrameWriter(std::string folder, const Model& model, std::vector<double> times,
                         int threads, FileList* list, FrameFormat format)
    : folder_(std::move(folder)),
      model_(model),
      threads_(threads),
      times_(std::move(times)),
      list_(list) {
  if (format == FrameFormat::xdmf) {
    create_folder(folder_);
    container_ = std::make_unique<FrameContainer>(folder_, times_.size());
  } else {
    for (const Series& series : kSeries) {
      std::string& entries = lists_.emplace_back(kListHead);
      for (size_t i = 0; i < times_.size(); ++i) entries += list_entry(series, i, times_[i]);
    }
    create_folder(folder_ + "/frames");
  }
  write_file(folder_ + "/names.csv", names_table(model_));
  for (RigidIndex i = 0; i < static_cast<RigidIndex>(model_.bodies.size()); ++i) {
    Cells cells = convex_cells(model_.bodies[i].rings());
    if (cells.size() > 1 || cells[0].size() < model_.bodies[i].potential.vertices.size()) {
      shapes_.cells[i] = std::move(cells);
    }
  }
  for (const DeformableBody& body : model_.deformables) {
    Cells& loops = shapes_.loops.emplace_back();
    for (BoundaryLoop& loop : boundary(body.mesh).loops) loops.push_back(std::move(loop.nodes));
  }
}

FrameWriter::~FrameWriter() = default;

void FrameWriter::write(const FrameContents& frame) {
  container_ ? contain(frame) : write_files(frame);
  times_.push_back(frame.state.time);
}

void FrameWriter::contain(const FrameContents& frame) {
  const FrameView view{model_, frame, shapes_};
  std::vector<NamedGrid> grids;
  for (const Series& series : kSeries) {
    if (series.needed(view)) grids.push_back({std::string(series.name), series.make(view)});
  }
  container_->add(frame.state.time, grids);
}

void FrameWriter::write_files(const FrameContents& frame) {
  const size_t number = times_.size();
  const FrameView view{model_, frame, shapes_};
  std::vector<size_t> needed;  // numbers of series
  std::vector<std::string> names;
  for (size_t s = 0; s < kSeries.size(); ++s) {
    if (!kSeries[s].needed(view)) continue;
    needed.push_back(s);
    names.push_back(file_name(kSeries[s], number));
  }
  if (list_) list_->add(names);
  work_on(threads_, needed.size(), [&](size_t i) {
    write_file(folder_ + "/" + names[i], vtu_text(kSeries[needed[i]].make(view), frame.state.time));
  });
  fresh_.insert(fresh_.end(), names.begin(), names.end());
  for (size_t s = 0; s < kSeries.size(); ++s) {
    lists_[s] += list_entry(kSeries[s], number, frame.state.time);
  }
  // A list is replaced as a whole, since readers and a kill may come at any moment. That of the
  // bodies comes last: what it lists is complete in all series.
  for (size_t i = needed.size(); i-- > 0;) {
    const size_t s = needed[i];
    write_file(fmt::format("{}/{}", folder_, kSeries[s].list),
               fmt::format("{}{}", lists_[s], kListEnd));
  }
}

void FrameWriter::make_last() {
  if (container_) return container_->make_last();
  if (fresh_.empty()) return;
  std::error_code ignored;
  for (const std::string& name : fresh_) {
    const std::string file = folder_ + "/" + name;
    if (std::filesystem::exists(file, ignored)) apothem::make_last(file);
  }
  apothem::make_last(folder_ + "/frames");
  fresh_.clear();
}

std::vector<std::string> frame_lists() {
  std::vector<std::string> names;
  names.reserve(kSeries.size() + 3);
  for (const Series& series : kSeries) names.emplace_back(series.list);
  names.insert(names.end(),
               {FrameContainer::kBodies, FrameContainer::kOthers, FrameContainer::kNumbers});
  return names;
}

bool is_frame_file(const std::string& name) {
  constexpr std::string_view kDigits = "0123456789", kStart = "frames/", kEnd = ".vtu";
  if (!name.starts_with(kStart) || !name.ends_with(kEnd)) return false;
  const size_t line = name.rfind('_');
  if (line == std::string::npos || line < kStart.size()) return false;
  const std::string series = name.substr(kStart.size(), line - kStart.size());
  const std::string number = name.substr(line + 1, name.size() - kEnd.size() - line - 1);
  return std::ranges::find(kSeries, series, &Series::name) != kSeries.end() && number.size() >= 6 &&
         number.find_first_not_of(kDigits) == std::string::npos;
}

}  // namespace apothem
