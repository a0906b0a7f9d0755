// apothem.Simulation: a scene that runs.
#include <cmath>
#include <cstring>
#include <filesystem>

#include "apps/python/views.hpp"
#include "lib/model/columns.hpp"
#include "lib/model/patch_quantities.hpp"
#include "lib/run/hash.hpp"

namespace apothem::python {
namespace {

// Two numbers of bodies, the loading point, and the quantities that Python has.
py::array contacts(const Driver& driver) {
  py::list names, formats, offsets;
  size_t size = 0;
  const auto add_field = [&](const char* name, const char* format, size_t bytes) {
    names.append(name), formats.append(format), offsets.append(size);
    size += bytes;
  };
  const auto add_vector = [&](const char* name) { add_field(name, "(2,)f8", 2 * sizeof(double)); };
  add_field("body_a", "i8", sizeof(std::int64_t));
  add_field("body_b", "i8", sizeof(std::int64_t));
  add_vector("point");
  for (const PatchQuantity& quantity : kPatchQuantities) {
    if (!quantity.in_python) continue;
    if (quantity.is_vector) {
      add_vector(quantity.in_python);
    } else {
      add_field(quantity.in_python, "f8", sizeof(double));
    }
  }
  const std::vector<ContactRecord> records = driver.look().simulation().contacts();
  py::array array(py::dtype(names, formats, offsets, static_cast<py::ssize_t>(size)),
                  static_cast<py::ssize_t>(records.size()));
  auto* next = static_cast<char*>(array.mutable_data());
  const auto put = [&](const void* from, size_t bytes) {
    std::memcpy(next, from, bytes);
    next += bytes;
  };
  for (const ContactRecord& record : records) {
    for (const std::int64_t body : {record.a, record.b}) put(&body, sizeof body);
    put(record.point.data(), 2 * sizeof(double));
    for (const PatchQuantity& quantity : kPatchQuantities) {
      if (!quantity.in_python) continue;
      const Vec2 value = quantity.value(record);
      put(value.data(), (quantity.is_vector ? 2 : 1) * sizeof(double));
    }
  }
  return array;
}

py::dict energies(const Driver& driver) {
  const Energies e = driver.look().simulation().energies();
  const double values[]{e.kinetic,        e.strain,        e.contact,
                        e.gravity,        e.friction_loss, e.damping_loss,
                        e.numerical_loss, e.external_work, e.total_error};
  py::dict dict;
  for (size_t i = 0; i < kEnergyColumns.size(); ++i) dict[kEnergyColumns[i].name] = values[i];
  return dict;
}

py::dict momenta(const Driver& driver) {
  const Momenta m = driver.look().simulation().momenta();
  const double values[]{m.x, m.y, m.angular, m.x_error, m.y_error, m.angular_error};
  py::dict dict;
  for (size_t i = 0; i < kMomentumColumns.size(); ++i) dict[kMomentumColumns[i].name] = values[i];
  return dict;
}

std::shared_ptr<Driver> make(const Scene& scene, const py::object& output, int threads,
                             bool overwrite, const py::object& begin_from) {
  if (threads < 1) throw std::invalid_argument("threads must be at least 1");
  const RunSettings settings{path_text(output), threads, false, overwrite, path_text(begin_from)};
  const py::gil_scoped_release release;
  return std::make_shared<Driver>(scene, settings);
}

std::shared_ptr<Driver> resume(const py::object& path, const Scene* scene, const py::object& output,
                               int threads, bool overwrite) {
  if (threads < 1) throw std::invalid_argument("threads must be at least 1");
  const std::string name = path_text(path);
  RunSettings settings{path_text(output), threads, false, overwrite};
  const py::gil_scoped_release release;
  if (std::filesystem::is_directory(name)) {
    if (scene == nullptr || !settings.folder.empty()) {
      throw std::invalid_argument(
          "to go on with the results in a folder, give its scene, and no "
          "other folder as output");
    }
    settings.folder = name;
    settings.resume = true;
    return std::make_shared<Driver>(*scene, settings);
  }
  settings.saved = name;
  return std::make_shared<Driver>(scene ? *scene : read_saved_scene(name), settings);
}

void set_velocities(Driver& driver, const std::optional<py::array_t<double>>& bodies,
                    const std::optional<py::array_t<double>>& nodes) {
  Simulation& simulation = driver.change().simulation();
  std::vector<double> v = simulation.state().v;
  const Layout& layout = simulation.state().layout;
  const auto put = [](const py::array_t<double>& from, std::span<double> to, py::ssize_t columns,
                      const char* name) {
    const py::ssize_t rows = static_cast<py::ssize_t>(to.size()) / columns;
    if (from.ndim() != 2 || from.shape(0) != rows || from.shape(1) != columns) {
      throw std::invalid_argument(std::string(name) + " must have the shape (" +
                                  std::to_string(rows) + ", " + std::to_string(columns) + ")");
    }
    const auto at = from.unchecked<2>();
    for (py::ssize_t i = 0; i < rows; ++i) {
      for (py::ssize_t k = 0; k < columns; ++k) {
        if (!std::isfinite(at(i, k))) {
          throw std::invalid_argument(std::string(name) + " must be finite");
        }
        to[static_cast<size_t>(i * columns + k)] = at(i, k);
      }
    }
  };
  if (bodies) put(*bodies, layout.of_rigid(v), 3, "bodies");
  if (nodes) put(*nodes, layout.of_nodes(v), 2, "nodes");
  simulation.set_velocities(v);
}

// Lets Python's garbage collector see the callbacks, which may refer to the simulation.
void support_collector(PyHeapTypeObject* heap_type) {
  PyTypeObject* type = &heap_type->ht_type;
  type->tp_flags |= Py_TPFLAGS_HAVE_GC;
  const auto driver = [](PyObject* self) -> Driver* {
    auto* instance = reinterpret_cast<py::detail::instance*>(self);
    auto holder = instance->get_value_and_holder();
    return holder.holder_constructed() ? static_cast<Driver*>(holder.value_ptr()) : nullptr;
  };
  static const auto find = driver;
  type->tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    const Driver* found = find(self);
    return found ? found->traverse(visit, arg) : 0;
  };
  type->tp_clear = [](PyObject* self) {
    if (Driver* found = find(self)) found->clear();
    return 0;
  };
}

constexpr const char* kSimulation = R"(A scene that runs, step by step or until a time.

Simulation(scene, output=None, threads=1, overwrite=False, begin_from=None)
    scene: Scene.
    output: folder of the results that `apothem run` would write; None: no files are written.
    threads: number of threads. The results have the same bits for any number.
    overwrite: results of an earlier run in the folder may be replaced.
    begin_from: folder of another run with whose last state bodies of the same name and shape begin,
    as with `apothem run --from`.

Raises SceneError if the scene cannot be run, OSError if files cannot be written. All coordinates are
relative to `origin`. One thread at a time may run a simulation; others must not look at it meanwhile.
Its results equal those of the program bit for bit. `with` closes it at the end.)";

void bind_running(py::class_<Driver, std::shared_ptr<Driver>>& type) {
  type.def("step", &Driver::step, py::arg("n") = 1,
           R"(Takes n time steps, or load steps of a static scene, with the records that are due.

Returns the number of steps taken: less than n at the end of the scene, and where a rule of the scene
stops the run. Raises Unstable, KeyboardInterrupt after a whole step, and what callbacks raise.)")
      .def("run", &Driver::run, py::arg("until") = py::none(),
           R"(Steps until a time in s, by default the end of the scene.

Returns False if a rule of the scene has stopped the run (see stopped_by), otherwise True. Other
Python threads run meanwhile. Ctrl-C ends the step and raises KeyboardInterrupt; the simulation can be
used and continued. Raises Unstable, and what callbacks raise.)")
      .def(
          "add_force", &Driver::add_force, py::arg("callback"), py::arg("name") = "force of Python",
          R"(Adds a force: callback(sim, force) is called in every step, also several times, and adds to
force.bodies (n, 3), N and N m, and force.nodes (m, 2), N. It must depend on time, positions and
velocities alone. The ledger counts its work as external. To be called before the first step; a
simulation that goes on after resume() needs the forces of the same names. After an exception of the callback the simulation is
of no more use, except for KeyboardInterrupt, after which the callback is asked once again.)")
      .def("on_step", &Driver::add_step_callback, py::arg("callback"), py::arg("every") = 1,
           "Calls callback(sim) after every so many steps. What it raises ends the run after that "
           "step; the simulation can be continued.")
      .def("set_velocities", &set_velocities, py::arg("bodies") = py::none(),
           py::arg("nodes") = py::none(),
           R"(Gives rigid bodies (n, 3), m/s and rad/s, and nodes (m, 2), m/s, new velocities.

Coordinates that are fixed or prescribed keep theirs. The ledger counts the change of energy as
external work. Raises ValueError if a shape is wrong or a number is not finite.)")
      .def("close", &Driver::close, R"(Completes the files in the output folder.

A run that is not at its end leaves a checkpoint there. Also done at the end of `with`, and when the
simulation is deleted. The simulation cannot be stepped any more.)")
      .def("__enter__", [](const std::shared_ptr<Driver>& self) { return self; })
      .def("__exit__", [](Driver& self, const py::args&) { self.close(); })
      .def(
          "save", [](Driver& d, const py::object& path) { d.change().save(path_text(path)); },
          py::arg("path"),
          R"(Writes the whole state, with the scene, to a file; see resume(). Raises OSError.)");
}

void bind_looking(py::class_<Driver, std::shared_ptr<Driver>>& type) {
  using Self = std::shared_ptr<Driver>;
  type.def_property_readonly(
          "time", [](const Driver& d) { return d.look().state().time; }, "Time, s.")
      .def_property_readonly(
          "steps", [](const Driver& d) { return d.look().state().step; },
          "Number of steps since time 0.")
      .def_property_readonly(
          "step_size", [](const Driver& d) { return d.look().simulation().step_size(); },
          "Size of the next time step, s.")
      .def_property_readonly(
          "ended", [](const Driver& d) { return d.look().ended(); },
          "At the end of the scene, or stopped for good by one of its rules.")
      .def_property_readonly(
          "stopped_by",
          [](const Driver& d) -> std::optional<std::string> {
            const std::string& rule = d.look().stopped_by();
            return rule.empty() ? std::nullopt : std::optional(rule);
          },
          "The rule of the scene that has stopped the run, or None.")
      .def_property_readonly(
          "warnings", [](const Driver& d) { return d.look().warnings(); },
          "Reasons to doubt the results, as a list of sentences.")
      .def_property_readonly(
          "origin",
          [](const Driver& d) {
            const Vec2& origin = d.look().scene().model.origin;
            return py::make_tuple(origin.x(), origin.y());
          },
          "What coordinates are relative to, m: (0, 0) unless the scene lies far from it. The "
          "coordinates of the scene are those of the simulation plus this.")
      .def_property_readonly(
          "bodies", [](const Self& d) { return Bodies{d->shared()}; }, "The rigid bodies.")
      .def_property_readonly(
          "nodes", [](const Self& d) { return Nodes{d->shared()}; },
          "The nodes of the deformable bodies.")
      .def_property_readonly(
          "elements", [](const Self& d) { return Elements{d->shared()}; },
          "The elements of the deformable bodies.")
      .def(
          "contacts", &contacts,
          R"(New structured array with a row for each contact patch, a connected part of the overlap of two bodies.

Fields: body_a and body_b, numbers of bodies, rigid ones first and then deformable ones; point (2,),
loading point relative to origin, m; normal, tangential and damping (2,), elastic normal force,
friction, and damping of the normal force on body_a, N; penetration, m; phi, largest potential met.)")
      .def(
          "energies", &energies,
          R"(New dict of energies, J: kinetic, strain, contact, gravity, friction_loss, damping_loss,
external_work and total_error, the part that none of them accounts for.)")
      .def(
          "momenta", &momenta,
          R"(New dict: momenta px, py, kg m/s, and angular, kg m^2/s about origin, of the free bodies, and
px_error, py_error, angular_error, the parts that no impulse accounts for.)")
      .def(
          "state_hash", [](const Driver& d) { return state_hash(d.look().state()); },
          "Hash of the bits of time, positions, velocities and forces: `final_state_hash` of "
          "run.json.");
}

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<Driver, std::shared_ptr<Driver>> type(module, "Simulation", kSimulation,
                                                   py::custom_type_setup(support_collector));
  type.def(py::init(&make), py::arg("scene"), py::arg("output") = py::none(),
           py::arg("threads") = 1, py::arg("overwrite") = false,
           py::arg("begin_from") = py::none());
  bind_running(type);
  bind_looking(type);
  module.def("resume", &resume, py::arg("path"), py::arg("scene") = nullptr,
             py::arg("output") = py::none(), py::arg("threads") = 1, py::arg("overwrite") = false,
             R"(Goes on bit for bit where a simulation was saved.

path: file of Simulation.save(); or the folder of a run that was stopped, by the program or by Python:
then with its scene, and its results are continued there.
scene: Scene; by default the one in the file.
output, threads, overwrite: as of Simulation. Forces and callbacks have to be added again.

Returns a Simulation. Raises SceneError if the file is damaged or belongs to another scene.)");
}

}  // namespace apothem::python
