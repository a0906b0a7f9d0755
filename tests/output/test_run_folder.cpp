// The folder of a run, read back.
#include "lib/output/run_folder.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "lib/mesh/measure.hpp"
#include "lib/output/field.hpp"
#include "tests/folder.hpp"
#include "tests/output/run_results.hpp"
#include "tests/support.hpp"

using namespace apothem;
using namespace apothem::test;

TEST_CASE("bodies are read back as they were written", "[results]") {
  const Folder folder;
  const Model model = model_of_results(true);
  write_results(folder.path(), model, 3);
  const RunFolder run(folder.path());
  CHECK(run.times() == std::vector<double>{0, 1, 2});
  const Frame frame = run.frame(2);
  CHECK(frame.time == 2);
  CHECK(frame.material_names == std::vector<std::string>{"rock", "ice"});
  REQUIRE(frame.bodies.size() == 4);
  CHECK(frame.bodies[0].name == "floor");
  CHECK(frame.bodies[0].motion == Motion::fixed);
  CHECK_FALSE(frame.bodies[1].present);
  CHECK(frame.bodies[1].name == "gone");
  const FrameBody& block = frame.bodies[2];
  CHECK(block.present);
  CHECK_FALSE(block.meshed);
  CHECK(block.motion == Motion::free);
  CHECK(block.rotation() == .2);
  CHECK(block.spin() == .1);
  CHECK(block.values[body_quantity("contact_force")] == Components{5, 6, 0});
  CHECK(block.values[body_quantity("coordination")][0] == 4);
  CHECK(block.values[body_quantity("friction")][0] == 3);
  CHECK(block.mean_stress().xx == -3);
  CHECK(block.mean_stress().yy == -5);
  CHECK(block.mean_stress().xy == 1);
  CHECK(frame.bodies[3].meshed);

  // The L is one element again, although it was written as two convex cells.
  REQUIRE(frame.mesh.element_count() == 6);
  CHECK(frame.body == std::vector<int>{0, 2, 3, 3, 3, 3});
  CHECK(frame.material == std::vector<int>{0, 1, 0, 1, 0, 1});
  CHECK(frame.mesh.element(0).size() == 6);
  CHECK(element_area(frame.mesh, 0) == Approx(3).epsilon(1e-14));
  for (int e = 0; e < 4; ++e) {
    CHECK(frame.stress[2 + e].xx == e + 1);
    CHECK(frame.stress[2 + e].yy == -e);
    CHECK(frame.stress[2 + e].xy == 2 * e);
    CHECK(frame.stress[2 + e].zz == 10);
  }
  // Positions to the bit: the centre of the block, turned vertices, the origin added last.
  const Vec2 centre = model.bodies[2].position + Vec2(.5, 0);
  const std::span<const int> corners = frame.mesh.element(1);
  REQUIRE(corners.size() == 4);
  for (size_t i = 0; i < 4; ++i) {
    const Vec2 arm = model.bodies[2].potential.vertices[i];
    const Vec2 turned(std::cos(.2) * arm.x() - std::sin(.2) * arm.y(),
                      std::sin(.2) * arm.x() + std::cos(.2) * arm.y());
    CHECK((frame.position[corners[i]] - centre - model.origin - turned).norm() < 1e-12);
    CHECK((frame.velocity[corners[i]] - Vec2(.25, 0) - .1 * Vec2(-turned.y(), turned.x())).norm() <
          1e-15);
  }
  const Mesh& beam = model.deformables[0].mesh;
  for (size_t n = 0; n < beam.nodes.size(); ++n) {
    const size_t at = frame.position.size() - beam.nodes.size() + n;
    const Vec2 u(.02 * beam.nodes[n].x(), 0);
    CHECK(frame.displacement[at] == u);
    CHECK(frame.position[at] == Vec2(Vec2(beam.nodes[n] + u) + model.origin));
  }
}

TEST_CASE("a frame from before there was a quantity is read, and has no values of it",
          "[results]") {
  const Folder folder;
  write_results(folder.path(), model_of_results(false), 1);
  std::string text = content(folder / "frames/bodies_000000.vtu");
  const std::string name = "Name=\"coordination\"";
  REQUIRE(text.find(name) != std::string::npos);
  text.replace(text.find(name), name.size(), "Name=\"other\"");
  folder.write("frames/bodies_000000.vtu", text);
  const Frame frame = RunFolder(folder.path()).frame(0);
  const Field field = field_of(frame, *field_quantity("coordination"));
  CHECK(field.blank == std::vector<bool>(field.blank.size(), true));
  CHECK_FALSE(field_of(frame, *field_quantity("spin")).blank.back());
}

TEST_CASE("chains and roses are read back as they were written", "[results]") {
  const Folder folder;
  const Model model = model_of_results(true);
  write_results(folder.path(), model, 2);
  const RunFolder run(folder.path());
  const std::vector<ForceChain> chains = run.chains(1);
  REQUIRE(chains.size() == 1);
  CHECK(chains[0].body_a == 0);
  CHECK(chains[0].body_b == 2);
  CHECK(chains[0].normal == Vec2(8, 19).norm());
  REQUIRE(chains[0].line.size() == 2);  // the floor is fixed
  CHECK(chains[0].line[0] == Vec2(1026.5, -511.75));
  CHECK((chains[0].line[1] - model.bodies[2].position - Vec2(.25, 0) - model.origin).norm() <
        1e-12);

  REQUIRE(run.has_roses());
  const std::vector<Rose> roses = run.roses(1);
  REQUIRE(roses.size() == 1);
  CHECK(roses[0].line.size() == roses[0].frequency.size());
  CHECK(*std::max_element(roses[0].frequency.begin(), roses[0].frequency.end()) == 18);
}

TEST_CASE("a frame without contacts, or without bodies, is read", "[results]") {
  const Folder folder;
  const Model model = model_of_results(false);
  State state = state_of_results(model);
  FrameWriter writer(folder.path(), model);
  for (const std::uint8_t absent : std::array<std::uint8_t, 2>{0, 1}) {
    state.absent.assign(3, absent);
    writer.write({.state = state, .forces = std::vector<BodyForce>(3)});
  }
  const RunFolder run(folder.path());
  CHECK(run.chains(0).empty());
  CHECK(run.frame(0).body.size() == 3);
  CHECK(run.frame(1).body.empty());
  CHECK(run.frame(1).bodies.size() == 3);
}

TEST_CASE("the frame nearest to a time", "[results]") {
  const Folder folder;
  write_results(folder.path(), model_of_results(false), 3);
  const RunFolder run(folder.path());
  CHECK(run.nearest(0) == 0);
  CHECK(run.nearest(.6) == 1);
  CHECK(run.nearest(2) == 2);
  for (const double outside : {-.1, 2.1, std::nan("")}) {
    CHECK_THROWS_WITH(run.nearest(outside), Catch::Contains("there are 3 from 0 s to 2 s"));
  }
}

TEST_CASE("a run that goes on can be read", "[results]") {
  // Files of a frame that no list has yet, and half a row.
  const Folder folder;
  write_results(folder.path(), model_of_results(false), 2);
  folder.write("frames/bodies_000002.vtu", "<VTK");
  folder.write("energy.csv", "time [s],kinetic [J]\n0,1.5\n1,2.5\n2,3.5");
  const RunFolder run(folder.path());
  CHECK(run.times().size() == 2);
  const HistoryTable table = run.table("energy.csv");
  CHECK(table.names == std::vector<std::string>{"time", "kinetic"});
  CHECK(table.units == std::vector<std::string>{"s", "J"});
  CHECK(table.columns[0] == std::vector<double>{0, 1});
  CHECK(table.columns[1] == std::vector<double>{1.5, 2.5});
  for (const char* damaged : {"time [s],kinetic [J]\n0,1.5\n1,\n2,3\n", "\n", ""}) {
    folder.write("energy.csv", damaged);
    CHECK_THROWS_AS(run.table("energy.csv"), ResultsError);
  }
}

TEST_CASE("results that are missing or damaged are refused by name", "[results]") {
  const Folder folder;
  CHECK_THROWS_WITH(RunFolder(folder / "none"), Catch::Contains("there is no such folder"));
  CHECK_THROWS_WITH(RunFolder(folder.path()), Catch::Contains("frames.pvd"));
  folder.write("frames.pvd", "no XML");
  CHECK_THROWS_WITH(RunFolder(folder.path()), Catch::Contains("frames.pvd"));
  write_results(folder / "run", model_of_results(false), 1);
  const RunFolder run(folder / "run");
  std::filesystem::resize_file(folder / "run/frames/bodies_000000.vtu", 2000);
  CHECK_THROWS_WITH(run.frame(0), Catch::Contains("bodies_000000.vtu"));
  folder.write("run/frames/bodies_000000.vtu", "");
  CHECK_THROWS_AS(run.frame(0), ResultsError);
  std::filesystem::remove(folder / "run/frames/chains_000000.vtu");
  CHECK_THROWS_WITH(run.chains(0), Catch::Contains("there is no such file"));
  CHECK_THROWS_WITH(run.table("history.csv"), Catch::Contains("history.csv"));
  std::filesystem::copy(folder / "run/frames/contacts_000000.vtu",
                        folder / "run/frames/chains_000000.vtu");
  CHECK_THROWS_WITH(run.chains(0), Catch::Contains("has no array"));
}

// VTK's reader would not survive them.
TEST_CASE("frames with arrays or cells that VTK does not know are damaged files", "[results]") {
  const Folder folder;
  const Model model = model_of_results(true);
  write_results(folder.path(), model, 1);
  const std::string file = folder / "frames/bodies_000000.vtu", good = content(file);
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    const size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    folder.write("frames/bodies_000000.vtu", text.replace(at, what.size(), by));
  };
  for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
           {"type=\"Float64\"", "type=\"Float14\""},
           {"type=\"Int32\"", "type=\"\""},
           {"NumberOfComponents=\"", "NumberOfComponents=\"9999999"},
           {"NumberOfPoints=\"", "NumberOfPoints=\"-"},
           {"NumberOfCells=\"", "NumberOfCells=\"99999999999"}}) {
    with(what, by);
    INFO(what);
    CHECK_THROWS_WITH(RunFolder(folder.path()).frame(0), Catch::Contains("damaged"));
  }
}
