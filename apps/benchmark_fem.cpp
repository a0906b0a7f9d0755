// Internal forces and whole steps of finite elements, next to a straightforward Eigen version and
// to what the machine can do: bytes of memory and operations of arithmetic, per second.

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <Eigen/LU>

#include "apothem/dynamics/elements.hpp"
#include "apothem/geometry/meshing/voronoi.hpp"
#include "apothem/mesh/rectangle_mesh.hpp"
#include "apothem/mesh/reorder.hpp"

namespace {

using namespace apothem;

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

void report(benchmark::State& state, int elements) {
  state.counters["ns_per_element"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * elements * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// The internal forces alone.
void force(benchmark::State& state, ElementKind kind) {
  const DeformableBody body = block(kind, static_cast<int>(state.range(0)));
  FiniteElements elements(std::vector<ElementSet>{{kind, &body.mesh, 0, kRock, 2000, 1, 0}}, 1);
  std::vector<double> u(2 * body.mesh.nodes.size()), f(u.size());
  for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-5 * std::sin(static_cast<double>(i));
  for (auto _ : state) {
    elements.force(u, u, f);
    benchmark::DoNotOptimize(f.data());
  }
  report(state, elements.element_count());
}

// A whole step of the nodes: forces, two kicks, drift.
void step(benchmark::State& state, ElementKind kind) {
  const Model model = model_of(block(kind, static_cast<int>(state.range(0))));
  Elements elements(model, 1);
  const DegreesOfFreedom dofs(model, elements.elements().mass());
  State s = dofs.start();
  elements.start(dofs, s);
  StepBounds bounds;
  elements.bound_step(bounds);
  const double dt = .5 * bounds.nodes.step;
  Stopwatch clock;
  for (auto _ : state) {
    dofs.kick(s, dt / 2);
    dofs.drift(s, dt);
    elements.add_forces({s, s.v, dt, {}, clock});
    dofs.kick(s, dt / 2);
    benchmark::DoNotOptimize(s.x.data());
  }
  report(state, model.deformables[0].mesh.element_count());
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
template <bool keep>
void force_eigen(benchmark::State& state) {
  const DeformableBody body = block(ElementKind::quad4_full, static_cast<int>(state.range(0)));
  const Mesh& mesh = body.mesh;
  const auto n = static_cast<Eigen::Index>(mesh.nodes.size());
  Eigen::Matrix2Xd u(2, n), f(2, n);
  for (Eigen::Index i = 0; i < u.size(); ++i) u(i) = 1e-5 * std::sin(static_cast<double>(i));
  const auto corners = [&](int e) {
    Eigen::Matrix<double, 2, 4> x;
    for (int i = 0; i < 4; ++i) x.col(i) = mesh.nodes[mesh.element(e)[i]];
    return x;
  };
  std::vector<std::array<EigenGauss, 4>> kept;
  for (int e = 0; keep && e < mesh.element_count(); ++e) {
    kept.push_back({gauss_point(corners(e), 0), gauss_point(corners(e), 1),
                    gauss_point(corners(e), 2), gauss_point(corners(e), 3)});
  }
  const Hooke hooke(kRock);
  Eigen::Matrix3d elasticity;
  elasticity << hooke.constrained, hooke.coupled, 0, hooke.coupled, hooke.constrained, 0, 0, 0,
      hooke.twice_shear / 2;
  for (auto _ : state) {
    f.setZero();
    for (int e = 0; e < mesh.element_count(); ++e) {
      const std::span<const int> nodes = mesh.element(e);
      Eigen::Matrix<double, 2, 4> displacement, x;
      for (int i = 0; i < 4; ++i) displacement.col(i) = u.col(nodes[i]);
      if constexpr (!keep) x = corners(e);
      Eigen::Matrix<double, 8, 1> forces = Eigen::Matrix<double, 8, 1>::Zero();
      for (int k = 0; k < 4; ++k) {
        EigenGauss g;
        if constexpr (keep) {
          g = kept[e][k];
        } else {
          g = gauss_point(x, k);
        }
        const Eigen::Matrix2d h = displacement * g.gradients.transpose();
        const Eigen::Matrix2d deformation = Eigen::Matrix2d::Identity() + h;
        const Eigen::Matrix2d strain =
            .5 * (deformation.transpose() * deformation - Eigen::Matrix2d::Identity());
        const Eigen::Vector3d stress =
            elasticity * Eigen::Vector3d(strain(0, 0), strain(1, 1), 2 * strain(0, 1));
        Eigen::Matrix<double, 3, 8> b;
        for (int i = 0; i < 4; ++i) {
          const double gx = g.gradients(0, i), gy = g.gradients(1, i);
          b.block<1, 2>(0, 2 * i) = gx * deformation.col(0).transpose();
          b.block<1, 2>(1, 2 * i) = gy * deformation.col(1).transpose();
          b.block<1, 2>(2, 2 * i) =
              gy * deformation.col(0).transpose() + gx * deformation.col(1).transpose();
        }
        forces += g.weight * (b.transpose() * stress);
      }
      for (int i = 0; i < 4; ++i) f.col(nodes[i]) -= forces.segment<2>(2 * i);
    }
    benchmark::DoNotOptimize(f.data());
  }
  report(state, mesh.element_count());
}

// Voronoi cells, about six corners each.
void force_voronoi(benchmark::State& state) {
  const Polygon square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  VoronoiOptions options;
  options.cells = static_cast<int>(state.range(0));
  options.lloyd = 5;
  const VoronoiMesh voronoi = voronoi_mesh(square, options);
  Mesh mesh;
  mesh.nodes = voronoi.mesh.points;
  for (const std::vector<int>& cell : voronoi.mesh.cells) mesh.add_element(cell);
  reorder_along_curve(mesh);
  FiniteElements elements(
      std::vector<ElementSet>{{ElementKind::polygon, &mesh, 0, kRock, 2000, 1, 0}}, 1);
  std::vector<double> u(2 * mesh.nodes.size()), f(u.size());
  for (size_t i = 0; i < u.size(); ++i) u[i] = 1e-5 * std::sin(static_cast<double>(i));
  for (auto _ : state) {
    elements.force(u, u, f);
    benchmark::DoNotOptimize(f.data());
  }
  report(state, mesh.element_count());
}

// Memory: a = b + s c on arrays far larger than the caches (J. McCalpin, STREAM).
void machine_memory(benchmark::State& state) {
  std::vector<double> a(1 << 23), b(a.size(), 1), c(a.size(), 2);
  for (auto _ : state) {
    for (size_t i = 0; i < a.size(); ++i) a[i] = b[i] + 3 * c[i];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.counters["GB/s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * a.size()) * 24e-9, benchmark::Counter::kIsRate);
}

// Arithmetic: independent multiplications and additions in registers.
template <class Chain>
APOTHEM_INLINE void chains(benchmark::State& state, Chain& p) {
  const Pack factor(1.0000001), term(1e-9);
  for (auto _ : state) {
    for (int i = 0; i < 1000; ++i) {
      for (Pack& x : p) x = x * factor + term;
    }
    benchmark::DoNotOptimize(p);
  }
  state.counters["GF/s"] =
      benchmark::Counter(static_cast<double>(state.iterations() * 1000 * p.size() * kLanes) * 2e-9,
                         benchmark::Counter::kIsRate);
}
[[gnu::target("avx512f")]] void chains_avx512(benchmark::State& state) {
  std::array<Pack, 12> p{};
  chains(state, p);
}
[[gnu::target("avx2")]] void chains_avx2(benchmark::State& state) {
  std::array<Pack, 6> p{};
  chains(state, p);
}
void machine_arithmetic(benchmark::State& state) {
  if (__builtin_cpu_supports("avx512f")) {
    chains_avx512(state);
  } else if (__builtin_cpu_supports("avx2")) {
    chains_avx2(state);
  } else {
    std::array<Pack, 3> p{};
    chains(state, p);
  }
}

void sizes(benchmark::internal::Benchmark* b) { b->Arg(1000)->Arg(100000)->Arg(1000000); }

BENCHMARK_CAPTURE(force, T3, ElementKind::tri3)->Apply(sizes);
BENCHMARK_CAPTURE(force, Q4, ElementKind::quad4)->Apply(sizes);
BENCHMARK_CAPTURE(force, Q4_full, ElementKind::quad4_full)->Apply(sizes);
BENCHMARK_CAPTURE(force, polygon_of_four, ElementKind::polygon)->Apply(sizes);
BENCHMARK(force_voronoi)->Name("force/voronoi")->Arg(1000)->Arg(10000);
BENCHMARK_TEMPLATE(force_eigen, false)->Name("force/eigen")->Apply(sizes);
BENCHMARK_TEMPLATE(force_eigen, true)->Name("force/eigen_kept_gradients")->Apply(sizes);
BENCHMARK_CAPTURE(step, T3, ElementKind::tri3)->Apply(sizes);
BENCHMARK_CAPTURE(step, Q4, ElementKind::quad4)->Apply(sizes);
BENCHMARK_CAPTURE(step, Q4_full, ElementKind::quad4_full)->Apply(sizes);
BENCHMARK(machine_memory);
BENCHMARK(machine_arithmetic);

}  // namespace
