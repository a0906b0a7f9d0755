// Settings: values that replace those of a scene, by a path of dots.
#include <catch2/catch.hpp>

#include "lib/scene/scene.hpp"
#include "tests/folder.hpp"

using namespace apothem;
using test::Folder;

namespace {

const char* const kScene = R"({
  "materials": { "rock": { "density": 2000 }, "rock.1": { "density": 3000 } },
  "contact": { "normal_stiffness": 2e9 },
  "bodies": [
    { "name": "floor", "material": "rock", "motion": "fixed",
      "polygon": [[-1, -1], [1, -1], [1, 0], [-1, 0]] },
    { "name": "block", "material": "rock", "polygon": [[0, 1], [1, 1], [0, 2]] },
    { "name": "block.top", "material": "rock", "polygon": [[0, 3], [1, 3], [0, 4]] } ],
  "time": { "end": 1 } })";

Scene with(const Folder& folder, const std::vector<std::string>& texts) {
  const std::string file = folder.write("scene.json", kScene);
  std::vector<Setting> settings;
  for (const std::string& text : texts) settings.push_back(parse_setting(text, file));
  return read_scene(file, settings);
}

}  // namespace

TEST_CASE("a setting is a path and a value in JSON, or a bare word or number", "[scene][setting]") {
  const auto value = [](const std::string& text) { return parse_setting(text, "f").value; };
  CHECK(parse_setting("a.b=1", "f").path == "a.b");
  CHECK(value("a=0.30") == "0.3");
  CHECK(value("a=.5") == "0.5");
  CHECK(value("a=-.5") == "-0.5");
  CHECK(value("a=+2.") == "2.0");
  CHECK(value("a=1.2.3") == "\"1.2.3\"");
  CHECK(value("a=[0, -9.81]") == "[0,-9.81]");
  CHECK(value("a=word") == "\"word\"");
  CHECK(value("a=two words") == "\"two words\"");
  CHECK(value("a=\"1\"") == "\"1\"");
  CHECK(value("a=true") == "true");
  CHECK(value("a=b=c") == "\"b=c\"");
  for (const char* bad : {"", "a", "=1", "a=", "a=[1", "a={", "a=\"b"}) {
    INFO(bad);
    CHECK_THROWS_AS(parse_setting(bad, "f"), SceneError);
  }
}

TEST_CASE("settings reach keys, items by index and by name, and what is not there yet",
          "[scene][setting]") {
  const Folder folder;
  CHECK(with(folder, {"time.end=3"}).time.end == 3);
  CHECK(with(folder, {"contact.normal_stiffness=1e9"}).model.contact.normal_stiffness == 1e9);
  CHECK(with(folder, {"bodies.block.velocity=[1,2]"}).model.bodies[1].velocity == Vec2(1, 2));
  CHECK(with(folder, {"bodies.1.velocity=[1,2]"}).model.bodies[1].velocity == Vec2(1, 2));
  CHECK(with(folder, {"bodies.block.top.velocity=[1,2]"}).model.bodies[2].velocity == Vec2(1, 2));
  CHECK(with(folder, {"bodies.0.polygon.2.0=2"}).model.bodies[0].area == Approx(2.5));
  CHECK(with(folder, {"materials.rock.1.density=5"}).model.materials[1].density == 5);
  CHECK(with(folder, {"bodies.block.material=rock.1"}).model.bodies[1].material == 1);
  CHECK(with(folder, {"output.checkpoint.wall_clock=7"}).output.checkpoint_interval == 7);
  CHECK_FALSE(with(folder, {"output.checkpoint=false"}).output.checkpoint_interval.has_value());
  CHECK(with(folder, {}).output.checkpoint_interval == 600);
  const Scene both =
      with(folder, {"contact.friction={\"coefficient\":1,\"tangential_stiffness\":1}",
                    "contact.friction.coefficient=0.3", "time.end=2", "time.end=4"});
  CHECK(both.model.contact.friction.coefficient == .3);
  CHECK(both.time.end == 4);
  CHECK(both.settings.size() == 4);
}

TEST_CASE("a setting that leads nowhere names the path and what is near", "[scene][setting]") {
  const Folder folder;
  for (const auto& [setting, place, says] :
       {std::tuple<const char*, const char*, const char*>{
            "contact.fricton.coefficient=0.3", "/contact/fricton: ", "did you mean \"friction\"?"},
        {"bodies.blok.spin=1",
         "/bodies: ", "has no item of the name \"blok\"; did you mean \"block\"?"},
        {"bodies.7.spin=1", "/bodies: ", "has no item 7: it has 3, counted from 0"},
        {"time.end.x=1", "/time/end: ", "has no keys and no items, as \"time.end.x=1\" asks for"},
        {"time.end=soon", "/time/end: ", "must be a number in s, not a string, set by time.end"},
        {"time..end=1", "scene.json: ", "the path has an empty part"},
        {"bodies.block.polygon=[[0,0],[1,0]]", "/bodies/1/polygon", "at least 3"}}) {
    INFO(setting);
    std::string message;
    try {
      with(folder, {setting});
    } catch (const SceneError& error) {
      message = error.what();
    }
    INFO(message);
    CHECK(message.find(place) != std::string::npos);
    CHECK(message.find(says) != std::string::npos);
    CHECK(message.find(std::string(setting).substr(0, std::string(setting).find('='))) !=
          std::string::npos);
  }
}
