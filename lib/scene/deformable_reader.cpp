#include "lib/scene/deformable_reader.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/fem/mass.hpp"
#include "lib/mesh/locate.hpp"
#include "lib/mesh/select.hpp"
#include "lib/text/words.hpp"

namespace apothem {
namespace {

// Reads rows of `size` numbers, of which the first is a time that increases from row to row, and
// calls add() with each row.
template <class Add>
void rows(const JsonReader& in, const JsonValue& value, size_t size, const char* meaning,
          Add&& add) {
  double before = 0;
  bool first = true;
  for (const JsonValue& row : in.array(value)) {
    const std::vector<double> p = in.numbers(row, size, meaning);
    if (!first && !(p[0] > before)) {
      in.fail(row, fmt::format("times must increase: {} s follows {} s", p[0], before));
    }
    first = false;
    before = p[0];
    add(p);
  }
}

}  // namespace

std::vector<MotionHistory::VelocityPoint> read_velocities(const JsonReader& in,
                                                          const JsonValue& value) {
  std::vector<MotionHistory::VelocityPoint> points;
  rows(in, value, 3, "[t, vx, vy] in s and m/s", [&](const std::vector<double>& p) {
    points.push_back({p[0], {p[1], p[2]}});
  });
  return points;
}

std::vector<MotionHistory::SpinPoint> read_spins(const JsonReader& in, const JsonValue& value) {
  std::vector<MotionHistory::SpinPoint> points;
  rows(in, value, 2, "[t, spin] in s and rad/s", [&](const std::vector<double>& p) {
    points.push_back({p[0], p[1]});
  });
  return points;
}

namespace {

LoadHistory read_factors(const JsonReader& in, const JsonValue& value, const char* row,
                         const char* without) {
  LoadHistory history;
  rows(in, value, 2, row, [&](const std::vector<double>& p) {
    history.points.push_back({p[0], p[1]});
  });
  if (history.points.empty()) {
    in.fail(value, std::string("must hold at least one row; leave it out for ") + without);
  }
  return history;
}

}  // namespace

LoadHistory read_load_history(const JsonReader& in, const JsonValue& value) {
  return read_factors(in, value, "[t, factor], t in s", "1");
}

LoadHistory read_tilt_history(const JsonReader& in, const JsonValue& value) {
  return read_factors(in, value, "[t, angle] in s and rad", "0");
}

namespace {

class DeformableReader {
 public:
  DeformableReader(const JsonReader& in, const Model& model, DeformableBody& body)
      : in_(in), model_(model), body_(body) {}

  void supports(const JsonValue& value) {
    held_.assign(body_.mesh.nodes.size(), {});
    for (const JsonValue& item : in_.array(value)) support(item);
  }

  void loads(const JsonValue& value) {
    for (const JsonValue& item : in_.array(value)) load(item);
  }

 private:
  Place place(const JsonValue& value) const {
    JsonObject object(in_, value);
    Place place;
    if (const JsonValue* v = object.optional("x"))
      place.x = in_.number(*v, "m") - model_.origin.x();
    if (const JsonValue* v = object.optional("y"))
      place.y = in_.number(*v, "m") - model_.origin.y();
    if (const JsonValue* v = object.optional("box")) {
      const std::vector<JsonValue>& corners = in_.array(*v);
      if (corners.size() != 2) in_.fail(*v, "must be [[x0, y0], [x1, y1]] in m");
      const Vec2 low = in_.vec2(corners[0], "m") - model_.origin;
      const Vec2 high = in_.vec2(corners[1], "m") - model_.origin;
      if (!(low.x() <= high.x() && low.y() <= high.y())) {
        in_.fail(*v, "must give the lower left corner first, then the upper right one");
      }
      place.box = Box{low.x(), low.y(), high.x(), high.y()};
    }
    if (const JsonValue* v = object.optional("group")) {
      const std::string& name = in_.string(*v);
      const std::vector<std::string> names = names_of(body_.mesh.groups);
      if (std::ranges::find(names, name) == names.end()) {
        in_.fail(*v, names.empty() ? "the mesh has no groups"
                                   : "the mesh has no group " + suggest(name, names));
      }
      place.group = name;
    }
    if (const JsonValue* v = object.optional("nearest")) {
      place.nearest = in_.vec2(*v, "m") - model_.origin;
    }
    object.finish();
    return place;
  }

  std::vector<int> nodes(const JsonValue& where) const {
    std::vector<int> found = nodes_where(body_.mesh, place(where));
    if (found.empty()) in_.fail(where, "no node of the mesh lies there");
    return found;
  }

  std::vector<MeshEdge> edges(const JsonValue& where) const {
    std::vector<MeshEdge> found = edges_where(body_.mesh, place(where));
    if (found.empty()) {
      in_.fail(where,
               "no edge of the mesh's boundary has both ends there; for a single node use "
               "\"at\" and \"force\"");
    }
    return found;
  }

  void support(const JsonValue& value) {
    JsonObject object(in_, value);
    Support support;
    const JsonValue& where = object.required("where", "{\"x\": ...}, {\"group\": ...} ...");
    support.nodes = nodes(where);
    const JsonValue* fix = object.optional("fix");
    const JsonValue* velocity = object.optional("velocity");
    if (fix) {
      for (const JsonValue& direction : in_.array(*fix)) {
        support.held[in_.choice(direction, {"x", "y"})] = true;
      }
    } else if (velocity || value.find("spin")) {
      support.held = {true, true};
    }
    if (!support.held[0] && !support.held[1]) {
      in_.fail(value, "must say what it holds: \"fix\": [\"x\", \"y\"]");
    }
    if (velocity) {
      support.motion.velocity = read_velocities(in_, *velocity);
      if (support.motion.velocity.empty()) {
        in_.fail(*velocity, "must hold at least one row; leave it out for a support at rest");
      }
      require_held(*velocity, support);
    }
    rotation(object, support);
    object.finish();
    for (const int node : support.nodes) {
      for (int axis = 0; axis < 2; ++axis) {
        if (!support.held[axis]) continue;
        if (held_[node][axis] && !support.motion.empty()) {
          in_.fail(value, fmt::format("another support already holds the {} of a node here",
                                      axis == 0 ? "x" : "y"));
        }
        held_[node][axis] = true;
      }
    }
    body_.supports.push_back(std::move(support));
  }

  // A velocity moves nodes in the directions that the support holds.
  void require_held(const JsonValue& velocity, const Support& support) const {
    for (int axis = 0; axis < 2; ++axis) {
      const bool moves = std::ranges::any_of(
          support.motion.velocity, [&](const auto& row) { return row.velocity[axis] != 0; });
      if (support.held[axis] || !moves) continue;
      const char* const name = axis == 0 ? "x" : "y";
      in_.fail(velocity, fmt::format("moves nodes along {0}, which the support does not hold: add "
                                     "\"{0}\" to \"fix\", or make this component 0",
                                     name));
    }
  }

  // Of a support that turns its nodes about a point.
  void rotation(JsonObject& object, Support& support) const {
    const JsonValue* spin = object.optional("spin");
    const JsonValue* pivot = object.optional("pivot");
    if (pivot && !spin) in_.fail(*pivot, kPivotAtRest);
    if (!spin) return;
    support.motion.spin = read_spins(in_, *spin);
    if (support.motion.spin.empty()) {
      in_.fail(*spin, "must hold at least one row; leave it out for a support that does not turn");
    }
    if (!support.held[0] || !support.held[1]) {
      in_.fail(*spin, "turns nodes, which moves them in both directions: \"fix\": [\"x\", \"y\"]");
    }
    support.pivot =
        in_.vec2(object.required("pivot", "[x, y] in m, the point that the support turns about"),
                 "m") -
        model_.origin;
  }

  void load(const JsonValue& value) {
    JsonObject object(in_, value);
    const JsonValue* at = object.optional("at");
    const JsonValue* where = object.optional("where");
    const JsonValue* force = object.optional("force");
    const JsonValue* traction = object.optional("traction");
    const JsonValue* normal = object.optional("pressure");
    const JsonValue* inside = object.optional("body_force");
    LoadHistory history;
    if (const JsonValue* v = object.optional("history")) history = read_load_history(in_, *v);
    object.finish();
    if ((force != nullptr) + (traction != nullptr) + (normal != nullptr) + (inside != nullptr) !=
        1) {
      in_.fail(value,
               "must give one of \"force\" (N), \"traction\" (Pa), \"pressure\" (Pa) and "
               "\"body_force\" (N/m^3)");
    }
    if (inside ? (at || where) : !at == !where) {
      in_.fail(value, inside ? "a body force acts on the whole body; leave out \"at\" and \"where\""
                             : "must give either \"at\" (a point) or \"where\" (edges)");
    }
    if (at && !force) in_.fail(*at, "a point takes a \"force\"; for the others use \"where\"");
    if (inside) {
      body_force(in_.vec2(*inside, "N/m^3"), history);
    } else if (at) {
      point_force(*at, in_.vec2(*force, "N"), history);
    } else if (normal) {
      pressure(*where, in_.number(*normal, "Pa"), history);
    } else {
      edge_force(*where, in_.vec2(force ? *force : *traction, force ? "N" : "Pa"), !force, history);
    }
  }

  void point_force(const JsonValue& at, const Vec2& force, const LoadHistory& history) {
    const Vec2 p = in_.vec2(at, "m") - model_.origin;
    const std::optional<MeshPoint> found = find_point(body_.mesh, p);
    if (!found) in_.fail(at, "lies outside the body");
    DeadLoad load{{}, {}, history};
    const std::span<const int> corners = body_.mesh.element(found->element);
    for (size_t i = 0; i < corners.size(); ++i) {
      if (found->weights[i] == 0) continue;
      load.nodes.push_back(corners[i]);
      load.forces.emplace_back(found->weights[i] * force);
    }
    body_.dead_loads.push_back(std::move(load));
  }

  void edge_force(const JsonValue& where, const Vec2& value, bool per_area,
                  const LoadHistory& history) {
    const std::vector<MeshEdge> selected = edges(where);
    const auto length = [&](const MeshEdge& e) {
      return (body_.mesh.nodes[e.nodes[1]] - body_.mesh.nodes[e.nodes[0]]).norm();
    };
    double whole = 0;
    for (const MeshEdge& e : selected) whole += length(e);
    DeadLoad load{{}, {}, history};
    for (const MeshEdge& e : selected) {
      const double share = per_area ? length(e) * model_.thickness : length(e) / whole;
      for (const int node : e.nodes) {
        load.nodes.push_back(node);
        load.forces.emplace_back(share / 2 * value);
      }
    }
    body_.dead_loads.push_back(std::move(load));
  }

  void pressure(const JsonValue& where, double value, const LoadHistory& history) {
    PressureLoad load{{}, value, history};
    for (const MeshEdge& e : edges(where)) load.edges.push_back(e.nodes);
    body_.pressures.push_back(std::move(load));
  }

  void body_force(const Vec2& density, const LoadHistory& history) {
    DeadLoad load{{}, {}, history};
    load.forces.assign(body_.mesh.nodes.size(), Vec2::Zero());
    for (size_t i = 0; i < body_.mesh.nodes.size(); ++i) load.nodes.push_back(static_cast<int>(i));
    for (int e = 0; e < body_.mesh.element_count(); ++e) {
      const std::vector<double> areas = corner_areas(body_.mesh.places(body_.mesh.element(e)));
      for (size_t i = 0; i < areas.size(); ++i) {
        load.forces[body_.mesh.element(e)[i]] += areas[i] * model_.thickness * density;
      }
    }
    body_.dead_loads.push_back(std::move(load));
  }

  const JsonReader& in_;
  const Model& model_;
  DeformableBody& body_;
  std::vector<std::array<bool, 2>> held_;  // x and y of each node, by the supports read so far
};

}  // namespace

void read_supports(const JsonReader& in, const JsonValue& value, const Model& model,
                   DeformableBody& body) {
  DeformableReader(in, model, body).supports(value);
}

void read_loads(const JsonReader& in, const JsonValue& value, const Model& model,
                DeformableBody& body) {
  DeformableReader(in, model, body).loads(value);
}

}  // namespace apothem
