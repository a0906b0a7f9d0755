#include "apothem/geometry/skeleton/cgal_skeleton.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/create_straight_skeleton_2.h>

#include <map>
#include <tuple>

#include "apothem/geometry/skeleton/child_process.hpp"

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

using Ring = std::vector<Vec2>;
using Node = Skeleton::Node;
using Faces = std::vector<std::vector<int>>;

// The numbers that are sent through the pipe: the number n of faces; the number of nodes; three
// numbers per node (x, y, height); then for every face the number of its nodes and their indices.
// An empty message means that CGAL found no skeleton.
using Message = std::vector<double>;

template <class Kernel>
Message cgal_skeleton(const Ring& ring) {
  using Point = typename Kernel::Point_2;
  std::vector<Point> points;
  std::map<std::pair<double, double>, int> index;  // of the vertex with these coordinates
  for (const Vec2& v : ring) {
    index[{v.x(), v.y()}] = static_cast<int>(points.size());
    points.emplace_back(v.x(), v.y());
  }
  const auto skeleton =
      CGAL::create_interior_straight_skeleton_2(points.begin(), points.end(), Kernel());
  if (!skeleton) return {};

  const size_t n = ring.size();
  std::map<int, int> node_of;  // from CGAL's vertex id to the node
  std::vector<Node> nodes;
  for (const Vec2& v : ring) nodes.push_back({v, 0});
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
  Faces faces(n);
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

  Message message{static_cast<double>(n), static_cast<double>(nodes.size())};
  for (const Node& node : nodes) {
    message.insert(message.end(), {node.point.x(), node.point.y(), node.height});
  }
  for (const std::vector<int>& face : faces) {
    message.push_back(static_cast<double>(face.size()));
    message.insert(message.end(), face.begin(), face.end());
  }
  return message;
}

// The nodes and faces in a message. Returns nothing if the message is incomplete.
std::optional<SkeletonParts> decode(const Message& message) {
  size_t at = 0;
  const auto take = [&] { return at < message.size() ? message[at++] : (++at, 0.0); };
  const auto n = static_cast<size_t>(take());
  const auto node_count = static_cast<size_t>(take());
  if (message.size() < 2 + 3 * node_count + n) return std::nullopt;
  std::vector<Node> nodes(node_count);
  for (Node& node : nodes) {
    node.point.x() = take();
    node.point.y() = take();
    node.height = take();
  }
  Faces faces(n);
  for (std::vector<int>& face : faces) {
    for (auto left = static_cast<size_t>(take()); left > 0 && at < message.size(); --left) {
      face.push_back(static_cast<int>(take()));
    }
  }
  if (at != message.size()) return std::nullopt;
  return SkeletonParts{std::move(nodes), std::move(faces)};
}

CgalAnswer answer_of(const Message& message) {
  if (message.empty()) return {std::nullopt, "CGAL found no skeleton"};
  std::optional<SkeletonParts> parts = decode(message);
  if (!parts) return {std::nullopt, "CGAL's answer was cut off"};
  return {std::move(parts), ""};
}

// Rings that one child works on, one after the other.
struct Share {
  std::vector<size_t> rings;
  size_t done = 0;

  [[nodiscard]] bool finished() const { return done == rings.size(); }
};

}  // namespace

CgalAnswer ask_cgal(const Ring& ring, bool exact, double seconds, const Progress& progress) {
  ChildAnswer answer = run_in_child(
      [&](const SendNumbers& send) {
        send(exact ? cgal_skeleton<CGAL::Exact_predicates_exact_constructions_kernel>(ring)
                   : cgal_skeleton<CGAL::Exact_predicates_inexact_constructions_kernel>(ring));
      },
      seconds,
      [&] {
        if (progress) progress({exact ? "CGAL, exactly" : "CGAL", std::nullopt});
      });
  if (const std::string failure = answer.failure(); !failure.empty()) {
    return {std::nullopt, "CGAL " + failure};
  }
  return answer_of(answer.numbers);
}

std::vector<CgalAnswer> ask_cgal(const std::vector<Ring>& rings, double seconds, int processes,
                                 const Progress& progress) {
  std::vector<CgalAnswer> answers(rings.size());
  std::vector<Share> shares(static_cast<size_t>(std::max(processes, 1)));
  for (size_t i = 0; i < rings.size(); ++i) shares[i % shares.size()].rings.push_back(i);
  while (true) {
    std::erase_if(shares, [](const Share& share) { return share.finished(); });
    if (shares.empty()) return answers;
    std::vector<ChildWork> works;
    for (const Share& share : shares) {
      works.emplace_back([&](const SendNumbers& send) {
        for (size_t k = share.done; k < share.rings.size(); ++k) {
          Message message = cgal_skeleton<CGAL::Exact_predicates_inexact_constructions_kernel>(
              rings[share.rings[k]]);
          message.insert(message.begin(), static_cast<double>(message.size()));
          send(message);
        }
      });
    }
    const std::vector<ChildAnswer> sent = run_in_children(works, seconds, [&] {
      if (progress) progress({"CGAL", std::nullopt});
    });
    for (size_t s = 0; s < shares.size(); ++s) {
      Share& share = shares[s];
      const Message& numbers = sent[s].numbers;
      for (size_t at = 0; at < numbers.size() && !share.finished(); ++share.done) {
        const auto size = static_cast<size_t>(numbers[at]);
        if (numbers.size() - at - 1 < size) break;
        const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(at + 1);
        answers[share.rings[share.done]] =
            answer_of(Message(first, first + static_cast<std::ptrdiff_t>(size)));
        at += 1 + size;
      }
      if (share.finished()) continue;
      const std::string failure = sent[s].failure();
      answers[share.rings[share.done]] = {
          std::nullopt, failure.empty() ? "CGAL's answer was cut off" : "CGAL " + failure};
      ++share.done;
    }
  }
}

}  // namespace apothem
