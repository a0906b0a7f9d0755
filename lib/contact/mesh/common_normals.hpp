// The common normal of friction springs that are close to each other on a boundary, and how much
// of the normal force counts for friction there (docs/theory.md, Friction).
//
// At a corner the edges push against each other. With every edge by itself, Coulomb's limit would
// be the sum of the sizes of their forces, which is more than what presses the bodies together, and
// the slip would be along the flanks. Therefore the pushes of a neighbourhood are summed: friction
// acts across their resultant, and what cancels does not count. Neighbourhoods are as long as a few
// depths: where a boundary is straight nothing changes, however the pressure varies.
#pragma once

#include <vector>

#include "lib/contact/mesh/edge_face_blocks.hpp"
#include "lib/contact/surface/outlines.hpp"

namespace apothem {

/// The contacts of an edge that have one friction spring, in an evaluation.
struct SpringContact {
  // What their contacts add up to; nothing acts where `normal` is 0.
  double normal = 0;      ///< size of the elastic push on the edge, N
  double place = 0;       ///< its moment along the edge over the length of the edge, N
  double rate_x = 0;      ///< slip rate of the edge against the faces, times the push, N m/s
  double rate_y = 0;      ///< likewise
  double slope_x = 0;     ///< of the potentials along the faces, which resist across them, N/m
  double slope_y = 0;     ///< likewise
  double deepest = 0;     ///< depth, m
  double ratio = 0;       ///< of the spring's stiffness to that along the normal
  std::int32_t edge = 0;  ///< of the outlines
  BodyIndex other = 0;    ///< the body of the faces
  // What the springs before have left; force_before is then with what neighbours hand over.
  bool is_old = false;
  double force_before = 0, stiffness_before = 0;  ///< N, N/m
  double push_before = 0;                         ///< of the dashpot along the normal, N
  // What follows.
  double nx = 0, ny = 0;      ///< unit vector along which the edge is pushed; 0 if there is none
  double pressed = 0;         ///< normal force that counts for friction, N
  double resistance = 0;      ///< stiffness along the normal, N/m
  double stiffness = 0;       ///< of the spring, N/m
  double friction = 0;        ///< its force along (-ny, nx) on the edge, N
  double drag = 0, push = 0;  ///< of the dashpots, along it and along the normal, N
};

class CommonNormals {
 public:
  /// Must outlive this object.
  explicit CommonNormals(const Outlines& outlines) : outlines_(outlines) {}

  /// Finds the normals, the normal forces and the forces of the springs before the step, in place.
  /// The same bits for any order of the springs and number of threads.
  void find(std::vector<SpringContact>& springs);

 private:
  /// Of those on one closed line that touch one body: by their places along the line.
  struct Place {
    std::int32_t loop;
    BodyIndex other;
    double at;  // along the line, m
    std::int32_t spring;
    double depth = 0;      // with that of neighbours, less the further they are, m
    double sizes = 0;      // of the pushes of the neighbourhood, N
    double cancelled = 0;  // of the own push, N
    double offered = 0;    // part of what a neighbour wants that it gets of what has gone
  };

  void find_places(const std::vector<SpringContact>& springs);
  void find_neighbourhood(std::vector<SpringContact>& springs, size_t first, size_t end);
  void hand_over(std::vector<SpringContact>& springs, size_t first, size_t end);
  template <class F>
  void each_neighbour(size_t first, size_t end, size_t i, const F& f) const;

  const Outlines& outlines_;
  std::vector<double> at_;              // of each vertex along its line, m
  std::vector<double> perimeter_;       // of each line, m
  std::vector<std::int32_t> loop_of_;   // of each vertex
  std::vector<std::uint8_t> measured_;  // of each line, in this evaluation
  std::vector<Place> places_;
  std::vector<double> added_;  // forces that neighbours hand over, N
  double deepest_ = 0;         // of the line at hand, m
};

}  // namespace apothem
