#include "geometry/skeleton/skeleton_parts.hpp"

#include <algorithm>
#include <map>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

void set_arcs(Skeleton& skeleton, const Polygon& polygon) {
  const int n = static_cast<int>(skeleton.faces.size());
  std::map<std::pair<int, int>, int> face_of;
  for (int f = 0; f < n; ++f) {
    const std::vector<int>& face = skeleton.faces[f];
    for (size_t i = 0; i < face.size(); ++i) {
      face_of[{face[i], after(face, i)}] = f;
    }
  }
  for (int e = 0; e < n; ++e) skeleton.arcs.push_back({e, polygon.next(e), e, -1});
  for (const auto& [ends, face] : face_of) {
    const auto [start, end] = ends;
    if (face < n && start == face && end == polygon.next(face)) continue;
    const auto opposite = face_of.find({end, start});
    const int right = opposite == face_of.end() ? -1 : opposite->second;
    if (right < 0 || start < end) skeleton.arcs.push_back({start, end, face, right});
  }
}

// The nodes of the face of an edge, from the edge's start and end on, given its other borders.
// Empty if its borders do not form one loop.
std::vector<int> face_of(int edge, int end, std::vector<FaceBorder>& borders) {
  std::sort(borders.begin(), borders.end(),
            [](const FaceBorder& p, const FaceBorder& q) { return p.from < q.from; });
  std::vector<int> nodes{edge};
  for (int at = end; at != edge;) {
    nodes.push_back(at);
    const auto found =
        std::lower_bound(borders.begin(), borders.end(), at,
                         [](const FaceBorder& p, int from) { return p.from < from; });
    if (found == borders.end() || found->from != at || nodes.size() > borders.size() + 1) {
      return {};
    }
    at = found->to;
  }
  if (nodes.size() != borders.size() + 1) return {};
  return nodes;
}

}  // namespace

std::optional<SkeletonParts> joined(std::vector<Skeleton::Node> nodes,
                                    std::vector<std::vector<FaceBorder>>& borders,
                                    const Polygon& polygon) {
  SkeletonParts parts{std::move(nodes), {}};
  const int n = static_cast<int>(borders.size());
  for (int f = 0; f < n; ++f) {
    parts.faces.push_back(face_of(f, polygon.next(f), borders[f]));
    if (parts.faces.back().empty()) return std::nullopt;
  }
  return parts;
}

Skeleton assemble(SkeletonParts parts, const Polygon& polygon) {
  Skeleton skeleton;
  skeleton.nodes = std::move(parts.nodes);
  skeleton.faces = std::move(parts.faces);
  set_arcs(skeleton, polygon);
  for (const Skeleton::Node& node : skeleton.nodes) {
    skeleton.roof_height = std::max(skeleton.roof_height, node.height);
  }
  return skeleton;
}

}  // namespace apothem
