#include "geometry/skeleton/node_order.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "geometry/polygon/disjoint_sets.hpp"

namespace apothem {
namespace {

// What happens to one part of the front at one time, and what becomes of it afterwards.
struct Division {
  std::vector<int> nodes;          // inner nodes that are made
  std::vector<int> parts;          // the next divisions of the parts that are left
  std::array<int, 2> least_edges;  // the two first edges in the front before it
};

class Divisions {
 public:
  Divisions(const std::vector<std::vector<FaceBorder>>& borders,
            const std::vector<NodeEvent>& events, int vertices)
      : events_(events),
        beside_(events.size()),
        edges_(events.size()),
        of_(events.size(), -1),
        joined_(events.size()) {
    for (int f = 0; f < static_cast<int>(borders.size()); ++f) {
      for (const FaceBorder& b : borders[f]) {
        const int from = b.from - vertices, to = b.to - vertices;
        if (to >= 0) edges_[to].push_back(f);
        if (from >= 0 && to >= 0) beside_[from].push_back(to);
      }
    }
    // From the last time to the first, what lies above a time falls into parts that grow together.
    for (int end = static_cast<int>(events.size()); end > 0;) {
      int start = end;
      while (start > 0 && events[start - 1].time == events[end - 1].time) --start;
      add(start, end);
      end = start;
    }
  }

  // The inner nodes in the order of their new numbers.
  std::vector<int> order() {
    std::vector<int> result;
    std::vector<int> stack{static_cast<int>(divisions_.size()) - 1};
    while (!stack.empty()) {
      Division& d = divisions_[stack.back()];
      stack.pop_back();
      std::sort(d.nodes.begin(), d.nodes.end(),
                [&](int i, int j) { return events_[i].first < events_[j].first; });
      result.insert(result.end(), d.nodes.begin(), d.nodes.end());
      // Two parts may share their first edge where it was hit. The first one is then the one from
      // which the front goes on to its last edges.
      std::sort(d.parts.begin(), d.parts.end(), [&](int p, int q) {
        const auto &a = divisions_[p].least_edges, &b = divisions_[q].least_edges;
        return std::pair(a[0], -a[1]) < std::pair(b[0], -b[1]);
      });
      stack.insert(stack.end(), d.parts.begin(), d.parts.end());
    }
    return result;
  }

 private:
  // The divisions at one time, whose inner nodes are those from `start` to `end` - 1.
  void add(int start, int end) {
    std::vector<std::pair<int, int>> parts;  // node, and division of a part above it
    for (int i = start; i < end; ++i) {
      for (const int j : beside_[i]) {
        if (j >= end) parts.emplace_back(i, of_[joined_.find(j)]);
      }
    }
    for (int i = start; i < end; ++i) {
      for (const int j : beside_[i]) {
        if (j >= start) joined_.join(i, j);
      }
    }
    const int first = static_cast<int>(divisions_.size());
    for (int i = start; i < end; ++i) {
      int& division = of_[joined_.find(i)];
      if (division < first) {
        division = static_cast<int>(divisions_.size());
        divisions_.push_back({{}, {}, {kEndless, kEndless}});
      }
      divisions_[division].nodes.push_back(i);
      for (const int e : edges_[i]) offer(divisions_[division], e);
    }
    std::sort(parts.begin(), parts.end(),
              [](const auto& p, const auto& q) { return p.second < q.second; });
    for (size_t k = 0; k < parts.size(); ++k) {
      if (k > 0 && parts[k].second == parts[k - 1].second) continue;
      Division& d = divisions_[of_[joined_.find(parts[k].first)]];
      d.parts.push_back(parts[k].second);
      for (const int e : divisions_[parts[k].second].least_edges) offer(d, e);
    }
  }

  static void offer(Division& d, int edge) {
    auto& [least, second] = d.least_edges;
    if (edge < least) {
      second = std::exchange(least, edge);
    } else if (edge > least && edge < second) {
      second = edge;
    }
  }

  static constexpr int kEndless = 1 << 30;

  const std::vector<NodeEvent>& events_;
  std::vector<std::vector<int>> beside_, edges_;  // of each inner node: others, and faces
  std::vector<int> of_;                           // per set of joined nodes: its first division
  DisjointSets joined_;
  std::vector<Division> divisions_;  // from the last time to the first
};

// By time, and where they are in the front.
std::vector<int> by_time(const std::vector<NodeEvent>& events) {
  std::vector<int> order(events.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return std::tie(events[i].time, events[i].first) < std::tie(events[j].time, events[j].first);
  });
  return order;
}

}  // namespace

void renumber(std::vector<Skeleton::Node>& nodes, std::vector<std::vector<FaceBorder>>& borders,
              const std::vector<NodeEvent>& events, const Polygon& polygon) {
  const int n = polygon.size();
  const std::vector<int> order =
      polygon.has_holes() ? by_time(events) : Divisions(borders, events, n).order();
  std::vector<Skeleton::Node> in_order(nodes.begin(), nodes.begin() + n);
  std::vector<int> number(nodes.size());
  std::iota(number.begin(), number.begin() + n, 0);
  for (const int i : order) {
    number[n + i] = static_cast<int>(in_order.size());
    in_order.push_back(nodes[n + i]);
  }
  nodes = std::move(in_order);
  for (std::vector<FaceBorder>& face : borders) {
    for (FaceBorder& b : face) b = {number[b.from], number[b.to]};
  }
}

}  // namespace apothem
