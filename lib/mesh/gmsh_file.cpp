#include "lib/mesh/gmsh_file.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "lib/mesh/gmsh.hpp"
#include "lib/text/decimal.hpp"

namespace apothem {
namespace {

using Tag = GmshFile::Tag;

// Reads a text word by word and line by line, and reports errors with the line number.
class Rows {
 public:
  explicit Rows(std::string_view text) : text_(text) {}

  [[noreturn]] void fail(const std::string& what) const { throw BadMeshText(what, line_); }
  [[nodiscard]] int line() const { return line_; }

  // Goes to the next line that is not blank. Returns false at the end of the text.
  bool next() {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      row_ = text_.substr(at_, end - at_);
      at_ = end + 1;
      ++line_;
      skip_blanks();
      if (!row_.empty()) return true;
    }
    return false;
  }
  void require_next(const std::string& what) {
    if (!next()) fail("the file ends where " + what + " should follow");
  }
  [[nodiscard]] std::string_view rest() const { return row_; }

  std::string_view word(const char* what) {
    if (row_.empty()) fail(std::string("the line ends before ") + what);
    const size_t end = std::min(row_.find_first_of(" \t\r"), row_.size());
    const std::string_view result = row_.substr(0, end);
    row_.remove_prefix(end);
    skip_blanks();
    return result;
  }
  double number(const char* what) {
    const std::string_view text = word(what);
    const std::optional<double> value = find_decimal(text);
    if (!value) refuse(text, what);
    return *value;
  }
  template <class Number = Tag>
  Number integer(const char* what) {
    const std::string_view text = word(what);
    const std::optional<Number> value = find_integer<Number>(text);
    if (!value) refuse(text, what);
    return *value;
  }
  Tag count(const char* what) {
    const Tag n = integer(what);
    if (n < 0) fail(std::to_string(n) + " is not " + what);
    return n;
  }
  void require_end() const {
    if (!row_.empty())
      fail(std::string(1, '"').append(row_) + "\" is left over at the end of the line");
  }

 private:
  [[noreturn]] void refuse(std::string_view text, const char* what) const {
    fail("\"" + std::string(text) + "\" is not " + what);
  }
  void skip_blanks() { row_.remove_prefix(std::min(row_.find_first_not_of(" \t\r"), row_.size())); }

  std::string_view text_, row_;
  size_t at_ = 0;
  int line_ = 0;
};

// Element types by gmsh's number, for the messages that refuse them.
struct ElementType {
  int number;
  const char* name;
};
constexpr ElementType kSecondOrder[]{
    {8, "3-node line"},           {9, "6-node triangle"},  {10, "9-node quadrilateral"},
    {16, "8-node quadrilateral"}, {20, "9-node triangle"}, {21, "10-node triangle"},
};
constexpr ElementType kSolids[]{
    {4, "tetrahedron"},
    {5, "hexahedron"},
    {6, "prism"},
    {7, "pyramid"},
    {11, "10-node tetrahedron"},
    {12, "27-node hexahedron"},
    {17, "20-node hexahedron"},
};
// The element types that are read: points, lines, triangles and quadrilaterals.
struct ReadType {
  int number;  // of gmsh
  int dimension, size;
};
constexpr auto kRead = std::to_array<ReadType>({{15, 0, 1}, {1, 1, 2}, {2, 2, 3}, {3, 2, 4}});

// The reader of one text.
class GmshReader {
 public:
  explicit GmshReader(std::string_view text) : rows_(text) {}

  GmshFile run() {
    sections();
    if (file_.nodes.empty()) throw BadMeshText("has no nodes", 0);
    return std::move(file_);
  }

 private:
  void sections() {
    if (!rows_.next()) throw BadMeshText("is empty", 0);
    if (rows_.rest().front() != '$') rows_.fail("is no gmsh file: it must start with $MeshFormat");
    do {
      const std::string section(rows_.word("the name of a section"));
      if (section.front() != '$') rows_.fail("a line stands outside of all sections");
      if (section == "$MeshFormat") {
        format();
      } else if (section == "$NOD" || section == "$ELM") {
        rows_.fail(
            "is of version 1, which is not read; save it as 4.1 or 2.2 (gmsh FILE -save -format "
            "msh41)");
      } else if (version_ == 0 && section != "$Comments") {
        rows_.fail("is no gmsh file: $MeshFormat must come before all other sections");
      } else if (section == "$PhysicalNames") {
        physical_names();
      } else if (section == "$Entities") {
        entities();
      } else if (section == "$PartitionedEntities") {
        partitioned_entities();
      } else if (section == "$Nodes") {
        version_ == 4 ? node_blocks() : node_list(false);
      } else if (section == "$ParametricNodes") {
        node_list(true);
      } else if (section == "$Elements") {
        version_ == 4 ? element_blocks() : element_list();
      } else {
        skip(section);
        continue;
      }
      end(section);
    } while (rows_.next());
  }

  void end(const std::string& section) {
    const std::string wanted = "$End" + section.substr(1);
    rows_.require_next(wanted);
    if (rows_.word(wanted.c_str()) != wanted) rows_.fail(wanted + " should stand here");
  }

  void skip(const std::string& section) {
    const std::string wanted = "$End" + section.substr(1);
    do rows_.require_next(wanted);
    while (rows_.word(wanted.c_str()) != wanted);
  }

  void format() {
    rows_.require_next("the version");
    const std::string version(rows_.word("the version"));
    if (version != "4.1" && version != "2.2") {
      rows_.fail("has version " + version +
                 ", which is not read; save it as 4.1 or 2.2 (gmsh FILE -save -format msh41)");
    }
    version_ = version == "4.1" ? 4 : 2;
    if (rows_.integer("the file type") != 0) {
      rows_.fail(
          "is binary; save it as text (gmsh FILE -save -format msh41 -setnumber Mesh.Binary "
          "0)");
    }
  }

  void physical_names() {
    rows_.require_next("the number of names");
    for (Tag n = rows_.count("the number of names"); n > 0; --n) {
      rows_.require_next("a physical name");
      const int dimension = rows_.integer<int>("a dimension");
      const Tag tag = rows_.integer("a tag");
      std::string_view text = rows_.rest();
      text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
      if (text.size() < 2 || text.front() != '"' || text.back() != '"') {
        rows_.fail("the name of a physical group must stand in quotes");
      }
      file_.names[{dimension, tag}] = text.substr(1, text.size() - 2);
    }
  }

  // Of points, curves, surfaces and volumes.
  std::array<Tag, 4> entity_counts() {
    rows_.require_next("the numbers of entities");
    std::array<Tag, 4> counts;
    for (Tag& n : counts) n = rows_.count("a number of entities");
    return counts;
  }

  // The physical groups of points, curves, surfaces and volumes (version 4.1).
  void entities() {
    const std::array<Tag, 4> counts = entity_counts();
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (Tag n = counts[dimension]; n > 0; --n) {
        rows_.require_next("an entity");
        const Tag tag = rows_.integer("the tag of an entity");
        groups_of_entity(dimension, tag);
      }
    }
  }

  // Behind its box, which is a place for a point.
  void groups_of_entity(int dimension, Tag tag) {
    for (int k = dimension == 0 ? 3 : 6; k > 0; --k) rows_.number("a coordinate");
    std::vector<Tag>& physical = physical_of_[{dimension, tag}];
    for (Tag k = rows_.count("the number of physical groups"); k > 0; --k) {
      physical.push_back(std::abs(rows_.integer("the tag of a physical group")));
    }
  }

  // In a mesh that is partitioned, elements belong to parts of the entities, with tags of their
  // own.
  void partitioned_entities() {
    rows_.require_next("the number of partitions");
    rows_.count("the number of partitions");
    rows_.require_next("the number of ghost entities");
    for (Tag n = rows_.count("the number of ghost entities"); n > 0; --n) {
      rows_.require_next("a ghost entity");
    }
    const std::array<Tag, 4> counts = entity_counts();
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (Tag n = counts[dimension]; n > 0; --n) {
        rows_.require_next("a part of an entity");
        const Tag tag = rows_.integer("the tag of an entity");
        const bool is_part = rows_.integer<int>("the dimension of an entity") == dimension;
        rows_.integer("the tag of the whole entity");
        for (Tag k = rows_.count("the number of partitions"); k > 0; --k) {
          rows_.integer("the tag of a partition");
        }
        groups_of_entity(dimension, tag);
        // What lies between parts has the groups of what it divides, which are of another
        // dimension.
        if (!is_part) physical_of_[{dimension, tag}].clear();
      }
    }
  }

  // With its parameters on the geometry or without them.
  void node_list(bool parametric) {
    rows_.require_next("the number of nodes");
    for (Tag n = rows_.count("the number of nodes"); n > 0; --n) {
      rows_.require_next("a node");
      const Tag tag = rows_.integer("the tag of a node");
      add_node(tag, rows_.line(), false);
      place(file_.nodes.back());
      if (!parametric) rows_.require_end();
    }
  }

  void node_blocks() {
    rows_.require_next("the number of blocks of nodes");
    for (Tag blocks = rows_.count("the number of blocks"); blocks > 0; --blocks) {
      rows_.require_next("a block of nodes");
      const int dimension = rows_.integer<int>("a dimension");
      rows_.integer("the tag of an entity");
      const bool parametric = rows_.integer("0 or 1") != 0;
      const Tag count = rows_.count("the number of nodes");
      const size_t first = file_.nodes.size();
      for (Tag n = count; n > 0; --n) {
        rows_.require_next("the tag of a node");
        add_node(rows_.integer("the tag of a node"), rows_.line(), dimension == 0);
        rows_.require_end();
      }
      for (size_t i = first; i < file_.nodes.size(); ++i) {
        rows_.require_next("the coordinates of the " + gmsh_name("node", file_.nodes[i].tag));
        file_.nodes[i].line = rows_.line();
        place(file_.nodes[i]);
        if (!parametric) rows_.require_end();
      }
    }
  }

  void add_node(Tag tag, int line, bool at_point) {
    if (!node_of_.emplace(tag, static_cast<int>(file_.nodes.size())).second) {
      rows_.fail("there are two nodes with the tag " + std::to_string(tag));
    }
    file_.nodes.push_back({tag, Vec2::Zero(), 0, line, at_point});
  }

  void place(GmshFile::Node& node) {
    for (int k = 0; k < 2; ++k) node.place[k] = rows_.number("a coordinate in m");
    node.z = rows_.number("a coordinate in m");
  }

  void element_list() {
    rows_.require_next("the number of elements");
    for (Tag n = rows_.count("the number of elements"); n > 0; --n) {
      rows_.require_next("an element");
      const Tag tag = rows_.integer("the tag of an element");
      const int type = rows_.integer<int>("the type of an element");
      const Tag tags = rows_.count("the number of tags");
      std::vector<Tag> physical;
      for (Tag k = 0; k < tags; ++k) {
        const Tag value = std::abs(rows_.integer("a tag"));
        if (k == 0 && value != 0) physical.push_back(value);
      }
      add_element(tag, type, physical, true);
    }
  }

  void element_blocks() {
    rows_.require_next("the number of blocks of elements");
    for (Tag blocks = rows_.count("the number of blocks"); blocks > 0; --blocks) {
      rows_.require_next("a block of elements");
      const int dimension = rows_.integer<int>("a dimension");
      const Tag entity = rows_.integer("the tag of an entity");
      const int type = rows_.integer<int>("the type of an element");
      const std::vector<Tag>& physical = physical_of_[{dimension, entity}];
      for (Tag n = rows_.count("the number of elements"); n > 0; --n) {
        rows_.require_next("an element");
        const Tag tag = rows_.integer("the tag of an element");
        add_element(tag, type, physical, false);
      }
    }
  }

  // Reads the nodes of an element after its tags. Version 2.2 repeats an element that is in several
  // physical groups, once for each; `may_repeat` recognises that.
  void add_element(Tag tag, int type, const std::vector<Tag>& physical, bool may_repeat) {
    GmshFile::Part part{tag, rows_.line(), 2, {-1, -1, -1, -1}, 0};
    const auto read = std::ranges::find(kRead, type, &ReadType::number);
    if (read == kRead.end()) refuse_type(tag, type);
    part.dimension = read->dimension, part.size = read->size;
    for (int i = 0; i < part.size; ++i) {
      const Tag node = rows_.integer("the tag of a node");
      const auto found = node_of_.find(node);
      if (found == node_of_.end()) {
        rows_.fail("the " + gmsh_name("element", tag) + " has the node " + std::to_string(node) +
                   ", which is not in $Nodes");
      }
      part.nodes[i] = found->second;
    }
    rows_.require_end();
    const bool repeats = may_repeat && part.dimension == 2 && !file_.parts.empty() &&
                         file_.parts.back().dimension == 2 &&
                         file_.parts.back().nodes == part.nodes;
    if (!repeats) file_.parts.push_back(part);
    const int index = static_cast<int>(file_.parts.size()) - 1;
    for (const Tag group : physical) file_.members[{part.dimension, group}].push_back(index);
  }

  [[noreturn]] void refuse_type(Tag tag, int type) const {
    const std::string element = "the " + gmsh_name("element", tag) + " is a ";
    for (const ElementType& t : kSecondOrder) {
      if (t.number != type) continue;
      rows_.fail(element + t.name +
                 " of higher order; mesh with first order (gmsh -order 1, Mesh.ElementOrder = 1)");
    }
    for (const ElementType& t : kSolids) {
      if (t.number != type) continue;
      rows_.fail(element + t.name + "; give a mesh of a surface (gmsh -2)");
    }
    rows_.fail("the " + gmsh_name("element", tag) + " has the type " + std::to_string(type) +
               "; known are triangles (2), quadrilaterals (3), lines (1) and points (15)");
  }

  Rows rows_;
  int version_ = 0;
  std::map<GmshFile::Key, std::vector<Tag>> physical_of_;  // physical groups of each entity
  std::unordered_map<Tag, int> node_of_;
  GmshFile file_;
};

}  // namespace

GmshFile read_gmsh_file(std::string_view text) { return GmshReader(text).run(); }

std::string gmsh_name(const char* kind, GmshFile::Tag tag) {
  return std::string(kind) + " with the tag " + std::to_string(tag);
}

}  // namespace apothem
