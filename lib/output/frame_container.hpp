// Private header: the container of all frames of a run. frames.h5 (HDF5) has the numbers: a group
// for each frame, in it one for each series, in it `points`, `cells`, `point_data` and `cell_data`.
// What has not changed since the frame before is written once, and linked from both. frames.xdmf
// says how to read the bodies, contacts.xdmf how to read all other series, as blocks. ParaView,
// PyVista and VTK's readers of XDMF open both, meshio's reader of time series the first, and every
// program that knows HDF5 the numbers themselves.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/output/frame_grid.hpp"
#include "lib/output/hdf5_file.hpp"
#include "lib/output/vtu_file.hpp"

namespace apothem {

/// The grid of a series in a frame.
struct NamedGrid {
  std::string name;
  FrameGrid grid;
};

/// An XDMF file of a time series, to which frames are added. All functions throw SystemFailure.
class XdmfList {
 public:
  /// Keeps the first `frames` entries of the file that is there.
  XdmfList(std::string file, std::string_view name, size_t frames);
  ~XdmfList();
  XdmfList(const XdmfList&) = delete;
  XdmfList& operator=(const XdmfList&) = delete;
  void add(std::string_view entry);
  /// Removes the entry that was added last.
  void take_back();
  void make_last() const { apothem::make_last(file_); }

 private:
  void write(std::string_view text);

  std::string file_;
  int descriptor_;
  std::int64_t size_ = 0, before_ = 0;  // without the end, now and before the last entry
};

class FrameContainer {
 public:
  /// The files, bodies first.
  static constexpr const char *kNumbers = "frames.h5", *kBodies = "frames.xdmf",
                              *kOthers = "contacts.xdmf";

  /// Begins the files in a folder, or goes on with those of so many frames. Throws SystemFailure.
  FrameContainer(const std::string& folder, size_t frames);

  /// Adds a frame at a time in s, of which the first grid is that of the bodies. A frame is in the
  /// files as a whole or not at all. Throws SystemFailure; the earlier frames are then intact.
  void add(double time, const std::vector<NamedGrid>& grids);
  void make_last() const;

 private:
  struct Kept {
    GridArray array;
    std::uint64_t address = 0;
  };
  void remember(const Hdf5Reader& reader, std::uint64_t frame);
  std::uint64_t add_array(const std::string& key, GridArray array);
  std::uint64_t add_grid(const NamedGrid& of, const std::string& frame, const Vec2& place,
                         std::string& entry);

  std::optional<Hdf5Writer> numbers_;
  XdmfList bodies_, others_;
  size_t count_ = 0;                    // of frames
  std::map<std::string, Kept> before_;  // arrays of the last frame, by their places in it
  std::map<std::string, Kept> now_;     // of the one at hand
};

/// Reads a container back. All functions throw ResultsError.
class ContainedFrames {
 public:
  /// Of a folder of results.
  explicit ContainedFrames(const std::string& folder);
  /// Of all frames, s.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  [[nodiscard]] GridFile read(const std::string& series, size_t frame) const;
  /// Whether a frame has a series.
  [[nodiscard]] bool has(const std::string& series, size_t frame) const;

 private:
  template <class Read>
  void guarded(const Read& read) const;
  [[nodiscard]] std::uint64_t find(std::uint64_t group, std::string_view name) const;
  [[nodiscard]] std::uint64_t linked(std::uint64_t group, std::string_view name) const;
  [[nodiscard]] GridFile::Arrays arrays(std::uint64_t group, std::string_view name) const;
  void read_cells(std::uint64_t group, bool mixed, GridFile& into) const;

  std::string file_;
  std::optional<Hdf5Reader> reader_;
  std::vector<std::uint64_t> frames_;  // addresses
  std::vector<double> times_;
};

}  // namespace apothem
