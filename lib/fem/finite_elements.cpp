#include "lib/fem/finite_elements.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/dispatch.hpp"
#include "lib/execution/dual.hpp"
#include "lib/fem/mass.hpp"

namespace apothem {
namespace {

constexpr int kChunk = 512;          // elements of a chunk
constexpr double kElementTime = 15;  // of one element, ns
constexpr double kSharedTime = 5;    // of one node that several chunks share, ns
constexpr int kMostCorners = 64;     // of a polygonal element, for arrays on the stack

using Pair = double __attribute__((vector_size(16)));
using FourWide = double __attribute__((vector_size(32)));

// The elements of one run and the local arrays of their chunk: the argument of a kernel.
struct Blocks {
  const double* data;
  const std::uint16_t* local;
  int elements, corners;
  ElementKind kind;
  const ElementMaterial& material;
  double thickness;
  const double* u;
  const double* v;
  double* f;
  double lag;  // s, by which v is behind u
};

// The vectors (x, y) of nodes: loads of 16 bytes and a transposition, which is faster than a gather
// instruction.
APOTHEM_INLINE Pair load(const double* from, std::uint16_t node) {
  return *reinterpret_cast<const Pair*>(from + 2 * static_cast<ptrdiff_t>(node));
}
APOTHEM_INLINE void gather(const double* from, const std::uint16_t* n, Point<PackOf<4>>& to) {
  const FourWide a = __builtin_shufflevector(load(from, n[0]), load(from, n[1]), 0, 1, 2, 3);
  const FourWide b = __builtin_shufflevector(load(from, n[2]), load(from, n[3]), 0, 1, 2, 3);
  to.x = PackOf<4>(__builtin_shufflevector(a, b, 0, 2, 4, 6));
  to.y = PackOf<4>(__builtin_shufflevector(a, b, 1, 3, 5, 7));
}
APOTHEM_INLINE void gather(const double* from, const std::uint16_t* n, Point<PackOf<8>>& to) {
  Point<PackOf<4>> low, high;
  gather(from, n, low);
  gather(from, n + 4, high);
  to.x = PackOf<8>(__builtin_shufflevector(low.x.v, high.x.v, 0, 1, 2, 3, 4, 5, 6, 7));
  to.y = PackOf<8>(__builtin_shufflevector(low.y.v, high.y.v, 0, 1, 2, 3, 4, 5, 6, 7));
}

APOTHEM_INLINE void add_pair(double* to, std::uint16_t node, Pair value) {
  *reinterpret_cast<Pair*>(to + 2 * static_cast<ptrdiff_t>(node)) += value;
}
// Adds the forces of one lane after the other, because two lanes may share a node.
APOTHEM_INLINE void add(const Point<PackOf<4>>& f, double* to, const std::uint16_t* node) {
  const FourWide low = __builtin_shufflevector(f.x.v, f.y.v, 0, 4, 1, 5);
  const FourWide high = __builtin_shufflevector(f.x.v, f.y.v, 2, 6, 3, 7);
  add_pair(to, node[0], __builtin_shufflevector(low, low, 0, 1));
  add_pair(to, node[1], __builtin_shufflevector(low, low, 2, 3));
  add_pair(to, node[2], __builtin_shufflevector(high, high, 0, 1));
  add_pair(to, node[3], __builtin_shufflevector(high, high, 2, 3));
}
APOTHEM_INLINE void add(const Point<PackOf<8>>& f, double* to, const std::uint16_t* node) {
  const PackOf<8>::Vector low = __builtin_shufflevector(f.x.v, f.y.v, 0, 8, 1, 9, 2, 10, 3, 11);
  const PackOf<8>::Vector high = __builtin_shufflevector(f.x.v, f.y.v, 4, 12, 5, 13, 6, 14, 7, 15);
  add_pair(to, node[0], __builtin_shufflevector(low, low, 0, 1));
  add_pair(to, node[1], __builtin_shufflevector(low, low, 2, 3));
  add_pair(to, node[2], __builtin_shufflevector(low, low, 4, 5));
  add_pair(to, node[3], __builtin_shufflevector(low, low, 6, 7));
  add_pair(to, node[4], __builtin_shufflevector(high, high, 0, 1));
  add_pair(to, node[5], __builtin_shufflevector(high, high, 2, 3));
  add_pair(to, node[6], __builtin_shufflevector(high, high, 4, 5));
  add_pair(to, node[7], __builtin_shufflevector(high, high, 6, 7));
}

// Adds the forces into blocks.f and returns the power of damping or, if not `forces`, returns the
// strain energy alone. Blocks of kLanes elements are worked on in parts of `lanes`; their forces
// are added in the same order whatever the parts are.
template <int lanes, class Element, class Law, bool damped, bool forces>
APOTHEM_INLINE double work_through(const Blocks& blocks) {
  using Number = PackOf<lanes>;
  constexpr int kParts = kLanes / lanes;
  const ElementMaterial& material = blocks.material;
  const Response<Law, damped> response(Law(material.elastic), material.elastic,
                                       material.stiffness_damping, blocks.thickness, blocks.lag);
  const int corners = Element::kCorners > 0 ? Element::kCorners : blocks.corners;
  constexpr int kMost = Element::kCorners > 0 ? Element::kCorners : kMostCorners;
  const ptrdiff_t stored = static_cast<ptrdiff_t>(Element::stored(corners)) * kLanes;
  double sum = 0;
  for (int first = 0, block = 0; first < blocks.elements; first += kLanes, ++block) {
    const std::uint16_t* local = blocks.local + static_cast<ptrdiff_t>(block) * corners * kLanes;
    Point<Number> f[kParts][forces ? kMost : 1];
    for (int part = 0; part < kParts; ++part) {
      const int lane = part * lanes;
      const Stored<Number> data{blocks.data + block * stored + lane};
      Point<Number> u[kMost], v[damped ? kMost : 1];
      for (ptrdiff_t i = 0; i < corners; ++i) gather(blocks.u, local + i * kLanes + lane, u[i]);
      if constexpr (damped && forces) {
        for (ptrdiff_t i = 0; i < corners; ++i) gather(blocks.v, local + i * kLanes + lane, v[i]);
      }
      Number value(0.);
      if constexpr (forces) {
        Element::force(data, response, corners, u, v, f[part], value);
      } else {
        value = Element::energy(data, response, corners, u);
      }
      if constexpr (damped || !forces) {
        for (int i = 0; i < std::min(lanes, blocks.elements - first - lane); ++i) {
          sum += value.v[i];
        }
      }
    }
    if constexpr (forces) {
      for (ptrdiff_t i = 0; i < corners; ++i) {
        for (ptrdiff_t part = 0; part < kParts; ++part) {
          add(f[part][i], blocks.f, local + i * kLanes + part * lanes);
        }
      }
    }
  }
  return sum;
}

template <bool damped, bool forces>
double dispatch(const Blocks& blocks) {
  return with_element(blocks.kind, [&]<class Element>(Element) {
    return with_law(blocks.material.elastic, [&]<class Law>(const Law&) {
      const auto kernel = [&](auto lanes) __attribute__((always_inline)) {
        return work_through<decltype(lanes)::value, Element, Law, damped, forces>(blocks);
      };
      // Energies are asked for rarely: one version of their kernels is enough.
      if constexpr (forces) {
        return with_widest(kernel);
      } else {
        return kernel(Lanes<4>());
      }
    });
  });
}

}  // namespace

FiniteElements::FiniteElements(std::span<const ElementSet> sets, int threads)
    : sets_(sets.begin(), sets.end()), threads_(threads) {
  for (ElementSet& set : sets_) {
    if (set.materials.empty()) {
      set.materials = {{set.material, set.density, set.stiffness_damping}};
    }
  }
  for (int i = 0; i < static_cast<int>(sets_.size()); ++i) add_masses(i, sets_[i]);
  find_behaviours();
  add_chunks();
  find_shared_nodes();
  chunk_sums_.resize(chunks_.size());
  size_t most = 0;
  for (const Chunk& c : chunks_) most = std::max(most, c.nodes_end - c.nodes);
  Scratch scratch;
  for (Aligned* a : {&scratch.u, &scratch.v, &scratch.f}) a->assign(2 * (most + 1), 0);
  scratch_.assign(threads_.count(), scratch);
}

void FiniteElements::add_masses(int index, const ElementSet& set) {
  const Mesh& mesh = *set.mesh;
  elements_ += mesh.element_count();
  mass_.resize(std::max(mass_.size(), set.first_node + mesh.nodes.size()), 0);
  for (int e = 0; e < mesh.element_count(); ++e) {
    const ElementMaterial& of_element = material(index, e);
    damped_ = damped_ || of_element.stiffness_damping > 0;
    const std::vector<Vec2> x = mesh.places(mesh.element(e));
    const std::vector<double> areas = corner_areas(x);
    for (size_t i = 0; i < areas.size(); ++i) {
      shortest_edge_ = std::min(shortest_edge_, (x[i] - before(x, i)).norm());
      mass_[set.first_node + mesh.element(e)[i]] += of_element.density * set.thickness * areas[i];
    }
  }
}

// Sets of the same kind, material and thickness share a behaviour.
void FiniteElements::find_behaviours() {
  using Key = std::tuple<ElementKind, ElasticLaw, Plane, double, double, double, double>;
  std::map<Key, int> numbers;
  for (const ElementSet& set : sets_) {
    std::vector<int>& of_set = behaviour_numbers_.emplace_back();
    for (const ElementMaterial& m : set.materials) {
      const Key key(set.kind, m.elastic.law, m.elastic.plane, m.elastic.young, m.elastic.poisson,
                    m.stiffness_damping, set.thickness);
      const auto [found, is_new] = numbers.emplace(key, static_cast<int>(behaviours_.size()));
      if (is_new) behaviours_.push_back({set.kind, m, set.thickness});
      of_set.push_back(found->second);
    }
  }
}

// Small bodies share a chunk, so that they fill its blocks. None of them begins in one chunk and
// goes on in the next: then chunks share no nodes.
void FiniteElements::add_chunks() {
  std::vector<Member> members;
  const auto close = [&] {
    // Elements with the same number of corners and the same behaviour form one run.
    const auto key = [&](const Member& m) {
      return std::pair(behaviour_of(m), corners_of(m).size());
    };
    std::ranges::stable_sort(members, {}, key);
    add_chunk(members);
    members.clear();
  };
  for (int i = 0; i < static_cast<int>(sets_.size()); ++i) {
    const int count = sets_[i].mesh->element_count();
    if (!members.empty() && members.size() + static_cast<size_t>(count) > kChunk) close();
    for (int e = 0; e < count; ++e) {
      members.push_back({i, e});
      if (members.size() == kChunk) close();
    }
  }
  if (!members.empty()) close();
}

void FiniteElements::add_chunk(std::span<const Member> elements) {
  Chunk chunk{runs_.size(), 0, nodes_.size(), 0, false};
  std::vector<int> nodes;
  for (const Member& m : elements) {
    for (const int node : corners_of(m)) nodes.push_back(sets_[m.set].first_node + node);
  }
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  const auto local_of = [&](int node) {
    return static_cast<std::uint16_t>(std::ranges::lower_bound(nodes, node) - nodes.begin());
  };
  for (size_t begin = 0; begin < elements.size();) {
    const int corners = static_cast<int>(corners_of(elements[begin]).size());
    const int number = behaviour_of(elements[begin]);
    const Behaviour& behaviour = behaviours_[number];
    size_t end = begin;
    while (end < elements.size() && static_cast<int>(corners_of(elements[end]).size()) == corners &&
           behaviour_of(elements[end]) == number) {
      ++end;
    }
    const int count = static_cast<int>(end - begin);
    const size_t blocks = (end - begin + kLanes - 1) / kLanes;
    runs_.push_back(
        {corners, count, number, data_.size(), local_.size(), static_cast<int>(order_.size())});
    order_.insert(order_.end(), elements.begin() + static_cast<ptrdiff_t>(begin),
                  elements.begin() + static_cast<ptrdiff_t>(end));
    const int stored = with_element(
        behaviour.kind, [&]<class Element>(Element) { return Element::stored(corners); });
    data_.resize(data_.size() + blocks * stored * kLanes);
    // Lanes without an element repeat the data of the last one and use an additional local node,
    // which has no place in the global arrays.
    local_.resize(local_.size() + blocks * corners * kLanes,
                  static_cast<std::uint16_t>(nodes.size()));
    for (size_t k = 0; k < blocks * kLanes; ++k) {
      const size_t block = k / kLanes, lane = k % kLanes;
      const Member& m = elements[std::min(begin + k, end - 1)];
      with_element(behaviour.kind, [&]<class Element>(Element) {
        Element::prepare(sets_[m.set].mesh->places(sets_[m.set].mesh->element(m.element)),
                         behaviour.material.elastic, behaviour.thickness,
                         &data_[runs_.back().data + block * stored * kLanes + lane]);
      });
      if (begin + k >= end) continue;
      for (int i = 0; i < corners; ++i) {
        local_[runs_.back().local + (block * corners + i) * kLanes + lane] =
            local_of(sets_[m.set].first_node + corners_of(m)[i]);
      }
    }
    begin = end;
  }
  nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
  chunk.runs_end = runs_.size();
  chunk.nodes_end = nodes_.size();
  chunks_.push_back(chunk);
}

void FiniteElements::find_shared_nodes() {
  std::vector<int> users(mass_.size(), 0);
  for (const int node : nodes_) ++users[node];
  std::vector<int> next(mass_.size(), -1);
  slots_.push_back(0);
  for (int node = 0; node < node_count(); ++node) {
    if (users[node] < 2) continue;
    shared_.push_back(node);
    next[node] = slots_.back();
    slots_.push_back(slots_.back() + users[node]);
  }
  halo_.resize(2 * static_cast<size_t>(slots_.back()));
  for (const int node : nodes_) target_.push_back(next[node] < 0 ? node : -1 - next[node]++);
  for (Chunk& chunk : chunks_) {
    chunk.apart = true;
    for (size_t i = chunk.nodes; i < chunk.nodes_end; ++i) {
      const int own = nodes_[chunk.nodes] + static_cast<int>(i - chunk.nodes);
      chunk.apart = chunk.apart && target_[i] == own;
    }
  }
}

double FiniteElements::run(Task task, std::span<const double> u, std::span<const double> v,
                           std::span<double> f, double lag) {
  const int count = static_cast<int>(chunks_.size());
  const bool moving = task == Task::force && damped_;
  threads_.chunks(count, kChunk * kElementTime, [&](int first, int end, int worker) {
    Scratch& s = scratch_[worker];
    for (int c = first; c < end; ++c) {
      const Chunk& chunk = chunks_[c];
      const size_t n = chunk.nodes_end - chunk.nodes;
      const int* nodes = &nodes_[chunk.nodes];
      const auto take = [&](std::span<const double> from, Aligned& to) {
        if (chunk.apart) {
          std::copy_n(from.begin() + 2 * static_cast<ptrdiff_t>(nodes[0]), 2 * n, to.begin());
        } else {
          for (size_t i = 0; i < n; ++i) {
            to[2 * i] = from[2 * static_cast<size_t>(nodes[i])];
            to[2 * i + 1] = from[2 * static_cast<size_t>(nodes[i]) + 1];
          }
        }
        to[2 * n] = to[2 * n + 1] = 0;
      };
      take(u, s.u);
      if (moving) take(v, s.v);
      std::fill(s.f.begin(), s.f.begin() + static_cast<ptrdiff_t>(2 * (n + 1)), 0.);
      double sum = 0;
      for (size_t r = chunk.runs; r < chunk.runs_end; ++r) {
        const Run& part = runs_[r];
        const Behaviour& of_part = behaviours_[part.behaviour];
        const Blocks blocks{&data_[part.data],
                            &local_[part.local],
                            part.elements,
                            part.corners,
                            of_part.kind,
                            of_part.material,
                            of_part.thickness,
                            s.u.data(),
                            s.v.data(),
                            s.f.data(),
                            lag};
        if (task == Task::energy) {
          sum += dispatch<false, false>(blocks);
        } else {
          sum += of_part.material.stiffness_damping > 0 ? dispatch<true, true>(blocks)
                                                        : dispatch<false, true>(blocks);
        }
      }
      chunk_sums_[c] = sum;
      if (task == Task::energy) continue;
      if (chunk.apart) {
        std::transform(s.f.begin(), s.f.begin() + static_cast<ptrdiff_t>(2 * n),
                       f.begin() + 2 * static_cast<ptrdiff_t>(nodes[0]), std::negate<>());
        continue;
      }
      const int* target = &target_[chunk.nodes];
      for (size_t i = 0; i < n; ++i) {
        double* to = target[i] >= 0 ? &f[2 * static_cast<size_t>(target[i])]
                                    : &halo_[2 * static_cast<size_t>(-1 - target[i])];
        to[0] = -s.f[2 * i];
        to[1] = -s.f[2 * i + 1];
      }
    }
  });
  if (task == Task::force) {
    const auto shared = static_cast<int>(shared_.size());
    threads_.chunks(shared, kSharedTime, [&](int first, int end, int) {
      for (int i = first; i < end; ++i) {
        double x = 0, y = 0;
        for (int k = slots_[i]; k < slots_[i + 1]; ++k) {
          x += halo_[2 * static_cast<size_t>(k)];
          y += halo_[2 * static_cast<size_t>(k) + 1];
        }
        f[2 * static_cast<size_t>(shared_[i])] = x;
        f[2 * static_cast<size_t>(shared_[i]) + 1] = y;
      }
    });
  }
  double sum = 0;
  for (const double part : chunk_sums_) sum += part;
  return sum;
}

double FiniteElements::force(std::span<const double> u, std::span<const double> v,
                             std::span<double> f, double lag) {
  return run(Task::force, u, v, f, lag);
}

double FiniteElements::strain_energy(std::span<const double> u) {
  return run(Task::energy, u, {}, {}, 0);
}

// Calls f(element struct, stored numbers, number of corners, set, number in its mesh, displacements
// of its corners) for the k-th element of a run. `corners` is working memory.
template <class F>
void FiniteElements::visit(const Run& part, int k, std::span<const double> u,
                           std::vector<Point<double>>& corners, F&& f) const {
  const Member& member = order_[part.first + k];
  corners.clear();
  for (const int node : corners_of(member)) {
    const size_t at = 2 * static_cast<size_t>(sets_[member.set].first_node + node);
    corners.push_back({u[at], u[at + 1]});
  }
  with_element(behaviours_[part.behaviour].kind, [&]<class Element>(Element e) {
    const size_t block = static_cast<size_t>(Element::stored(part.corners)) * kLanes;
    const Stored<double> data{&data_[part.data + (k / kLanes) * block + k % kLanes]};
    f(e, data, part.corners, member.set, member.element, corners.data());
  });
}

template <class F>
void FiniteElements::each_element(std::span<const double> u, F&& f) const {
  std::vector<Point<double>> corners;
  for (const Chunk& chunk : chunks_) {
    for (size_t r = chunk.runs; r < chunk.runs_end; ++r) {
      for (int k = 0; k < runs_[r].elements; ++k) visit(runs_[r], k, u, corners, f);
    }
  }
}

namespace {

template <class Element>
CauchyStress mean_stress(const Elastic& material, const Stored<double>& data, int corners,
                         const Point<double>* w) {
  CauchyStress s;
  with_law(material, [&](const auto& law) {
    const Tensor<double> h = Element::mean_gradient(data, corners, w);
    const Tensor<double> p = law.stress(h);
    const double stretch = law.thickness_stretch(h);
    const double j = (1 + h.xx + h.yy + determinant(h)) * stretch;
    s.xx = (p.xx * (1 + h.xx) + p.xy * h.xy) / j;
    s.yy = (p.yx * h.yx + p.yy * (1 + h.yy)) / j;
    s.xy = (p.xx * h.yx + p.xy * (1 + h.yy)) / j;
    s.zz = law.transverse_stress(h) * stretch * stretch / j;
    s.energy_density = law.energy(h);
  });
  return s;
}

}  // namespace

std::vector<CauchyStress> FiniteElements::stresses(std::span<const double> u) const {
  std::vector<CauchyStress> result(elements_);
  std::vector<int> first{0};
  for (const ElementSet& set : sets_) first.push_back(first.back() + set.mesh->element_count());
  each_element(u, [&]<class Element>(Element, const Stored<double>& data, int corners, int set,
                                     int element, const Point<double>* w) {
    result[first[set] + element] =
        mean_stress<Element>(material(set, element).elastic, data, corners, w);
  });
  return result;
}

CauchyStress FiniteElements::stress(std::span<const double> u, int set, int element) const {
  CauchyStress result;
  std::vector<Point<double>> corners;
  const auto found = std::ranges::find_if(
      order_, [&](const Member& m) { return m.set == set && m.element == element; });
  const auto number = static_cast<int>(found - order_.begin());
  const auto run = std::prev(std::ranges::upper_bound(runs_, number, {}, &Run::first));
  visit(*run, number - run->first, u, corners,
        [&]<class Element>(Element, const Stored<double>& data, int count, int, int,
                           const Point<double>* w) {
          result = mean_stress<Element>(material(set, element).elastic, data, count, w);
        });
  return result;
}

// Calls f(coordinates, matrix) with the stiffness matrix of every element, row after row; x of node
// 0 is 0.
void FiniteElements::each_stiffness(
    std::span<const double> u, const Motion& motion,
    const std::function<void(std::span<const size_t>, std::span<const double>)>& f) const {
  constexpr size_t kAtOnce = 8;  // derivatives that are found in one pass over an element
  using Number = Dual<kAtOnce>;
  const bool damped = !motion.v.empty();
  std::vector<Point<Number>> moved, rate, force;
  std::vector<size_t> coordinates;
  std::vector<double> matrix;
  each_element(u, [&]<class Element>(Element, const Stored<double>& data, int corners, int index,
                                     int element, const Point<double>* w) {
    const ElementSet& set = sets_[index];
    coordinates.clear();
    for (const int node : set.mesh->element(element)) {
      const size_t x = 2 * static_cast<size_t>(set.first_node + node);
      coordinates.insert(coordinates.end(), {x, x + 1});
    }
    const size_t size = coordinates.size();
    matrix.resize(size * size);
    moved.resize(size / 2);
    rate.resize(size / 2);
    force.resize(size / 2);
    const ElementMaterial& of_element = material(index, element);
    const Elastic& elastic = of_element.elastic;
    with_law(elastic, [&]<class Law>(const Law& law) {
      const Response<Law, false> stiff(law, elastic, 0, set.thickness);
      const Response<Law, true> stiff_and_damped(law, elastic, of_element.stiffness_damping,
                                                 set.thickness, motion.span / 2);
      for (size_t from = 0; from < size; from += kAtOnce) {
        const size_t end = std::min(from + kAtOnce, size);
        for (size_t i = 0; i < size / 2; ++i) moved[i] = {w[i].x, w[i].y};
        for (size_t i = 0; damped && i < size / 2; ++i) {
          rate[i] = {motion.v[coordinates[2 * i]], motion.v[coordinates[2 * i + 1]]};
        }
        const auto vary = [&](std::vector<Point<Number>>& points, size_t j, double by) {
          (j % 2 ? points[j / 2].y : points[j / 2].x).d.v[j - from] = by;
        };
        for (size_t j = from; j < end; ++j) {
          vary(moved, j, 1);
          if (damped) vary(rate, j, 1 / motion.span);
        }
        Number power(0.);
        const auto find = [&](const auto& response) {
          Element::force(Stored<Number>{data.base}, response, corners, moved.data(), rate.data(),
                         force.data(), power);
        };
        damped ? find(stiff_and_damped) : find(stiff);
        for (size_t i = 0; i < size; ++i) {
          const Number& component = i % 2 ? force[i / 2].y : force[i / 2].x;
          for (size_t j = from; j < end; ++j) matrix[i * size + j] = component.d.v[j - from];
        }
      }
    });
    f(coordinates, matrix);
  });
}

void FiniteElements::stiffness_sums(std::span<const double> u, std::span<double> sums) const {
  std::ranges::fill(sums, 0.);
  each_stiffness(u, {}, [&](std::span<const size_t> at, std::span<const double> k) {
    for (size_t i = 0; i < k.size(); ++i) sums[at[i / at.size()]] += std::abs(k[i]);
  });
}

void FiniteElements::add_tangent(std::span<const double> u, size_t first, Tangent& tangent,
                                 std::span<const double> v, double span) const {
  const bool damped = !v.empty();
  each_stiffness(u, {v, span}, [&](std::span<const size_t> at, std::span<const double> k) {
    const size_t n = at.size();
    for (size_t i = 0; i < k.size(); ++i) {
      const double symmetric = damped ? (k[i] + k[i % n * n + i / n]) / 2 : k[i];
      tangent.add(first + at[i / n], first + at[i % n], symmetric);
    }
  });
}

FiniteElements::Collapse FiniteElements::smallest_ratio(std::span<const double> u) const {
  Collapse worst{HUGE_VAL, -1, -1};
  each_element(u, [&]<class Element>(Element, const Stored<double>& data, int corners, int set,
                                     int element, const Point<double>* w) {
    const Tensor<double> h = Element::mean_gradient(data, corners, w);
    const double ratio = 1 + h.xx + h.yy + determinant(h);
    if (std::isnan(worst.ratio)) return;
    if (!(ratio >= worst.ratio)) worst = {ratio, set, element};
  });
  return worst;
}

}  // namespace apothem
