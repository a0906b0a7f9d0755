#include "geometry/skeleton/cgal_skeleton.hpp"

#include <algorithm>

#include "geometry/skeleton/helper_process.hpp"
#include "geometry/skeleton/skeleton_program.hpp"

namespace apothem {
namespace {

using Message = SkeletonMessage;

// The nodes and faces in a message. Returns nothing if the message is incomplete.
std::optional<SkeletonParts> decode(const Message& message) {
  size_t at = 0;
  const auto take = [&] { return at < message.size() ? message[at++] : (++at, 0.0); };
  const auto n = static_cast<size_t>(take());
  const auto node_count = static_cast<size_t>(take());
  if (message.size() < 2 + 3 * node_count + n) return std::nullopt;
  std::vector<Skeleton::Node> nodes(node_count);
  for (Skeleton::Node& node : nodes) {
    node.point.x() = take();
    node.point.y() = take();
    node.height = take();
  }
  std::vector<std::vector<int>> faces(n);
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

// Polygons that one helper works on, one after the other.
struct Share {
  std::vector<size_t> polygons;
  size_t done = 0;
  int asked = 0;  // without an answer, for the next polygon

  [[nodiscard]] bool finished() const { return done == polygons.size(); }
};

std::vector<double> request_of(const Share& share, const std::vector<Rings>& polygons, bool exact) {
  std::vector<double> request{kSkeletonRequest, exact ? 1. : 0.};
  for (size_t k = share.done; k < share.polygons.size(); ++k) {
    const Rings& rings = polygons[share.polygons[k]];
    request.push_back(static_cast<double>(rings.size()));
    for (const std::vector<Vec2>& ring : rings) {
      request.push_back(static_cast<double>(ring.size()));
      for (const Vec2& v : ring) request.insert(request.end(), {v.x(), v.y()});
    }
  }
  return request;
}

// How often a helper is asked the same.
constexpr int kTries = 3;

[[noreturn]] void give_up(const HelperAnswer& sent) {
  throw HelperFailure("the helper program " + skeleton_program() + " " + sent.failure() + ", " +
                      std::to_string(kTries) +
                      " times for the same polygon: nothing is known against the polygon; look at "
                      "the load and the memory of the machine, and run it again");
}

// Takes the answers from what a helper has sent. If it has failed, so has the next polygon; if it
// was kept from its work, that polygon is asked again.
void take_answers(Share& share, const HelperAnswer& sent, std::vector<CgalAnswer>& answers) {
  const Message& numbers = sent.numbers;
  for (size_t at = 0; at < numbers.size() && !share.finished(); ++share.done) {
    const auto size = static_cast<size_t>(numbers[at]);
    if (numbers.size() - at - 1 < size) break;
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(at + 1);
    answers[share.polygons[share.done]] =
        answer_of(Message(first, first + static_cast<std::ptrdiff_t>(size)));
    at += 1 + size;
    share.asked = 0;
  }
  if (share.finished()) return;
  if (!sent.is_certain()) {
    if (++share.asked == kTries) give_up(sent);
    return;
  }
  share.asked = 0;
  const std::string failure = sent.failure();
  answers[share.polygons[share.done]] = {
      std::nullopt, failure.empty() ? "CGAL's answer was cut off" : "CGAL " + failure};
  ++share.done;
}

}  // namespace

CgalAnswer ask_cgal(const Rings& polygon, bool exact, double seconds, const Progress& progress) {
  return std::move(ask_cgal(std::vector<Rings>{polygon}, exact, seconds, 1, progress).front());
}

std::vector<CgalAnswer> ask_cgal(const std::vector<Rings>& polygons, bool exact, double seconds,
                                 int processes, const Progress& progress) {
  std::vector<CgalAnswer> answers(polygons.size());
  std::vector<Share> shares(static_cast<size_t>(std::max(processes, 1)));
  for (size_t i = 0; i < polygons.size(); ++i) shares[i % shares.size()].polygons.push_back(i);
  while (true) {
    std::erase_if(shares, [](const Share& share) { return share.finished(); });
    if (shares.empty()) return answers;
    std::vector<std::vector<double>> requests;
    requests.reserve(shares.size());
    for (const Share& share : shares) requests.push_back(request_of(share, polygons, exact));
    const std::vector<HelperAnswer> sent = run_helpers(skeleton_program(), requests, seconds, [&] {
      if (progress) progress({exact ? "CGAL, exactly" : "CGAL", std::nullopt});
    });
    for (size_t s = 0; s < shares.size(); ++s) take_answers(shares[s], sent[s], answers);
  }
}

}  // namespace apothem
