// Contact of deformable bodies by the potentials of their outermost elements (the paper, Sec. 3;
// docs/theory.md, Contact), for comparison with OutlineKernel.
//
// PairIntegrals gives the force and the loading point of each pair of polygons, and shape functions
// turn them into nodal forces. These are not the gradient of an energy, and the potentials vanish
// on borders between elements that are not part of any surface.
//
// Friction has one spring for each pair of polygons (Eqs. 10-14), along the tangent of the normal
// force. It follows the relative velocity of the two materials at the action point, SUM N_i v_i,
// and its force is distributed to the corners by the same N_i. Linear and angular momentum are
// conserved. The spring is lost with its pair: wherever a border between elements slides over
// another one, the friction of its neighbours is lost.
#pragma once

#include <optional>
#include <vector>

#include "geometry/integrals/contact_patches.hpp"
#include "geometry/integrals/penetration.hpp"
#include "lib/contact/kernel.hpp"
#include "lib/contact/law/pair_vector.hpp"
#include "lib/contact/rigid/pair_integrals.hpp"

namespace apothem {

class ElementKernel final : public Kernel {
 public:
  /// The distribution of the law must be resultant or integrated; `thickness` is in m. All
  /// arguments must outlive this object.
  ElementKernel(const Surfaces& surfaces, const ContactLaw& law, const PairTable& table,
                double thickness, int threads);

  void set_pairs(std::span<const BoxPair> pairs) override;
  void evaluate() override;
  [[nodiscard]] ContactSummary summary() const override;
  void visit_contacts(double least, const ContactVisitor& visit) const override;
  [[nodiscard]] double penetration(const Contact& contact, double floor) override;
  [[nodiscard]] ContactFault fault(const Contact& contact) const override;
  double update_friction(const Kinematics& now, double dt, FrictionMemory& memory) override;
  void add_forces(const ForceViews& forces) override;
  void add_dashpots(const Kinematics& now, Dashpots& dashpots) override;
  void keep_pushes(const Dashpots& dashpots, size_t& next, FrictionMemory& memory) override;

  [[nodiscard]] PairPeak largest_force() const override { return largest_force_; }
  [[nodiscard]] double energy() const override { return thickness_ * pairs_.energy(table_); }
  /// The bound of OutlineKernel::rate, with the edges of the undeformed mesh.
  [[nodiscard]] double rate(std::span<const double> node_mass) const override;
  [[nodiscard]] size_t candidates() const override { return pairs_.candidates(); }
  [[nodiscard]] Vec2 force_on(BodyIndex body) const override {
    return normal_.sums[body].force + tangential_.sums[body].force;
  }
  void add_records(std::vector<ContactRecord>& records) const override;
  void add_surfaces(std::vector<SurfaceRecord>& records) const override;

 private:
  /// Two polygons that touch.
  struct Touch {
    SurfaceIndex a, b;
    Vec2 force;            ///< force on a, N
    Vec2 point;            ///< action point relative to a's reference point, m
    Vec2 offset;           ///< a's reference point minus b's, m
    double pressure;       ///< sum of the magnitudes of the pressures that the force consists of, N
    double depth;          ///< see PairIntegral, m
    double stiffness = 0;  ///< stiffness along the force, N/m
    double spring = 0, spring_stiffness = 0;  ///< friction spring: force, N, and stiffness, N/m
    Vec2 friction = Vec2::Zero();             ///< friction on a, N
    Vec2 push = Vec2::Zero(), drag = Vec2::Zero();  ///< forces of the dashpots on a, N
  };
  struct NodeForce {
    NodeIndex node = 0;
    Vec2 force = Vec2::Zero();
    void fields(Archive& archive) { archive("node", node)("force", force); }
  };
  struct Forces {
    std::vector<NodeForce> nodes;
    std::vector<Resultant> sums;  ///< resultant on each body
    void clear(size_t bodies) {
      nodes.clear();
      sums.assign(bodies, {});
    }
  };
  /// A point of an element as the weighted mean of the element's corners.
  struct Corners {
    std::span<const NodeIndex> nodes;
    std::vector<double> weights;
    std::vector<Vec2> ring;
  };
  [[nodiscard]] std::span<const NodeIndex> nodes(SurfaceIndex i) const;
  [[nodiscard]] bool convex(SurfaceIndex i) const;
  void find_corners(SurfaceIndex i, const Vec2& point, Corners& corners) const;
  [[nodiscard]] Vec2 velocity_at(SurfaceIndex i, const Vec2& point, const Corners& corners,
                                 const Kinematics& now) const;
  static void distribute(const Corners& corners, const Vec2& force, Forces& sum);
  /// k_n times the thickness, N/m.
  [[nodiscard]] double stiffness(SurfaceIndex a, SurfaceIndex b) const {
    return table_.between(surfaces_.body(a), surfaces_.body(b)).normal_stiffness * thickness_;
  }
  void add_touch(const PairInTouch& result);
  void find_largest_force();
  void find_damped_pairs();
  /// Memory of find_penetration.
  struct Depths {
    PatchWorkspace workspace;
    std::vector<BoundarySegment> segments;
    std::vector<PairIntegral> patches;
    BoundaryDistance boundary;
  };
  [[nodiscard]] bool outer(SurfaceIndex i, int edge) const;
  template <class F>
  void each_outer_edge(SurfaceIndex i, const F& f) const;
  double find_penetration(SurfaceIndex a, SurfaceIndex b, double floor, Depths& work) const;
  [[nodiscard]] double power(const Forces& forces, const Kinematics& now) const;
  [[nodiscard]] static bool has_direction(const Touch& touch) {
    return touch.force.norm() > kNoResultant * touch.pressure;
  }
  [[nodiscard]] std::vector<int> patches() const;

  const Surfaces& surfaces_;
  const PairTable& table_;
  double thickness_;  // m
  ForceDistribution distribution_;
  PairIntegrals pairs_;
  std::vector<Contact> contacts_;  // ascending
  std::vector<Touch> touches_;     // one for each contact, unless one is out of range
  /// The two bodies of a touch, and the index of the touch.
  struct BodyTouch {
    BodyIndex a, b;
    int touch;
    auto operator<=>(const BodyTouch&) const = default;
  };
  std::vector<BodyTouch> body_touches_;  // one for each touch, ascending
  /// Sums over the touches between two damped bodies.
  struct DampedPair {
    /// Stiffness along the forces, and of the friction springs, N/m.
    double resistance = 0, stiffness = 0;
    double sizes = 0;           ///< sum of the magnitudes of the forces, N
    Vec2 force = Vec2::Zero();  ///< sum of the forces, N
    /// Sum of the action points times the magnitudes of the forces, N m.
    Vec2 places = Vec2::Zero();
  };
  std::vector<DampedPair> damped_pairs_;
  std::vector<size_t> pair_of_;  // index of the pair of each touch
  PairPeak largest_force_;
  Forces normal_, tangential_;
  PatchWorkspace workspace_;
  std::vector<BoundarySegment> segments_;
  std::vector<PairIntegral> patches_;
  Depths depths_;
  Corners of_a_, of_b_;
};

}  // namespace apothem
