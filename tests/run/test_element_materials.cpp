// Bodies whose mesh has several materials, by the groups of a file of gmsh: against closed forms,
// and a run that was stopped.
#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkUnstructuredGrid.h>

#include <catch2/catch.hpp>

#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/run/hash.hpp"
#include "lib/text/error.hpp"
#include "tests/run/scenes.hpp"
#include "tests/vtk_reader.hpp"

using namespace apothem;
using namespace apothem::test;

namespace {

// A bar of 4 m x 1 m with the physical surfaces "left" (1 m long), "right" (3 m) and "all".
std::string bar_file(ElementShape shape) {
  const Mesh mesh = rectangle_mesh({4, 1}, {16, 4}, {0, 0}, shape);
  std::string nodes, elements;
  for (size_t i = 0; i < mesh.nodes.size(); ++i) {
    nodes += fmt::format("{} {} {} 0\n", i + 1, mesh.nodes[i].x(), mesh.nodes[i].y());
  }
  std::array<std::string, 2> block;
  std::array<int, 2> count{};
  for (int e = 0; e < mesh.element_count(); ++e) {
    double x = 0;
    for (const int node : mesh.element(e)) x += mesh.nodes[node].x();
    const size_t side = x / static_cast<double>(mesh.element(e).size()) < 1 ? 0 : 1;
    block[side] += fmt::format("{}", e + 1);
    for (const int node : mesh.element(e)) block[side] += fmt::format(" {}", node + 1);
    block[side] += "\n";
    ++count[side];
  }
  const auto type = mesh.element(0).size() - 1;
  return fmt::format(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"left\"\n2 2 \"right\"\n"
      "2 3 \"all\"\n$EndPhysicalNames\n$Entities\n0 0 2 0\n1 0 0 0 1 1 0 2 1 3 0\n"
      "2 1 0 0 4 1 0 2 2 3 0\n$EndEntities\n$Nodes\n1 {0} 1 {0}\n2 1 0 {0}\n{1}{2}$EndNodes\n"
      "$Elements\n2 {3} 1 {3}\n2 1 {4} {5}\n{6}2 2 {4} {7}\n{8}$EndElements\n",
      mesh.nodes.size(),
      [&] {
        std::string tags;
        for (size_t i = 0; i < mesh.nodes.size(); ++i) tags += fmt::format("{}\n", i + 1);
        return tags;
      }(),
      [&] {
        std::string places;
        for (const Vec2& p : mesh.nodes) places += fmt::format("{} {} 0\n", p.x(), p.y());
        return places;
      }(),
      mesh.element_count(), type, count[0], block[0], count[1], block[1]);
}

std::string two_material_bar(const std::string& element, const std::string& body,
                             const std::string& rest) {
  return R"({ "materials": {
      "sand": { "density": 1600, "young": 1e9, "poisson": 0 },
      "rock": { "density": 2500, "young": 20e9, "poisson": 0, "damping": { "model": "rayleigh", "mass": 40 } },
      "steel": { "density": 7800, "young": 200e9, "poisson": 0, "damping": { "model": "rayleigh", "mass": 40, "stiffness": 1e-6 } },
      "powder": { "density": 500 } },
    "bodies": [ { "name": "bar", "material": "rock", "mesh": { "file": "bar.msh", "element": ")" +
         element + "\" }" + body + " } ]" + rest + " }";
}

std::string without_damping(std::string text) {
  for (size_t at; (at = text.find(", \"damping\"")) != std::string::npos;) {
    text.erase(at, text.find('}', at) + 1 - at);
  }
  return text;
}

const char* const kStretched = R"(,
  "supports": [ { "where": { "x": 0 }, "fix": ["x"] }, { "where": { "nearest": [0, 0] }, "fix": ["y"] } ],
  "loads": [ { "where": { "x": 4 }, "traction": [1e5, 0] } ])";

std::string error_of(const Folder& folder, const std::string& text) {
  try {
    scene_of(folder, text);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a bar of two materials is as long and as heavy as its parts", "[materials]") {
  for (const char* element : {"T3", "Q4", "Q4-full", "polygon"}) {
    INFO(element);
    const Folder folder;
    folder.write("bar.msh", bar_file(element == std::string("T3") ? ElementShape::triangle
                                                                  : ElementShape::quadrilateral));
    Run run(
        scene_of(
            folder,
            without_damping(two_material_bar(
                element, R"(, "materials": { "right": "steel" })" + std::string(kStretched),
                R"(, "time": { "end": 1, "mode": "static", "load_steps": 1, "tolerance": 1e-10 })"))),
        {.folder = folder / "results"});
    REQUIRE(run.run() == Run::Status::done);
    const Simulation& simulation = run.simulation();
    const DeformableBody& body = simulation.model().deformables[0];
    // Of 1 m of rock and 3 m of steel, to the strain of 5e-6 that a linear law leaves out.
    const double rock = 1e5 / 20e9, steel = 1e5 / 200e9;
    double mass = 0;
    for (NodeIndex i = 0; i < simulation.model().node_count(); ++i) {
      const double x = body.mesh.nodes[i].x() + simulation.model().origin.x();
      const double expected = x < 1 ? rock * x : rock + steel * (x - 1);
      CHECK(simulation.state().node(i).x() ==
            Approx(expected).epsilon(2e-5).margin(1e-9 * (rock + 3 * steel)));
      mass += simulation.node_mass()[static_cast<size_t>(i)];
    }
    CHECK(mass == Approx(2500 * 1 + 7800 * 3).epsilon(1e-13));
    for (const CauchyStress& stress : simulation.stresses()) {
      CHECK(stress.xx == Approx(1e5).epsilon(1e-4));
    }

    // Frames show the material of each element.
    const auto reader = read_grid(folder / "results/frames/bodies_000001.vtu");
    vtkUnstructuredGrid* grid = reader->GetOutput();
    REQUIRE(grid->GetNumberOfCells() == body.mesh.element_count());
    int of_steel = 0;
    for (ElementIndex e = 0; e < body.mesh.element_count(); ++e) {
      double x = simulation.model().origin.x();
      for (const int node : body.mesh.element(e)) {
        x += body.mesh.nodes[node].x() / static_cast<double>(body.mesh.element(e).size());
      }
      const double shown = grid->GetCellData()->GetArray("material")->GetTuple1(e);
      CHECK(shown == (x < 1 ? 1 : 2));
      of_steel += shown == 2;
    }
    CHECK(of_steel == body.mesh.element_count() / 4 * 3);
  }
}

TEST_CASE("mass damping acts by the material of the elements", "[materials]") {
  const Folder folder;
  folder.write("bar.msh", bar_file(ElementShape::quadrilateral));
  double end = 0;
  const auto momentum = [&](const std::string& materials, double& before) {
    const Scene scene =
        scene_of(folder, two_material_bar("Q4", materials + R"(, "velocity": [2, 0])",
                                          R"(, "time": { "end": 0.01, "step": 1e-5 })"));
    Simulation simulation(scene.model, scene.time, 1, 1);
    before = simulation.momenta().x;
    while (simulation.state().time < .01) simulation.step();
    end = simulation.state().time;
    const Energies e = simulation.energies();
    CHECK(std::abs(e.total_error) < 1e-4 * e.kinetic);
    return simulation.momenta().x;
  };
  // The same alpha in both materials: no strain, and all slows down alike.
  double before = 0;
  const double same = momentum(R"(, "materials": { "left": "steel" })", before);
  CHECK(before == Approx(2 * (7800 + 3 * 2500)));
  CHECK(same == Approx(before * std::exp(-40 * end)).epsilon(1e-10));
  // Sand has none: the sum of the forces of damping is that on the rock.
  const double half = momentum(R"(, "materials": { "left": "sand" })", before);
  CHECK(before == Approx(2 * (1600 + 3 * 2500)));
  CHECK(half < before);
  CHECK(half > before * std::exp(-40 * .01));
}

TEST_CASE("a run of a bar of two materials that was stopped continues bit for bit",
          "[resume][materials]") {
  const Folder folder;
  folder.write("bar.msh", bar_file(ElementShape::quadrilateral));
  const Scene scene = scene_of(
      folder,
      two_material_bar("Q4", R"(, "materials": { "right": "steel" })" + std::string(kStretched),
                       R"(, "time": { "end": 2e-3 }, "output": { "frames": 2 })"));
  Run whole(scene, {.folder = folder / "whole"});
  REQUIRE(whole.run() == Run::Status::done);
  Run first(scene, {.folder = folder / "parts"});
  REQUIRE(first.run(1e-3) == Run::Status::done);
  Run second(scene, {.folder = folder / "parts", .threads = 2, .resume = true});
  REQUIRE(second.run() == Run::Status::done);
  CHECK(second.state().step == whole.state().step);
  CHECK(state_hash(second.state()) == state_hash(whole.state()));
  CHECK(second.simulation().energies().damping_loss > 0);

  // Another division into materials in the file is another scene.
  std::string other = bar_file(ElementShape::quadrilateral);
  const size_t names = other.find("2 1 \"left\"");
  other.replace(names, std::string("2 1 \"left\"\n2 2 \"right\"").size(),
                "2 2 \"left\"\n2 1 \"right\"");
  const std::string hash = scene_hash(scene);
  folder.write("bar.msh", other);
  CHECK(scene_hash(read_scene(folder / "scene.json")) != hash);
}

TEST_CASE("materials of groups that do not fit are refused", "[materials][scene]") {
  const Folder folder;
  folder.write("bar.msh", bar_file(ElementShape::quadrilateral));
  const std::string time = R"(, "time": { "end": 1 })";
  struct Case {
    const char* materials;
    const char* place;
    const char* message;
  };
  for (const Case& c :
       {Case{R"({ "rigth": "steel" })", "/bodies/0/materials/rigth", "did you mean \"right\""},
        Case{R"({ "right": "stel" })", "/bodies/0/materials/right", "did you mean \"steel\""},
        Case{R"({ "right": "powder" })", "/bodies/0/materials/right", "needs \"young\" (Pa)"},
        Case{R"({ "right": 3 })", "/bodies/0/materials/right", "must be a string"},
        Case{R"({})", "/bodies/0/materials", "groups of the mesh"},
        Case{R"("steel")", "/bodies/0/materials", "groups of the mesh"},
        Case{R"({ "all": "steel", "left": "sand" })", "/bodies/0/materials/left",
             "\"all\" and \"left\" share elements"}}) {
    INFO(c.materials);
    const std::string error = error_of(
        folder, two_material_bar("Q4", std::string(", \"materials\": ") + c.materials, time));
    INFO(error);
    CHECK(error.find(folder / "scene.json:6: " + c.place + ": ") == 0);
    CHECK(error.find(c.message) != std::string::npos);
  }
  // Two groups of the same material may overlap.
  const Scene scene = scene_of(
      folder,
      two_material_bar("Q4", R"(, "materials": { "all": "steel", "left": "steel" })", time));
  CHECK(scene.model.deformables[0].materials() == std::vector<MaterialIndex>{2});
  CHECK(scene.model.material_of(0) == 1);
  // All of the body's own material is no list at all.
  const Scene plain =
      scene_of(folder, two_material_bar("Q4", R"(, "materials": { "all": "rock" })", time));
  CHECK(plain.model.deformables[0].element_material.empty());
  // Meshes that are made here have no groups of elements.
  std::string made = two_material_bar("Q4", R"(, "materials": { "left": "steel" })", time);
  const std::string file = R"("file": "bar.msh")";
  made.replace(made.find(file), file.size(), R"("rectangle": { "size": [1, 1], "cells": [2, 2] })");
  CHECK(error_of(folder, made).find("has no groups of elements") != std::string::npos);
}
