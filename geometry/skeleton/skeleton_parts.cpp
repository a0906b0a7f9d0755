#include "geometry/skeleton/skeleton_parts.hpp"

#include <algorithm>
#include <map>

#include "geometry/polygon/cyclic.hpp"

namespace apothem {
namespace {

void set_arcs(Skeleton& skeleton) {
  const int n = static_cast<int>(skeleton.faces.size());
  std::map<std::pair<int, int>, int> face_of;
  for (int f = 0; f < n; ++f) {
    const std::vector<int>& face = skeleton.faces[f];
    for (size_t i = 0; i < face.size(); ++i) {
      face_of[{face[i], after(face, i)}] = f;
    }
  }
  for (int e = 0; e < n; ++e) skeleton.arcs.push_back({e, next(e, n), e, -1});
  for (const auto& [ends, face] : face_of) {
    const auto [start, end] = ends;
    if (face < n && start == face && end == next(face, n)) continue;
    const auto opposite = face_of.find({end, start});
    const int right = opposite == face_of.end() ? -1 : opposite->second;
    if (right < 0 || start < end) skeleton.arcs.push_back({start, end, face, right});
  }
}

// The nodes of the face of an edge of n, from its edge on, given its other borders. Empty if its
// borders do not form one loop.
std::vector<int> face_of(int edge, int n, std::vector<FaceBorder>& borders) {
  std::sort(borders.begin(), borders.end(),
            [](const FaceBorder& p, const FaceBorder& q) { return p.from < q.from; });
  std::vector<int> nodes{edge};
  for (int at = next(edge, n); at != edge;) {
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
                                    std::vector<std::vector<FaceBorder>>& borders) {
  SkeletonParts parts{std::move(nodes), {}};
  const int n = static_cast<int>(borders.size());
  for (int f = 0; f < n; ++f) {
    parts.faces.push_back(face_of(f, n, borders[f]));
    if (parts.faces.back().empty()) return std::nullopt;
  }
  return parts;
}

Skeleton assemble(SkeletonParts parts) {
  Skeleton skeleton;
  skeleton.nodes = std::move(parts.nodes);
  skeleton.faces = std::move(parts.faces);
  set_arcs(skeleton);
  for (const Skeleton::Node& node : skeleton.nodes) {
    skeleton.roof_height = std::max(skeleton.roof_height, node.height);
  }
  return skeleton;
}

}  // namespace apothem
