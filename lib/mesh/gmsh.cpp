#include "apothem/mesh/gmsh.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <unordered_map>

#include "apothem/mesh/edges.hpp"
#include "apothem/mesh/groups.hpp"
#include "apothem/mesh/invalid_mesh.hpp"
#include "apothem/mesh/measure.hpp"

namespace apothem {
namespace {

// Gmsh's number of a node, element or entity.
using Tag = long long;

std::string name(const char* kind, Tag tag) {
  return std::string(kind) + " with the tag " + std::to_string(tag);
}

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
  template <class Number>
  Number number(const char* what) {
    const std::string_view text = word(what);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      fail("\"" + std::string(text) + "\" is not " + what);
    }
    return value;
  }
  Tag integer(const char* what) { return number<Tag>(what); }
  Tag count(const char* what) {
    const Tag n = integer(what);
    if (n < 0) fail(std::to_string(n) + " is not " + what);
    return n;
  }
  void require_end() const {
    if (!row_.empty()) fail("\"" + std::string(row_) + "\" is left over at the end of the line");
  }

 private:
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
// Gmsh's numbers of the element types that are read.
constexpr int kPoint = 15;
constexpr int kLine = 1;
constexpr int kTriangle = 2;
constexpr int kQuadrilateral = 3;

struct Node {
  Tag tag;
  Vec2 place;
  double z;
  int line;
  bool at_point;         // belongs to a point of the geometry
  bool at_line = false;  // belongs to a line element
  int number = -1;       // in the mesh; -1 if left out
};

// An element of the file, of any dimension.
struct Part {
  Tag tag;
  int line;
  int dimension;
  std::array<int, 4> nodes;  // indices into the list of the file's nodes
  int size;
};

// The reader of one text.
class Reader {
 public:
  Reader(std::string_view text, const MeshRules& rules) : rows_(text), rules_(rules) {}

  Mesh run() {
    sections();
    if (nodes_.empty()) throw BadMeshText("has no nodes", 0);
    number_nodes();
    elements_of_mesh();
    check();
    groups();
    return std::move(mesh_);
  }

 private:
  void sections() {
    if (!rows_.next()) throw BadMeshText("is empty", 0);
    if (rows_.rest().front() != '$') rows_.fail("is no gmsh file: it must start with $MeshFormat");
    do {
      const std::string section(rows_.word("the name of a section"));
      if (section.front() != '$') rows_.fail("\"" + section + "\" stands outside of all sections");
      if (section == "$MeshFormat") {
        format();
      } else if (version_ == 0 && section != "$Comments") {
        rows_.fail("is no gmsh file: $MeshFormat must come before " + section);
      } else if (section == "$PhysicalNames") {
        physical_names();
      } else if (section == "$Entities") {
        entities();
      } else if (section == "$Nodes") {
        version_ == 4 ? node_blocks() : node_list();
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
      const int dimension = rows_.number<int>("a dimension");
      const Tag tag = rows_.integer("a tag");
      std::string_view text = rows_.rest();
      text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
      if (text.size() < 2 || text.front() != '"' || text.back() != '"') {
        rows_.fail("the name of a physical group must stand in quotes");
      }
      names_[{dimension, tag}] = text.substr(1, text.size() - 2);
    }
  }

  // The physical groups of points, curves, surfaces and volumes (version 4.1).
  void entities() {
    rows_.require_next("the numbers of entities");
    std::array<Tag, 4> counts;
    for (Tag& n : counts) n = rows_.count("a number of entities");
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (Tag n = counts[dimension]; n > 0; --n) {
        rows_.require_next("an entity");
        const Tag tag = rows_.integer("the tag of an entity");
        for (int k = dimension == 0 ? 3 : 6; k > 0; --k) rows_.number<double>("a coordinate");
        std::vector<Tag>& physical = physical_of_[{dimension, tag}];
        for (Tag k = rows_.count("the number of physical groups"); k > 0; --k) {
          physical.push_back(std::abs(rows_.integer("the tag of a physical group")));
        }
      }
    }
  }

  void node_list() {
    rows_.require_next("the number of nodes");
    for (Tag n = rows_.count("the number of nodes"); n > 0; --n) {
      rows_.require_next("a node");
      const Tag tag = rows_.integer("the tag of a node");
      add_node(tag, rows_.line(), false);
      place(nodes_.back());
      rows_.require_end();
    }
  }

  void node_blocks() {
    rows_.require_next("the number of blocks of nodes");
    for (Tag blocks = rows_.count("the number of blocks"); blocks > 0; --blocks) {
      rows_.require_next("a block of nodes");
      const int dimension = rows_.number<int>("a dimension");
      rows_.integer("the tag of an entity");
      const bool parametric = rows_.integer("0 or 1") != 0;
      const Tag count = rows_.count("the number of nodes");
      const size_t first = nodes_.size();
      for (Tag n = count; n > 0; --n) {
        rows_.require_next("the tag of a node");
        add_node(rows_.integer("the tag of a node"), rows_.line(), dimension == 0);
        rows_.require_end();
      }
      for (size_t i = first; i < nodes_.size(); ++i) {
        rows_.require_next("the coordinates of the " + name("node", nodes_[i].tag));
        nodes_[i].line = rows_.line();
        place(nodes_[i]);
        if (!parametric) rows_.require_end();
      }
    }
  }

  void add_node(Tag tag, int line, bool at_point) {
    if (!node_of_.emplace(tag, static_cast<int>(nodes_.size())).second) {
      rows_.fail("there are two nodes with the tag " + std::to_string(tag));
    }
    nodes_.push_back({tag, Vec2::Zero(), 0, line, at_point});
  }

  void place(Node& node) {
    for (int k = 0; k < 2; ++k) node.place[k] = rows_.number<double>("a coordinate in m");
    node.z = rows_.number<double>("a coordinate in m");
  }

  void element_list() {
    rows_.require_next("the number of elements");
    for (Tag n = rows_.count("the number of elements"); n > 0; --n) {
      rows_.require_next("an element");
      const Tag tag = rows_.integer("the tag of an element");
      const int type = rows_.number<int>("the type of an element");
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
      const int dimension = rows_.number<int>("a dimension");
      const Tag entity = rows_.integer("the tag of an entity");
      const int type = rows_.number<int>("the type of an element");
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
    Part part{tag, rows_.line(), 2, {-1, -1, -1, -1}, 0};
    switch (type) {
      case kPoint:
        part.dimension = 0;
        part.size = 1;
        break;
      case kLine:
        part.dimension = 1;
        part.size = 2;
        break;
      case kTriangle:
        part.size = 3;
        break;
      case kQuadrilateral:
        part.size = 4;
        break;
      default:
        refuse_type(tag, type);
    }
    for (int i = 0; i < part.size; ++i) {
      const Tag node = rows_.integer("the tag of a node");
      const auto found = node_of_.find(node);
      if (found == node_of_.end()) {
        rows_.fail("the " + name("element", tag) + " has the node " + std::to_string(node) +
                   ", which is not in $Nodes");
      }
      part.nodes[i] = found->second;
    }
    rows_.require_end();
    const bool repeats = may_repeat && part.dimension == 2 && !parts_.empty() &&
                         parts_.back().dimension == 2 && parts_.back().nodes == part.nodes;
    if (!repeats) parts_.push_back(part);
    const int index = static_cast<int>(parts_.size()) - 1;
    for (const Tag group : physical) members_[{part.dimension, group}].push_back(index);
  }

  [[noreturn]] void refuse_type(Tag tag, int type) const {
    const std::string element = "the " + name("element", tag) + " is a ";
    for (const ElementType& t : kSecondOrder) {
      if (t.number != type) continue;
      rows_.fail(element + t.name +
                 " of higher order; mesh with first order (gmsh -order 1, Mesh.ElementOrder = 1)");
    }
    for (const ElementType& t : kSolids) {
      if (t.number != type) continue;
      rows_.fail(element + t.name + "; give a mesh of a surface (gmsh -2)");
    }
    rows_.fail("the " + name("element", tag) + " has the type " + std::to_string(type) +
               "; known are triangles (2), quadrilaterals (3), lines (1) and points (15)");
  }

  void number_nodes() {
    std::vector<bool> used(nodes_.size(), false);
    for (const Part& part : parts_) {
      for (int i = 0; i < part.size; ++i) {
        Node& node = nodes_[part.nodes[i]];
        if (part.dimension == 2) used[part.nodes[i]] = true;
        if (part.dimension == 1) node.at_line = true;
        if (part.dimension == 0) node.at_point = true;
      }
    }
    for (size_t i = 0; i < nodes_.size(); ++i) {
      Node& node = nodes_[i];
      if (used[i]) {
        node.number = static_cast<int>(mesh_.nodes.size());
        mesh_.nodes.push_back(node.place);
        file_node_.push_back(static_cast<int>(i));
      } else if (!node.at_point || node.at_line) {
        throw BadMeshText(
            "the " + name("node", node.tag) + " belongs to no triangle or quadrilateral",
            node.line);
      }
    }
  }

  void elements_of_mesh() {
    for (size_t i = 0; i < parts_.size(); ++i) {
      const Part& part = parts_[i];
      if (part.dimension != 2) continue;
      std::vector<int> corners;
      for (int k = 0; k < part.size; ++k) corners.push_back(nodes_[part.nodes[k]].number);
      mesh_.add_element(corners);
      file_part_.push_back(static_cast<int>(i));
      const int e = mesh_.element_count() - 1;
      // The surface's normal points to -z: gmsh lists the corners clockwise.
      if (element_area(mesh_, e) < 0)
        std::reverse(mesh_.corners.end() - part.size + 1, mesh_.corners.end());
    }
  }

  void check() const {
    const double size = mesh_size(mesh_);
    for (const int i : file_node_) {
      const Node& node = nodes_[i];
      if (!(std::abs(node.z) <= 1e-9 * size)) {
        throw BadMeshText("the " + name("node", node.tag) + " has z = " + std::to_string(node.z) +
                              "; the mesh must lie in the plane z = 0",
                          node.line);
      }
    }
    try {
      check_mesh(mesh_, rules_);
    } catch (const InvalidMesh& error) {
      std::string where;
      int line = 0;
      if (error.node() >= 0) {
        const Node& node = nodes_[file_node_[error.node()]];
        where = "node " + std::to_string(error.node()) + ": tag " + std::to_string(node.tag);
        line = node.line;
      }
      if (error.element() >= 0) {
        const Part& part = parts_[file_part_[error.element()]];
        where = "element " + std::to_string(error.element()) + ": tag " + std::to_string(part.tag) +
                (where.empty() ? "" : ", " + where);
        line = part.line;
      }
      throw BadMeshText(error.what() + (where.empty() ? "" : " (" + where + ")"), line);
    }
  }

  void groups() {
    const std::vector<MeshEdge> edges = mesh_edges(mesh_);
    std::set<std::string> taken;
    for (const auto& [key, members] : members_) {
      static constexpr const char* kKinds[]{"point-", "curve-", "surface-"};
      const auto [dimension, tag] = key;
      const auto named = names_.find(key);
      const std::string group =
          named == names_.end() ? kKinds[dimension] + std::to_string(tag) : named->second;
      if (!taken.insert(group).second) {
        throw BadMeshText("two physical groups have the name \"" + group + "\"; give each its own",
                          0);
      }
      if (dimension == 1) {
        mesh_.groups.push_back(line_group(group, edges_of(members, edges, group)));
        continue;
      }
      std::set<int> numbers;
      for (const int member : members) {
        const Part& part = parts_[member];
        for (int i = 0; i < part.size; ++i) {
          const Node& node = nodes_[part.nodes[i]];
          if (node.number < 0) {
            throw BadMeshText("the " + name("node", node.tag) + " of the group \"" + group +
                                  "\" belongs to no triangle or quadrilateral",
                              part.line);
          }
          numbers.insert(node.number);
        }
      }
      mesh_.groups.push_back({group, {numbers.begin(), numbers.end()}, {}});
    }
  }

  [[nodiscard]] std::vector<std::array<int, 2>> edges_of(const std::vector<int>& members,
                                                         const std::vector<MeshEdge>& edges,
                                                         const std::string& group) const {
    std::vector<std::array<int, 2>> result;
    std::set<const MeshEdge*> taken;
    for (const int member : members) {
      const Part& part = parts_[member];
      const int a = nodes_[part.nodes[0]].number;
      const int b = nodes_[part.nodes[1]].number;
      const MeshEdge* edge = find_edge(edges, a, b);
      if (edge == nullptr) {
        throw BadMeshText("the " + name("line", part.tag) + " of the group \"" + group +
                              "\" is no edge of a triangle or quadrilateral",
                          part.line);
      }
      if (!taken.insert(edge).second) continue;
      result.push_back(edge->on_boundary() ? edge->nodes : std::array{a, b});
    }
    return result;
  }

  using Key = std::pair<int, Tag>;  // dimension and tag

  Rows rows_;
  const MeshRules& rules_;
  int version_ = 0;
  std::map<Key, std::string> names_;             // names of physical groups
  std::map<Key, std::vector<Tag>> physical_of_;  // physical groups of each entity
  std::map<Key, std::vector<int>> members_;      // indices of the parts in each physical group
  std::vector<Node> nodes_;
  std::unordered_map<Tag, int> node_of_;
  std::vector<Part> parts_;
  Mesh mesh_;
  std::vector<int> file_node_, file_part_;  // file index of each mesh node, element
};

}  // namespace

Mesh parse_gmsh(std::string_view text, const MeshRules& rules) { return Reader(text, rules).run(); }

}  // namespace apothem
