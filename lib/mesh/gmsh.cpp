#include "lib/mesh/gmsh.hpp"

#include <algorithm>
#include <array>
#include <set>

#include "lib/mesh/edges.hpp"
#include "lib/mesh/gmsh_file.hpp"
#include "lib/mesh/groups.hpp"
#include "lib/mesh/invalid_mesh.hpp"
#include "lib/mesh/measure.hpp"

namespace apothem {
namespace {

constexpr const char* kSurfaceGroup =
    "where a mesh has physical groups, gmsh saves only what is in one: put the surface into a "
    "group "
    "(Physical Surface(\"body\") = {...};), or save all elements (-save_all, or Mesh.SaveAll = 1)";

// Makes the mesh of a file, and says what is wrong with it in gmsh's tags.
class GmshMesh {
 public:
  GmshMesh(const GmshFile& file, const MeshRules& rules) : file_(file), rules_(rules) {}

  Mesh run() {
    number_nodes();
    elements_of_mesh();
    check();
    groups();
    return std::move(mesh_);
  }

 private:
  using Node = GmshFile::Node;
  using Part = GmshFile::Part;

  void number_nodes() {
    const size_t count = file_.nodes.size();
    const bool has_elements =
        std::ranges::any_of(file_.parts, [](const Part& part) { return part.dimension == 2; });
    if (!has_elements) {
      throw BadMeshText(std::string("has no triangles or quadrilaterals; mesh the surface (gmsh "
                                    "-2); ") +
                            kSurfaceGroup,
                        0);
    }
    // Per dimension of parts and per node: whether such a part has the node.
    std::array<std::vector<bool>, 3> used;
    used.fill(std::vector<bool>(count, false));
    for (const Part& part : file_.parts) {
      for (int i = 0; i < part.size; ++i) used[part.dimension][part.nodes[i]] = true;
    }
    number_.assign(count, -1);
    for (size_t i = 0; i < count; ++i) {
      const Node& node = file_.nodes[i];
      if (used[2][i]) {
        number_[i] = static_cast<int>(mesh_.nodes.size());
        mesh_.nodes.push_back(node.place);
        file_node_.push_back(static_cast<int>(i));
      } else if (!(node.at_point || used[0][i]) || used[1][i]) {
        throw BadMeshText(
            "the " + gmsh_name("node", node.tag) +
                " belongs to no triangle or quadrilateral; delete it, or, if it is of a surface: " +
                kSurfaceGroup,
            node.line);
      }
    }
  }

  void elements_of_mesh() {
    element_.assign(file_.parts.size(), -1);
    for (size_t i = 0; i < file_.parts.size(); ++i) {
      const Part& part = file_.parts[i];
      if (part.dimension != 2) continue;
      std::vector<int> corners;
      corners.reserve(part.size);
      for (int k = 0; k < part.size; ++k) corners.push_back(number_[part.nodes[k]]);
      mesh_.add_element(corners);
      file_part_.push_back(static_cast<int>(i));
      const int e = element_[i] = mesh_.element_count() - 1;
      // The surface's normal points to -z: gmsh lists the corners clockwise.
      if (element_area(mesh_, e) < 0)
        std::reverse(mesh_.corners.end() - part.size + 1, mesh_.corners.end());
    }
  }

  void check() const {
    const double size = mesh_size(mesh_);
    for (const int i : file_node_) {
      const Node& node = file_.nodes[i];
      if (!(std::abs(node.z) <= 1e-9 * size)) {
        throw BadMeshText("the " + gmsh_name("node", node.tag) + " has z = " +
                              std::to_string(node.z) + "; the mesh must lie in the plane z = 0",
                          node.line);
      }
    }
    try {
      check_mesh(mesh_, rules_);
    } catch (const InvalidMesh& error) {
      std::string where;
      int line = 0;
      if (error.node() >= 0) {
        const Node& node = file_.nodes[file_node_[error.node()]];
        where = "node " + std::to_string(error.node()) + ": tag " + std::to_string(node.tag);
        line = node.line;
      }
      if (error.element() >= 0) {
        const Part& part = file_.parts[file_part_[error.element()]];
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
    for (const auto& [key, members] : file_.members) {
      static constexpr const char* kKinds[]{"point-", "curve-", "surface-"};
      const auto [dimension, tag] = key;
      const auto named = file_.names.find(key);
      const std::string group =
          named == file_.names.end() ? kKinds[dimension] + std::to_string(tag) : named->second;
      if (!taken.insert(group).second) {
        throw BadMeshText("two physical groups have the name \"" + group + "\"; give each its own",
                          0);
      }
      if (dimension == 1) {
        mesh_.groups.push_back(line_group(group, edges_of(members, edges, group)));
        continue;
      }
      std::set<int> numbers, elements;
      for (const int member : members) {
        const Part& part = file_.parts[member];
        if (dimension == 2) elements.insert(element_[static_cast<size_t>(member)]);
        for (int i = 0; i < part.size; ++i) {
          const int number = number_[part.nodes[i]];
          if (number < 0) {
            const Node& node = file_.nodes[part.nodes[i]];
            throw BadMeshText("the " + gmsh_name("node", node.tag) + " of the group \"" + group +
                                  "\" belongs to no triangle or quadrilateral",
                              part.line);
          }
          numbers.insert(number);
        }
      }
      mesh_.groups.push_back(
          {group, {numbers.begin(), numbers.end()}, {}, {elements.begin(), elements.end()}});
    }
  }

  [[nodiscard]] std::vector<std::array<int, 2>> edges_of(const std::vector<int>& members,
                                                         const std::vector<MeshEdge>& edges,
                                                         const std::string& group) const {
    std::vector<std::array<int, 2>> result;
    std::set<const MeshEdge*> taken;
    for (const int member : members) {
      const Part& part = file_.parts[member];
      const int a = number_[part.nodes[0]];
      const int b = number_[part.nodes[1]];
      const MeshEdge* edge = find_edge(edges, a, b);
      if (edge == nullptr) {
        throw BadMeshText("the " + gmsh_name("line", part.tag) + " of the group \"" + group +
                              "\" is no edge of a triangle or quadrilateral",
                          part.line);
      }
      if (!taken.insert(edge).second) continue;
      result.push_back(edge->on_boundary() ? edge->nodes : std::array{a, b});
    }
    return result;
  }

  const GmshFile& file_;
  const MeshRules& rules_;
  Mesh mesh_;
  std::vector<int> number_;                 // in the mesh, of each node of the file; -1: left out
  std::vector<int> element_;                // in the mesh, of each surface part of the file
  std::vector<int> file_node_, file_part_;  // file index of each mesh node, element
};

}  // namespace

Mesh parse_gmsh(std::string_view text, const MeshRules& rules) {
  const GmshFile file = read_gmsh_file(text);
  return GmshMesh(file, rules).run();
}

}  // namespace apothem
