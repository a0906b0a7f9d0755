// Internal forces and whole steps of finite elements, next to a straightforward Eigen version.
//
// Operations are counted by running the kernel with numbers that count. Bytes are those that have
// to pass between memory and processor if no cache holds the mesh: what is kept of each element,
// the numbers of its corners, and of each node the displacement that is read, the force that is
// written, and its place in both.

#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>

#include "apps/benchmark/bench.hpp"
#include "apps/benchmark/counted.hpp"
#include "geometry/meshing/voronoi.hpp"
#include "lib/dynamics/elements.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/mesh/reorder.hpp"

namespace apothem {
namespace {

constexpr Elastic kRock{ElasticLaw::st_venant_kirchhoff, Plane::stress, 20e9, .2};

DeformableBody block(ElementKind kind, int elements) {
  DeformableBody body;
  body.name = "block";
  body.element = kind;
  const bool triangles = kind == ElementKind::tri3;
  const int cells = static_cast<int>(std::lround(std::sqrt(triangles ? elements / 2 : elements)));
  body.mesh = rectangle_mesh({1, 1}, {cells, cells}, {0, 0},
                             triangles ? ElementShape::triangle : ElementShape::quadrilateral);
  reorder_along_curve(body.mesh);
  return body;
}

Model model_of(DeformableBody body) {
  Model model;
  model.materials = {{"rock", 2000, kRock}};
  model.deformables = {std::move(body)};
  return model;
}

// Displacements of all nodes, and room for their forces.
struct Nodal {
  std::vector<double> u, f;
  explicit Nodal(size_t nodes) : u(2 * nodes), f(2 * nodes) {
    for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-5 * std::sin(static_cast<double>(i));
  }
};

double operations_of(ElementKind kind, const Mesh& mesh) {
  const std::vector<Vec2> x = mesh.places(mesh.element(0));
  const int corners = static_cast<int>(x.size());
  return with_element(kind, [&]<class Element>(Element) {
    std::vector<double> stored(static_cast<size_t>(Element::stored(corners)) * kLanes);
    Element::prepare(x, kRock, 1, stored.data());
    std::vector<Point<Counted>> u(x.size()), f(x.size());
    Counted power = 0.;
    const Response<StVenantKirchhoff, false> material(StVenantKirchhoff(kRock), kRock, 0, 1);
    Counted::operations = 0;
    Element::force(Stored<Counted>{stored.data()}, material, corners, u.data(), u.data(), f.data(),
                   power);
    // Each corner's force is added to that of its node, x and y.
    return static_cast<double>(Counted::operations) + 2. * corners;
  });
}

double bytes_of(ElementKind kind, const Mesh& mesh) {
  const int corners = static_cast<int>(mesh.element(0).size());
  const int stored =
      with_element(kind, [&]<class Element>(Element) { return Element::stored(corners); });
  const double nodes_per_element =
      static_cast<double>(mesh.nodes.size()) / static_cast<double>(mesh.element_count());
  const double of_element = 8. * stored + 2. * corners;
  const double of_node = 2 * 16. + 2 * 4.;
  return of_element + nodes_per_element * of_node;
}

// The internal forces of a mesh with elements of one kind.
Work force_of(ElementKind kind, Mesh made, int threads) {
  struct Prepared {
    Mesh mesh;
    FiniteElements elements;
    Nodal nodal;
    Prepared(Mesh&& m, ElementKind kind, int threads)
        : mesh(std::move(m)),
          elements(std::vector<ElementSet>{{kind, &mesh, 0, kRock, 2000, 1, 0}}, threads),
          nodal(mesh.nodes.size()) {}
  };
  const auto p = std::make_shared<Prepared>(std::move(made), kind, threads);
  return {.once = [p] {
    p->elements.force(p->nodal.u, p->nodal.u, p->nodal.f);
    keep(*p->nodal.f.data());
    return static_cast<double>(p->elements.element_count());
  }};
}

Work force(ElementKind kind, int elements, int threads) {
  Mesh mesh = block(kind, elements).mesh;
  const double bytes = bytes_of(kind, mesh), operations = operations_of(kind, mesh);
  Work work = force_of(kind, std::move(mesh), threads);
  work.bytes = bytes, work.operations = operations;
  return work;
}

// A whole step of the nodes: forces, two kicks, drift.
Work step(ElementKind kind, int count, int threads) {
  struct Prepared {
    Model model;
    Elements elements;
    DegreesOfFreedom dofs;
    State state;
    double dt = 0;
    PhaseTimer clock;
    Prepared(Model&& m, int threads)
        : model(std::move(m)),
          elements(model, threads),
          dofs(model, elements.elements().mass()),
          state(dofs.start()) {
      elements.start(dofs, state);
      StepBounds bounds;
      elements.bound_step(bounds);
      dt = .5 * bounds.nodes.step;
    }
  };
  const auto p = std::make_shared<Prepared>(model_of(block(kind, count)), threads);
  return {.once = [p] {
    p->dofs.kick(p->state, p->dt / 2);
    p->dofs.drift(p->state, p->dt);
    p->elements.add_forces({p->state, p->state.v, p->dt, {}, p->clock});
    p->dofs.kick(p->state, p->dt / 2);
    keep(*p->state.x.data());
    return static_cast<double>(p->elements.elements().element_count());
  }};
}

struct EigenGauss {
  Eigen::Matrix<double, 2, 4> gradients;
  double weight;  // of the area
};

// Gradients of the shape functions of a quadrilateral, a column per corner.
EigenGauss gauss_point(const Eigen::Matrix<double, 2, 4>& corners, int g) {
  const double p = 1 / std::sqrt(3.);
  const double xi = (g == 1 || g == 2) ? p : -p, eta = g > 1 ? p : -p;
  Eigen::Matrix<double, 2, 4> local;
  local << -(1 - eta), 1 - eta, 1 + eta, -(1 + eta), -(1 - xi), -(1 + xi), 1 + xi, 1 - xi;
  local /= 4;
  const Eigen::Matrix2d jacobian = local * corners.transpose();
  return {jacobian.inverse() * local, jacobian.determinant()};
}

// Q4-full in Eigen's fixed-size matrices as textbooks write it: f = SUM B^T S w with B of 3 x 8,
// S = D E; with the shape functions' gradients computed in every call, or kept.
template <bool kept_gradients>
class EigenElements {
 public:
  explicit EigenElements(int count) : mesh_(block(ElementKind::quad4_full, count).mesh) {
    const auto n = static_cast<Eigen::Index>(mesh_.nodes.size());
    u_.resize(2, n), f_.resize(2, n);
    for (Eigen::Index i = 0; i < u_.size(); ++i) u_(i) = 1e-5 * std::sin(static_cast<double>(i));
    for (int e = 0; kept_gradients && e < mesh_.element_count(); ++e) {
      const Eigen::Matrix<double, 2, 4> x = corners(e);
      kept_.push_back({gauss_point(x, 0), gauss_point(x, 1), gauss_point(x, 2), gauss_point(x, 3)});
    }
    const Hooke hooke(kRock);
    elasticity_ << hooke.constrained, hooke.coupled, 0, hooke.coupled, hooke.constrained, 0, 0, 0,
        hooke.twice_shear / 2;
  }

  double force() {
    f_.setZero();
    for (int e = 0; e < mesh_.element_count(); ++e) {
      const std::span<const int> nodes = mesh_.element(e);
      Eigen::Matrix<double, 2, 4> displacement, x;
      for (int i = 0; i < 4; ++i) displacement.col(i) = u_.col(nodes[i]);
      if constexpr (!kept_gradients) x = corners(e);
      Eigen::Matrix<double, 8, 1> forces = Eigen::Matrix<double, 8, 1>::Zero();
      for (int k = 0; k < 4; ++k) {
        EigenGauss g;
        if constexpr (kept_gradients) {
          g = kept_[e][k];
        } else {
          g = gauss_point(x, k);
        }
        const Eigen::Matrix2d h = displacement * g.gradients.transpose();
        const Eigen::Matrix2d deformation = Eigen::Matrix2d::Identity() + h;
        const Eigen::Matrix2d strain =
            .5 * (deformation.transpose() * deformation - Eigen::Matrix2d::Identity());
        const Eigen::Vector3d stress =
            elasticity_ * Eigen::Vector3d(strain(0, 0), strain(1, 1), 2 * strain(0, 1));
        Eigen::Matrix<double, 3, 8> b;
        for (Eigen::Index i = 0; i < 4; ++i) {
          const double gx = g.gradients(0, i), gy = g.gradients(1, i);
          b.block<1, 2>(0, 2 * i) = gx * deformation.col(0).transpose();
          b.block<1, 2>(1, 2 * i) = gy * deformation.col(1).transpose();
          b.block<1, 2>(2, 2 * i) =
              gy * deformation.col(0).transpose() + gx * deformation.col(1).transpose();
        }
        forces += g.weight * (b.transpose() * stress);
      }
      for (Eigen::Index i = 0; i < 4; ++i) {
        f_.col(nodes[static_cast<size_t>(i)]) -= forces.segment<2>(2 * i);
      }
    }
    keep(*f_.data());
    return mesh_.element_count();
  }

 private:
  [[nodiscard]] Eigen::Matrix<double, 2, 4> corners(int e) const {
    Eigen::Matrix<double, 2, 4> x;
    for (int i = 0; i < 4; ++i) x.col(i) = mesh_.nodes[mesh_.element(e)[i]];
    return x;
  }

  Mesh mesh_;
  Eigen::Matrix2Xd u_, f_;
  std::vector<std::array<EigenGauss, 4>> kept_;
  Eigen::Matrix3d elasticity_;
};

template <bool kept_gradients>
Work force_eigen(int count) {
  const auto elements = std::make_shared<EigenElements<kept_gradients>>(count);
  return {.once = [elements] { return elements->force(); }};
}

// Voronoi cells, about six corners each.
Work force_voronoi(int cells, int threads) {
  VoronoiOptions options;
  options.cells = cells;
  options.lloyd = 5;
  const VoronoiMesh voronoi = voronoi_mesh(Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), options);
  Mesh mesh;
  mesh.nodes = voronoi.mesh.points;
  for (const std::vector<int>& cell : voronoi.mesh.cells) mesh.add_element(cell);
  reorder_along_curve(mesh);
  return force_of(ElementKind::polygon, std::move(mesh), threads);
}

}  // namespace

std::vector<BenchmarkCase> element_cases() {
  std::vector<BenchmarkCase> cases;
  const auto enter = [&](const std::string& name, const std::string& about,
                         std::initializer_list<int> counts,
                         const std::function<Work(int count, int threads)>& make) {
    add_family(cases, {.name = name, .item = "element", .about = about}, counts, make);
  };
  const auto counts = {1000, 100000, 1000000};
  const std::pair<const char*, ElementKind> kinds[]{{"T3", ElementKind::tri3},
                                                    {"Q4", ElementKind::quad4},
                                                    {"Q4_full", ElementKind::quad4_full},
                                                    {"polygon_of_four", ElementKind::polygon}};
  for (const auto& [name, kind] : kinds) {
    enter(std::string("force/") + name, "internal forces of finite elements", counts,
          [kind = kind](int count, int threads) { return force(kind, count, threads); });
  }
  enter("force/voronoi", "internal forces of Voronoi cells", {1000, 10000}, force_voronoi);
  enter("force/eigen", "Q4_full written with Eigen as in a textbook", counts,
        [](int count, int) { return force_eigen<false>(count); });
  enter("force/eigen_kept_gradients", "the same, gradients of shape functions kept", counts,
        [](int count, int) { return force_eigen<true>(count); });
  for (const auto& [name, kind] : std::span(kinds).first(3)) {
    enter(std::string("step/") + name, "whole steps of the nodes", counts,
          [kind = kind](int count, int threads) { return step(kind, count, threads); });
  }
  return cases;
}

}  // namespace apothem
