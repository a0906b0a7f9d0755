// Internal forces of all finite elements: the hot loop.
//
//   elements in the order of a space-filling curve, 512 to a chunk, 8 to a block:
//
//     chunk:  nodes -> local copy of u (v)  ->  blocks of 8 (one SIMD pass each)  ->  local f
//             local f of nodes that only this chunk has:  straight to the global array
//             of nodes shared with other chunks:          to a slot of their own in the halo
//     then:   each shared node sums its slots, in the order of the chunks
//
// A chunk works inside the first-level cache and writes nothing that another one writes, so chunks
// run on any number of threads and give the same bits.
#pragma once

#include <boost/align/aligned_allocator.hpp>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "fem/element.hpp"
#include "fem/stress.hpp"
#include "mesh/mesh.hpp"

namespace apothem {

/// The elements of one body.
struct ElementSet {
  ElementKind kind = ElementKind::quad4;
  const Mesh* mesh = nullptr;  ///< elements and nodes in the order of a space-filling curve
  int first_node = 0;          ///< in the arrays of all nodes
  Elastic material;
  double density = 0;            ///< kg/m^3
  double thickness = 1;          ///< m
  double stiffness_damping = 0;  ///< Rayleigh's beta, s
};

class FiniteElements {
 public:
  /// Nodal arrays of all functions: x, y of each node, one body after another.
  FiniteElements(std::span<const ElementSet> sets, int threads);

  [[nodiscard]] int node_count() const { return static_cast<int>(mass_.size()); }
  [[nodiscard]] int element_count() const { return elements_; }
  /// Lumped, kg.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  [[nodiscard]] bool damped() const { return damped_; }
  /// Of all elements in the reference configuration, m.
  [[nodiscard]] double shortest_edge() const { return shortest_edge_; }

  /// Minus the internal forces, N, of displacements (m) and, where there is damping, velocities
  /// (m/s). Returns the power that damping takes, W. No allocation.
  double force(std::span<const double> u, std::span<const double> v, std::span<double> f);

  /// J.
  [[nodiscard]] double strain_energy(std::span<const double> u);

  /// For each coordinate an upper bound of SUM_j |K_ij|, N/m, of the tangent stiffness at u: the
  /// sum over the elements' own matrices, by differences of their forces. Without damping.
  void stiffness_sums(std::span<const double> u, std::span<double> sums) const;

  /// Mean stress of every element, in the order of the sets. Without damping.
  [[nodiscard]] std::vector<CauchyStress> stresses(std::span<const double> u) const;

  /// The same of one element, by its set and its number in the set's mesh. Looks for it.
  [[nodiscard]] CauchyStress stress(std::span<const double> u, int set, int element) const;

  /// The smallest ratio of an element's present area to its reference area, and which element it
  /// is: at zero it is turned inside out.
  struct Collapse {
    double ratio;
    int set, element;
  };
  [[nodiscard]] Collapse smallest_ratio(std::span<const double> u) const;

 private:
  /// Blocks of elements with the same number of corners.
  struct Run {
    int corners, elements;
    size_t data, local;  // where their numbers and local node numbers start
    int first;           // of their places in order_
  };
  struct Chunk {
    int set;
    size_t runs, runs_end;
    size_t nodes, nodes_end;
  };
  using Aligned = std::vector<double, boost::alignment::aligned_allocator<double, 64>>;
  struct Scratch {
    Aligned u, v, f;
  };
  enum class Task { force, energy };

  void add_set(int index, const ElementSet& set);
  void add_chunk(int index, const ElementSet& set, std::span<const int> elements);
  void find_shared_nodes();
  double run(Task task, std::span<const double> u, std::span<const double> v, std::span<double> f);
  template <class F>
  void visit(const Chunk& chunk, const Run& part, int k, std::span<const double> u,
             std::vector<Point<double>>& corners, F&& f) const;
  template <class F>
  void each_element(std::span<const double> u, F&& f) const;

  std::vector<ElementSet> sets_;
  int elements_ = 0;
  bool damped_ = false;
  double shortest_edge_ = HUGE_VAL;
  std::vector<double> mass_;
  std::vector<Chunk> chunks_;
  std::vector<Run> runs_;
  Aligned data_;                      // blocks: a column of kLanes per number
  std::vector<std::uint16_t> local_;  // blocks: a column of kLanes local nodes per corner
  std::vector<int> order_;            // number in its mesh of each element
  std::vector<int> nodes_;            // of the chunks' local nodes, in the global arrays
  std::vector<int> target_;           // of their forces: a node, or -1 - a slot of the halo
  std::vector<int> shared_, slots_;   // nodes with slots slots_[i] ... slots_[i + 1] - 1
  std::vector<double> halo_;
  std::vector<double> chunk_sums_;
  std::vector<Scratch> scratch_;  // one per thread
};

}  // namespace apothem
