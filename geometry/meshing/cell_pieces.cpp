#include "geometry/meshing/cell_pieces.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "geometry/polygon/cyclic.hpp"
#include "geometry/polygon/disjoint_sets.hpp"
#include "geometry/polygon/predicates.hpp"
#include "geometry/polygon/ring_moments.hpp"

namespace apothem {
namespace {

using Ring = std::vector<int>;

// The ring around the union of two rings, or nothing unless they have an edge in common and their
// union is bounded by a simple ring.
std::optional<Ring> united(const Ring& a, const Ring& b) {
  std::set<std::pair<int, int>> edges;
  for (const Ring* ring : {&a, &b}) {
    for (size_t i = 0; i < ring->size(); ++i) {
      const int u = (*ring)[i];
      const int v = after(*ring, i);
      if (edges.erase({v, u}) == 0) edges.insert({u, v});
    }
  }
  if (edges.empty() || edges.size() == a.size() + b.size()) return std::nullopt;
  std::unordered_map<int, int> next;
  for (const auto& [u, v] : edges) {
    if (!next.emplace(u, v).second) return std::nullopt;
  }
  Ring ring;
  for (int node = edges.begin()->first; ring.empty() || node != ring.front(); node = next.at(node))
    ring.push_back(node);
  if (ring.size() != edges.size()) return std::nullopt;
  return ring;
}

// Does the work of join_pieces and join_triangles.
class PieceJoiner {
 public:
  explicit PieceJoiner(Pieces& pieces) : pieces_(pieces), sets_(pieces.list.size()) {
    for (int i = 0; i < static_cast<int>(pieces.list.size()); ++i) {
      const Ring& ring = pieces_.list[i].ring;
      for (size_t k = 0; k < ring.size(); ++k) {
        piece_left_of_[{ring[k], after(ring, k)}] = i;
      }
    }
  }

  void join_to_owned() {
    std::vector<int> alone;
    for (int i = 0; i < static_cast<int>(pieces_.list.size()); ++i) {
      if (!pieces_.list[i].owned) alone.push_back(i);
    }
    const auto takes = [](const Piece&, const Piece& other) { return other.owned; };
    // A piece that cannot be joined yet may become able to once others have been joined.
    while (std::erase_if(alone, [&](int i) { return join(i, takes) >= 0; }) > 0) {
    }
    drop_joined();
  }

  void join_triangles() {
    std::vector<double> area(pieces_.list.size());
    std::set<std::pair<double, int>> open;  // the smallest part first
    for (int i = 0; i < static_cast<int>(pieces_.list.size()); ++i) {
      if (!pieces_.list[i].opened) continue;
      area[i] = ring_area(pieces_.points(pieces_.list[i].ring));
      open.emplace(area[i], i);
    }
    const auto takes = [](const Piece& part, const Piece& other) {
      return other.opened && other.site == part.site;
    };
    std::set<std::pair<double, int>> stuck;  // until others have been joined
    while (!open.empty()) {
      const auto [own, i] = *open.begin();
      open.erase(open.begin());
      const int j = join(i, takes);
      if (j < 0) {
        stuck.emplace(own, i);
        continue;
      }
      for (auto* list : {&open, &stuck}) list->erase({area[j], j});
      area[j] += own;
      open.emplace(area[j], j);
      open.merge(stuck);
    }
    drop_joined();
  }

 private:
  void drop_joined() {
    std::erase_if(pieces_.list, [](const Piece& piece) { return piece.ring.empty(); });
  }

  // Joins piece i to one of those that may take it and returns the number of that one, or -1.
  template <class Takes>
  int join(int i, const Takes& takes) {
    Ring& ring = pieces_.list[i].ring;
    std::map<int, double> common;  // from the neighbour to the common length
    for (size_t k = 0; k < ring.size(); ++k) {
      const int u = ring[k];
      const int v = after(ring, k);
      const auto other = piece_left_of_.find({v, u});
      if (other == piece_left_of_.end()) continue;
      const int j = sets_.find(other->second);
      if (j == i || !takes(pieces_.list[i], pieces_.list[j])) continue;
      common[j] += (pieces_.nodes[u] - pieces_.nodes[v]).norm();
    }
    std::vector<int> neighbours;
    neighbours.reserve(common.size());
    for (const auto& [j, length] : common) neighbours.push_back(j);
    std::ranges::stable_sort(neighbours, [&](int a, int b) { return common[a] > common[b]; });
    for (const int j : neighbours) {
      std::optional<Ring> both = united(pieces_.list[j].ring, ring);
      if (!both) continue;
      pieces_.list[j].ring = std::move(*both);
      ring.clear();
      sets_.join(i, j);
      return j;
    }
    return -1;
  }

  Pieces& pieces_;
  DisjointSets sets_;  // of pieces: the number is that of the piece that the others have joined
  std::map<std::pair<int, int>, int> piece_left_of_;
};

}  // namespace

void put_in_order(Pieces& pieces, int outline_size) {
  std::vector<int> order(pieces.nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin() + outline_size, order.end(),
                   [&](int i, int j) { return precedes(pieces.nodes[i], pieces.nodes[j]); });
  Pieces sorted;
  std::vector<int> index(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    index[order[i]] = static_cast<int>(i);
    sorted.nodes.push_back(pieces.nodes[order[i]]);
    sorted.freedom.push_back(pieces.freedom[order[i]]);
  }
  for (Piece& piece : pieces.list) {
    for (int& node : piece.ring) node = index[node];
    std::rotate(piece.ring.begin(), std::ranges::min_element(piece.ring), piece.ring.end());
  }
  sorted.list = std::move(pieces.list);
  std::ranges::sort(sorted.list, [](const Piece& a, const Piece& b) {
    return std::tie(a.site, a.ring) < std::tie(b.site, b.ring);
  });
  pieces = std::move(sorted);
}

void mark_owned(Pieces& pieces, const std::vector<Vec2>& sites) {
  std::vector<std::vector<int>> of_site(sites.size());
  for (size_t i = 0; i < pieces.list.size(); ++i) {
    of_site[pieces.list[i].site].push_back(static_cast<int>(i));
  }
  for (size_t site = 0; site < sites.size(); ++site) {
    const std::vector<int>& list = of_site[site];
    if (list.empty()) continue;
    int best = list[0];
    double largest = -1;
    for (const int i : list) {
      if (list.size() == 1) break;
      const std::vector<Vec2> ring = pieces.points(pieces.list[i].ring);
      if (strictly_inside(ring, sites[site])) {
        best = i;
        break;
      }
      if (const double size = ring_moments(ring, sites[site]).area; size > largest) {
        largest = size;
        best = i;
      }
    }
    pieces.list[best].owned = true;
  }
}

void join_triangles(Pieces& pieces) { PieceJoiner(pieces).join_triangles(); }

void join_pieces(Pieces& pieces) { PieceJoiner(pieces).join_to_owned(); }

}  // namespace apothem
