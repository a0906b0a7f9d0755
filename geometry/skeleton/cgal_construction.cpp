#include "geometry/skeleton/cgal_construction.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/create_straight_skeleton_2.h>

#include <map>
#include <tuple>

// CGAL orders events of equal rank by their addresses in memory, so the skeleton of a symmetric
// polygon would depend on what the program did before. This overload of the comparison replaces
// that order by one of edge indices.
namespace CGAL::CGAL_SS_i {

template <class Skeleton, class Traits>
bool operator<(const boost::intrusive_ptr<Event_2<Skeleton, Traits>>& a,
               const boost::intrusive_ptr<Event_2<Skeleton, Traits>>& b) {
  const auto rank = [](const Event_2<Skeleton, Traits>& event) {
    const auto id = [](const auto& edge) { return handle_assigned(edge) ? edge->id() : -1; };
    const auto& edges = event.triedge();
    return std::tuple(static_cast<int>(event.type()), id(edges.e0()), id(edges.e1()),
                      id(edges.e2()));
  };
  return rank(*a) < rank(*b);
}

}  // namespace CGAL::CGAL_SS_i

namespace apothem {
namespace {

template <class Kernel>
SkeletonMessage construct(const Rings& polygon) {
  std::vector<std::vector<typename Kernel::Point_2>> rings;
  std::map<std::pair<double, double>, int> index;  // of the vertex with these coordinates
  std::vector<Skeleton::Node> nodes;
  for (const std::vector<Vec2>& ring : polygon) {
    rings.emplace_back();
    for (const Vec2& v : ring) {
      index[{v.x(), v.y()}] = static_cast<int>(nodes.size());
      rings.back().emplace_back(v.x(), v.y());
      nodes.push_back({v, 0});
    }
  }
  const auto skeleton = CGAL::create_interior_straight_skeleton_2(
      rings.front().begin(), rings.front().end(), rings.begin() + 1, rings.end(), Kernel());
  if (!skeleton) return {};

  const size_t n = nodes.size();
  std::map<int, int> node_of;  // from CGAL's vertex id to the node
  for (auto v = skeleton->vertices_begin(); v != skeleton->vertices_end(); ++v) {
    const Vec2 p(CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y()));
    if (v->is_contour()) {
      const auto found = index.find({p.x(), p.y()});
      if (found == index.end()) return {};
      node_of[v->id()] = found->second;
    } else {
      node_of[v->id()] = static_cast<int>(nodes.size());
      nodes.push_back({p, CGAL::to_double(v->time())});
    }
  }
  std::vector<std::vector<int>> faces(n);
  for (auto f = skeleton->faces_begin(); f != skeleton->faces_end(); ++f) {
    const auto contour = f->halfedge()->defining_contour_edge();
    std::vector<int> face;
    auto h = contour;
    do {
      face.push_back(node_of[h->opposite()->vertex()->id()]);
      h = h->next();
    } while (h != contour && face.size() <= nodes.size());
    if (face[0] < static_cast<int>(n)) faces[face[0]] = face;
  }

  SkeletonMessage message{static_cast<double>(n), static_cast<double>(nodes.size())};
  for (const Skeleton::Node& node : nodes) {
    message.insert(message.end(), {node.point.x(), node.point.y(), node.height});
  }
  for (const std::vector<int>& face : faces) {
    message.push_back(static_cast<double>(face.size()));
    message.insert(message.end(), face.begin(), face.end());
  }
  return message;
}

}  // namespace

SkeletonMessage cgal_skeleton(const Rings& polygon, bool exact) {
  return exact ? construct<CGAL::Exact_predicates_exact_constructions_kernel>(polygon)
               : construct<CGAL::Exact_predicates_inexact_constructions_kernel>(polygon);
}

}  // namespace apothem
