// phi of a polygon that is not convex, along the edges of another polygon that stay in its boundary
// layer (boundary_layer.hpp). Most contacts are that shallow. Everything follows from the heights
// of the ends of an edge over the lines of the cells: where the edge enters and leaves a cell, and
// phi between. Four cells are the lanes of a pack.
//
// Two adjacent cells share the number that says where an edge passes from one to the other, so that
// round-off leaves no gap between them, and overlaps are no longer than round-off.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/integrals/cell_parts.hpp"
#include "geometry/integrals/placed_edge.hpp"
#include "geometry/polygon/segment_moments.hpp"

namespace apothem {

/// A maximal part of an edge inside the polygon, from s0 to s1, with the integrals of phi along
/// it. edge0 and edge1 are the edges that it crosses there, or -1 at an end of the edge itself.
struct LayerSegment {
  double s0, s1;
  int edge0, edge1;
  SegmentMoments<double> moments;
};

/// An edge of x that may enter y. An edge that leaves the boundary layer, or is deeper
/// everywhere, is marked as beyond_layer and has no segments here.
struct LayerEdge {
  int index;
  edge_detail::PlacedEdge placed;
  bool beyond_layer;
  size_t segments_end;  ///< end of its segments, which begin where those of the edge before end
};

/// Finds the segments of a polygon in another one by the boundary layer of the latter. Nothing is
/// allocated after the first calls with polygons of a given size.
class LayerTrace {
 public:
  /// Finds the segments of x in y, whose coordinates are finite. The arguments are those of
  /// walk_segments (edge_trace.hpp). The result for an edge depends on the polygons alone, and not
  /// on near_x and near_y. With `use` false all edges count as beyond the layer.
  void find(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
            std::uint64_t near_x, std::uint64_t near_y, bool use = true);
  /// The edges that may enter y, in ascending order.
  [[nodiscard]] const std::vector<LayerEdge>& edges() const { return edges_; }
  /// The segments of all edges, in their order along each edge.
  [[nodiscard]] const std::vector<LayerSegment>& segments() const { return segments_; }

 private:
  static constexpr int kPack = kComparedLanes;
  using Pack = edge_detail::CellPack;
  using End = edge_detail::CellEnd;
  enum class Found { all, neighbour, beyond };
  // A part of an edge in the cell of an edge of y, or in the sector of a vertex of y, where phi
  // forms an arc.
  struct Piece {
    double s0, s1, v0, v1;  // its ends, and phi at the ends
    End end0, end1;
    int cell;
    bool arc;
    double foot, square;  // for an arc: s of the point nearest to the vertex, and phi^2 there
  };
  // Cells of consecutive edges from `first` on, with one bit of `cells` for each.
  struct Window {
    int first;
    unsigned cells;
  };
  [[nodiscard]] bool sector_at(const PlacedPotential& y, int vertex) const {
    return distance_ && y.layer->reflex(vertex);
  }
  void list_edges(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                  std::uint64_t near);
  void list_windows(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
                    std::uint64_t near);
  bool add_cell(int cell);
  bool add_neighbours(const PlacedPotential& y, int cell);
  [[nodiscard]] Window* window_of(int cell);
  bool trace(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy);
  bool trace_edges(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy);
  [[nodiscard]] bool touches(const PlacedPotential& y, int c) const;
  Found trace_cells(const PlacedPotential& y, const Window& window);
  Found trace_sectors(const PlacedPotential& y);
  Found trace_sector(const PlacedPotential& y, int vertex);
  Found check_borders(const PlacedPotential& y, const Piece& piece, int before, int after);
  void close_pieces(const PlacedPotential& y);
  void find_beyond(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy);

  std::vector<LayerEdge> edges_;
  std::vector<Window> windows_;  // windows of cells of y, in ascending order of their first cells
  bool distance_ = false;        // true if phi is the distance from the boundary
  const edge_detail::PlacedEdge* edge_ = nullptr;  // the present edge
  double end_x_ = 0, end_y_ = 0;                   // end of the present edge
  std::vector<Piece> pieces_;                      // pieces of the present edge
  size_t count_ = 0;                               // number of these pieces
  std::vector<LayerSegment> segments_;
};

}  // namespace apothem
