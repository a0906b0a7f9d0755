// Arrays over the state: views of its memory, which keep the simulation alive, and copies.
#include "apps/python/views.hpp"

#include <algorithm>
#include <cmath>

#include "lib/text/words.hpp"

namespace apothem::python {
namespace {

using Array = py::array_t<double>;

// Rows of `columns` numbers in the memory of a run, which they keep.
Array view(std::span<const double> values, int columns, const std::shared_ptr<SharedRun>& run,
           bool writable = false) {
  const auto rows = static_cast<py::ssize_t>(values.size()) / columns;
  using Keeper = std::shared_ptr<SharedRun>;
  const py::capsule keeper(new Keeper(run), [](void* kept) { delete static_cast<Keeper*>(kept); });
  Array array({rows, static_cast<py::ssize_t>(columns)}, values.data(), keeper);
  if (!writable) {
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  }
  return array;
}

// The part of a vector of the state that belongs to rigid bodies, or to nodes.
template <class Owner, std::vector<double> State::*vector>
Array state_view(const Owner& owner) {
  const State& state = owner.run->look().state();
  if constexpr (std::is_same_v<Owner, Bodies>) {
    return view(state.layout.of_rigid(state.*vector), 3, owner.run);
  } else {
    return view(state.layout.of_nodes(state.*vector), 2, owner.run);
  }
}

const Model& model_of(const std::shared_ptr<SharedRun>& run) { return run->look().scene().model; }

Array of_bodies(const Bodies& bodies, double RigidBody::*value) {
  const std::vector<RigidBody>& list = model_of(bodies.run).bodies;
  Array array(static_cast<py::ssize_t>(list.size()));
  std::ranges::transform(list, array.mutable_data(), value);
  return array;
}

py::array_t<bool> present(const Bodies& bodies) {
  const State& state = bodies.run->look().state();
  py::array_t<bool> array(state.layout.rigid_bodies);
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    array.mutable_at(i) = !state.is_absent(i);
  }
  return array;
}

// The rings of each body where they are now.
template <class Use>
void each_body(const Bodies& bodies, const Use& use) {
  const State& state = bodies.run->look().state();
  for (RigidIndex i = 0; i < state.layout.rigid_bodies; ++i) {
    const auto pose = state.pose(i);
    const double c = std::cos(pose[2]), s = std::sin(pose[2]);
    Rings rings = model_of(bodies.run).bodies[static_cast<size_t>(i)].rings();
    for (std::vector<Vec2>& ring : rings) {
      for (Vec2& v : ring) {
        v = {pose[0] + (c * v.x() - s * v.y()), pose[1] + (s * v.x() + c * v.y())};
      }
    }
    use(rings);
  }
}

py::list outlines(const Bodies& bodies) {
  py::list list;
  each_body(bodies, [&](const Rings& rings) { list.append(array_of(rings[0])); });
  return list;
}

py::list holes(const Bodies& bodies) {
  py::list list;
  each_body(bodies, [&](const Rings& rings) {
    py::list of_body;
    for (size_t k = 1; k < rings.size(); ++k) of_body.append(array_of(rings[k]));
    list.append(of_body);
  });
  return list;
}

std::vector<Vec2> node_places(const Nodes& nodes, bool displaced) {
  const State& state = nodes.run->look().state();
  std::vector<Vec2> places;
  places.reserve(static_cast<size_t>(state.layout.nodes));
  for (const DeformableBody& body : model_of(nodes.run).deformables) {
    for (size_t i = 0; i < body.mesh.nodes.size(); ++i) {
      const NodeIndex node = body.first_node + static_cast<NodeIndex>(i);
      places.push_back(displaced ? Vec2(body.mesh.nodes[i] + state.node(node))
                                 : body.mesh.nodes[i]);
    }
  }
  return places;
}

// Nodes or elements of the deformable body of a name.
py::slice slice_of(const std::shared_ptr<SharedRun>& run, const std::string& name,
                   py::ssize_t (*count)(const DeformableBody&)) {
  py::ssize_t first = 0;
  for (const DeformableBody& body : model_of(run).deformables) {
    const py::ssize_t behind = first + count(body);
    if (body.name == name) return {first, behind, 1};
    first = behind;
  }
  throw py::key_error("no deformable body has the name \"" + name + "\"");
}
py::ssize_t node_count(const DeformableBody& body) {
  return static_cast<py::ssize_t>(body.mesh.nodes.size());
}
py::ssize_t element_count(const DeformableBody& body) { return body.mesh.element_count(); }

Array stress(const Elements& elements) {
  const std::vector<CauchyStress> stresses = elements.run->look().simulation().stresses();
  Array array({static_cast<py::ssize_t>(stresses.size()), py::ssize_t{4}});
  auto at = array.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const CauchyStress& s = stresses[static_cast<size_t>(i)];
    at(i, 0) = s.xx, at(i, 1) = s.yy, at(i, 2) = s.xy, at(i, 3) = s.zz;
  }
  return array;
}

py::list element_nodes(const Elements& elements) {
  py::list list;
  for (const DeformableBody& body : model_of(elements.run).deformables) {
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const std::span<const int> nodes = body.mesh.element(e);
      py::array_t<int> numbers(static_cast<py::ssize_t>(nodes.size()));
      std::ranges::transform(nodes, numbers.mutable_data(),
                             [&](int node) { return body.first_node + node; });
      list.append(numbers);
    }
  }
  return list;
}

void bind_forces(py::module_& module) {
  py::class_<Forces>(
      module, "Forces",
      "What a force callback adds to: writable views, zero at the start of the call.")
      .def_property_readonly(
          "bodies",
          [](const Forces& f) {
            const Layout& layout = f.run->look().state().layout;
            return view(layout.of_rigid(f.values), 3, f.run, true);
          },
          "View (n, 3): force in x and y, N, and moment about the mass centre, N m, on each rigid "
          "body.")
      .def_property_readonly(
          "nodes",
          [](const Forces& f) {
            const Layout& layout = f.run->look().state().layout;
            return view(layout.of_nodes(f.values), 2, f.run, true);
          },
          "View (m, 2): force on each node, N.");
}

void bind_bodies(py::module_& module) {
  py::class_<Bodies>(module, "Bodies", R"(The n rigid bodies of a simulation.

position, velocity and force are views of the simulation's own memory, without a copy. They show the
present state at any time, keep the memory of the simulation, and are read-only: the balance of energy
would not know of what is written there (see Simulation.set_velocities). The arrays have a row for every
body that the scene will ever have; `present` says which of them are in the world now.)")
      .def_property_readonly("position", &state_view<Bodies, &State::x>,
                             "View (n, 3): x and y of the mass centre relative to "
                             "Simulation.origin, m, and angle, rad.")
      .def_property_readonly("velocity", &state_view<Bodies, &State::v>,
                             "View (n, 3): m/s, m/s, rad/s. Rows of absent bodies are zero.")
      .def_property_readonly("force", &state_view<Bodies, &State::f>,
                             "View (n, 3): force, N, and moment about the mass centre, N m, of "
                             "contacts and of added forces. Without gravity.")
      .def_property_readonly(
          "names", [](const Bodies& b) { return names_of(model_of(b.run).bodies); },
          "List of the n names.")
      .def_property_readonly(
          "mass", [](const Bodies& b) { return of_bodies(b, &RigidBody::mass); },
          "Copy (n,): masses, kg.")
      .def_property_readonly(
          "inertia", [](const Bodies& b) { return of_bodies(b, &RigidBody::inertia); },
          "Copy (n,): moments of inertia about the mass centres, kg m^2.")
      .def_property_readonly("present", &present,
                             "Copy (n,), bool: in the world, neither to come nor gone.")
      .def("outlines", &outlines,
           "List of n new arrays (k, 2): the vertices where they are now, relative to "
           "Simulation.origin, m, counter-clockwise, without those of holes.")
      .def(
          "holes", &holes,
          "List of n lists of new arrays (k, 2): the vertices of the holes of each body where they "
          "are now, relative to Simulation.origin, m, clockwise.")
      .def("__len__", [](const Bodies& b) { return model_of(b.run).bodies.size(); });
}

void bind_nodes(py::module_& module) {
  py::class_<Nodes>(module, "Nodes",
                    R"(The m nodes of the meshes of all deformable bodies, one mesh after the other.

displacement, velocity and force are read-only views of the simulation's own memory, as those of
Bodies. The simulation stores displacements, so `position` is computed and a copy.)")
      .def_property_readonly(
          "position", [](const Nodes& n) { return array_of(node_places(n, true)); },
          "Copy (m, 2): present places relative to Simulation.origin, m.")
      .def_property_readonly(
          "reference", [](const Nodes& n) { return array_of(node_places(n, false)); },
          "Copy (m, 2): places in the meshes as given, relative to Simulation.origin, m.")
      .def_property_readonly("displacement", &state_view<Nodes, &State::x>,
                             "View (m, 2): displacements from the meshes as given, m.")
      .def_property_readonly("velocity", &state_view<Nodes, &State::v>, "View (m, 2): m/s.")
      .def_property_readonly("force", &state_view<Nodes, &State::f>,
                             "View (m, 2): forces of elements, loads and contacts, N. Without "
                             "gravity.")
      .def(
          "of",
          [](const Nodes& n, const std::string& name) { return slice_of(n.run, name, node_count); },
          py::arg("name"), "The slice of the rows of a deformable body. Raises KeyError.")
      .def("__len__", [](const Nodes& n) { return n.run->look().state().layout.nodes; });
}

void bind_elements(py::module_& module) {
  py::class_<Elements>(module, "Elements",
                       "The elements of the meshes of all deformable bodies, one mesh after the "
                       "other.")
      .def_property_readonly("stress", &stress,
                             "Copy (e, 4): mean Cauchy stress xx, yy, xy, zz of each element, Pa, "
                             "tension positive. It is computed when asked for.")
      .def_property_readonly("nodes", &element_nodes,
                             "List of e new arrays: the nodes of each element, counter-clockwise, "
                             "as rows of Simulation.nodes.")
      .def(
          "of",
          [](const Elements& e, const std::string& name) {
            return slice_of(e.run, name, element_count);
          },
          py::arg("name"), "The slice of the rows of a deformable body. Raises KeyError.")
      .def("__len__", [](const Elements& e) {
        py::ssize_t count = 0;
        for (const DeformableBody& body : model_of(e.run).deformables) {
          count += element_count(body);
        }
        return count;
      });
}

}  // namespace

void bind_views(py::module_& module) {
  bind_bodies(module);
  bind_nodes(module);
  bind_elements(module);
  bind_forces(module);
}

}  // namespace apothem::python
