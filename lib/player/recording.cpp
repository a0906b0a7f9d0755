#include "lib/player/recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "lib/output/axes.hpp"
#include "lib/player/data_block.hpp"

namespace apothem {
namespace {

// What the player can show, beside the material and the quantities of bodies.
constexpr std::array<std::string_view, 5> kQuantities{"speed", "pressure", "s1", "s2", "von_mises"};

// Reads frame after frame.
class Recorder {
 public:
  explicit Recorder(const RunFolder& run) : run_(run) {
    out_.times = run.times();
    out_.shapes = read_shapes(run);
    for (const FieldQuantity& quantity : field_quantities()) {
      const bool shown = quantity.kind == FieldKind::body ||
                         std::ranges::find(kQuantities, quantity.name) != kQuantities.end();
      const bool elements_only = quantity.kind == FieldKind::stress_of_elements;
      if (!shown || (elements_only && out_.shapes.elements.empty())) continue;
      out_.quantities.push_back({&quantity, quantity.unit});
    }
  }

  Recording recording() {
    for (size_t k = 0; k < out_.times.size(); ++k) add(k);
    return std::move(out_);
  }

 private:
  void add(size_t k) {
    const Frame frame = run_.frame(k);
    const size_t bodies = frame.bodies.size();
    if (k == 0) {
      for (const FrameBody& body : frame.bodies) out_.bodies.push_back(body.name);
      out_.materials = frame.material_names;
    }
    const size_t nodes = static_cast<size_t>(out_.shapes.nodes);
    // Bodies stay where they were until their new place is known.
    grow(out_.place, bodies, Vec2(Vec2::Zero()));
    grow(out_.rotation, bodies, 0.);
    grow(out_.nodes, nodes, Vec2(Vec2::Zero()));
    out_.present.resize(out_.place.size(), 0);
    for (RecordedQuantity& q : out_.quantities) {
      q.values.resize(out_.items() * (k + 1), kNoValue);
    }
    parts_ = parts_of(frame);
    for (size_t b = 0; b < bodies; ++b) {
      if (parts_[b].element < 0) continue;
      out_.present[bodies * k + b] = 1;
      if (out_.shapes.bodies[b].meshed) {
        add_meshed(frame, k, b);
      } else {
        add_rigid(frame, k, b);
      }
    }
    add_chains(frame, k);
  }

  // Another frame with the values of the last one.
  template <class T>
  static void grow(std::vector<T>& values, size_t count, const T& first) {
    if (values.empty()) {
      values.assign(count, first);
      return;
    }
    const size_t last = values.size() - count;
    values.resize(values.size() + count);
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(last), count,
                values.end() - static_cast<std::ptrdiff_t>(count));
  }

  void add_rigid(const Frame& frame, size_t k, size_t b) {
    const int e = parts_[b].element;
    const FrameBody& body = frame.bodies[b];
    const Vec2 centroid = measure(rings_of(frame, e)).centroid;
    out_.place[out_.bodies.size() * k + b] = centroid;
    out_.rotation[out_.bodies.size() * k + b] = body.rotation();
    const int node = frame.mesh.element(e)[0];
    const Vec2 arm = centroid - frame.position[node];
    const Vec2 velocity = frame.velocity[node] + body.spin() * Vec2(-arm.y(), arm.x());
    add_values(k, b, body, velocity, body.mean_stress());
  }

  void add_meshed(const Frame& frame, size_t k, size_t b) {
    const Shapes::Body& shape = out_.shapes.bodies[b];
    const FramePart& part = parts_[b];
    const FrameBody& body = frame.bodies[b];
    RingMeasure whole;
    Vec2 momentum = Vec2::Zero();
    for (int i = 0; i < part.elements; ++i) {
      const int e = part.element + i;
      Vec2 velocity = Vec2::Zero();
      const auto nodes = frame.mesh.element(e);
      for (const int node : nodes) {
        // An element may begin at another node than in the frame that its shape is from.
        out_.nodes[static_cast<size_t>(out_.shapes.nodes) * k +
                   static_cast<size_t>(shape.first_node + node - part.node)] = frame.position[node];
        velocity += frame.velocity[node] / static_cast<double>(nodes.size());
      }
      const RingMeasure own = measure(rings_of(frame, e));
      whole.area += own.area;
      whole.centroid += own.area * own.centroid;
      momentum += own.area * velocity;
      add_values(k, out_.bodies.size() + static_cast<size_t>(shape.first_element + i), body,
                 velocity, frame.stress[e]);
    }
    out_.place[out_.bodies.size() * k + b] = whole.centroid / whole.area;
    add_values(k, b, body, momentum / whole.area, body.mean_stress());
  }

  // The values of a body or of an element, whose velocity is that of its middle. A meshed body as a
  // whole has the mean of its stresses.
  void add_values(size_t k, size_t item, const FrameBody& body, const Vec2& velocity,
                  const CauchyStress& stress) {
    FieldSample sample;
    sample.body = &body;
    sample.stress = stress;
    sample.velocity = velocity;
    const bool rigid_only = out_.shapes.elements.empty();
    for (RecordedQuantity& quantity : out_.quantities) {
      if (!has_value(body, quantity.quantity->kind, rigid_only)) continue;
      const auto value = static_cast<float>(quantity.quantity->value(sample));
      if (!std::isnan(value)) quantity.values[out_.items() * k + item] = value;
    }
  }

  void add_chains(const Frame& frame, size_t k) {
    std::vector<ForceChain> chains = run_.chains(k);
    std::ranges::stable_sort(chains, [](const ForceChain& c, const ForceChain& d) {
      return std::pair(c.body_a, c.body_b) < std::pair(d.body_a, d.body_b);
    });
    RecordedChains& out = out_.chains;
    const int bodies = static_cast<int>(frame.bodies.size());
    for (const ForceChain& chain : chains) {
      const int a = chain.body_a, b = chain.body_b;
      if (std::min(a, b) < 0 || std::max(a, b) >= bodies) {
        throw ResultsError(run_.path() + ": a force chain is of a body that is not in its frame");
      }
      const bool from_a = frame.bodies[a].motion == Motion::free;
      const bool to_b = chain.line.size() > (from_a ? 2 : 1);
      if (!from_a && !to_b) continue;
      const bool near_b = out_.shapes.bodies[b].radius < out_.shapes.bodies[a].radius;
      out.a.push_back(a);
      out.b.push_back(b);
      out.ends.push_back((from_a ? 1 : 0) + (to_b ? 2 : 0));
      out.near.push_back(near_b);
      out.point.emplace_back(
          chain.line[from_a ? 1 : 0] -
          out_.place[out_.bodies.size() * k + static_cast<size_t>(near_b ? b : a)]);
      out.force.push_back(chain.normal);
    }
    out.first.push_back(static_cast<std::int32_t>(out.a.size()));
  }

  const RunFolder& run_;
  Recording out_;
  std::vector<FramePart> parts_;  // of the frame at hand
};

// The same scale over the run: from the least to the largest value, or where a few values are far
// beyond the others, to the values below and above which one in 500 lies.
void choose_scale(RecordedQuantity& quantity) {
  std::vector<float> values;
  for (const float v : quantity.values) {
    if (v != kNoValue) values.push_back(v);
  }
  if (values.empty()) return;
  std::ranges::sort(values);
  const double least = values.front(), most = values.back();
  const double low = values[values.size() / 500],
               high = values[values.size() - 1 - values.size() / 500];
  const double far = 0.5 * (high - low);
  quantity.below = low - least > far && high > low;
  quantity.above = most - high > far && high > low;
  quantity.low = quantity.below ? low : least;
  quantity.high = quantity.above ? high : most;
  if (quantity.low >= 0 && quantity.low < 0.5 * quantity.high)
    quantity.low = 0, quantity.below = false;
  if (quantity.high == quantity.low) quantity.high = quantity.low + 1;
}

}  // namespace

Recording record(const RunFolder& run) {
  Recording recording = Recorder(run).recording();
  for (RecordedQuantity& quantity : recording.quantities) {
    double largest = 0;
    for (const float v : quantity.values) {
      if (v != kNoValue) largest = std::max(largest, std::abs(static_cast<double>(v)));
    }
    double factor = 1;
    std::tie(quantity.unit, factor) = prefixed(quantity.unit, largest);
    for (float& v : quantity.values) {
      if (v != kNoValue) v = rounded(factor * v, factor * largest);
    }
    choose_scale(quantity);
  }
  return recording;
}

}  // namespace apothem
