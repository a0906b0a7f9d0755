#include "geometry/skeleton/skeletons.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "geometry/skeleton/polish.hpp"
#include "geometry/skeleton/skeleton_parts.hpp"
#include "geometry/skeleton/skeleton_search.hpp"
#include "lib/execution/parallel.hpp"

namespace apothem {
namespace {

// Polygons per helper process below which another helper costs more than it gives.
constexpr size_t kWorthProcess = 8;

// Nanoseconds per vertex of a polygon, roughly.
constexpr double kVertexTime = 2e4;

// The progress of work that several threads do. Only the one that has begun it reports, because a
// report may belong to its thread, such as one in Python. What a report throws ends the work of the
// others, too.
class SharedProgress {
 public:
  struct Stopped {};

  explicit SharedProgress(const Progress& progress) : own_(progress) {
    shared_ = [this, first = std::this_thread::get_id()](const Stage& stage) {
      if (stopped_) throw Stopped();
      if (own_ && std::this_thread::get_id() == first) own_(stage);
    };
  }

  void stop() { stopped_ = true; }
  [[nodiscard]] bool is_stopped() const { return stopped_; }
  [[nodiscard]] const Progress& progress() const { return shared_; }

 private:
  const Progress& own_;
  Progress shared_;
  std::atomic<bool> stopped_{false};
};

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
  SharedProgress shared(progress);
  double vertices = 0;
  for (const Polygon* polygon : polygons) vertices += polygon->size();
  const auto count = static_cast<int>(polygons.size());
  Threads(processes).each(count, kVertexTime * vertices / std::max(count, 1), [&](int i) {
    if (shared.is_stopped()) return;
    try {
      result[i] = straight_skeleton(*polygons[i], std::move(first[i]), shared.progress());
    } catch (const SkeletonFailure&) {
      result[i] = std::current_exception();
    } catch (const InvalidPolygon&) {
      result[i] = std::current_exception();
    } catch (const SharedProgress::Stopped&) {  // by another thread, which says why
    } catch (...) {
      shared.stop();
      throw;
    }
  });
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
