#include "lib/dynamics/forecast.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/inradius.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {
namespace {

// A body as the formulas see it.
struct Block {
  double mass, density;
  double breadth;                // of the side on which it lands, m
  double wave = HUGE_VAL;        // pressure of its strongest elastic wave per speed, Pa s/m
  double tangent = HUGE_VAL;     // of half the sharpest angle; infinite if not known
  double speed;                  // of its fastest point, without a fall, m/s
  Vec2 velocity = Vec2::Zero();  // of its mass centre
  bool free;
  double top = 0, bottom = 0;  // along gravity, m
  double left = 0, right = 0;  // across it
};

double mean_density(const Model& model, const DeformableBody& body, double area) {
  if (body.element_material.empty()) return model.materials[body.material].density;
  double mass = 0;
  for (ElementIndex e = 0; e < body.mesh.element_count(); ++e) {
    mass += model.materials[body.material_of(e)].density * element_area(body.mesh, e);
  }
  return mass / area;
}

class Blocks {
 public:
  explicit Blocks(const Model& model) : model_(model), g_(model.strongest_gravity()) {
    if (g_ > 0) down_ = model.gravity.normalized();
    for (const RigidBody& body : model.bodies) add(body);
    for (const DeformableBody& body : model.deformables) add(body);
    if (!blocks_.empty()) divide();
  }

  Forecast forecast(std::span<const double> slopes) const {
    Forecast result;
    double top = HUGE_VAL, bottom = -HUGE_VAL;
    for (const Block& b : blocks_) {
      if (b.free) top = std::min(top, b.top), bottom = std::max(bottom, b.bottom);
    }
    const double softest = pair_table(model_).softest();
    std::array<double, 2> flattest{HUGE_VAL, HUGE_VAL};  // the two smallest slopes
    for (const double slope : slopes) {
      if (slope < flattest[1]) flattest[1] = std::max(slope, flattest[0]);
      flattest[0] = std::min(slope, flattest[0]);
    }
    const auto note = [&](double depth, double corner, BodyIndex body, ExpectedDepth& worst) {
      if (!(depth > 0)) return;
      const double share = std::max(depth, corner) / inradius_of(model_, body);
      if (share > worst.share) worst = {depth, corner, share, body};
    };
    for (BodyIndex i = 0; i < static_cast<BodyIndex>(blocks_.size()); ++i) {
      const Block& b = blocks_[i];
      if (!b.free) continue;
      const double partner = slopes[i] > flattest[0] ? flattest[0] : flattest[1];
      const double stiffness = softest * (slopes[i] + partner);  // Pa/m
      const double sine = std::isfinite(b.tangent) ? b.tangent / hypotenuse(1, b.tangent) : 1;
      const double at_corner = softest * (partner + sine * slopes[i]);
      note(b.density * g_ * (bottom - top) / stiffness, 0, i, result.by_weight);
      const double height = fall(b);
      result.last_landing = std::max(result.last_landing, fall_time(b, height));
      const double v = hypotenuse(b.speed, std::sqrt(2 * g_ * height)) + fastest_;
      const double energy = b.mass / model_.thickness * v * v / 2;  // J/m
      note(std::min(std::sqrt(2 * energy / (stiffness * b.breadth)), b.wave * v / stiffness),
           cube_root(3 * energy / (b.tangent * at_corner)), i, result.by_speed);
    }
    return result;
  }

 private:
  void add(const RigidBody& body) {
    Block b{.mass = body.mass,
            .density = model_.materials[body.material].density,
            .breadth = 0,
            .speed = body.velocity.norm(),
            .velocity = body.velocity,
            .free = body.motion == Motion::free};
    double radius = 0;
    const std::vector<Vec2>& v = body.potential.vertices;
    const auto [s, c] = sine_cosine(body.angle);
    std::vector<Vec2> points;
    for (size_t i = 0; i < v.size(); ++i) {
      radius = std::max(radius, v[i].norm());
      const int vertex = static_cast<int>(i);
      const Vec2 next = v[body.potential.next(vertex)] - v[i];
      const Vec2 last = v[body.potential.previous(vertex)] - v[i];
      b.breadth = std::max(b.breadth, next.norm());
      const double sine = cross(next, last), whole = next.norm() * last.norm();
      if (sine > 0) b.tangent = std::min(b.tangent, sine / (whole + next.dot(last)));
      points.emplace_back(body.position.x() + c * v[i].x() - s * v[i].y(),
                          body.position.y() + s * v[i].x() + c * v[i].y());
    }
    b.speed += std::abs(body.spin) * radius;
    if (body.servo) fastest_ = std::max(fastest_, body.servo->speed);
    for (const auto& point : body.history.velocity) {
      fastest_ = std::max(fastest_, point.velocity.norm());
    }
    for (const auto& point : body.history.spin) {
      fastest_ = std::max(fastest_, std::abs(point.spin) * body.reach());
    }
    measure(points, b);
  }

  void add(const DeformableBody& body) {
    const double area = mesh_quality(body.mesh).area;
    const double density = mean_density(model_, body, area);
    double wave = 0;
    for (const MaterialIndex material : body.materials()) {
      const Material& m = model_.materials[material];
      wave = std::max(wave, std::sqrt(m.density * m.elastic.young));
    }
    Block b{.mass = density * area * model_.thickness,
            .density = density,
            .breadth = 0,
            .wave = wave,
            .speed = body.velocity.norm(),
            .velocity = body.velocity,
            .free = body.supports.empty()};
    double radius = 0;
    for (const Vec2& x : body.mesh.nodes) {
      radius = std::max(radius, (x - body.mesh.nodes[0]).norm());
    }
    b.speed += std::abs(body.spin) * radius;
    for (const Support& support : body.supports) {
      for (const auto& point : support.motion.velocity) {
        fastest_ = std::max(fastest_, point.velocity.norm());
      }
      for (const auto& point : support.motion.spin) {
        for (const int node : support.nodes) {
          const double arm = (body.mesh.nodes[node] - support.pivot).norm();
          fastest_ = std::max(fastest_, std::abs(point.spin) * arm);
        }
      }
    }
    measure(body.mesh.nodes, b);
    blocks_.back().breadth = blocks_.back().right - blocks_.back().left;
  }

  void measure(const std::vector<Vec2>& points, Block& b) {
    b.top = b.left = HUGE_VAL;
    b.bottom = b.right = -HUGE_VAL;
    for (const Vec2& p : points) {
      const double along = p.dot(down_), across = cross(down_, p);
      b.top = std::min(b.top, along), b.bottom = std::max(b.bottom, along);
      b.left = std::min(b.left, across), b.right = std::max(b.right, across);
    }
    blocks_.push_back(b);
  }

  // Divides the breadth of the scene into strips about as broad as a body. Each has the bodies that
  // reach into it.
  void divide() {
    double right = -HUGE_VAL, breadth = 0;
    for (const Block& b : blocks_) {
      left_ = std::min(left_, b.left), right = std::max(right, b.right);
      breadth += (b.right - b.left) / static_cast<double>(blocks_.size());
    }
    strip_ = std::max(breadth, (right - left_) / static_cast<double>(blocks_.size()));
    if (!(strip_ > 0) || !std::isfinite(strip_)) strip_ = HUGE_VAL;
    strips_.resize(strip_of(right) + 1);
    for (size_t i = 0; i < blocks_.size(); ++i) {
      const size_t last = strip_of(blocks_[i].right);
      for (size_t k = strip_of(blocks_[i].left); k <= last; ++k) strips_[k].push_back(i);
    }
  }
  [[nodiscard]] size_t strip_of(double across) const {
    return static_cast<size_t>(std::max(0., (across - left_) / strip_));
  }

  // Free fall onto the next body below, 0 if there is none, m.
  [[nodiscard]] double fall(const Block& b) const {
    if (!(g_ > 0)) return 0;
    double gap = HUGE_VAL;
    const size_t last = strip_of(b.right);
    for (size_t k = strip_of(b.left); k <= last; ++k) {
      for (const size_t i : strips_[k]) {
        const Block& other = blocks_[i];
        if (&other == &b || other.right <= b.left || b.right <= other.left) continue;
        if (other.bottom > b.bottom) gap = std::min(gap, std::max(0., other.top - b.bottom));
      }
    }
    return std::isfinite(gap) ? gap : 0;
  }

  // How long a fall of a height (m) takes, s.
  [[nodiscard]] double fall_time(const Block& b, double height) const {
    if (!(height > 0)) return 0;
    const double down = b.velocity.dot(down_);
    return (std::sqrt(down * down + 2 * g_ * height) - down) / g_;
  }

  const Model& model_;
  double g_;
  Vec2 down_{0, -1};
  double fastest_ = 0;  // of bodies with prescribed motion, m/s
  std::vector<Block> blocks_;
  double left_ = HUGE_VAL, strip_ = HUGE_VAL;  // where the first strip begins, its breadth, m
  std::vector<std::vector<size_t>> strips_;
};

}  // namespace

Forecast forecast(const Model& model, std::span<const double> slopes) {
  return Blocks(model).forecast(slopes);
}

}  // namespace apothem
