// phi of a polygon that is not convex, along the edges of another polygon that stay in its collar
// (collar_cells.hpp). Most contacts are that shallow. The heights of the ends of an edge over the
// lines of the cells then give all: where the edge enters and leaves a cell, and phi between.
//
// Two cells share the number that says where an edge passes from one to the other, so that round-
// off leaves no gap between them, and overlaps are no longer than round-off.
#pragma once

#include <cstdint>
#include <vector>

#include "apothem/geometry/polygon/segment_moments.hpp"

namespace apothem {

struct PlacedPotential;

/// Nothing is allocated after the first calls with polygons of a given size.
class CollarTrace {
 public:
  /// A maximal part of an edge inside the polygon, from s0 to s1, with the integrals of phi along
  /// it. edge0 and edge1 are the edges that it crosses there, or -1 at an end of the edge itself.
  struct Run {
    int edge;
    double s0, s1;
    int edge0, edge1;
    SegmentMoments<double> moments;
  };

  /// Finds the runs of x in y, whose coordinates are finite. The arguments are those of walk_runs
  /// (edge_trace.hpp); `near_y` are the edges of y that may enter x. Returns false if an edge of x
  /// leaves the collar; then there is no result. It depends on the polygons alone, and not on
  /// near_x and near_y, whether this is so.
  bool find(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy,
            std::uint64_t near_x, std::uint64_t near_y);
  /// The runs in the order of their edges, and along each edge.
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }

 private:
  enum class Found { all, neighbour, deep };
  // Where a part of an edge ends: with the edge itself, at the border to the cell before or after,
  // at the depth of the cell, or, from 0 on, at this edge of the polygon.
  static constexpr int kEnd = -1, kBefore = -2, kAfter = -3, kTop = -4;
  struct Part {
    double s0 = 0, s1 = 1;
    int end0 = kEnd, end1 = kEnd;
    // Keeps what is inside; a linear function is `a` at the start of the edge and `b` at its end.
    // Returns false if nothing is left.
    bool cut(double a, double b, bool a_inside, bool b_inside, int by);
  };
  // A part of an edge in the cell of an edge, or, of an arc, in the sector of a vertex.
  struct Piece {
    Part part;
    int cell;
    bool arc;
    double v0, v1;        // phi at the ends of the part
    double foot, square;  // of an arc: s of the point nearest to the vertex, and phi^2 there
  };
  [[nodiscard]] bool sector_before(const PlacedPotential& y, int vertex) const;
  void place_lines(const PlacedPotential& y);
  void place_point(double px, double py, double* row) const;
  Found trace(const PlacedPotential& x, const PlacedPotential& y, double dx, double dy);
  Found trace_cell(const PlacedPotential& y, const double* from, const double* to, size_t k);
  Found trace_sector(const PlacedPotential& y, const double* from, const double* to, int vertex,
                     size_t own);
  Found add_piece(const PlacedPotential& y, const Piece& piece, int before, int after);
  void close_pieces(int edge, double slope);

  static constexpr int kPack = 4;
  static constexpr size_t kLineNumbers = 6;   // g, first vertex, second vertex
  std::vector<int> edges_, cells_;            // of x and of y
  std::vector<size_t> slots_;                 // places of the lines of the cells
  std::vector<double> lines_;                 // of cells and their neighbours, number by number
  size_t stride_ = 0, packs_ = 0;             // of the lines
  bool distance_ = false;                     // phi is the distance from the boundary
  double px_ = 0, py_ = 0, ex_ = 0, ey_ = 0;  // the edge at hand
  std::vector<double> rows_;                  // of its ends: see place_point
  std::vector<Piece> pieces_;                 // of this edge
  std::vector<Run> runs_;
};

}  // namespace apothem
