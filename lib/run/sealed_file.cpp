#include "lib/run/sealed_file.hpp"

#include "lib/output/checksum.hpp"
#include "lib/output/files.hpp"
#include "lib/run/json_archive.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/file.hpp"

namespace apothem {
namespace {

constexpr const char* kKey = "checksum";

// What stands behind the part of a text that has this checksum.
std::string seal(const Checksum& checksum) {
  return std::string(",\"") + kKey + "\":\"" + checksum.text() + "\"}\n";
}

}  // namespace

void write_sealed(const std::string& file, const std::function<void(Archive&)>& write) {
  write_file(
      file,
      [&](const FileSink& sink) {
        Checksum checksum;
        JsonWriter archive([&](std::string_view part) {
          checksum.add(part);
          sink(part);
        });
        write(archive);
        archive.flush();
        sink(seal(checksum));
      },
      Lasting::yes);
}

std::string read_sealed(const std::string& file) {
  std::string text = read_text(file);
  if (text.empty()) throw Damaged(file, "is damaged: it is empty");
  const size_t length = seal({}).size();
  Checksum checksum;
  if (text.size() > length) checksum.add(text.data(), text.size() - length);
  if (text.size() > length && text.ends_with(seal(checksum))) return text;
  const size_t key = text.rfind(std::string(",\"") + kKey);
  throw Damaged(file, key == std::string::npos || key + length < text.size()
                          ? "is damaged, or of an older version of the program: it does not end "
                            "with its checksum"
                          : "is damaged: its content does not have the checksum at its end");
}

}  // namespace apothem
