// SPDX-License-Identifier: Apache-2.0
// Arrays of particles, bodies, bonds or joints, with a row for each.
#include "array_argument.h"
#include "binders.h"
#include "law_argument.h"
#include "names.h"
#include "restructure_result.h"
#include "typed_argument.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace iota::bindings {

namespace {

/// An ordered list of things of one kind in a system.
template <class IdType>
struct HandleArray {
  nb::object system_object;
  SystemObject* system = nullptr;
  std::vector<IdType> ids;

  const Many read() const { return std::as_const(system->use()).many(); }  // NOLINT(readability-const-return-type)
  Many change(const char* what) const { return system->use_between_steps(what).many(); }
};
using ParticleArray = HandleArray<ParticleId>;
using BodyArray = HandleArray<BodyId>;
using BondArray = HandleArray<BondId>;
using JointArray = HandleArray<ConstraintId>;

constexpr const char* copies =
    "\n\nReturned arrays are float64 copies with a row for each, in its order; any array of that shape can be assigned,\n"
    "which is one edit. StaleIdError if one of them no longer exists.";

using RowsArgument = TypedArgument<"numpy.typing.ArrayLike">;
using ColumnArgument = TypedArgument<"float | numpy.typing.ArrayLike">;

/// The numbers of an array of shape (count, columns), or (count,) for one column; `array` keeps them alive. `one`: a single
/// row may stand for all.
std::span<const double> to_numbers(nb::handle values, std::size_t count, std::size_t columns, const char* name,
                                   nb::object& array, bool one = false) {
  try {
    array = nb::module_::import_("numpy").attr("ascontiguousarray")(values, "float64");
  } catch (nb::python_error&) {
    throw nb::type_error((std::string(name) + " must be an array of numbers, not " + describe(values)).c_str());
  }
  const auto view = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  // ascontiguousarray turns zero dimensions into one.
  const std::size_t row_shape = columns == 1 ? 0 : 1;
  const bool is_rows =
      view.ndim() == 1 + row_shape && view.shape(0) == count && (!row_shape || view.shape(1) == columns);
  const bool is_one = one && view.size() == columns && view.ndim() == 1;
  if (!is_rows && !is_one) {
    const std::string shape = "(" + std::to_string(count) + (row_shape ? ", " + std::to_string(columns) + ")" : ",)");
    throw nb::value_error((std::string(name) + " must have the shape " + shape + ", a row for each, not " +
                           nb::repr(array.attr("shape")).c_str())
                              .c_str());
  }
  for (std::size_t i = 0; i < view.size(); ++i)
    if (!std::isfinite(view.data()[i]))
      throw nb::value_error(
          (std::string(name) + " must be finite; row " + std::to_string(i / columns) + " is not").c_str());
  return {view.data(), view.size()};
}

std::vector<Vec3> to_vectors(std::span<const double> numbers) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  std::vector<Vec3> vectors(numbers.size() / 3);
  if (!vectors.empty()) std::memcpy(static_cast<void*>(vectors.data()), numbers.data(), numbers.size_bytes());
  return vectors;
}

std::size_t row_count(nb::handle values, const char* name) {
  const Py_ssize_t size = PyObject_Size(values.ptr());
  if (size >= 0) return static_cast<std::size_t>(size);
  PyErr_Clear();
  throw nb::type_error((std::string(name) + " must be an array of shape (n, 3), not " + describe(values)).c_str());
}

nb::object to_array(std::vector<double> numbers, std::size_t columns) {
  auto* const owned = new std::vector<double>(std::move(numbers));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  if (columns == 1)
    return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>, nb::c_contig>(owned->data(), {owned->size()}, owner));
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<2>, nb::c_contig>(owned->data(),
                                                                            {owned->size() / columns, columns}, owner));
}

constexpr const char* array_type = "numpy.typing.NDArray[numpy.float64]";

template <class IdType>
nb::object read(const HandleArray<IdType>& self, Quantity quantity) {
  std::vector<double> numbers(width(quantity) * self.ids.size());
  self.read().read(quantity, self.ids, numbers);
  return to_array(std::move(numbers), width(quantity));
}

template <class IdType>
void assign(const HandleArray<IdType>& self, Quantity quantity, nb::handle values, const char* name) {
  nb::object array;
  const auto numbers = to_numbers(values, self.ids.size(), width(quantity), name, array);
  self.change(name).assign(quantity, self.ids, numbers);
}

std::string getter_signature(const std::string& name) { return "def " + name + "(self) -> " + array_type; }

template <class Array>
void def_read(nb::class_<Array>& type, const char* name, Quantity quantity, const char* text) {
  type.def_prop_ro(
      name, [quantity](const Array& self) { return read(self, quantity); }, nb::sig(getter_signature(name).c_str()),
      text);
}

template <class Array>
void def_assigned(nb::class_<Array>& type, const char* name, Quantity quantity, const char* text) {
  type.def_prop_rw(
      name, [quantity](const Array& self) { return read(self, quantity); },
      [quantity, name](const Array& self, RowsArgument values) { assign(self, quantity, values.value, name); },
      nb::for_getter(nb::sig(getter_signature(name).c_str())),
      nb::for_setter(
          nb::sig((std::string("def ") + name + "(self, value: numpy.typing.ArrayLike, /) -> None").c_str())),
      text);
}

template <class Array>
void def_applied(nb::class_<Array>& type, const char* name, Quantity quantity, const char* argument, const char* text) {
  type.def(
      name,
      [quantity, argument](const Array& self, RowsArgument values) { assign(self, quantity, values.value, argument); },
      nb::arg(argument), text);
}

/// Length, members and slices. One member is a handle.
template <class Array>
void def_sequence(nb::class_<Array>& type, const char* name) {
  using Member = decltype(sibling(std::declval<const Array&>(), typename decltype(Array::ids)::value_type{}));
  const auto member = nb::cast<std::string>(nb::type<Member>().attr("__name__"));
  type.def("__len__", [](const Array& self) { return self.ids.size(); })
      .def(
          "__getitem__",
          [](const Array& self, Py_ssize_t index) {
            const auto size = static_cast<Py_ssize_t>(self.ids.size());
            if (index < -size || index >= size) {
              const std::string text = "there are " + std::to_string(size) + ", and no number " + std::to_string(index);
              throw nb::index_error(text.c_str());
            }
            return sibling(self, self.ids[static_cast<std::size_t>(index < 0 ? index + size : index)]);
          },
          "index"_a)
      .def(
          "__getitem__",
          [](const Array& self, const nb::slice& range) {
            const auto [start, stop, step, length] = range.compute(self.ids.size());
            Array part{self.system_object, self.system, {}};
            for (std::size_t i = 0; i < length; ++i)
              part.ids.push_back(self.ids[static_cast<std::size_t>(start + static_cast<Py_ssize_t>(i) * step)]);
            return part;
          },
          "range"_a)
      .def(
          "__iter__",
          [](const Array& self) {
            nb::list members;
            for (const auto id : self.ids) members.append(sibling(self, id));
            return nb::iter(members);
          },
          nb::sig(("def __iter__(self) -> collections.abc.Iterator[" + std::string(member) + "]").c_str()))
      .def("__repr__", [name](const Array& self) {
        return "<" + std::string(name) + " of " + std::to_string(self.ids.size()) + ">";
      });
}

// --- the arrays -----------------------------------------------------------------------------------------------------------

template <class Array>
nb::class_<Array> bind_array(nb::module_& module, const char* name, const std::string& text) {
  nb::class_<Array> type(module, name, (text + copies).c_str(), nb::type_slots(handle_slots<Array>));
  def_sequence(type, name);
  return type;
}

void bind_particle_array(nb::module_& module) {
  auto type = bind_array<ParticleArray>(module, "ParticleArray",
                                        "An ordered list of particles; made by `System.particle_array` or "
                                        "`System.array`.");
  def_assigned(type, "positions", Quantity::position,
               "(n, 3), m. Assigning moves whole rings, as `Particle.position` does.");
  def_assigned(type, "velocities", Quantity::velocity, "(n, 3), m/s.");
  def_assigned(type, "masses", Quantity::mass, "(n,), kg.");
  def_read(type, "forces", Quantity::force, "(n, 3): sum of all forces on each one's mass in the last step, N.");
  def_applied(type, "apply_forces", Quantity::force, "forces", "Adds forces, (n, 3), N, during the next step only.");
  type.def(
      "combine",
      [](const ParticleArray& self, const ParticleArray& others) {
        if (self.system != others.system) throw nb::value_error("combine takes particles of one system");
        return RestructureResult{self.system_object, self.system, self.change("combine").combine(self.ids, others.ids)};
      },
      "others"_a, "Hinges each with the one of the same index in another array. One report, all or nothing.");
}

void bind_body_array(nb::module_& module) {
  auto type = bind_array<BodyArray>(
      module, "BodyArray",
      "An ordered list of bodies; made by `System.rod_array` or `System.array`. Assigning moves each body\n"
      "independently: if the values of hinged bodies do not fit, the last one is used, and the next step closes the\n"
      "gap.");
  def_assigned(type, "positions", Quantity::position, "(n, 3): of the centers of mass, m.");
  def_assigned(type, "orientations", Quantity::orientation,
               "(n, 4): unit quaternions x y z w, see `Body.orientation`.");
  def_assigned(type, "velocities", Quantity::velocity, "(n, 3): of the centers of mass, m/s.");
  def_assigned(type, "angular_velocities", Quantity::angular_velocity, "(n, 3): rad/s, world axes.");
  def_assigned(type, "poses", Quantity::pose, "(n, 7): positions and orientations. Use it for hinged bodies.");
  def_assigned(type, "motions", Quantity::motion,
               "(n, 6): velocities and angular velocities. Use it for hinged bodies.");
  def_assigned(type, "masses", Quantity::mass, "(n,), kg; assigning scales the inertia too.");
  def_read(type, "forces", Quantity::force, "(n, 3): sum of all forces from outside in the last step, N.");
  def_read(type, "torques", Quantity::torque, "(n, 3): their moments about the centers of mass, N m.");
  def_read(
      type, "work", Quantity::work,
      "(n, 2): a measure of the work of the latest solution of each body's articulate, points times iterations, and the\n"
      "number of steps that it was for, see `Body.stride`; 0: it sleeps or is frozen.");
  def_applied(type, "apply_forces", Quantity::force, "forces",
              "Adds forces at the centers of mass, (n, 3), N, during the next step only.");
  def_applied(type, "apply_torques", Quantity::torque, "torques",
              "Adds torques, (n, 3), N m, during the next step only; see `Body.apply_torque`.");
  type.def_prop_ro(
      "particles",
      [](const BodyArray& self) {
        System& engine = self.system->use();
        ParticleArray all{self.system_object, self.system, {}};
        for (const BodyId body : self.ids)
          for (const ParticleId p : engine.bodies().particles(body)) all.ids.push_back(p);
        return all;
      },
      "Those of the first body, then those of the second ...; `rods.particles[1::2]` are the ends of rods.");
}

void bind_bond_array(nb::module_& module) {
  auto type = bind_array<BondArray>(module, "BondArray",
                                    "An ordered list of bonds; made by `System.bond_array` or "
                                    "`System.array`.");
  def_read(type, "forces", Quantity::force, "(n, 3): on the first particle of each, N; see `Bond.force`.");
  def_read(type, "distances", Quantity::length, "(n,): between the two ends, m.");
  type.def(
          "parameter",
          [](const BondArray& self, const std::string& name) {
            std::vector<double> numbers(self.ids.size());
            self.read().read(name, self.ids, numbers);
            return to_array(std::move(numbers), 1);
          },
          "name"_a, nb::sig("def parameter(self, name: str) -> numpy.typing.NDArray[numpy.float64]"),
          "(n,): a parameter of their laws.")
      .def(
          "set",
          [](const BondArray& self, const nb::kwargs& parameters) {
            for (const auto& [key, value] : parameters) {
              const std::string name = nb::cast<std::string>(key);
              nb::object array;
              auto numbers = to_numbers(value, self.ids.size(), 1, name.c_str(), array, true);
              const std::vector<double> all(self.ids.size(), numbers.empty() ? 0 : numbers[0]);
              if (numbers.size() != all.size()) numbers = all;
              self.change("set").assign(name, self.ids, numbers);
            }
          },
          "parameters"_a, nb::sig("def set(self, **parameters: float | numpy.typing.ArrayLike) -> None"),
          "Changes parameters of their laws: one number, or one for each.\n\n    springs.set(stiffness=stiffness, damping=1)");
}

void bind_joint_array(nb::module_& module) {
  auto type = bind_array<JointArray>(module, "JointArray", "An ordered list of joints; made by `System.array`.");
  const auto def = [&](const char* name, Quantity quantity, JointCoordinate which, const char* text) {
    type.def_prop_ro(
        name,
        [quantity, which](const JointArray& self) {
          std::vector<double> numbers(self.ids.size());
          self.read().read(quantity, which, self.ids, numbers);
          return to_array(std::move(numbers), 1);
        },
        nb::sig(getter_signature(name).c_str()), text);
  };
  def("angles", Quantity::value, JointCoordinate::angle, "(n,), rad; ValueError if one has none.");
  def("angle_speeds", Quantity::speed, JointCoordinate::angle, "(n,), rad/s.");
  def("angle_efforts", Quantity::effort, JointCoordinate::angle, "(n,), N m: see `JointCoordinate.effort`.");
  def("slides", Quantity::value, JointCoordinate::slide, "(n,), m; ValueError if one has none.");
  def("slide_speeds", Quantity::speed, JointCoordinate::slide, "(n,), m/s.");
  def("slide_efforts", Quantity::effort, JointCoordinate::slide, "(n,), N.");
}

// --- making ---------------------------------------------------------------------------------------------------------------

constexpr const char* make_particles_doc =
    "Many new bodies of one particle each.\n\n"
    "positions: (n, 3), m. velocities: (n, 3), m/s. masses: kg, one or (n,). kind, damping: as of `body`.\n\n"
    "    grains = system.particle_array(numpy.random.rand(100_000, 3), masses=1e-3)\n"
    "    grains.velocities = numpy.zeros((100_000, 3))";

constexpr const char* make_rods_doc =
    "Many new bodies of two particles each.\n\n"
    "starts, ends: (n, 3), m. masses: of each body, kg, one or (n,). radii: m, one or (n,): a solid cylinder, see\n"
    "`Body.set_rod`; 0: half of the mass at each end. kind, damping: as of `body`.\n\n"
    "    links = system.rod_array(places[:-1], places[1:], masses=0.1)\n"
    "    ends = links.particles\n"
    "    ends[1:-1:2].combine(ends[2::2])";

constexpr const char* make_bonds_doc =
    "Many new bonds of one law, between p[i] and q[i].\n\n"
    "law: as of `bond`, but not a function of the script. Parameters of the law: one number, an array (n,), or None\n"
    "for the distance now.\n\n"
    "    system.bond_array(knots[:-1], knots[1:], 'spring', stiffness=numpy.linspace(10, 20, 99), damping=0.1)";

template <class Rows>
void read_masses(Rows& rows, nb::handle masses, std::size_t count) {
  nb::object array;
  const auto numbers = to_numbers(masses, count, 1, "masses", array, true);
  rows.masses.assign(numbers.begin(), numbers.end());
}

/// An argument as an array of particles: a ParticleArray, or any sequence of handles.
std::vector<ParticleId> to_particles(const SystemObject& system, nb::handle value, const char* name) {
  const ParticleArray* array = nullptr;
  if (nb::try_cast<const ParticleArray*>(value, array) && array) {
    if (array->system != &system) throw nb::value_error((std::string(name) + " is of another system").c_str());
    return array->ids;
  }
  std::vector<ParticleId> ids;
  if (!PySequence_Check(value.ptr()) || PyUnicode_Check(value.ptr()))
    throw nb::type_error(
        (std::string(name) + " must be a ParticleArray or a list of particles, not " + describe(value)).c_str());
  for (nb::handle item : nb::borrow<nb::sequence>(value)) {
    const ParticleHandle* particle = nullptr;
    if (!nb::try_cast<const ParticleHandle*>(item, particle) || !particle)
      throw nb::type_error((std::string(name) + " must have particles only, not " + describe(item)).c_str());
    if (particle->system != &system) throw nb::value_error((std::string(name) + " is of another system").c_str());
    ids.push_back(particle->id);
  }
  return ids;
}

BondArray make_bonds(nb::handle_t<SystemObject> self, nb::object p, nb::object q, nb::object law,
                     std::optional<bool> implicit, const nb::kwargs& parameters) {
  SystemObject* system = nb::inst_ptr<SystemObject>(self);
  System& engine = system->use_between_steps("bond_array(...)");
  BondRows rows;
  rows.p = to_particles(*system, p, "p"), rows.q = to_particles(*system, q, "q");
  if (rows.p.size() != rows.q.size()) {
    const std::string text = "p and q must have the same length, not " + std::to_string(rows.p.size()) + " and " +
                             std::to_string(rows.q.size());
    throw nb::value_error(text.c_str());
  }
  rows.law.implicit = implicit;
  for (const auto& [key, value] : parameters) {
    const std::string name = nb::cast<std::string>(key);
    if (value.is_none()) {
      rows.law.parameters.push_back({name, std::numeric_limits<double>::quiet_NaN()});
      continue;
    }
    nb::object array;
    const auto numbers = to_numbers(value, rows.p.size(), 1, name.c_str(), array, true);
    const bool is_column = nb::cast<std::size_t>(nb::module_::import_("numpy").attr("ndim")(value)) == 1;
    rows.law.parameters.push_back({name, numbers.empty() ? 1 : numbers[0]});
    if (is_column) rows.columns.push_back({name, {numbers.begin(), numbers.end()}});
  }
  const LawHandle* shared = nullptr;
  if (nb::isinstance<nb::str>(law)) {
    rows.law.law = law_of_text(*system, nb::cast<std::string>(law), rows.law.parameters);
  } else if (nb::try_cast<const LawHandle*>(law, shared) && shared) {
    shared->use();
    if (shared->system != system) throw nb::value_error("a bond takes a law of its own system");
    rows.law.law = shared->id;
  } else {
    throw nb::type_error(("law must be a predefined law, an expression or a Law, not " + describe(law)).c_str());
  }
  require_stiffness(engine, rows.law.law, rows.law.parameters);
  return {nb::borrow(self), system, engine.many().create_bonds(rows)};
}

template <class HandleType, class Array>
bool try_array(nb::handle_t<SystemObject> self, const nb::list& items, nb::object& array) {
  const HandleType* first = nullptr;
  if (!nb::try_cast<const HandleType*>(items[0], first) || !first) return false;
  Array all{nb::borrow(self), nb::inst_ptr<SystemObject>(self), {}};
  for (nb::handle item : items) {
    const HandleType* handle = nullptr;
    if (!nb::try_cast<const HandleType*>(item, handle) || !handle)
      throw nb::type_error(
          ("array takes handles of one kind, but got " + describe(items[0]) + " and " + describe(item)).c_str());
    if (handle->system != all.system) throw nb::value_error("array takes handles of its own system");
    all.ids.push_back(handle->id);
  }
  array = nb::cast(std::move(all));
  return true;
}

nb::object make_array_of(nb::handle_t<SystemObject> self, const nb::iterable& handles) {
  const nb::list items = nb::list(handles);
  nb::object array;
  if (items.size() == 0) throw nb::value_error("array needs at least one handle, which gives its kind");
  if (try_array<ParticleHandle, ParticleArray>(self, items, array) ||
      try_array<BodyHandle, BodyArray>(self, items, array) || try_array<BondHandle, BondArray>(self, items, array) ||
      try_array<ConstraintHandle, JointArray>(self, items, array))
    return array;
  throw nb::type_error(("array takes particles, bodies, bonds or joints, not " + describe(items[0])).c_str());
}

void bind_array_makers(nb::class_<SystemObject>& system) {
  system.def("array", &make_array_of, "handles"_a,
             nb::sig("def array(self, handles: collections.abc.Iterable[Particle] | collections.abc.Iterable[Body] | "
                     "collections.abc.Iterable[Bond] | collections.abc.Iterable[Constraint]) -> typing.Any"),
             "A ParticleArray, BodyArray, BondArray or JointArray of handles of one kind, in their order.\n\n"
             "    bodies = system.array(system.bodies)\n"
             "    bodies.velocities = numpy.zeros((len(bodies), 3))");
  system.def(
      "particle_array",
      [](nb::handle_t<SystemObject> self, RowsArgument positions, ColumnArgument masses, nb::object velocities,
         const KindWord& kind, double damping) {
        SystemObject* system = nb::inst_ptr<SystemObject>(self);
        System& engine = system->use_between_steps("particle_array(...)");
        const std::size_t count = row_count(positions.value, "positions");
        nb::object array;
        PointRows rows;
        rows.body = {to_kind(kind), finite_not_negative(damping, "damping", "1/s")};
        rows.positions = to_vectors(to_numbers(positions.value, count, 3, "positions", array));
        if (!velocities.is_none()) rows.velocities = to_vectors(to_numbers(velocities, count, 3, "velocities", array));
        read_masses(rows, masses.value, count);
        return ParticleArray{nb::borrow(self), system, engine.many().create_points(rows)};
      },
      "positions"_a, nb::kw_only(), "masses"_a = 1.0, "velocities"_a = nb::none(), "kind"_a = KindWord{"dynamic"},
      "damping"_a = 0.0,
      nb::sig(
          "def particle_array(self, positions: numpy.typing.ArrayLike, *, masses: float | numpy.typing.ArrayLike = 1.0, "
          "velocities: numpy.typing.ArrayLike | None = None, "
          "kind: typing.Literal['dynamic', 'static', 'scripted', 'inactive', 'resting'] = 'dynamic', "
          "damping: float = 0.0) -> ParticleArray"),
      make_particles_doc);
  system.def(
      "rod_array",
      [](nb::handle_t<SystemObject> self, RowsArgument starts, RowsArgument ends, ColumnArgument masses,
         ColumnArgument radii, const KindWord& kind, double damping) {
        SystemObject* system = nb::inst_ptr<SystemObject>(self);
        System& engine = system->use_between_steps("rod_array(...)");
        const std::size_t count = row_count(starts.value, "starts");
        nb::object array;
        RodRows rows;
        rows.body = {to_kind(kind), finite_not_negative(damping, "damping", "1/s")};
        rows.starts = to_vectors(to_numbers(starts.value, count, 3, "starts", array));
        rows.ends = to_vectors(to_numbers(ends.value, count, 3, "ends", array));
        read_masses(rows, masses.value, count);
        const auto numbers = to_numbers(radii.value, count, 1, "radii", array, true);
        rows.radii.assign(numbers.begin(), numbers.end());
        return BodyArray{nb::borrow(self), system, engine.many().create_rods(rows)};
      },
      "starts"_a, "ends"_a, nb::kw_only(), "masses"_a = 1.0, "radii"_a = 0.0, "kind"_a = KindWord{"dynamic"},
      "damping"_a = 0.0,
      nb::sig("def rod_array(self, starts: numpy.typing.ArrayLike, ends: numpy.typing.ArrayLike, *, "
              "masses: float | numpy.typing.ArrayLike = 1.0, radii: float | numpy.typing.ArrayLike = 0.0, "
              "kind: typing.Literal['dynamic', 'static', 'scripted', 'inactive', 'resting'] = 'dynamic', "
              "damping: float = 0.0) -> BodyArray"),
      make_rods_doc);
  system.def("bond_array", &make_bonds, "p"_a, "q"_a, "law"_a, nb::kw_only(), "implicit"_a = nb::none(), "parameters"_a,
             nb::sig("def bond_array(self, p: ParticleArray | collections.abc.Sequence[Particle], "
                     "q: ParticleArray | collections.abc.Sequence[Particle], law: str | Law, *, "
                     "implicit: bool | None = None, **parameters: float | numpy.typing.ArrayLike | None) -> BondArray"),
             make_bonds_doc);
}

}  // namespace

void bind_arrays(nb::module_& module) {
  bind_particle_array(module);
  bind_body_array(module);
  bind_bond_array(module);
  bind_joint_array(module);
  auto system = nb::borrow<nb::class_<SystemObject>>(module.attr("System"));
  bind_array_makers(system);
}

}  // namespace iota::bindings
