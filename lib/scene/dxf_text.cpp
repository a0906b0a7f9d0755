#include "lib/scene/dxf_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "lib/scene/dxf_names.hpp"
#include "lib/scene/json.hpp"
#include "lib/text/decimal.hpp"
#include "lib/text/file.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Use = DxfEntity::Use;

// A code and its value, which stand in two lines.
struct Tag {
  int code;
  std::string_view value;
  int line;  // of the code
};
using Tags = std::vector<Tag>;

int whole_number(std::string_view text, int otherwise) {
  const bool negative = text.starts_with('-');
  const std::optional<int> size = find_count(negative ? text.substr(1) : text);
  return size ? (negative ? -*size : *size) : otherwise;
}

// ---------------------------------------------------------------------------- lines of the file

class TagReader {
 public:
  TagReader(const std::string& file, std::string_view text) : file_(file), rest_(text) {}

  Tags read() {
    Tags tags;
    for (std::string_view code, value; next(code);) {
      const int line = line_;
      const int number = whole_number(trimmed(code), -10000);
      if (number < -5 || number > 1071) {
        fail(fmt::format("line {} must hold a group code, a whole number, and does not", line));
      }
      if (!next(value)) fail(fmt::format("it ends at line {}, within an entity", line));
      if (number == 999) continue;  // a comment
      tags.push_back({number, value, line});
      if (number == 0 && trimmed(value) == "EOF") return tags;
    }
    fail(fmt::format("it ends at line {} without \"EOF\": a part of it is missing", line_));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(file_, fmt::format("is not valid DXF: {}; save it anew as DXF (ASCII)", what));
  }

  // Lines end as on Unix, Windows or old Macs.
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const size_t end = rest_.find_first_of("\r\n");
    line = rest_.substr(0, end);
    const bool two = rest_.substr(line.size(), 2) == "\r\n";
    rest_.remove_prefix(std::min(rest_.size(), line.size() + (two ? 2 : 1)));
    ++line_;
    return true;
  }

  const std::string& file_;
  std::string_view rest_;
  int line_ = 0;
};

void refuse_other_files(const std::string& file, std::string_view text) {
  std::string what;
  if (text.starts_with("AutoCAD Binary DXF")) {
    what = "is a binary DXF file, which is not supported yet; save it as DXF (ASCII)";
  } else if (text.starts_with("AC10")) {
    what = "is not valid DXF but a DWG file under another name; save it as DXF (ASCII)";
  } else if (text.find('\0') != std::string_view::npos) {
    what = "is not valid DXF: it is not text; save it as DXF (ASCII)";
  }
  if (!what.empty()) throw SceneError(file, what);
}

// ---------------------------------------------------------------------------- kinds of entities

const char* const kExplode =
    "turn it into a closed polyline (EXPLODE, BOUNDARY or the like), or leave its layer out";

// Drawn, but never the outline of anything.
const std::set<std::string, std::less<>> kAnnotations{"ACAD_TABLE",
                                                      "ARCALIGNEDTEXT",
                                                      "ARC_DIMENSION",
                                                      "ATTDEF",
                                                      "CAMERA",
                                                      "DGNUNDERLAY",
                                                      "DIMENSION",
                                                      "DWFUNDERLAY",
                                                      "GEOPOSITIONMARKER",
                                                      "IMAGE",
                                                      "LARGE_RADIAL_DIMENSION",
                                                      "LEADER",
                                                      "LIGHT",
                                                      "MLEADER",
                                                      "MULTILEADER",
                                                      "OLE2FRAME",
                                                      "OLEFRAME",
                                                      "PDFUNDERLAY",
                                                      "POSITIONMARKER",
                                                      "RTEXT",
                                                      "SECTION",
                                                      "SECTIONOBJECT",
                                                      "SHAPE",
                                                      "SUN",
                                                      "TABLE",
                                                      "TOLERANCE",
                                                      "VIEWPORT",
                                                      "WIPEOUT"};
const std::set<std::string, std::less<>> kRead{
    "3DFACE", "ARC",   "ATTRIB", "CIRCLE",   "ELLIPSE", "HATCH",  "INSERT", "LINE", "LWPOLYLINE",
    "MLINE",  "MTEXT", "POINT",  "POLYLINE", "SOLID",   "SPLINE", "TEXT",   "TRACE"};

bool is_decimal_code(int code) {
  return (code >= 10 && code <= 59) || (code >= 110 && code <= 149) || (code >= 210 && code <= 239);
}

class Preparation {
 public:
  Preparation(const std::string& file, const Tags& tags) : file_(file), tags_(tags) {}

  DxfText make() {
    collect_names();
    put(0, "SECTION");
    put(2, "HEADER");
    put(9, "$ACADVER");
    put(1, "AC1015");
    put(0, "ENDSEC");
    put_layers();
    copy_section("BLOCKS");
    copy_section("ENTITIES");
    put(0, "EOF");
    return std::move(result_);
  }

 private:
  struct Layer {
    std::string name;
    int flags, colour;
  };
  struct Range {
    size_t begin, end;
  };

  [[noreturn]] void fail(const std::string& what) const { throw SceneError(file_, what); }

  [[nodiscard]] size_t next_of_code_0(size_t i) const {
    while (i < tags_.size() && tags_[i].code != 0) ++i;
    return i;
  }
  [[nodiscard]] std::string_view value(size_t i) const { return trimmed(tags_[i].value); }
  [[nodiscard]] std::optional<std::string_view> find(Range range, int code) const {
    for (size_t i = range.begin; i < range.end; ++i) {
      if (tags_[i].code == code) return value(i);
    }
    return {};
  }
  [[nodiscard]] int find_number(Range range, int code, int otherwise) const {
    const auto found = find(range, code);
    return found ? whole_number(*found, otherwise) : otherwise;
  }

  // What stands in front of the entities: sections, the unit, layers and blocks.
  void collect_names() {
    std::string section, table;
    for (size_t i = next_of_code_0(0), end = 0; i < tags_.size(); i = end) {
      end = next_of_code_0(i + 1);
      const std::string_view type = value(i);
      const Range range{i + 1, end};
      if (type == "SECTION") {
        section = find(range, 2).value_or("");
        sections_[section] = {end, tags_.size()};
        if (section == "HEADER") read_header(range);
      } else if (type == "ENDSEC") {
        if (!section.empty()) sections_[section].end = i;
        section.clear();
      } else if (type == "TABLE") {
        table = find(range, 2).value_or("");
      } else if (section == "TABLES" && table == "LAYER" && type == "LAYER") {
        const std::string name = unescaped(find(range, 2).value_or("0"));
        // Names of DXF files are the same in upper and lower case.
        if (!layers_.try_emplace(upper_case(name), name).second) continue;
        result_.layers.push_back(name);
        table_.push_back({name, find_number(range, 70, 0), find_number(range, 62, 7)});
      } else if (section == "BLOCKS" && type == "BLOCK") {
        const std::string name = unescaped(find(range, 2).value_or(""));
        blocks_.try_emplace(upper_case(name), Block{name, find_number(range, 70, 0)});
      }
    }
    if (sections_.count("ENTITIES") == 0) {
      fail("is not valid DXF: it has no section ENTITIES; save it anew as DXF (ASCII)");
    }
  }

  void read_header(Range range) {
    for (size_t i = range.begin; i + 1 < range.end; ++i) {
      if (tags_[i].code == 9 && value(i) == "$INSUNITS") {
        result_.unit = whole_number(value(i + 1), -1);
      }
    }
  }

  void put(int code, std::string_view text) {
    result_.text += fmt::format("{}\n{}\n", code, text);
    result_.owners.push_back(owner_);
  }

  void put_layers() {
    put(0, "SECTION");
    put(2, "TABLES");
    put(0, "TABLE");
    put(2, "LAYER");
    for (const Layer& layer : table_) {
      put(0, "LAYER");
      put(2, layer.name);
      put(70, std::to_string(layer.flags));
      put(62, std::to_string(layer.colour));
    }
    put(0, "ENDTAB");
    put(0, "ENDSEC");
  }

  void copy_section(const char* name) {
    const auto found = sections_.find(name);
    if (found == sections_.end()) return;
    put(0, "SECTION");
    put(2, name);
    bool in_paper_space = false;
    for (size_t i = found->second.begin; i < found->second.end;) {
      const size_t end = next_of_code_0(i + 1);
      const std::string_view type = value(i);
      if (type == "BLOCK" || type == "ENDBLK") {
        const std::string block = unescaped(find({i + 1, end}, 2).value_or(""));
        if (type == "BLOCK") in_paper_space = upper_case(block).starts_with("*PAPER_SPACE");
        if (!in_paper_space) copy(i, end, {2, 10, 20, 30, 70});
        i = end;
      } else {
        i = copy_entity(i, end, in_paper_space);
      }
    }
    put(0, "ENDSEC");
  }

  // The tags of these codes. Without a list, all of them but those that do not matter here.
  void copy(size_t i, size_t end, const std::set<int>& only) {
    put(0, value(i));
    for (size_t k = i + 1; k < end; ++k) {
      if (only.count(tags_[k].code)) put(tags_[k].code, written(tags_[k]));
    }
  }

  // Names of layers and blocks as they are first written.
  std::string written(const Tag& tag) {
    if (tag.code != 2 && tag.code != 8) {
      return tag.code < 10 ? unescaped(tag.value) : std::string(trimmed(tag.value));
    }
    const std::string name = unescaped(trimmed(tag.value));
    if (tag.code == 8) return layers_.try_emplace(upper_case(name), name).first->second;
    const auto block = blocks_.find(upper_case(name));
    return block != blocks_.end() ? block->second.name : name;
  }

  // Copies an entity with what belongs to it, and returns the place behind it.
  size_t copy_entity(size_t i, size_t end, bool in_paper_space) {
    const std::string type(value(i));
    const Range own{i + 1, end};
    size_t behind = end;
    const bool has_parts = type == "POLYLINE" || (type == "INSERT" && find_number(own, 66, 0) == 1);
    if (has_parts) {
      while (behind < tags_.size() && (value(behind) == "VERTEX" || value(behind) == "ATTRIB")) {
        behind = next_of_code_0(behind + 1);
      }
      if (behind < tags_.size() && value(behind) == "SEQEND") behind = next_of_code_0(behind + 1);
    }
    DxfEntity entity = entity_of(type, {i, end}, behind);
    if (in_paper_space || find_number(own, 67, 0) == 1) {
      entity.use = Use::left_out;
      entity.remark = "in the paper space";
      if (!in_paper_space) result_.paper_space.push_back(std::move(entity));
      return behind;
    }
    const bool read = entity.use == Use::read;
    put_entity({i, end}, read ? type.c_str() : "POINT", read);
    result_.entities.push_back(std::move(entity));
    for (size_t k = end; read && k < behind;) {
      const size_t next = next_of_code_0(k + 1);
      if (value(k) == "ATTRIB") {
        put_entity({k, next}, "ATTRIB", true);
        result_.entities.push_back(entity_of("ATTRIB", {k, next}, next));
      } else {
        put_tags({k, next});
      }
      k = next;
    }
    owner_ = -1;
    return behind;
  }

  void put_entity(Range range, const char* type, bool with_shape) {
    owner_ = static_cast<int>(result_.entities.size());
    put(0, type);
    put(6, std::to_string(owner_));
    for (size_t k = range.begin + 1; k < range.end && tags_[k].code != 101; ++k) {
      const int code = tags_[k].code;
      // The line type is taken. A thickness would make walls of lines. Handles and the data of
      // programs are not used.
      const bool matters = with_shape
                               ? code != 5 && code != 6 && code != 39 && code != 102 && code < 1000
                               : code == 8 || code == 60;
      if (matters) put(code, written(tags_[k]));
    }
    if (with_shape) return;
    put(10, "0");
    put(20, "0");
  }

  void put_tags(Range range) {
    for (size_t k = range.begin; k < range.end; ++k) {
      if (tags_[k].code < 1000) put(tags_[k].code, written(tags_[k]));
    }
  }

  DxfEntity entity_of(const std::string& type, Range range, size_t behind) {
    DxfEntity entity;
    entity.type = type;
    const Range own{range.begin + 1, range.end};
    const auto layer = find(own, 8);
    entity.layer = layer ? written({8, *layer, 0}) : "0";
    const auto handle = find(own, 5);
    entity.place = fmt::format("the {} at line {}{}", type, tags_[range.begin].line,
                               handle ? fmt::format(" (handle {})", *handle) : "");
    const auto say = [&](Use use, std::string remark) {
      entity.use = use;
      entity.remark = std::move(remark);
    };
    if (kAnnotations.count(type)) {
      say(Use::left_out, "no outline");
    } else if (type == "RAY" || type == "XLINE") {
      say(Use::unbounded,
          "is a line without an end, which is not supported yet between lines; "
          "trim it to a LINE, or leave its layer out");
    } else if (kRead.count(type) == 0) {
      say(Use::unsupported, fmt::format("is not supported yet; {}", kExplode));
    } else if (std::string fault = fault_of(type, own, behind); !fault.empty()) {
      say(Use::unsupported, std::move(fault));
    }
    return entity;
  }

  // Why an entity of a kind that is read cannot be read, or nothing.
  std::string fault_of(const std::string& type, Range own, size_t behind) {
    for (size_t k = own.begin; k < behind && tags_[k].code != 101; ++k) {
      if (!is_decimal_code(tags_[k].code)) continue;
      try {
        parse_decimal(value(k));
      } catch (const BadNumber& error) {
        return fmt::format("line {}: {}; correct it, or save the drawing anew", tags_[k].line + 1,
                           error.what());
      }
    }
    if (type == "POLYLINE" && (find_number(own, 70, 0) & (16 | 64))) {
      return fmt::format("is a mesh in space, which is not supported yet; {}", kExplode);
    }
    if (type == "SPLINE") return fault_of_spline(own);
    if (type == "INSERT") {
      const std::string name = unescaped(find(own, 2).value_or(""));
      const auto block = blocks_.find(upper_case(name));
      if (block == blocks_.end()) {
        return fmt::format(
            "inserts the block \"{}\", which the drawing does not hold; add it, or "
            "take the entity out",
            name);
      }
      if (block->second.flags & (4 | 8)) {
        return fmt::format(
            "inserts another file, \"{}\" (an external reference), which is not "
            "supported yet; bind it into the drawing (XREF, Bind)",
            name);
      }
    }
    return "";
  }

  [[nodiscard]] std::string fault_of_spline(Range own) const {
    size_t controls = 0, fits = 0;
    std::vector<double> knots;
    for (size_t k = own.begin; k < own.end; ++k) {
      controls += tags_[k].code == 10;
      fits += tags_[k].code == 11;
      if (tags_[k].code == 40) knots.push_back(parse_decimal(value(k)));
    }
    const int degree = find_number(own, 71, 3);
    if (controls == 0 && fits > 0) {
      return "is a spline that is given by fit points alone, which is not supported yet; save it "
             "with control vertices (SPLINEDIT, or EXPLODE to a polyline), or leave its layer out";
    }
    if (degree < 1 || controls <= static_cast<size_t>(degree) ||
        knots.size() != controls + static_cast<size_t>(degree) + 1) {
      return fmt::format(
          "is a spline of degree {} with {} control points and {} knots, which do "
          "not fit together; draw it anew, or leave its layer out",
          degree, controls, knots.size());
    }
    // GDAL draws the curve over all knots, which is right where it begins and ends at its control
    // points: the knots at each end are one.
    const double near = 1e-9 * std::abs(knots.back() - knots.front());
    const auto last = knots.size() - 1, repeated = static_cast<size_t>(degree);
    if (std::abs(knots[repeated] - knots[0]) > near ||
        std::abs(knots[last] - knots[last - repeated]) > near) {
      return "is a periodic spline, or another one that does not end at its control points, which "
             "is "
             "not supported yet; turn it into a polyline, or leave its layer out";
    }
    return "";
  }

  struct Block {
    std::string name;
    int flags;
  };

  const std::string& file_;
  const Tags& tags_;
  DxfText result_;
  int owner_ = -1;                                      // of what is being written
  std::map<std::string, Range, std::less<>> sections_;  // behind the name, up to ENDSEC
  std::map<std::string, std::string> layers_;           // by their names in upper case
  std::vector<Layer> table_;
  std::map<std::string, Block> blocks_;  // by their names in upper case
};

std::string header_variable(const Tags& tags, std::string_view name) {
  for (size_t i = 0; i + 1 < tags.size(); ++i) {
    if (tags[i].code == 0 && trimmed(tags[i].value) == "ENDSEC") break;
    if (tags[i].code == 9 && trimmed(tags[i].value) == name) {
      return std::string(trimmed(tags[i + 1].value));
    }
  }
  return "";
}

}  // namespace

DxfText read_dxf(const std::string& file) {
  std::string text = read_text(file);
  refuse_other_files(file, text);
  const Tags raw = TagReader(file, text).read();
  text = decoded(file, std::move(text), header_variable(raw, "$ACADVER"),
                 header_variable(raw, "$DWGCODEPAGE"));
  const Tags tags = TagReader(file, text).read();
  return Preparation(file, tags).make();
}

}  // namespace apothem
