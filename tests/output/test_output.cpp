#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

#include "lib/fem/finite_elements.hpp"
#include "lib/mesh/rectangle_mesh.hpp"
#include "lib/model/columns.hpp"
#include "lib/output/files.hpp"
#include "lib/output/frames.hpp"
#include "lib/output/history.hpp"
#include "lib/output/polygon_vtk.hpp"
#include "lib/output/run_folder.hpp"
#include "tests/folder.hpp"
#include "tests/support.hpp"

using namespace apothem;
using test::content;
using test::Folder;

namespace {

Model two_bodies() {
  Model model;
  model.origin = {1024, -512};
  model.materials = {{"rock", 2000}, {"ice", 900}};
  for (const char* name : {"one", "two"}) {
    RigidBody body;
    body.name = name;
    body.material = body.name == "two";
    set_shape(body, samples::shifted(test::quad_q(), model.origin + Vec2(body.material * 3, 0)),
              model);
    model.bodies.push_back(body);
  }
  return model;
}

State state_of(const Model& model) {
  State state(Layout{2, 0});
  for (int i = 0; i < 2; ++i) {
    const RigidBody& body = model.bodies[i];
    state.pose(i) << body.position, body.angle;
  }
  return state;
}

// (time, file) of every entry of a collection.
std::vector<std::pair<double, std::string>> entries(const std::string& file) {
  boost::property_tree::ptree tree;
  boost::property_tree::read_xml(file, tree);
  std::vector<std::pair<double, std::string>> result;
  for (const auto& [name, node] : tree.get_child("VTKFile.Collection")) {
    if (name == "DataSet")
      result.emplace_back(node.get<double>("<xmlattr>.timestep"),
                          node.get<std::string>("<xmlattr>.file"));
  }
  return result;
}

OutputSettings tracking(int body) {
  OutputSettings settings;
  settings.track = {body};
  return settings;
}

}  // namespace

TEST_CASE("frames have the same bytes for any number of threads", "[output][parallel]") {
  const Model model = two_bodies();
  std::map<std::string, std::string> before;
  for (const int threads : {1, 2, 3, 7}) {
    const Folder folder;
    State state = state_of(model);
    FrameWriter frames(folder.path(), model, {}, threads);
    for (int i = 0; i < 20; ++i) {
      state.time = .1 * i;
      state.pose(1)[0] += .25;
      frames.write({.state = state,
                    .contacts = {{0, 1, {.5, .25}, {10., 20. + i}, {3, -4}, 1e-3, .01, {-2, -1}}},
                    .surfaces = {{0, {0, 0}, {1, 0}, 5, 6. * i}},
                    .forces = {{0, 0, 5}, {0, 0, 8}}});
    }
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      if (!entry.is_regular_file()) continue;
      files[std::filesystem::relative(entry.path(), folder.path())] = content(entry.path());
    }
    CHECK(files.size() == 5 * 20 + 5 + 1);
    if (threads > 1) CHECK((files == before));
    before = files;
  }
}

TEST_CASE("a file of a frame that cannot be written is named, and the earlier frames stay",
          "[output][parallel]") {
  const Model model = two_bodies();
  for (const int threads : {1, 2, 7}) {
    for (const char* series : {"bodies", "outlines", "contacts", "chains"}) {
      CAPTURE(threads, series);
      const Folder folder;
      const State state = state_of(model);
      FrameWriter frames(folder.path(), model, {}, threads);
      frames.write({.state = state, .forces = std::vector<BodyForce>(2)});
      const std::string list = content(folder / "frames.pvd");
      const std::string name = folder / fmt::format("frames/{}_000001.vtu", series);
      std::filesystem::create_directory(name);  // where a file should be
      CHECK_THROWS_WITH(frames.write({.state = state, .forces = std::vector<BodyForce>(2)}),
                        Catch::StartsWith(name + ": cannot be written"));
      CHECK(frames.times().size() == 1);
      CHECK(content(folder / "frames.pvd") == list);
      // When there is room again, the frame is written.
      std::filesystem::remove(name);
      frames.write({.state = state, .forces = std::vector<BodyForce>(2)});
      CHECK(entries(folder / "frames.pvd").size() == 2);
    }
  }
}

TEST_CASE("VTK's own reader gets bodies, times and fields back", "[output]") {
  const Folder folder;
  const Model model = two_bodies();
  State state = state_of(model);
  FrameWriter frames(folder.path(), model);
  frames.write({.state = state, .forces = std::vector<BodyForce>(2)});
  state.time = 0.1 + 0.2;  // not representable in few digits
  state.pose(1)[0] += 0.25;
  state.pose(1)[2] = M_PI / 2;
  state.v = {1, 2, 0, 0, 0, 3};
  state.f = {5, 6, 7, 0, 0, 0};
  frames.write({.state = state,
                .contacts = {{0, 1, {0.5, 0.25}, {10, 20}, {3, -4}, 1e-3, 0.01, {-2, -1}}},
                .forces = {{0, 0, 5}, {0, 0, 8}}});

  const auto list = entries(folder / "frames.pvd");
  REQUIRE(list.size() == 2);
  CHECK(list[0].first == 0);
  CHECK(list[1].first == 0.1 + 0.2);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / list[1].second).c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  REQUIRE(grid->GetNumberOfCells() == 2);
  REQUIRE(grid->GetNumberOfPoints() == 8);
  CHECK(grid->GetCellType(0) == VTK_POLYGON);
  CHECK(grid->GetFieldData()->GetArray("TimeValue")->GetTuple1(0) == 0.1 + 0.2);
  CHECK(grid->GetFieldData()->GetNumberOfArrays() == 1);
  CHECK(read_names(folder / "names.csv").bodies[1] == "two");
  CHECK(grid->GetCellData()->GetArray("body")->GetTuple1(1) == 1);
  CHECK(grid->GetCellData()->GetArray("material")->GetTuple1(1) == 1);
  CHECK(grid->GetCellData()->GetArray("contact_force")->GetComponent(0, 1) == 6);
  CHECK(grid->GetCellData()->GetArray("friction")->GetTuple1(1) == 8);
  CHECK(grid->GetPointData()->GetArray("velocity")->GetComponent(0, 1) == 2);
  // Body two: quarter turn about its centre, then 0.25 to the right; world coordinates.
  const Vec2 centre = model.bodies[1].position + model.origin + Vec2(.25, 0);
  for (int i = 0; i < 4; ++i) {
    const Vec2 arm = model.bodies[1].potential.vertices[i];
    double p[3];
    grid->GetPoint(4 + i, p);
    CHECK(p[0] == Approx(centre.x() - arm.y()).epsilon(1e-15));
    CHECK(p[1] == Approx(centre.y() + arm.x()).epsilon(1e-15));
    CHECK(grid->GetPointData()->GetArray("displacement")->GetComponent(4 + i, 0) ==
          Approx(.25 - arm.y() - arm.x()).margin(1e-15));
    CHECK(grid->GetPointData()->GetArray("velocity")->GetComponent(4 + i, 0) ==
          Approx(-3 * arm.x()).margin(1e-14));
  }

  const auto contacts = entries(folder / "contacts.pvd");
  REQUIRE(contacts.size() == 2);
  reader->SetFileName((folder / contacts[1].second).c_str());
  reader->Update();
  REQUIRE(grid->GetNumberOfPoints() == 1);
  CHECK(grid->GetPoint(0)[0] == 1024.5);
  for (const auto& [name, x, y] :
       {std::tuple("force_on_a", 11, 15), std::tuple("normal_force_on_a", 8, 19),
        std::tuple("damping_force_on_a", -2, -1), std::tuple("tangential_force_on_a", 3, -4)}) {
    CHECK(grid->GetPointData()->GetArray(name)->GetComponent(0, 0) == x);
    CHECK(grid->GetPointData()->GetArray(name)->GetComponent(0, 1) == y);
  }
  CHECK(grid->GetPointData()->GetArray("penetration")->GetTuple1(0) == 1e-3);
  CHECK(grid->GetPointData()->GetArray("phi")->GetTuple1(0) == 0.01);
}

TEST_CASE("VTK's own reader gets a mesh back, with shared points", "[output]") {
  const Folder folder;
  const PolygonMesh mesh{{{0, 0}, {2, 0}, {2, 1}, {0, 1}, {.1, 0}, {.3, 1}},
                         {{0, 4, 5, 3}, {1, 2, 5, 4}}};
  write_mesh(folder / "mesh.vtu", mesh);
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "mesh.vtu").c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  REQUIRE(grid->GetNumberOfPoints() == 6);
  CHECK(grid->GetPoint(5)[0] == .3);
  REQUIRE(grid->GetNumberOfCells() == 2);
  CHECK(grid->GetCellType(1) == VTK_POLYGON);
  vtkNew<vtkIdList> nodes;
  grid->GetCellPoints(1, nodes);
  REQUIRE(nodes->GetNumberOfIds() == 4);
  for (int i = 0; i < 4; ++i) CHECK(nodes->GetId(i) == mesh.cells[1][i]);
  CHECK(grid->GetCellData()->GetArray("cell")->GetTuple1(1) == 1);
  CHECK(grid->GetCellData()->GetArray("area")->GetTuple1(0) == Approx(.2).epsilon(1e-15));
  CHECK(grid->GetCellData()->GetArray("area")->GetTuple1(1) == Approx(1.8).epsilon(1e-15));
  CHECK_THROWS_AS(write_mesh("/proc/none/mesh.vtu", mesh), SystemFailure);
}

TEST_CASE("frames of a deformed body hold its stresses", "[output]") {
  // A uniform stretch along x and shear, in plane strain: stresses by Hooke's law to 1e-6.
  const Folder folder;
  Model model;
  model.materials = {{"rock", 2000, {ElasticLaw::st_venant_kirchhoff, Plane::strain, 1e9, .25}}};
  DeformableBody body;
  body.name = "block";
  body.mesh = rectangle_mesh({2, 1}, {4, 2}, {0, 0}, ElementShape::quadrilateral);
  model.deformables = {body};
  FiniteElements elements(std::vector<ElementSet>{{body.element, &model.deformables[0].mesh, 0,
                                                   model.materials[0].elastic, 2000, 1, 0}},
                          1);
  State state(Layout{0, model.node_count()});
  for (int i = 0; i < model.node_count(); ++i) {
    const Vec2& x = body.mesh.nodes[i];
    state.node(i) = Vec2(1e-7 * x.x() + 2e-7 * x.y(), 0);
    state.v[state.layout.node(i)] = x.y();
    state.v[state.layout.node(i) + 1] = 7;
  }
  FrameWriter frames(folder.path(), model);
  frames.write({.state = state,
                .stresses = elements.stresses(state.x),
                .forces = std::vector<BodyForce>(1),
                .node_mass = elements.mass()});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / entries(folder / "frames.pvd")[0].second).c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  REQUIRE(grid->GetNumberOfCells() == 8);
  REQUIRE(grid->GetNumberOfPoints() == 15);
  // lambda = mu = E / 2.5
  const double mu = 4e8, xx = 3 * mu * 1e-7, yy = mu * 1e-7, xy = mu * 2e-7;
  const double radius = std::hypot((xx - yy) / 2, xy),
               mises = std::sqrt(((xx - yy) * (xx - yy) + xx * xx * 4 / 9) / 2 + 3 * xy * xy);
  for (vtkDataSetAttributes* data :
       std::initializer_list<vtkDataSetAttributes*>{grid->GetCellData(), grid->GetPointData()}) {
    const vtkIdType last = data->GetNumberOfTuples() - 1;
    const auto value = [&](const char* name, int component) {
      return data->GetArray(name)->GetComponent(last, component);
    };
    CHECK(value("stress", 0) == Approx(xx).epsilon(1e-6));
    CHECK(value("stress", 1) == Approx(yy).epsilon(1e-6));
    CHECK(value("stress", 2) == Approx(xy).epsilon(1e-6));
    CHECK(value("stress_zz", 0) == Approx(yy).epsilon(1e-6));
    CHECK(value("principal_stress", 0) == Approx((xx + yy) / 2 + radius).epsilon(1e-6));
    CHECK(value("principal_stress", 1) == Approx((xx + yy) / 2 - radius).margin(1e-6 * radius));
    CHECK(value("von_mises", 0) == Approx(mises).epsilon(1e-6));
    CHECK(value("strain_energy_density", 0) == Approx((xx * 1e-7 + xy * 2e-7) / 2).epsilon(1e-6));
  }
  const int corner = 14;
  CHECK(grid->GetPointData()->GetArray("velocity")->GetComponent(corner, 1) == 7);
  CHECK(grid->GetPoint(corner)[0] == Approx(2 + 4e-7).epsilon(1e-14));
}

TEST_CASE("histories read back to the same doubles", "[output]") {
  const Folder folder;
  const Model model = two_bodies();
  State state = state_of(model);
  samples::Random random(30);
  std::vector<std::vector<double>> rows;
  {
    const OutputSettings settings = tracking(1);
    HistoryWriter writer(folder.path(), model, settings);
    for (int i = 0; i < 500; ++i) {
      const auto any = [&] { return std::ldexp(random.uniform(-1, 1), random.integer(-300, 300)); };
      state.time = i / 3.0;
      for (double& v : state.v) v = any();
      for (double& f : state.f) f = any();
      const Energies e{any(), 0, any(), any(), 0, 0, any(), any()};
      const Momenta p{any(), any(), any(), any(), any(), any()};
      const std::vector<BodyForce> contact{{}, {0, 0, any()}};
      writer.add(state, e, p,
                 {.contact = contact, .bodies = std::vector<BodyStatistics>(contact.size())});
      rows.push_back({state.time, state.pose_rate(1)[0], state.force(1)[1], e.contact,
                      e.total_error, p.angular_error, contact[1].friction});
    }
    writer.flush();
  }
  const HistoryTable history = read_history(folder / "history.csv");
  const HistoryTable energy = read_history(folder / "energy.csv");
  const HistoryTable momentum = read_history(folder / "momentum.csv");
  CHECK(content(folder / "history.csv")
            .starts_with("time [s],two.x [m],two.y [m],two.angle [rad],two.vx [m/s],"));
  CHECK(
      content(folder / "energy.csv")
          .starts_with("time [s],kinetic [J],strain [J],contact [J],gravity [J],friction_loss [J],"
                       "damping_loss [J],numerical_loss [J],external_work [J],total_error [J]\n"));
  CHECK(content(folder / "momentum.csv")
            .starts_with("time [s],px [kg m/s],py [kg m/s],angular [kg m^2/s],px_error [kg m/s],"
                         "py_error [kg m/s],angular_error [kg m^2/s]\n"));
  REQUIRE(history.columns[0].size() == rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(history.columns[0][i] == rows[i][0]);
    REQUIRE((*history.column("two.vx"))[i] == rows[i][1]);
    REQUIRE((*history.column("two.fy"))[i] == rows[i][2]);
    REQUIRE((*energy.column("contact"))[i] == rows[i][3]);
    REQUIRE((*energy.column("total_error"))[i] == rows[i][4]);
    REQUIRE((*momentum.column("angular_error"))[i] == rows[i][5]);
    REQUIRE((*history.column("two.friction"))[i] == rows[i][6]);
  }
}

TEST_CASE("extremes are refined where a column is smooth, and nowhere else", "[output]") {
  const Folder folder;
  const auto extremes = [&](const std::vector<double>& rows, bool jumps = false) {
    std::string text = "time [s],r.q [1]\n";
    for (size_t i = 0; i < rows.size(); ++i)
      text += fmt::format("{},{}\n", .1 * double(i), rows[i]);
    folder.write("history.csv", text);
    const auto of = [&](Reduction::Take take) {
      Reduction reduction;
      reduction.quantity = "r.q", reduction.take = take, reduction.jumps = jumps;
      return reduce(reduction, folder.path());
    };
    using Take = Reduction::Take;
    return std::array{of(Take::minimum), of(Take::maximum), of(Take::largest)};
  };
  using Three = std::array<double, 3>;
  // A plateau and a jump, at either side; a jump from a slope, as of a velocity that bounces; a
  // kink.
  CHECK(extremes({3, 3, 3, 0, 0, 0}) == Three{0, 3, 3});
  CHECK(extremes({3, 2, 2, 3, 0, 1}) == Three{0, 3, 3});
  CHECK(extremes({-2.8, -2.9, -3, 3, 2.9, 2.8}) == Three{-3, 3, 3});
  CHECK(extremes({0, 1, 2, 3, 2.5, 2, 1.5}) == Three{0, 3, 3});
  CHECK(extremes({0, 0, 100, 60, 0, 0}) == Three{0, 100, 100});
  // What is smooth: the top of a parabola is exact, also with the top between the first rows.
  const auto parabola = [](double top) {
    std::vector<double> rows;
    for (int i = 0; i < 8; ++i) rows.push_back(5 - std::pow(i - top, 2));
    return rows;
  };
  CHECK(extremes(parabola(3.3))[1] == Approx(5).epsilon(1e-14));
  CHECK(extremes(parabola(1.3))[1] == Approx(5).epsilon(1e-14));
  CHECK(extremes(parabola(3.3), true)[1] == 5 - .3 * .3);
}

TEST_CASE("extremes of what regions count are those of rows", "[output]") {
  Model model;
  model.regions = {{"r", {}, 1}};
  for (const HistoryColumn& column : history_columns(model, {})) {
    INFO(column.name);
    CHECK(column.jumps == (column.name != "r.solid_fraction"));
  }
}

TEST_CASE("expectations are judged by what was recorded", "[output]") {
  const Folder folder;
  const Model model = two_bodies();
  State state = state_of(model);
  const OutputSettings settings = tracking(0);
  HistoryWriter writer(folder.path(), model, settings);
  for (int i = 0; i <= 20; ++i) {  // a parabola with its top between two rows
    state.time = i * .1;
    state.pose(0)[1] = 3 - (state.time - 1.03) * (state.time - 1.03);
    writer.add(state, {}, {},
               {.contact = std::vector<BodyForce>(2), .bodies = std::vector<BodyStatistics>(2)});
  }
  writer.flush();
  const double top = 3 + model.origin.y();
  using Take = Expectation::Take;
  CHECK(evaluate({"one.y", Take::maximum, {}, {}, "m", false, top, 1e-12}, folder.path()).met);
  CHECK_FALSE(
      evaluate({"one.y", Take::maximum, {}, {}, "m", false, top + 1e-3, 1e-4}, folder.path()).met);
  CHECK(
      evaluate({"one.y", Take::first, {}, {}, "m", false, top - 1.03 * 1.03, 1e-12}, folder.path())
          .met);
  CHECK(evaluate({"one.y", Take::last, {}, {}, "m", false, top - .97 * .97, 1e-12}, folder.path())
            .met);
  CHECK(evaluate({"one.y", Take::maximum, {}, 0.55, "m", false, top - .53 * .53, 1e-12},
                 folder.path())
            .met);
  CHECK_THROWS(evaluate({"one.y", Take::maximum, 5, 6, "m", false, 0, 1}, folder.path()));
  const auto reduced = [&](Take take) { return reduce({"one.y", take, {}, {}}, folder.path()); };
  CHECK(reduced(Take::increase) == Approx(1.03 * 1.03 - .97 * .97));
  CHECK(reduced(Take::decrease) == Approx(.97 * .97 - 1.03 * 1.03));
  CHECK(reduced(Take::slope) == Approx(.06));
  // The trapezoid rule is too low by h^2/6.
  const double mean = top - (std::pow(1.03, 3) + std::pow(.97, 3)) / 6 - .01 / 6;
  CHECK(reduced(Take::mean) == Approx(mean).epsilon(1e-12));
  CHECK(reduce({"time", Take::last, {}, {}}, folder.path()) == Approx(2));
}

TEST_CASE("a pipe is written to and stays", "[output]") {
  const Folder folder;
  const std::string pipe = folder / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  REQUIRE(reader >= 0);
  write_file(pipe, "content");
  char read[16] = {};
  CHECK(::read(reader, read, sizeof(read)) == 7);
  ::close(reader);
  CHECK(std::string(read) == "content");
  CHECK(std::filesystem::is_fifo(pipe));
}

TEST_CASE("a full disk costs the block, not the file", "[output]") {
  // A file-size limit stands in for the full disk: write() fails in the same way.
  const Folder folder;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  write_file(folder / "old", "old content");
  AppendedFile log(folder / "log");
  log.append("first block\n");
  const rlimit small{4096, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string block(10000, 'x');
  std::string error;
  try {
    log.append(block);
  } catch (const SystemFailure& failure) {
    error = failure.what();
  }
  CHECK_THROWS_AS(write_file(folder / "old", block), SystemFailure);
  CHECK_THROWS_AS(write_file(folder / "new", block), SystemFailure);
  setrlimit(RLIMIT_FSIZE, &before);
  CHECK(error.find("log: cannot be written") != std::string::npos);
  CHECK(content(folder / "log") == "first block\n");
  CHECK(content(folder / "old") == "old content");
  CHECK_FALSE(std::filesystem::exists(folder / "new"));
  log.append("next\n");
  CHECK(content(folder / "log") == "first block\nnext\n");
  CHECK_THROWS_AS(create_folder("/dev/null/out"), SystemFailure);
}
