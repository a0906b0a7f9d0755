#include "lib/output/field_overlay.hpp"

#include <algorithm>
#include <cmath>

#include "lib/mesh/edges.hpp"

namespace apothem {
namespace {

constexpr double kThickestOutline = .7, kThinnestOutline = .15;  // of outlines, points
constexpr double kLineOfSize = .04;  // width of an outline over the size of a body
constexpr double kFaintest = 5e-3;   // of the largest force: chains below are not drawn
const Colour kChain{.1, .1, .1}, kChainHalo{1, 1, 1};
const Colour kRose{.84, .37, 0};  // vermilion, which differs from all of Viridis

// The boundary edges, joined into closed lines.
std::vector<std::vector<Vec2>> boundary_lines(const Mesh& mesh) {
  const std::vector<MeshEdge> edges = boundary_edges(mesh);
  std::vector<std::vector<int>> leaving(mesh.nodes.size());
  for (const MeshEdge& edge : edges) leaving[edge.nodes[0]].push_back(edge.nodes[1]);
  std::vector<std::vector<Vec2>> lines;
  for (const MeshEdge& edge : edges) {
    int node = edge.nodes[0];
    if (leaving[node].empty()) continue;
    std::vector<Vec2>& line = lines.emplace_back();
    while (!leaving[node].empty()) {
      line.push_back(mesh.nodes[node]);
      const int next = leaving[node].back();
      leaving[node].pop_back();
      node = next;
    }
  }
  return lines;
}

}  // namespace

void draw_outlines(Canvas& canvas, const Axes& axes, const Field& field, double area) {
  Rings lines = boundary_lines(field.mesh);
  const double size = std::sqrt(area / std::max<double>(1, static_cast<double>(lines.size())));
  const Pen pen{{.15, .15, .15},
                std::clamp(kLineOfSize * size, kThinnestOutline, kThickestOutline)};
  for (const auto& [element, holes] : field.holes) {
    for (const std::vector<int>& hole : holes) lines.push_back(field.mesh.places(hole));
  }
  for (const std::vector<Vec2>& line : lines) canvas.stroke(axes(line), true, pen);
}

void draw_chains(Canvas& canvas, const Axes& axes, const std::vector<ForceChain>& chains,
                 double largest, double widest) {
  // A light halo separates the chains from the colours below; all halos lie below all chains.
  for (const bool halo : {true, false}) {
    for (const ForceChain& chain : chains) {
      const double share = chain.normal / largest;
      if (!(share > kFaintest)) continue;
      const double width = widest * share;
      const Pen pen{halo ? kChainHalo : kChain, halo ? width + std::min(1.2, width) : width};
      canvas.stroke(axes(chain.line), false, pen);
    }
  }
}

void draw_roses(Canvas& canvas, const Axes& axes, const std::vector<Rose>& roses) {
  for (const Rose& rose : roses) {
    if (rose.line.empty()) continue;
    // Opposite directions are equally frequent, so the middle is the mean of all points.
    Vec2 middle = Vec2::Zero();
    for (const Vec2& p : rose.line) middle += p;
    middle /= static_cast<double>(rose.line.size());
    const std::vector<Vec2> ring = axes(rose.line);
    canvas.fill(ring, {kRose.red, kRose.green, kRose.blue, .45});
    canvas.stroke(ring, true, {kRose, 1});
    const size_t longest =
        static_cast<size_t>(std::ranges::max_element(rose.frequency) - rose.frequency.begin());
    if (!(rose.frequency[longest] > 0)) continue;
    const double radius =
        (axes(rose.line[longest]) - axes(middle)).norm() / rose.frequency[longest];
    canvas.circle(axes(middle), radius, {0, 0, 0, 0}, {{.1, .1, .1}, .9, {3, 2.5}});
  }
}

void draw_chain_sample(Canvas& canvas, const Vec2& at, double widest) {
  constexpr double kSample = 26;
  const Vec2 cap(widest / 2, 0);
  canvas.stroke({at + cap, at + Vec2(kSample, 0) - cap}, false, {kChain, widest});
}

void draw_rose_sample(Canvas& canvas, const Vec2& at) {
  canvas.circle(at + Vec2(13, 0), 6, {kRose.red, kRose.green, kRose.blue, .45}, {kRose, 1});
}

}  // namespace apothem
