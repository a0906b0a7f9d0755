#include "lib/output/hdf5_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <map>
#include <stdexcept>

namespace apothem {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they are");

constexpr std::uint64_t kNowhere = ~std::uint64_t{0};  // the address of what is not there
constexpr std::uint64_t kSuperblock = 96;              // bytes of it
constexpr std::string_view kSignature("\211HDF\r\n\032\n", 8);

// Kinds of messages in the header of an object.
enum : int {
  kDataspace = 1,
  kLinkInfo = 2,
  kDatatype = 3,
  kFillValue = 5,
  kLink = 6,
  kLayout = 8,
  kContinuation = 16
};

template <class Number>
void put(std::string& bytes, Number value) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &value, raw.size());
  bytes.append(raw.data(), raw.size());
}

template <class Number>
Number get(std::string_view bytes, size_t at) {
  if (at + sizeof(Number) > bytes.size()) throw std::runtime_error("is damaged");
  Number value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void fill_up(std::string& bytes) { bytes.resize((bytes.size() + 7) / 8 * 8, '\0'); }

// Messages, and how many there are.
struct Messages {
  std::string bytes;
  std::uint16_t count = 0;

  void add(int type, std::string body) {
    fill_up(body);
    put<std::uint16_t>(bytes, static_cast<std::uint16_t>(type));
    put<std::uint16_t>(bytes, static_cast<std::uint16_t>(body.size()));
    bytes.append(4, '\0');
    bytes += body;
    ++count;
  }
};

// An object header of version 1 with all its messages, `elsewhere` of them in other places.
std::string header(const Messages& messages, std::uint32_t elsewhere = 0) {
  std::string bytes;
  put<std::uint16_t>(bytes, 1);
  put<std::uint16_t>(bytes, static_cast<std::uint16_t>(messages.count + elsewhere));
  put<std::uint32_t>(bytes, 1);  // links to the object, which count when one is removed
  put<std::uint32_t>(bytes, static_cast<std::uint32_t>(messages.bytes.size()));
  put<std::uint32_t>(bytes, 0);
  return bytes + messages.bytes;
}

std::string link_body(const Hdf5Link& link) {
  std::string bytes("\1\0", 2);
  put<std::uint8_t>(bytes, static_cast<std::uint8_t>(link.name.size()));
  bytes += link.name;
  put(bytes, link.address);
  return bytes;
}

// All links of a group stand in its header.
std::string link_info() {
  std::string bytes(2, '\0');
  put(bytes, kNowhere);
  put(bytes, kNowhere);
  return bytes;
}

std::string continuation(std::uint64_t address, std::uint64_t size) {
  std::string bytes;
  put(bytes, address);
  put(bytes, size);
  return bytes;
}

std::string dataspace(std::uint64_t rows, std::uint64_t columns) {
  std::string bytes("\1", 1);
  put<std::uint8_t>(bytes, columns > 0 ? 2 : 1);
  bytes.append(6, '\0');
  put(bytes, rows);
  if (columns > 0) put(bytes, columns);
  return bytes;
}

// Of IEEE 754, and of the second complement.
std::string datatype(double /*unused*/) {
  std::string bytes("\x11\x20\x3f\0\x08\0\0\0\0\0\x40\0\x34\x0b\0\x34", 16);
  put<std::uint32_t>(bytes, 1023);
  return bytes;
}
std::string datatype(std::int32_t /*unused*/) {
  return std::string("\x10\x08\0\0\x04\0\0\0\0\0\x20\0", 12);
}

template <class Number>
std::string fill_value(Number value) {
  std::string bytes("\2\2\2\1", 4);
  put<std::uint32_t>(bytes, sizeof value);
  put(bytes, value);
  return bytes;
}

std::string layout(std::uint64_t address, std::uint64_t size) {
  std::string bytes("\3\1", 2);
  put(bytes, address);
  put(bytes, size);
  return bytes;
}

// Whether all values have the same bits.
template <class Number>
bool are_equal(std::span<const Number> values) {
  return !values.empty() &&
         std::memcmp(values.data(), values.data() + 1, (values.size() - 1) * sizeof(Number)) == 0;
}

constexpr std::uint64_t kRootSize = 16 + 8 + 24 + 8 + 16;  // bytes of the root's header

std::string superblock(std::uint64_t end, std::uint64_t root) {
  std::string bytes(kSignature);
  bytes.append(5, '\0');
  bytes += std::string("\x08\x08\0", 3);
  put<std::uint16_t>(bytes, 4);
  put<std::uint16_t>(bytes, 16);
  put<std::uint32_t>(bytes, 0);
  for (const std::uint64_t address : {std::uint64_t{0}, kNowhere, end, kNowhere}) {
    put(bytes, address);
  }
  put<std::uint64_t>(bytes, 0);
  put(bytes, root);
  bytes.append(kSuperblock - bytes.size(), '\0');
  return bytes;
}

// The root: what its newest link says, and through it all others.
std::string root_header(const Hdf5State& state) {
  Messages messages;
  messages.add(kLinkInfo, link_info());
  messages.add(kContinuation, continuation(state.links, state.link_size));
  return header(messages, 2 * state.count - 1);
}

}  // namespace

Hdf5Writer::Hdf5Writer(std::string file, const Hdf5State& kept)
    : file_(std::move(file)),
      descriptor_(::open(file_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw SystemFailure(file_, errno);
  if (kept.end > 0) {
    cut_off(kept);
    return;
  }
  if (::ftruncate(descriptor_, 0) != 0) throw SystemFailure(file_, errno);
  Messages none;
  none.add(kLinkInfo, link_info());
  const std::string root = header(none);
  write_at(0, superblock(kSuperblock + root.size(), kSuperblock) + root);
  state_.end = kSuperblock + root.size();
}

// First the beginning, which says what counts; what is cut off counts no more then.
void Hdf5Writer::cut_off(const Hdf5State& at) {
  pending_.clear();
  const std::uint64_t root = at.count > 0 ? at.end - kRootSize : kSuperblock;
  write_at(0, superblock(at.end, root));
  if (::ftruncate(descriptor_, static_cast<off_t>(at.end)) != 0) throw SystemFailure(file_, errno);
  state_ = at;
}

Hdf5Writer::~Hdf5Writer() { ::close(descriptor_); }

void Hdf5Writer::write_at(std::uint64_t at, std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw SystemFailure(file_, errno);
    bytes.remove_prefix(static_cast<size_t>(n));
    at += static_cast<std::uint64_t>(n);
  }
}

std::uint64_t Hdf5Writer::append(std::string_view bytes) {
  const std::uint64_t address = state_.end + pending_.size();
  pending_ += bytes;
  fill_up(pending_);  // the state ends at a multiple of eight bytes
  return address;
}

template <class Number>
std::uint64_t Hdf5Writer::add_array(std::span<const Number> values, std::uint64_t columns) {
  const std::uint64_t rows = columns > 0 ? values.size() / columns : values.size();
  const std::uint64_t size = values.size_bytes();
  Messages messages;
  messages.add(kDataspace, dataspace(rows, columns));
  messages.add(kDatatype, datatype(Number{}));
  const bool equal = are_equal(values);
  messages.add(kFillValue, fill_value(equal ? values[0] : Number{}));
  std::uint64_t address = kNowhere;
  if (!equal && size > 0) {
    address = append({reinterpret_cast<const char*>(values.data()), size});
  }
  messages.add(kLayout, layout(address, size));
  return append(header(messages));
}

std::uint64_t Hdf5Writer::add(std::span<const double> values, std::uint64_t columns) {
  return add_array(values, columns);
}
std::uint64_t Hdf5Writer::add(std::span<const std::int32_t> values, std::uint64_t columns) {
  return add_array(values, columns);
}

std::uint64_t Hdf5Writer::add_group(std::span<const Hdf5Link> links) {
  Messages messages;
  messages.add(kLinkInfo, link_info());
  for (const Hdf5Link& link : links) messages.add(kLink, link_body(link));
  return append(header(messages));
}

void Hdf5Writer::commit(const Hdf5Link& link) {
  if (state_.count >= kMostLinks) {
    throw SystemFailure(file_,
                        "has as many frames as it can have; ask for fewer, or for the "
                        "format \"vtu\"");
  }
  // Each link stands in a block of its own that leads to the one before.
  Messages block;
  block.add(kLink, link_body(link));
  if (state_.count > 0) block.add(kContinuation, continuation(state_.links, state_.link_size));
  Hdf5State next = state_;
  next.links = append(block.bytes);
  next.link_size = block.bytes.size();
  ++next.count;
  const std::uint64_t root = append(root_header(next));
  next.end = state_.end + pending_.size();
  try {
    require_untouched(file_, descriptor_, static_cast<std::int64_t>(state_.end));
    write_at(state_.end, pending_);
    write_at(0, superblock(next.end, root));
  } catch (...) {
    pending_.clear();
    static_cast<void>(::ftruncate(descriptor_, static_cast<off_t>(state_.end)));
    throw;
  }
  pending_.clear();
  state_ = next;
}

void Hdf5Writer::make_last() const { apothem::make_last(file_); }

Hdf5Reader::Hdf5Reader(const std::string& file) : stream_(file, std::ios::binary | std::ios::ate) {
  if (!stream_) throw std::runtime_error("cannot be read");
  size_ = static_cast<std::uint64_t>(stream_.tellg());
  const std::string start = bytes(0, std::min(size_, kSuperblock));
  if (start.size() < kSuperblock || !start.starts_with(kSignature) || start[8] != 0) {
    throw std::runtime_error("is no file of frames");
  }
  size_ = std::min(size_, get<std::uint64_t>(start, 40));
  for (const Message& message : messages(get<std::uint64_t>(start, 64))) {
    if (message.type == kLink) root_.push_back(link(message));
    if (message.type == kLink) blocks_.push_back(message.block);
  }
  // The newest one comes first.
  std::ranges::reverse(root_);
  std::ranges::reverse(blocks_);
}

Hdf5State Hdf5Reader::state(size_t count) const {
  if (count == 0) return {};
  const Block& block = blocks_.at(count - 1);
  return {(block.address + block.size + 7) / 8 * 8 + kRootSize, block.address, block.size,
          static_cast<std::uint32_t>(count)};
}

std::string Hdf5Reader::bytes(std::uint64_t address, std::uint64_t size) const {
  if (address > size_ || size > size_ - address) throw std::runtime_error("is damaged");
  std::string bytes(size, '\0');
  stream_.seekg(static_cast<std::streamoff>(address));
  stream_.read(bytes.data(), static_cast<std::streamsize>(size));
  if (!stream_) throw std::runtime_error("cannot be read");
  return bytes;
}

// A header of version 1 and what continues it. Blocks are read once each, so that a damaged file
// cannot lead around in a circle: each one lies before the one that it continues.
std::vector<Hdf5Reader::Message> Hdf5Reader::messages(std::uint64_t address) const {
  const std::string prefix = bytes(address, 16);
  if (prefix[0] != 1) throw std::runtime_error("is damaged");
  std::vector<Message> found;
  Block block{address + 16, get<std::uint32_t>(prefix, 8)};
  while (block.size > 0) {
    const std::string text = bytes(block.address, block.size);
    Block next;
    for (size_t at = 0; at + 8 <= text.size();) {
      const auto type = get<std::uint16_t>(text, at), size = get<std::uint16_t>(text, at + 2);
      if (size > text.size() - at - 8) throw std::runtime_error("is damaged");
      std::string body = text.substr(at + 8, size);
      at += 8 + size_t{size};
      if (type != kContinuation) {
        found.push_back({type, block, std::move(body)});
        continue;
      }
      next = {get<std::uint64_t>(body, 0), get<std::uint64_t>(body, 8)};
      if (next.address >= block.address) throw std::runtime_error("is damaged");
    }
    block = next;
  }
  return found;
}

Hdf5Link Hdf5Reader::link(const Message& message) {
  const auto length = get<std::uint8_t>(message.body, 2);
  const auto address = get<std::uint64_t>(message.body, 3 + size_t{length});
  return {message.body.substr(3, length), address};
}

std::vector<Hdf5Link> Hdf5Reader::group(std::uint64_t address) const {
  std::vector<Hdf5Link> links;
  for (const Message& message : messages(address)) {
    if (message.type == kLink) links.push_back(link(message));
  }
  return links;
}

Hdf5Array Hdf5Reader::array(std::uint64_t address) const {
  std::map<int, std::string> parts;
  for (Message& message : messages(address)) parts[message.type] = std::move(message.body);
  const std::string &space = parts[kDataspace], &fill = parts[kFillValue], &place = parts[kLayout];
  const auto rank = get<std::uint8_t>(space, 1);
  const auto rows = get<std::uint64_t>(space, 8);
  Hdf5Array array;
  if (rank == 2) array.columns = get<std::uint64_t>(space, 16);
  const bool real = get<std::uint8_t>(parts[kDatatype], 0) == 0x11;
  array.is_whole = !real;
  const std::uint64_t width = real ? sizeof(double) : sizeof(std::int32_t);
  const auto size = get<std::uint64_t>(place, 10), at = get<std::uint64_t>(place, 2);
  // What takes no room can be as long as a damaged file says, which no frame needs.
  constexpr std::uint64_t kMost = std::uint64_t{1} << 31, kMostEqual = std::uint64_t{1} << 28;
  if (size % width != 0 || size > (at == kNowhere ? kMostEqual : kMost) || array.columns == 0 ||
      rows > kMost || array.columns > kMost || rows * array.columns * width != size) {
    throw std::runtime_error("is damaged");
  }
  const auto number = [&](std::string_view raw, size_t k) {
    return real ? get<double>(raw, k * width) : get<std::int32_t>(raw, k * width);
  };
  if (at == kNowhere) {
    array.values.assign(size / width, number(fill, 8 / width));
    return array;
  }
  const std::string raw = bytes(at, size);
  array.values.reserve(size / width);
  for (size_t k = 0; k < size / width; ++k) array.values.push_back(number(raw, k));
  return array;
}

}  // namespace apothem
