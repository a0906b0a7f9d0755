#include "geometry/skeleton/polish.hpp"

#include <Eigen/QR>
#include <algorithm>

#include "geometry/skeleton/edge_lines.hpp"

namespace apothem {
namespace {

using Node = Skeleton::Node;
using Faces = std::vector<std::vector<int>>;

class Polish {
 public:
  Polish(Skeleton& skeleton, const Polygon& polygon)
      : skeleton_(skeleton),
        polygon_(polygon),
        lines_(edge_lines(polygon)),
        faces_at_(skeleton.nodes.size()) {
    const int node_count = static_cast<int>(skeleton.nodes.size());
    for (size_t f = 0; f < skeleton.faces.size(); ++f) {
      for (const int node : skeleton.faces[f]) {
        if (node >= 0 && node < node_count) faces_at_[node].push_back(static_cast<int>(f));
      }
    }
  }

  void run() {
    skeleton_.roof_height = 0;
    for (size_t i = lines_.size(); i < skeleton_.nodes.size(); ++i) {
      for (int round = 0; round < 2; ++round) improve(skeleton_.nodes[i], faces_at_[i]);
      skeleton_.roof_height = std::max(skeleton_.roof_height, skeleton_.nodes[i].height);
    }
  }

 private:
  void improve(Node& node, const std::vector<int>& faces) {
    rows_.clear();
    off_.clear();
    for (const int f : faces) {
      const EdgeLine& line = lines_[f];
      add({line.normal().x(), line.normal().y(), -1}, line.distance(node.point) - node.height);
      const int g = polygon_.next(f);
      if (std::find(faces.begin(), faces.end(), g) != faces.end()) add_bisector(f, g, node.point);
    }
    const auto count = static_cast<Eigen::Index>(off_.size());
    const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> rows(rows_.data(), 3, count);
    Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, Eigen::Dynamic, 3>> solver;
    solver.setThreshold(1e-7);
    solver.compute(rows.transpose());
    const Eigen::Vector3d step =
        solver.solve(Eigen::Map<const Eigen::VectorXd>(off_.data(), count));
    node.point -= step.head<2>();
    node.height -= step[2];
  }

  // Adds the bisector of the neighbouring edges f and g as a vertical plane through the vertex
  // between them. If the two edges are nearly in line, their planes hardly determine where their
  // bisector is, but the vertex does.
  void add_bisector(int f, int g, const Vec2& point) {
    if (!(lines_[f].tangent.dot(lines_[g].tangent) > 0)) return;
    const Vec2 across = (lines_[f].tangent + lines_[g].tangent).normalized();
    add({across.x(), across.y(), 0}, across.dot(point - lines_[g].start));
  }

  // Adds one equation of the least-squares problem. `off` is the present distance of the node from
  // the plane.
  void add(const Eigen::Vector3d& row, double off) {
    rows_.insert(rows_.end(), row.begin(), row.end());
    off_.push_back(off);
  }

  Skeleton& skeleton_;
  const Polygon& polygon_;
  std::vector<EdgeLine> lines_;
  Faces faces_at_;                  // faces that meet at each node
  std::vector<double> rows_, off_;  // matrix, by rows, and right-hand side of one node
};

}  // namespace

void polish(Skeleton& skeleton, const Polygon& polygon) { Polish(skeleton, polygon).run(); }

}  // namespace apothem
