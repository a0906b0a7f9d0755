// Runs a scene of rigid convex polygons by Box2D 2.4, for apps/peers/compare.py:
//
//   apothem_box2d SCENE.json STEP END RESTITUTION [REST]
//
// The scene is one of Apothem's, of which names, polygons, densities, motions, velocities, gravity
// and the friction of the whole scene are read. STEP and END are in s. Velocities are solved 8
// times and places 3 times per step, as Box2D's manual recommends. Prints as JSON where the bodies
// are at the end, their velocities, the deepest overlap, and the processor time of the steps.
// With REST (s) also the largest way of a body since that time.
#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

using Json = nlohmann::json;

namespace {

struct Body {
  std::string name;
  b2Body* body;
};

using Points = std::vector<b2Vec2>;

Points points_of(const Json& polygon) {
  Points points;
  for (const Json& at : polygon) points.emplace_back(at[0].get<float>(), at[1].get<float>());
  return points;
}

// Box2D's polygons have a skin outside. So that the skin ends where the polygon does, each edge
// moves inwards by its thickness.
Points without_skin(const Points& points) {
  const size_t n = points.size();
  Points result;
  for (size_t i = 0; i < n; ++i) {
    const b2Vec2 before = points[(i + n - 1) % n], here = points[i], behind = points[(i + 1) % n];
    b2Vec2 in = here - before, out = behind - here;
    in.Normalize(), out.Normalize();
    const b2Vec2 normal_in(-in.y, in.x), normal_out(-out.y, out.x);  // to the left: inwards
    const float scale = b2_polygonRadius / (1 + b2Dot(normal_in, normal_out));
    result.push_back(here + scale * (normal_in + normal_out));
  }
  return result;
}

std::vector<Body> build(const Json& scene, float restitution, b2World& world) {
  const float friction = scene["contact"].contains("friction")
                             ? scene["contact"]["friction"]["coefficient"].get<float>()
                             : 0;
  std::vector<Body> bodies;
  for (const Json& each : scene["bodies"]) {
    b2BodyDef definition;
    definition.type = each.value("motion", "free") == "fixed" ? b2_staticBody : b2_dynamicBody;
    definition.allowSleep = false;  // all of Apothem's bodies are computed as well
    b2Body* body = world.CreateBody(&definition);
    const Points corners = points_of(each["polygon"]), core = without_skin(corners);
    b2PolygonShape whole, shape;
    whole.Set(corners.data(), static_cast<int>(corners.size()));
    shape.Set(core.data(), static_cast<int>(core.size()));
    const auto density =
        scene["materials"][each["material"].get<std::string>()]["density"].get<float>();
    b2FixtureDef fixture;
    fixture.shape = &shape;
    fixture.density = density;
    fixture.friction = friction;  // of two bodies the root of the product: the same
    fixture.restitution = restitution;
    fixture.restitutionThreshold = 0;
    body->CreateFixture(&fixture);
    if (definition.type == b2_dynamicBody) {
      b2MassData mass;  // of the whole polygon
      whole.ComputeMass(&mass, density);
      body->SetMassData(&mass);
    }
    if (each.contains("velocity")) {
      body->SetLinearVelocity({each["velocity"][0].get<float>(), each["velocity"][1].get<float>()});
    }
    if (each.contains("spin")) body->SetAngularVelocity(each["spin"].get<float>());
    bodies.push_back({each["name"].get<std::string>(), body});
  }
  return bodies;
}

// The deepest overlap of two bodies, skins included, m.
double deepest(const b2World& world) {
  double depth = 0;
  const b2Contact* contact = world.GetContactList();
  for (; contact != nullptr; contact = contact->GetNext()) {
    if (!contact->IsTouching()) continue;
    b2WorldManifold manifold;
    contact->GetWorldManifold(&manifold);
    for (int i = 0; i < contact->GetManifold()->pointCount; ++i) {
      depth = std::max(depth, -static_cast<double>(manifold.separations[i]));
    }
  }
  return depth;
}

double processor_time() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "usage: apothem_box2d SCENE.json STEP END RESTITUTION [REST]\n";
    return 2;
  }
  const Json scene = Json::parse(std::ifstream(argv[1]));
  const double step = std::atof(argv[2]), end = std::atof(argv[3]);
  const double rest = argc > 5 ? std::atof(argv[5]) : end;
  const Json gravity = scene.value("gravity", Json::array({0, 0}));
  b2World world({gravity[0].get<float>(), gravity[1].get<float>()});
  const std::vector<Body> bodies = build(scene, std::strtof(argv[4], nullptr), world);
  const auto steps = std::lround(end / step), first = std::lround(rest / step);
  std::vector<b2Vec2> from;
  double way = 0;
  double seconds = 0, at_rest = 0;
  for (long i = 0; i < steps; ++i) {
    if (i == first) {
      for (const Body& b : bodies) from.push_back(b.body->GetWorldCenter());
      at_rest = seconds;
    }
    const double begin = processor_time();
    world.Step(static_cast<float>(step), 8, 3);
    seconds += processor_time() - begin;
  }
  Json list = Json::object();
  for (size_t i = 0; i < bodies.size(); ++i) {
    const b2Body& b = *bodies[i].body;
    const b2Vec2 x = b.GetWorldCenter(), v = b.GetLinearVelocity();
    // The inertia about the mass centre.
    const double inertia =
        b.GetInertia() - b.GetMass() * b2Dot(b.GetLocalCenter(), b.GetLocalCenter());
    list[bodies[i].name] = {{"x", {x.x, x.y, b.GetAngle()}},
                            {"v", {v.x, v.y, b.GetAngularVelocity()}},
                            {"mass", b.GetMass()},
                            {"inertia", inertia}};
    if (i < from.size()) way = std::max(way, static_cast<double>((x - from[i]).Length()));
  }
  std::cout << Json{{"bodies", list},
                    {"processor_time", seconds},
                    {"processor_time_at_rest", seconds - at_rest},
                    {"depth", deepest(world)},
                    {"way", way}}
                   .dump()
            << "\n";
  return 0;
}
