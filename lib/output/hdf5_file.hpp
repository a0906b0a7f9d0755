// Private header: an HDF5 file that grows, and its reading back. The format is that of the HDF
// Group's specification, version 1.1 of which the library reads since 1999; of it only groups of
// links and contiguous arrays of doubles and 32-bit integers are used.
//
// The HDF5 library is not linked, for three reasons. It changes its directory in place, so that a
// run that is killed while a frame is added could lose all frames; here everything is added at the
// end, and then one write of 96 bytes at the beginning makes it part of the file. A file can be cut
// off after any frame, so that a run that goes on leaves the same bytes as one that was never
// stopped. And Debian's library loads 30 others, which takes each start of the program 27 ms.
#pragma once

#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/output/files.hpp"

namespace apothem {

/// A named object of a file: a group or an array, by the address of its header.
struct Hdf5Link {
  std::string name;
  std::uint64_t address = 0;
};

/// The end of a file at some moment, and what it is made of up to there.
struct Hdf5State {
  std::uint64_t end = 0;        ///< bytes
  std::uint64_t links = 0;      ///< address of the block with the root's last link
  std::uint64_t link_size = 0;  ///< bytes of this block
  std::uint32_t count = 0;      ///< of the root's links
  bool operator==(const Hdf5State&) const = default;
};

/// A file to which arrays and groups are added. Nothing of them is in the file before commit(). All
/// functions throw SystemFailure.
class Hdf5Writer {
 public:
  /// The root may have so many links, for which the format has a number of 16 bits.
  static constexpr std::uint32_t kMostLinks = 32000;

  /// Opens an empty file, or cuts an existing one off where it was in the state `kept`.
  explicit Hdf5Writer(std::string file, const Hdf5State& kept = {});
  ~Hdf5Writer();
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  /// Adds an array of rows of `columns` numbers, or of numbers if `columns` is 0. Returns its
  /// address. Numbers that are all the same take no room.
  std::uint64_t add(std::span<const double> values, std::uint64_t columns = 0);
  std::uint64_t add(std::span<const std::int32_t> values, std::uint64_t columns = 0);
  /// Adds a group of these links.
  std::uint64_t add_group(std::span<const Hdf5Link> links);
  /// Adds a link to the root, and makes it and all that was added part of the file.
  void commit(const Hdf5Link& link);
  /// Goes back to an earlier state.
  void cut_off(const Hdf5State& at);
  void make_last() const;

  /// As of the last commit().
  [[nodiscard]] const Hdf5State& state() const { return state_; }

 private:
  template <class Number>
  std::uint64_t add_array(std::span<const Number> values, std::uint64_t columns);
  std::uint64_t append(std::string_view bytes);
  void write_at(std::uint64_t at, std::string_view bytes) const;

  std::string file_;
  int descriptor_;
  Hdf5State state_;
  std::string pending_;  // from state_.end on
};

/// Numbers of an array, integers as doubles, row after row.
struct Hdf5Array {
  bool is_whole = false;
  std::uint64_t columns = 1;
  std::vector<double> values;
};

/// A file of Hdf5Writer. All functions throw std::runtime_error, which says what is wrong with it,
/// if it is damaged or of another program.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(const std::string& file);

  /// The links of the root, the first one first.
  [[nodiscard]] const std::vector<Hdf5Link>& root() const { return root_; }
  /// The links of a group.
  [[nodiscard]] std::vector<Hdf5Link> group(std::uint64_t address) const;
  [[nodiscard]] Hdf5Array array(std::uint64_t address) const;
  /// As it was when the root had so many links; of none: as before there was a file.
  [[nodiscard]] Hdf5State state(size_t count) const;

 private:
  struct Block {
    std::uint64_t address = 0, size = 0;
  };
  struct Message {
    int type;
    Block block;  // where it stands
    std::string body;
  };
  [[nodiscard]] std::string bytes(std::uint64_t address, std::uint64_t size) const;
  [[nodiscard]] std::vector<Message> messages(std::uint64_t address) const;
  [[nodiscard]] static Hdf5Link link(const Message& message);

  mutable std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::vector<Hdf5Link> root_;
  std::vector<Block> blocks_;  // of these links
};

}  // namespace apothem
