// Internal forces, masses, strain energy and stresses of all finite elements of a model.
//
// The evaluation of the internal forces takes most of a run's time. Elements come in the order of a
// space-filling curve, body after body, 512 to a chunk and 8 to a SIMD block:
//
//   for each chunk:  copy the nodal displacements (and velocities) into a local array
//                    process the blocks of 8 elements, one SIMD pass each, into local forces
//                    write the forces of nodes that only this chunk uses to the global array
//                    write the forces of nodes that other chunks use too to the halo, in which each
//                    (chunk, node) pair has a slot of its own
//   afterwards:      each shared node sums its slots, in the order of the chunks
//
// The working set of a chunk fits into the first-level cache. No chunk writes where another one
// writes, so that the result is the same to the last bit for any number of threads.
#pragma once

#include <boost/align/aligned_allocator.hpp>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lib/execution/parallel.hpp"
#include "lib/fem/element.hpp"
#include "lib/fem/stress.hpp"
#include "lib/mesh/mesh.hpp"
#include "lib/solver/tangent.hpp"

namespace apothem {

/// What an element is made of.
struct ElementMaterial {
  Elastic elastic;
  double density = 0;  ///< kg/m^3
  double stiffness_damping =
      0;  ///< Rayleigh's coefficient beta of stiffness-proportional damping, s
};

/// The finite elements of one body, with their materials.
struct ElementSet {
  ElementKind kind = ElementKind::quad4;
  const Mesh* mesh = nullptr;  ///< must outlive its users; numbered along a space-filling curve
  int first_node = 0;          ///< place of the mesh's node 0 in the arrays of all nodes
  /// Elastic law and constants.
  Elastic material = {};
  double density = 0;    ///< kg/m^3
  double thickness = 1;  ///< m
  double stiffness_damping =
      0;  ///< Rayleigh's coefficient beta of stiffness-proportional damping, s
  /// Where elements differ: the materials that there are, and which of them each element is made
  /// of; `material_of` must outlive its users. Both empty: all are of the material above.
  std::vector<ElementMaterial> materials = {};
  std::span<const int> material_of = {};

  [[nodiscard]] int material_number(int element) const {
    return material_of.empty() ? 0 : material_of[static_cast<size_t>(element)];
  }
};

/// The finite elements of all bodies. Nodal vectors (displacements, velocities, forces) hold x and
/// y of each node, one body after another: 2 x node_count() numbers.
class FiniteElements {
 public:
  /// Prepares the elements of all sets and their lumped masses. `threads` is the number of threads
  /// that force() and strain_energy() may use. The meshes of the sets are not copied.
  FiniteElements(std::span<const ElementSet> sets, int threads);

  [[nodiscard]] int node_count() const { return static_cast<int>(mass_.size()); }
  [[nodiscard]] int element_count() const { return elements_; }
  /// Lumped mass of each node, kg.
  [[nodiscard]] const std::vector<double>& mass() const { return mass_; }
  /// Whether any set has stiffness-proportional damping, so that force() reads velocities.
  [[nodiscard]] bool damped() const { return damped_; }
  /// Length of the shortest edge of all elements in the reference configuration, m.
  [[nodiscard]] double shortest_edge() const { return shortest_edge_; }

  /// Writes minus the internal forces, N, at the displacements `u` (m) and, if damped(), the
  /// velocities `v` (m/s) into `f`. Returns the power that damping dissipates, W. Allocates no
  /// memory. `lag`, s: the velocities are those with which the nodes have moved from 2 lag ago to
  /// now; strain rates are means over this way, which a rigid rotation leaves zero.
  double force(std::span<const double> u, std::span<const double> v, std::span<double> f,
               double lag = 0);

  /// Strain energy of all elements at the displacements `u` (m), J.
  [[nodiscard]] double strain_energy(std::span<const double> u);

  /// Writes for each degree of freedom i an upper bound of the row sum SUM_j |K_ij|, N/m, of the
  /// tangent stiffness K at the displacements `u` (m): the sum of the row sums of the elements' own
  /// matrices. Damping does not count.
  void stiffness_sums(std::span<const double> u, std::span<double> sums) const;

  /// Adds the tangent stiffness K = d(internal forces)/du at the displacements `u` (m), N/m, in
  /// which node 0 has the coordinates `first` and `first` + 1. It is exact: the elements' own force
  /// kernels are differentiated (lib/execution/dual.hpp). With the velocities `v` (m/s) with which
  /// the nodes have moved over the last `span` (s) damping counts, where force() has a lag of half
  /// of that: the matrix is the symmetric part of the derivative of all forces.
  void add_tangent(std::span<const double> u, size_t first, Tangent& tangent,
                   std::span<const double> v = {}, double span = 0) const;

  /// Mean Cauchy stress of every element at the displacements `u` (m), in the order of the sets and
  /// of the elements in each mesh. Stress of damping is not included.
  [[nodiscard]] std::vector<CauchyStress> stresses(std::span<const double> u) const;

  /// The mean Cauchy stress of one element, named by its set and its number in the set's mesh. The
  /// time grows with the number of elements, because the element has to be searched for.
  [[nodiscard]] CauchyStress stress(std::span<const double> u, int set, int element) const;

  /// The smallest ratio of an element's present area to its reference area, and that element's set
  /// and number in the mesh. An element is turned inside out when the ratio reaches zero. NaN if an
  /// element's ratio is NaN.
  struct Collapse {
    double ratio;
    int set, element;
  };
  [[nodiscard]] Collapse smallest_ratio(std::span<const double> u) const;

 private:
  /// An element of a set, by its number in the set's mesh.
  struct Member {
    int set, element;
  };
  /// What elements must have in common to be worked on together.
  struct Behaviour {
    ElementKind kind;
    ElementMaterial material;
    double thickness;  // m
  };
  /// Consecutive SIMD blocks of elements of one chunk that have the same number of corners and the
  /// same behaviour.
  struct Run {
    int corners, elements;
    int behaviour;       // among those of all (behaviours_)
    size_t data, local;  // where their stored numbers (data_) and local node numbers (local_) start
    int first;           // where their names (order_) start
  };
  /// Up to 512 elements, with the ranges of their runs (runs_) and nodes (nodes_).
  struct Chunk {
    size_t runs, runs_end;
    size_t nodes, nodes_end;
    bool apart;  ///< its nodes follow each other, and no other chunk uses them
  };
  using Aligned = std::vector<double, boost::alignment::aligned_allocator<double, 64>>;
  /// Local copies of the displacements, velocities and forces of one chunk's nodes.
  struct Scratch {
    Aligned u, v, f;
  };
  enum class Task { force, energy };

  [[nodiscard]] const ElementMaterial& material(int set, int element) const {
    return sets_[set].materials[sets_[set].material_number(element)];
  }
  void add_masses(int index, const ElementSet& set);
  void find_behaviours();
  void add_chunks();
  void add_chunk(std::span<const Member> elements);
  [[nodiscard]] std::span<const int> corners_of(const Member& member) const {
    return sets_[member.set].mesh->element(member.element);
  }
  [[nodiscard]] int behaviour_of(const Member& member) const {
    return behaviour_numbers_[member.set][sets_[member.set].material_number(member.element)];
  }
  void find_shared_nodes();
  double run(Task task, std::span<const double> u, std::span<const double> v, std::span<double> f,
             double lag);
  template <class F>
  void visit(const Run& part, int k, std::span<const double> u, std::vector<Point<double>>& corners,
             F&& f) const;
  template <class F>
  void each_element(std::span<const double> u, F&& f) const;
  // How the nodes have moved over the last `span` (s), m/s; empty if damping does not count.
  struct Motion {
    std::span<const double> v;
    double span = 0;
  };
  void each_stiffness(
      std::span<const double> u, const Motion& motion,
      const std::function<void(std::span<const size_t>, std::span<const double>)>& f) const;

  std::vector<ElementSet> sets_;
  std::vector<Behaviour> behaviours_;
  std::vector<std::vector<int>> behaviour_numbers_;  // of each set: that of each of its materials
  int elements_ = 0;
  bool damped_ = false;
  double shortest_edge_ = HUGE_VAL;
  std::vector<double> mass_;
  std::vector<Chunk> chunks_;
  std::vector<Run> runs_;
  // SIMD blocks: kLanes values of each stored number, and of each corner's local node, in a row.
  Aligned data_;
  std::vector<std::uint16_t> local_;
  std::vector<Member> order_;  // the elements, run after run
  std::vector<int> nodes_;     // number in the global arrays of each chunk's local nodes
  std::vector<int> target_;    // place of its force: node n as n, slot s of the halo as -1 - s
  std::vector<int> shared_, slots_;  // shared node i has the slots slots_[i] ... slots_[i + 1] - 1
  std::vector<double> halo_;         // forces on shared nodes, two numbers per slot
  std::vector<double> chunk_sums_;   // energy or damping power of each chunk
  Threads threads_;
  std::vector<Scratch> scratch_;  // one per thread
};

}  // namespace apothem
