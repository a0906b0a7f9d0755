#include "geometry/skeleton/skeletons.hpp"

#include <algorithm>

#include "geometry/skeleton/polish.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"
#include "geometry/skeleton/skeleton_search.hpp"

namespace apothem {
namespace {

// Polygons per helper process below which another helper costs more than it gives.
constexpr size_t kWorthProcess = 8;

// The face of the copy's edge. It begins with the ends of that edge.
std::vector<int> mapped_face(const std::vector<int>& face, const Similarity& map) {
  std::vector<int> image;
  image.reserve(face.size());
  for (const int node : face) image.push_back(node < map.vertices ? map.vertex(node) : node);
  if (map.mirrored) {
    std::reverse(image.begin(), image.end());
    std::rotate(image.begin(), image.end() - 2, image.end());
  }
  return image;
}

}  // namespace

std::vector<SkeletonOrFailure> straight_skeletons(const std::vector<const Polygon*>& polygons,
                                                  int processes, const Progress& progress) {
  std::vector<Rings> outlines;
  std::vector<size_t> asked;
  double seconds = 0;
  for (size_t i = 0; i < polygons.size(); ++i) {
    std::optional<FirstQuestion> question = first_question(*polygons[i]);
    if (!question) continue;
    asked.push_back(i);
    outlines.push_back(std::move(question->rings));
    seconds = std::max(seconds, question->seconds);
  }
  const int most = static_cast<int>((outlines.size() + kWorthProcess - 1) / kWorthProcess);
  std::vector<CgalAnswer> answers =
      ask_cgal(outlines, false, seconds, std::clamp(processes, 1, std::max(most, 1)), progress);
  std::vector<std::optional<CgalAnswer>> first(polygons.size());
  for (size_t k = 0; k < asked.size(); ++k) first[asked[k]] = std::move(answers[k]);

  std::vector<SkeletonOrFailure> result(polygons.size());
  for (size_t i = 0; i < polygons.size(); ++i) {
    try {
      result[i] = straight_skeleton(*polygons[i], std::move(first[i]), progress);
    } catch (const SkeletonFailure&) {
      result[i] = std::current_exception();
    } catch (const InvalidPolygon&) {
      result[i] = std::current_exception();
    }
  }
  return result;
}

std::optional<Skeleton> copied_skeleton(const Skeleton& original, const Similarity& map,
                                        const Polygon& copy) {
  SkeletonParts parts;
  parts.nodes.reserve(original.nodes.size());
  for (const Vec2& v : copy.local_vertices()) parts.nodes.push_back({v, 0});
  for (size_t i = parts.nodes.size(); i < original.nodes.size(); ++i) {
    const Skeleton::Node& node = original.nodes[i];
    parts.nodes.push_back({map(node.point), node.height * map.scale()});
  }
  parts.faces.resize(original.faces.size());
  for (int e = 0; e < map.vertices; ++e) {
    parts.faces[map.edge(e)] = mapped_face(original.faces[e], map);
  }
  Skeleton image = assemble(std::move(parts), copy);
  image.exact = original.exact;
  polish(image, copy);
  if (broken_law(image, copy)) return std::nullopt;
  return image;
}

}  // namespace apothem
