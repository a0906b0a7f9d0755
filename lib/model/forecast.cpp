#include "lib/model/forecast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/polygon/cyclic.hpp"
#include "lib/execution/elementary.hpp"
#include "lib/mesh/boundary.hpp"
#include "lib/mesh/measure.hpp"
#include "lib/model/inradius.hpp"
#include "lib/model/pairs.hpp"

namespace apothem {
namespace {

// A weight that acts at once presses twice as deep as it rests.
constexpr double kSudden = 2;

// A body as the formulas see it.
struct Block {
  double mass, density;
  double breadth;                // of the side on which it lands, m
  double wave = HUGE_VAL;        // pressure of its strongest elastic wave per speed, Pa s/m
  double tangent = HUGE_VAL;     // of half the sharpest angle
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

// Of half the angle of a corner between the ways to the vertices after and before it; infinite
// where it is no corner.
double half_tangent(const Vec2& next, const Vec2& last) {
  const double sine = cross(next, last), cosine = next.dot(last);
  const double whole = next.norm() * last.norm();
  if (!(sine > 0)) return HUGE_VAL;
  // Of the two forms, the one that round-off does not reach: in the middle of a straight side the
  // sum is nothing else.
  return cosine < 0 ? (whole - cosine) / sine : sine / (whole + cosine);
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
    const double k = pair_table(model_).softest();
    const auto note = [&](double depth, double corner, BodyIndex body, ExpectedDepth& worst) {
      if (!(depth > 0)) return;
      const double share = std::max(depth, corner) / inradius_of(model_, body);
      if (share > worst.share) worst = {depth, corner, share, body};
    };
    for_each_press(slopes, [&](BodyIndex i, const Block& b, const Press& p) {
      note(p.weight / (k * p.slopes), 0, i, result.by_weight);
      result.last_landing = std::max(result.last_landing, p.landing);
      note(std::min(std::sqrt(2 * p.energy / (k * p.slopes * b.breadth)),
                    b.wave * p.speed / (k * p.slopes)),
           cube_root(3 * p.energy / (b.tangent * k * p.at_corner)), i, result.by_speed);
    });
    return result;
  }

  // The formulas of forecast(), solved for k_n. What falls goes on falling while it is stopped.
  NeededStiffness stiffness_for(std::span<const double> slopes, double depth) const {
    NeededStiffness k;
    for_each_press(slopes, [&](BodyIndex, const Block& b, const Press& p) {
      const double energy = p.energy > 0 ? p.energy + b.mass / model_.thickness * g_ * depth : 0;
      const double flat = std::min(2 * energy / (p.slopes * b.breadth * depth * depth),
                                   b.wave * p.speed / (p.slopes * depth));
      k.flat = std::max({k.flat, kSudden * p.weight / (p.slopes * depth), flat});
      k.corner = std::max(k.corner, 3 * energy / (b.tangent * p.at_corner * depth * depth * depth));
    });
    return k;
  }

 private:
  // What presses a free body into other ones.
  struct Press {
    double slopes, at_corner;  // of the body and of its flattest partner, flat and at a corner, 1/m
    double weight;             // of a pile as high as all free bodies, Pa
    double speed;              // of an impact, m/s
    double energy;             // of an impact, over the thickness, J/m
    double landing;            // after a free fall, s
  };

  // The two smallest of some values.
  struct TwoSmallest {
    std::array<double, 2> values{HUGE_VAL, HUGE_VAL};
    void add(double value) {
      if (value < values[1]) values[1] = std::max(value, values[0]);
      values[0] = std::min(value, values[0]);
    }
    // The smallest one beside `own`, which is among them.
    [[nodiscard]] double beside(double own) const {
      return own > values[0] ? values[0] : values[1];
    }
  };

  // Of a body at a speed, over the thickness, J/m.
  [[nodiscard]] double kinetic(const Block& b, double speed) const {
    return b.mass / model_.thickness * speed * speed / 2;
  }

  template <class Visit>
  void for_each_press(std::span<const double> slopes, const Visit& visit) const {
    double top = HUGE_VAL, bottom = -HUGE_VAL;
    for (const Block& b : blocks_) {
      if (b.free) top = std::min(top, b.top), bottom = std::max(bottom, b.bottom);
    }
    TwoSmallest flattest;
    for (const double slope : slopes) flattest.add(slope);
    TwoSmallest fastest, strongest;  // of free bodies: their negative speeds and energies, J/m
    for (const Block& b : blocks_) {
      if (b.free) fastest.add(-b.speed), strongest.add(-kinetic(b, b.speed));
    }
    for (BodyIndex i = 0; i < static_cast<BodyIndex>(blocks_.size()); ++i) {
      const Block& b = blocks_[i];
      if (!b.free) continue;
      const double partner = flattest.beside(slopes[i]);
      const double sine = std::isfinite(b.tangent) ? b.tangent / hypotenuse(1, b.tangent) : 1;
      const double height = fall(b);
      const double v = hypotenuse(b.speed, std::sqrt(2 * g_ * height)) + fastest_;
      // Two free bodies that meet have no more energy than both, and none is worse than a heavy
      // one.
      const double own = kinetic(b, b.speed);
      const double met = b.speed + std::max(0., -fastest.beside(-b.speed));
      const double meeting = std::min(kinetic(b, met), own + std::max(0., -strongest.beside(-own)));
      visit(i, b,
            Press{.slopes = slopes[i] + partner,
                  .at_corner = partner + sine * slopes[i],
                  .weight = b.density * g_ * (bottom - top),
                  .speed = std::max(v, met),
                  .energy = std::max(kinetic(b, v), meeting),
                  .landing = fall_time(b, height)});
    }
  }

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
      b.tangent = std::min(b.tangent, half_tangent(next, last));
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
    for (const BoundaryLoop& loop : boundary(body.mesh).loops) {
      const std::vector<Vec2> ring = body.mesh.places(loop.nodes);
      for (size_t i = 0; i < ring.size(); ++i) {
        b.tangent =
            std::min(b.tangent, half_tangent(after(ring, i) - ring[i], before(ring, i) - ring[i]));
      }
    }
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

// The slope of the potential of each body, rigid ones first, 1/m.
std::vector<double> steepest_slopes(const Model& model) {
  std::vector<double> slopes;
  for (const RigidBody& body : model.bodies) slopes.push_back(body.potential.steepest);
  const PotentialChoice& choice = model.contact.potential;
  for (const DeformableBody& body : model.deformables) {
    const bool given = choice.reference == PotentialChoice::Reference::length;
    slopes.push_back(1 /
                     (given ? choice.length : boundary_inradius(body.mesh, boundary(body.mesh))));
  }
  return slopes;
}

// The next number of two digits; 0 for what is no positive number.
double rounded_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 0;
  double unit = 1;
  while (unit * 100 <= value) unit *= 10;
  while (unit * 10 > value) unit /= 10;
  return std::ceil(value / unit) * unit;
}

}  // namespace

NeededStiffness stiffness_for(const Model& model, double share) {
  double inradius = HUGE_VAL;
  const auto bodies = static_cast<BodyIndex>(model.bodies.size() + model.deformables.size());
  for (BodyIndex i = 0; i < bodies; ++i) inradius = std::min(inradius, inradius_of(model, i));
  const NeededStiffness k = Blocks(model).stiffness_for(steepest_slopes(model), share * inradius);
  return {rounded_up(k.flat), rounded_up(k.corner)};
}

Forecast forecast(const Model& model, std::span<const double> slopes) {
  return Blocks(model).forecast(slopes);
}

}  // namespace apothem
