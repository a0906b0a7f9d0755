// Contact of deformable bodies: one edge against one face by itself, whole interfaces in place, and
// the same interface by potentials of the elements on it.

#include <cmath>
#include <memory>

#include "apps/benchmark/bench.hpp"
#include "apps/benchmark/counted.hpp"
#include "apps/cases/samples.hpp"
#include "lib/contact/contacts.hpp"
#include "lib/mesh/rectangle_mesh.hpp"

namespace apothem {
namespace {

ContactLaw law_of(const Friction& friction = {}) {
  ContactLaw law;
  law.normal_stiffness = 1;
  law.friction = friction;
  return law;
}

// Two bars on each other, cells that do not match, a little wavy.
struct Interface {
  Interface(int cells, const ContactLaw& law)
      : lower(rectangle_mesh({1. * cells, 4}, {cells, 4}, {0, 0}, ElementShape::quadrilateral)),
        upper(rectangle_mesh({.97 * cells, 4}, {cells, 4}, {.01 * cells, 3.95},
                             ElementShape::quadrilateral)),
        displacement(2 * (lower.nodes.size() + upper.nodes.size())),
        now{{}, displacement, {}, displacement},
        contacts(law, 1, surfaces(law.surface == ContactSurface::body), PairTable(law, {0, 0}, 1),
                 1) {
    for (size_t i = 0; i < displacement.size(); ++i)
      displacement[i] = .01 * std::sin(static_cast<double>(i));
    place();
    contacts.evaluate();
  }
  void place() {
    contacts.place(now);
    contacts.search_if_stale();
  }
  Mesh lower, upper;
  std::vector<double> displacement;
  Kinematics now;  // the velocities are as wavy as the displacements
  Contacts contacts;

 private:
  [[nodiscard]] Surfaces surfaces(bool outlines) const {
    Surfaces made(.1, .1, outlines);
    const int second = static_cast<int>(lower.nodes.size());
    for (const auto& [mesh, first] : {std::pair(&lower, 0), std::pair(&upper, second)}) {
      if (outlines) {
        made.add_outline(*mesh, first, {});
      } else {
        made.add_elements(*mesh, first, {});
      }
    }
    return made;
  }
};

// One edge and one face.
struct EdgeAndFace {
  double alpha, beta;  // slopes of the cell's sides
  Vec2 p, q;           // ends of the edge

  template <class Number>
  bool meet(CollarPiece<Number>& piece) const {
    const CollarFace<Number> face{0, 0, 1, 0, 1, 0, 1, alpha, 1, beta, 1, .5, .4};
    CollarCrossings<Number> crossings;
    return collar_piece(face, Number(p.x()), Number(p.y()), Number(q.x()), Number(q.y()), piece,
                        crossings);
  }
};

Work edge_and_face() {
  constexpr size_t kPairs = 256;
  samples::Random random(1);
  const auto pairs = std::make_shared<std::vector<EdgeAndFace>>();
  long operations = 0;
  while (pairs->size() < kPairs) {
    const double alpha = random.uniform(-.2, .2), beta = random.uniform(-.2, .2);
    const double px = random.uniform(0, 1.5), py = random.uniform(-.1, .2);
    const double qx = random.uniform(-.5, 1), qy = random.uniform(-.1, .2);
    const EdgeAndFace pair{alpha, beta, {px, py}, {qx, qy}};
    CollarPiece<Counted> piece;
    Counted::operations = 0;
    if (!pair.meet(piece)) continue;
    operations += Counted::operations;
    pairs->push_back(pair);
  }
  return {.once =
              [pairs] {
                for (const EdgeAndFace& pair : *pairs) {
                  CollarPiece<double> piece;
                  keep(pair.meet(piece));
                  keep(piece);
                }
                return static_cast<double>(kPairs);
              },
          .operations = static_cast<double>(operations) / kPairs};
}

// All that a step needs: surfaces moved, candidates checked, pairs, nodal forces.
Work step(int cells, const ContactLaw& law) {
  const auto bars = std::make_shared<Interface>(cells, law);
  const auto f = std::make_shared<std::vector<double>>(bars->displacement.size());
  return {.once = [bars, f, cells] {
    bars->place();
    bars->contacts.evaluate();
    bars->contacts.add_forces({{}, *f, {}});
    keep(*f->data());
    return static_cast<double>(cells);
  }};
}

Work evaluation(int cells) {
  const auto bars = std::make_shared<Interface>(cells, law_of());
  return {.once = [bars, cells] {
    bars->contacts.evaluate();
    return static_cast<double>(cells);
  }};
}

Work friction(int cells) {
  const auto bars = std::make_shared<Interface>(cells, law_of({.5, .6}));
  return {.once = [bars, cells] {
    bars->contacts.update_friction(bars->now, 1e-3);
    return static_cast<double>(cells);
  }};
}

// The same interface by potentials of the outermost elements.
Work by_elements(int cells, ForceDistribution distribution) {
  ContactLaw law = law_of();
  law.surface = ContactSurface::element;
  law.distribution = distribution;
  return step(cells, law);
}

}  // namespace

std::vector<BenchmarkCase> contact_cases() {
  std::vector<BenchmarkCase> cases{{.name = "collar_edge_face",
                                    .item = "pair",
                                    .about = "one edge of a mesh against one face of another",
                                    .prepare = [](int) { return edge_and_face(); }}};
  const auto enter = [&](const std::string& name, const std::string& about,
                         const std::function<Work(int)>& make) {
    add_family(cases, {.name = name, .item = "cell", .about = about}, {100, 10000},
               [make](int cells, int) { return make(cells); });
  };
  enter("deformable_interface", "two rows of elements on each other: all that a step needs",
        [](int cells) { return step(cells, law_of()); });
  enter("deformable_evaluation", "the same: the pairs alone", evaluation);
  enter("deformable_friction", "the same: friction alone", friction);
  enter("element_interface/resultant", "the same by potentials of elements, resultants",
        [](int cells) { return by_elements(cells, ForceDistribution::resultant); });
  enter("element_interface/integrated", "the same by potentials of elements, integrated",
        [](int cells) { return by_elements(cells, ForceDistribution::integrated); });
  return cases;
}

}  // namespace apothem
