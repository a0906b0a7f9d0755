#include "lib/player/page_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "lib/model/rotation.hpp"
#include "lib/output/axes.hpp"
#include "lib/output/canvas.hpp"
#include "lib/player/data_block.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

using Json = nlohmann::ordered_json;
using Integers = std::vector<std::int32_t>;

struct Window {
  Vec2 low, high;
  [[nodiscard]] Vec2 middle() const { return (low + high) / 2; }
  [[nodiscard]] double size() const { return (high - low).maxCoeff(); }
};

// What the first view shows: all bodies in all frames, but at most three times the sides of the box
// around the first frame, lest one body that flies away makes the others small.
Window window_of(const Recording& run) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Window first{Vec2::Constant(kInfinity), Vec2::Constant(-kInfinity)}, all = first;
  const auto include = [&](const Vec2& p) {
    all.low = all.low.cwiseMin(p);
    all.high = all.high.cwiseMax(p);
  };
  const size_t bodies = run.bodies.size(), nodes = static_cast<size_t>(run.shapes.nodes);
  std::vector<int> body_of(nodes, 0);
  for (const Shapes::Element& element : run.shapes.elements) {
    for (const int node : element.nodes) body_of[node] = element.body;
  }
  for (size_t k = 0; k < run.times.size(); ++k) {
    for (size_t i = bodies * k; i < bodies * (k + 1); ++i) {
      if (!run.present[i]) continue;
      for (const Vec2& corner : run.shapes.bodies[i - bodies * k].ring) {
        include(run.place[i] + turned(corner, run.rotation[i]));
      }
    }
    for (size_t n = 0; n < nodes; ++n) {
      if (run.present[bodies * k + static_cast<size_t>(body_of[n])])
        include(run.nodes[nodes * k + n]);
    }
    if (k == 0) first = all;
  }
  if (!(first.size() > 0)) return all;
  const Vec2 reach = (first.high - first.low).cwiseMax(Vec2::Constant(0.2 * first.size()));
  return {all.low.cwiseMax(first.low - reach), all.high.cwiseMin(first.high + reach)};
}

double diameter(const Shapes::Body& body) { return 2 * std::sqrt(std::abs(body.area) / M_PI); }

// Whole steps.
class Steps {
 public:
  explicit Steps(double step) : step_(step) {}
  [[nodiscard]] std::int32_t operator()(double value) const {
    constexpr double kMost = 1 << 30;
    return static_cast<std::int32_t>(std::lround(std::clamp(value / step_, -kMost, kMost)));
  }
  [[nodiscard]] double step() const { return step_; }

 private:
  double step_;
};

// Puts a recording into a description and a block.
class Builder {
 public:
  explicit Builder(const Recording& run)
      : run_(run), window_(window_of(run)), length_(length_step()), angle_(angle_step()) {}

  void add_all(const Plots& plots) {
    add_head();
    add_shapes();
    add_motion();
    add_quantities();
    add_chains();
    add_plots(plots);
  }

  Json description;
  DataBlock block;

 private:
  [[nodiscard]] double length_step() const {
    double step = window_.size() / (1 << 17);
    for (const Shapes::Body& body : run_.shapes.bodies) {
      if (body.known && body.area > 0) step = std::min(step, diameter(body) / 1024);
    }
    return step;
  }
  // No corner of a body that turns moves by more than a step of length.
  [[nodiscard]] double angle_step() const {
    double largest = 0;
    for (size_t i = 0; i < run_.rotation.size(); ++i) {
      const Shapes::Body& body = run_.shapes.bodies[i % run_.bodies.size()];
      if (run_.rotation[i] != 0) largest = std::max(largest, body.radius);
    }
    return largest > 0 ? std::clamp(length_.step() / largest, 1e-7, 1e-4) : 1e-4;
  }

  void add_head() {
    std::vector<double> sizes;
    for (const Shapes::Body& body : run_.shapes.bodies) {
      if (body.known) sizes.push_back(diameter(body));
    }
    std::ranges::sort(sizes);
    const Vec2 half = (window_.high - window_.low) / 2, middle = window_.middle();
    description["times"] = run_.times;
    description["bodies"] = run_.bodies;
    description["elements"] = run_.shapes.elements.size();
    description["nodes"] = run_.shapes.nodes;
    description["origin"] = {middle.x(), middle.y()};
    description["box"] = {-half.x(), -half.y(), half.x(), half.y()};
    description["length_step"] = length_.step();
    description["angle_step"] = angle_.step();
    description["body_size"] = sizes.empty() ? window_.size() : sizes[sizes.size() / 2];
  }

  void add_shapes() {
    Integers ring_first{0}, triangles, hole_first, body_holes{0};
    std::vector<float> x, y;
    for (const Shapes::Body& body : run_.shapes.bodies) {
      const auto first = static_cast<std::int32_t>(x.size());
      for (const Vec2& p : body.ring) {
        x.push_back(static_cast<float>(p.x()));
        y.push_back(static_cast<float>(p.y()));
      }
      ring_first.push_back(static_cast<std::int32_t>(x.size()));
      for (const int corner : body.holes) hole_first.push_back(first + corner);
      body_holes.push_back(static_cast<std::int32_t>(hole_first.size()));
      for (const auto& triangle : body.triangles) {
        for (const int corner : triangle) triangles.push_back(first + corner);
      }
    }
    block.add("ring_first", ring_first, 1);
    block.add("ring_x", x);
    block.add("ring_y", y);
    block.add("body_holes", body_holes, 1);
    block.add("hole_first", hole_first, 1);
    block.add("triangles", triangles, 1);
    add_elements();
  }

  void add_elements() {
    Integers first{0}, nodes, body, triangles, owner;
    for (const Shapes::Element& element : run_.shapes.elements) {
      nodes.insert(nodes.end(), element.nodes.begin(), element.nodes.end());
      first.push_back(static_cast<std::int32_t>(nodes.size()));
      for (const auto& triangle : element.triangles) {
        triangles.insert(triangles.end(), triangle.begin(), triangle.end());
        owner.push_back(static_cast<std::int32_t>(body.size()));
      }
      body.push_back(element.body);
    }
    block.add("element_first", first, 1);
    block.add("element_nodes", nodes, 1);
    block.add("element_body", body, 1);
    block.add("element_triangles", triangles, 1);
    block.add("triangle_element", owner, 1);
    for (const auto& [name, edges] :
         {std::pair("boundary", &run_.shapes.boundary), {"inner", &run_.shapes.inner}}) {
      Integers ends, bodies;
      for (const Shapes::Edge& edge : *edges) {
        ends.insert(ends.end(), edge.nodes.begin(), edge.nodes.end());
        bodies.push_back(edge.body);
      }
      block.add(fmt::format("{}_nodes", name), ends, 1);
      block.add(fmt::format("{}_body", name), bodies, 1);
    }
  }

  // Both coordinates of places, as differences from frame to frame.
  void add_places(const std::string& name, const std::vector<Vec2>& places, size_t period) {
    for (const int k : {0, 1}) {
      Integers steps;
      for (const Vec2& p : places) steps.push_back(length_(p[k] - window_.middle()[k]));
      block.add(name + (k ? "y" : "x"), steps, period);
    }
  }

  void add_motion() {
    add_places("", run_.place, run_.bodies.size());
    Integers angles;
    for (const double angle : run_.rotation) angles.push_back(angle_(angle));
    block.add("angle", angles, run_.bodies.size());
    block.add("present", run_.present, run_.bodies.size());
    add_places("node_", run_.nodes, static_cast<size_t>(run_.shapes.nodes));
  }

  void add_quantities() {
    Json list = Json::array();
    for (const RecordedQuantity& q : run_.quantities) {
      list.push_back({{"name", q.quantity->name},
                      {"meaning", q.quantity->meaning},
                      {"unit", q.unit},
                      {"low", q.low},
                      {"high", q.high},
                      {"below", q.below},
                      {"above", q.above},
                      {"colours", "sizes"}});
      block.add(fmt::format("value_{}", q.quantity->name), q.values);
    }
    add_material(list);
    description["quantities"] = list;
    std::string sizes, names;
    const auto add = [](std::string& text, const Colour& c) {
      for (const double part : {c.red, c.green, c.blue}) {
        text += fmt::format("{:02x}", std::lround(255 * part));
      }
    };
    for (int i = 0; i < 256; ++i) add(sizes, viridis(i / 255.));
    for (size_t i = 0; i < run_.materials.size(); ++i) add(names, okabe_ito(i));
    description["colours"] = {{"sizes", sizes}, {"names", names}};
  }

  // Materials stay the same.
  void add_material(Json& list) {
    std::vector<float> values;
    for (const Shapes::Body& b : run_.shapes.bodies) {
      values.push_back(static_cast<float>(b.material));
    }
    for (const Shapes::Element& e : run_.shapes.elements) {
      values.push_back(static_cast<float>(e.material));
    }
    const FieldQuantity* material = field_quantity("material");
    list.push_back({{"name", material->name},
                    {"meaning", material->meaning},
                    {"unit", ""},
                    {"low", 0},
                    {"high", run_.materials.size() - 1},
                    {"names", run_.materials},
                    {"colours", "names"},
                    {"constant", true}});
    block.add(fmt::format("value_{}", material->name), values);
  }

  void add_chains() {
    const RecordedChains& chains = run_.chains;
    const Steps coarse(8 * length_.step());
    double largest = 0;
    for (const double force : chains.force) largest = std::max(largest, force);
    Integers x, y;
    std::vector<float> force;
    for (size_t i = 0; i < chains.a.size(); ++i) {
      x.push_back(coarse(chains.point[i].x()));
      y.push_back(coarse(chains.point[i].y()));
      force.push_back(rounded(chains.force[i], largest));
    }
    block.add("chain_first", chains.first, 1);
    block.add("chain_a", chains.a, 1);
    block.add("chain_b", chains.b);
    block.add("chain_ends", chains.ends);
    block.add("chain_near", chains.near);
    block.add("chain_x", x);
    block.add("chain_y", y);
    block.add("chain_force", force);
    std::vector<double> sorted = chains.force;
    std::ranges::sort(sorted);
    const double scale = sorted.empty() ? 0 : sorted[sorted.size() - 1 - sorted.size() / 40];
    description["force_scale"] = scale > 0 ? scale : 1;
    description["force_most"] = largest;
    const auto [unit, factor] = prefixed("N", largest);
    description["force_unit"] = unit;
    description["force_factor"] = factor;
  }

  void add_plots(const Plots& plots) {
    for (size_t i = 0; i < plots.columns.size(); ++i) {
      block.add(fmt::format("column_{}", i), plots.columns[i]);
    }
    Json groups = Json::array();
    for (const PlotGroup& group : plots.groups) {
      Json choices = Json::array();
      for (const PlotChoice& choice : group.choices) {
        Json lines = Json::array();
        for (const PlotLine& line : choice.lines) {
          lines.push_back({{"label", line.label},
                           {"time", line.time},
                           {"column", line.column},
                           {"offset", line.offset}});
        }
        choices.push_back({{"title", choice.title}, {"unit", choice.unit}, {"lines", lines}});
      }
      groups.push_back({{"title", group.title}, {"choices", choices}});
    }
    description["plots"] = groups;
  }

  const Recording& run_;
  Window window_;
  Steps length_, angle_;
};

// JSON that no browser takes for the end of a script.
std::string safe(const Json& json) {
  return replaced(json.dump(-1, ' ', false, Json::error_handler_t::replace), "<", "\\u003c");
}

}  // namespace

PageData page_data(const Recording& run, const Plots& plots, const std::string& made_by) {
  Builder data(run);
  data.add_all(plots);
  data.description["program"] = made_by;
  data.description["bytes"] = data.block.size();
  Json arrays = Json::array();
  for (const BlockArray& a : data.block.arrays()) {
    arrays.push_back({{"name", a.name},
                      {"type", a.real ? "float" : "integer"},
                      {"count", a.count},
                      {"planes", a.planes},
                      {"period", a.period}});
  }
  data.description["arrays"] = arrays;
  return {safe(data.description), data.block.text()};
}

}  // namespace apothem
