// SPDX-License-Identifier: Apache-2.0
// Groups of particles, and forces on them: fields and pairwise forces.
#include "batch_view.h"
#include "law_argument.h"

#include <algorithm>

namespace iota::bindings {

namespace {

constexpr const char* group_doc =
    "A named set of particles, on which fields and pair forces act; made by `System.group`.";

constexpr const char* make_group_doc =
    "A new named set of particles, on which fields and pair forces act. A system has at most 32 at a time.\n\n"
    "    fish = system.group('fish')\n"
    "    fish.add(p, q)";

constexpr const char* field_doc = "A force on each particle of a group, or on all; made by `System.field`.";

constexpr const char* make_field_doc =
    "A new force on each particle of a group, or on all, by itself; taken once a step and held. Particles that are hinged\n"
    "together count as one, with their total mass.\n\n"
    "field is one of\n"
    "- a predefined one: 'uniform' (acceleration), 'wind' (velocity, drag), 'current' (turbulent: velocity, drag, speed, size,\n"
    "  octaves, evolution, seed), 'well' (center, strength, softening: a heavy point), 'attractor' (center, strength, range);\n"
    "- an expression of x, y, z, vx, vy, vz, m, t and parameters that defines energy (J; the force is its negative\n"
    "  gradient), or fx, fy, fz (N), or both;\n"
    "- a function of NumPy arrays, called once a step with a ParticleBatch; it returns the forces, shape (n, 3), N;\n"
    "- compiled code, see docs/forces.md.\n\n"
    "Parameters are keywords; a vector stands for its three: velocity=(1, 0, 0). replaces_gravity=True makes it the default\n"
    "force of all particles instead of gravity.\n\n"
    "    system.field('wind', velocity=(3, 0, 0), drag=0.05, group=leaves)\n"
    "    system.field('fy = -m*g*(1 - y/h)', g=9.81, h=100, replaces_gravity=True)";

constexpr const char* pair_force_doc =
    "A force between all near pairs of particles of a group; made by `System.pair_force`.";

constexpr const char* make_pair_force_doc =
    "A new force between all pairs of particles of a group, or of all, that are nearer than `cutoff` (m); evaluated\n"
    "once a step and held. law is a predefined law, an expression or a Law with a derivative, as for `bond`. Not\n"
    "between points of one body. other: only pairs of one of `group` and one of this group. shifted: a constant and a\n"
    "linear term are subtracted from the energy, so that it and the force are zero at the cut-off and do not jump\n"
    "there; for laws that have an energy and do not depend on masses.\n\n"
    "    system.pair_force('lennard_jones', cutoff=2.5, shifted=True, depth=1, size=1)";

constexpr const char* particle_batch_doc =
    "The argument of a field's function: arrays with a row for each particle, in the order of `particles`. Valid\n"
    "only until the function returns; the arrays are copies and may be kept.";

struct ParticlesView : BatchView<ParticleBatch> {
  const ParticleBatch& use() const { return BatchView::use("ParticleBatch"); }
};

void bind_particle_batch(nb::module_& module) {
  nb::class_<ParticlesView>(module, "ParticleBatch", particle_batch_doc)
      .def("__len__", [](const ParticlesView& self) { return self.use().count; })
      .def_prop_ro(
          "position", [](const ParticlesView& self) { return copy_rows(self.use().position, self.use().count); },
          nb::sig("def position(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, 3), m; extrapolated by half a step in the energy-keeping mode.")
      .def_prop_ro(
          "velocity", [](const ParticlesView& self) { return copy_rows(self.use().velocity, self.use().count); },
          nb::sig("def velocity(self) -> numpy.typing.NDArray[numpy.float64]"), "(n, 3), m/s.")
      .def_prop_ro(
          "mass",
          [](const ParticlesView& self) {
            const ParticleBatch& b = self.use();
            return make_array(std::vector<double>(b.mass, b.mass + b.count));
          },
          nb::sig("def mass(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,), kg.")
      .def_prop_ro(
          "time", [](const ParticlesView& self) { return self.use().time; },
          "Of the positions, s: at the start of the step in the robust mode, else in its middle.")
      .def_prop_ro(
          "dt", [](const ParticlesView& self) { return self.use().dt; }, "Length of the step, s.")
      .def_prop_ro(
          "particles",
          [](const ParticlesView& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system,
                                            std::span(self.use().particles, self.use().count));
          },
          "The particles; of those hinged together, the first.");
}

FieldFunction make_field_function(SystemObject* system, std::shared_ptr<ScriptFunction> function) {
  return [system, function = std::move(function)](const ParticleBatch& batch) {
    ask_for_forces(function, ParticlesView{{{}, system, &batch}}, "particle");
  };
}

std::optional<GroupId> to_group(nb::handle group, const SystemObject* system) {
  if (group.is_none()) return std::nullopt;
  const GroupHandle* handle = nullptr;
  if (!nb::try_cast<const GroupHandle*>(group, handle) || !handle)
    throw nb::type_error(("group must be a Group or None, not " + describe(group)).c_str());
  handle->use();
  if (handle->system != system) throw nb::value_error("group must be of the same system");
  return handle->id;
}

/// As `to_parameters`; a vector is three parameters with _x, _y, _z at the ends of their names.
std::vector<LawParameter> to_field_parameters(const nb::kwargs& keywords) {
  std::vector<LawParameter> list;
  for (const auto& [key, value] : keywords) {
    const std::string name = nb::cast<std::string>(key);
    double number = 0;
    Vec3 vector;
    if (nb::try_cast<double>(value, number)) {
      list.push_back({name, finite(number, name.c_str())});
    } else if (try_vec3(value, vector)) {
      to_vec3({value}, name.c_str());  // refuses what is not finite
      list.push_back({name + "_x", vector.x});
      list.push_back({name + "_y", vector.y});
      list.push_back({name + "_z", vector.z});
    } else {
      throw nb::type_error((name + " must be a number or a vector, not " + describe(nb::handle(value))).c_str());
    }
  }
  return list;
}

FieldHandle make_field(nb::handle_t<SystemObject> self, nb::object field, nb::handle group, bool replaces_gravity,
                       const std::string& name, const nb::kwargs& keywords) {
  SystemObject* system = nb::inst_ptr<SystemObject>(self);
  System& engine = system->use_between_steps("field(...)");
  FieldOptions options{name, to_field_parameters(keywords), to_group(group, system), replaces_gravity};
  FieldId id;
  if (nb::isinstance<nb::str>(field)) {
    id = engine.fields().create(nb::cast<std::string>(field), options);
  } else if (const std::uintptr_t address = address_of(field)) {
    using Code = void (*)(std::int64_t count, double t, const double* position, const double* velocity,
                          const double* mass, double* force);
    if (name.empty()) options.name = function_name(field).substr(0, 31);
    id = engine.fields().create(FieldFunction([code = reinterpret_cast<Code>(address)](const ParticleBatch& b) {
                                  code(static_cast<std::int64_t>(b.count), b.time, b.position, b.velocity, b.mass,
                                       b.force);
                                }),
                                options);
    system->code.push_back(field);
  } else if (PyCallable_Check(field.ptr())) {
    if (name.empty()) options.name = function_name(field).substr(0, 31);
    auto function = std::make_shared<ScriptFunction>(ScriptFunction{field, "field " + options.name});
    system->keep(function);
    id = function->field = engine.fields().create(make_field_function(system, function), options);
  } else {
    throw nb::type_error(
        ("field must be a predefined field, an expression or a function of arrays, not " + describe(field)).c_str());
  }
  return handle_of(self, id);
}

PairsHandle make_pair_force(nb::handle_t<SystemObject> self, nb::object law, double cutoff, nb::handle group,
                            nb::handle other, bool shifted, const nb::kwargs& keywords) {
  SystemObject* system = nb::inst_ptr<SystemObject>(self);
  System& engine = system->use_between_steps("pair_force(...)");
  finite_positive(cutoff, "cutoff", "m");
  SharedLaw shared;
  shared.parameters = to_parameters(keywords);
  const LawHandle* handle = nullptr;
  if (nb::isinstance<nb::str>(law)) {
    shared.law = law_of_text(*system, nb::cast<std::string>(law), shared.parameters);
  } else if (nb::try_cast<const LawHandle*>(law, handle) && handle) {
    handle->use();
    if (handle->system != system) throw nb::value_error("a pair force takes a law of its own system");
    shared.law = handle->id;
  } else {
    throw nb::type_error(("law must be a predefined law, an expression or a Law, not " + describe(law)).c_str());
  }
  return handle_of(self,
                   engine.pairs().create(shared, {cutoff, to_group(group, system), to_group(other, system), shifted}));
}

/// Makes all of several changes or none.
template <class HandleType>
void set_all(const HandleType& self, const std::vector<LawParameter>& changes) {
  auto view = view_of(self.use(), self.id);
  self.system->use_between_steps("set");
  const std::vector<LawParameter> before = view.parameters(self.id);
  try {
    for (const LawParameter& c : changes) view.set_parameter(self.id, c.name, c.value);
  } catch (...) {
    for (const LawParameter& b : before) view.set_parameter(self.id, b.name, b.value);
    throw;
  }
}

/// The common parts of fields and pair forces.
template <class HandleType>
void def_force(nb::class_<HandleType>& type) {
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const HandleType& self) { return self.is_alive(); }, "False once it was destroyed.")
      .def_prop_rw(
          "active", [](const HandleType& self) { return view_of(self.use(), self.id).is_active(self.id); },
          [](const HandleType& self, bool active) { view_of(self.use(), self.id).set_active(self.id, active); },
          "False while it is switched off.")
      .def_prop_ro(
          "parameters",
          [](const HandleType& self) { return to_dict(view_of(self.use(), self.id).parameters(self.id)); },
          nb::sig("def parameters(self) -> dict[str, float]"), "A copy; change them with `set`.")
      .def("destroy", [](const HandleType& self) { view_of(self.use(), self.id).destroy(self.id); }, "Removes it.");
}

template <class Add>
void each_particle(const GroupHandle& self, const nb::args& particles, const char* call, Add add) {
  self.use();
  System& engine = self.system->use_between_steps(call);
  for (const nb::handle item : particles) {
    const ParticleHandle* particle = nullptr;
    const BodyHandle* body = nullptr;
    if (nb::try_cast<const ParticleHandle*>(item, particle) && particle) {
      particle->use();
      if (particle->system != self.system) throw nb::value_error("a group takes particles of its own system");
      add(engine, particle->id);
    } else if (nb::try_cast<const BodyHandle*>(item, body) && body) {
      body->use();
      if (body->system != self.system) throw nb::value_error("a group takes bodies of its own system");
      for (const ParticleId p : engine.bodies().particles(body->id)) add(engine, p);
    } else {
      throw nb::type_error(("a group takes particles and bodies, not " + describe(item)).c_str());
    }
  }
}

void bind_group(nb::module_& module) {
  nb::class_<GroupHandle> type(module, "Group", group_doc, nb::type_slots(handle_slots<GroupHandle>),
                               nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "group",
          [](nb::handle_t<SystemObject> self, const std::string& name) {
            return handle_of(self,
                             nb::inst_ptr<SystemObject>(self)->use_between_steps("group(...)").groups().create(name));
          },
          "name"_a, make_group_doc);
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const GroupHandle& self) { return self.is_alive(); }, "False once it was destroyed.")
      .def_prop_ro("name", [](const GroupHandle& self) { return self.use().groups().name(self.id); })
      .def(
          "add",
          [](const GroupHandle& self, const nb::args& members) {
            each_particle(self, members, "add to a group",
                          [&](System& engine, ParticleId p) { engine.groups().add(self.id, p); });
          },
          "members"_a, nb::sig("def add(self, *members: Particle | Body) -> None"),
          "Adds particles, and all particles of bodies.")
      .def(
          "remove",
          [](const GroupHandle& self, const nb::args& members) {
            each_particle(self, members, "remove from a group",
                          [&](System& engine, ParticleId p) { engine.groups().remove(self.id, p); });
          },
          "members"_a, nb::sig("def remove(self, *members: Particle | Body) -> None"),
          "Removes particles; those that are not in it are skipped.")
      .def("__contains__",
           [](const GroupHandle& self, const ParticleHandle& particle) {
             particle.use();
             return particle.system == self.system && self.use().groups().contains(self.id, particle.id);
           })
      .def("__len__", [](const GroupHandle& self) { return self.use().groups().particles(self.id).size(); })
      .def_prop_ro(
          "particles",
          [](const GroupHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().groups().particles(self.id));
          },
          "In the order of slots.")
      .def(
          "destroy", [](const GroupHandle& self) { self.use().groups().destroy(self.id); },
          "Removes the group, not the particles. Raises ValueError while a force acts on it.")
      .def("__repr__", [](const GroupHandle& self) {
        if (!self.is_alive()) return stale_repr("Group", self);
        return "<Group '" + self.system->engine.groups().name(self.id) + "' of " +
               std::to_string(self.system->engine.groups().particles(self.id).size()) + " particles>";
      });
}

void bind_field(nb::module_& module) {
  nb::class_<FieldHandle> type(module, "Field", field_doc, nb::type_slots(handle_slots<FieldHandle>),
                               nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def("field", &make_field, "field"_a, nb::kw_only(), "group"_a = nb::none(), "replaces_gravity"_a = false,
           "name"_a = "", "parameters"_a,
           nb::sig("def field(self, field: str | int | collections.abc.Callable[[ParticleBatch], "
                   "numpy.typing.ArrayLike], *, group: Group | None = None, replaces_gravity: bool = False, "
                   "name: str = '', **parameters: float | Vec3 | collections.abc.Sequence[float]) -> Field"),
           make_field_doc);
  def_force(type);
  type.def_prop_ro("name", [](const FieldHandle& self) { return self.use().fields().name(self.id); })
      .def_prop_ro(
          "kind", [](const FieldHandle& self) { return self.use().fields().kind(self.id); },
          nb::sig("def kind(self) -> typing.Literal['predefined', 'expression', 'function']"), "What it was made of.")
      .def_prop_ro(
          "text", [](const FieldHandle& self) { return self.use().fields().text(self.id); },
          "The name of the predefined one, or the expression; empty for code.")
      .def_prop_ro(
          "function",
          [](const FieldHandle& self) -> nb::object {
            self.use();
            for (const auto& script : self.system->functions)
              if (script->field == self.id) return script->function;
            return nb::none();
          },
          nb::sig("def function(self) -> collections.abc.Callable[[ParticleBatch], numpy.typing.ArrayLike] | None"),
          "The function of the script, or None.")
      .def_prop_ro(
          "group", [](const FieldHandle& self) { return sibling_or_none(self, self.use().fields().group(self.id)); },
          nb::sig("def group(self) -> Group | None"), "The particles that it acts on; None: all.")
      .def_prop_ro(
          "replaces_gravity", [](const FieldHandle& self) { return self.use().fields().replaces_gravity(self.id); },
          "Whether the system's gravity does not act while it is active.")
      .def(
          "set",
          [](const FieldHandle& self, const nb::kwargs& keywords) { set_all(self, to_field_parameters(keywords)); },
          "parameters"_a,
          nb::sig("def set(self, **parameters: float | Vec3 | collections.abc.Sequence[float]) -> None"),
          "Changes parameters.\n\n    wind.set(velocity=(5, 0, 0))")
      .def("__repr__", [](const FieldHandle& self) {
        if (!self.is_alive()) return stale_repr("Field", self);
        const std::string name = self.system->engine.fields().name(self.id);
        return "<Field " + std::to_string(self.id.slot) + (name.empty() ? ">" : " " + name + ">");
      });
}

void bind_pair_force(nb::module_& module) {
  nb::class_<PairsHandle> type(module, "PairForce", pair_force_doc, nb::type_slots(handle_slots<PairsHandle>),
                               nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def("pair_force", &make_pair_force, "law"_a, nb::kw_only(), "cutoff"_a, "group"_a = nb::none(),
           "other"_a = nb::none(), "shifted"_a = false, "parameters"_a,
           nb::sig("def pair_force(self, law: str | Law, *, cutoff: float, group: Group | None = None, "
                   "other: Group | None = None, shifted: bool = False, "
                   "**parameters: float) -> PairForce"),
           make_pair_force_doc);
  def_force(type);
  type.def_prop_ro(
          "law", [](const PairsHandle& self) { return sibling(self, self.use().pairs().law(self.id)); }, "Its Law.")
      .def_prop_ro(
          "cutoff", [](const PairsHandle& self) { return self.use().pairs().cutoff(self.id); }, "m")
      .def_prop_ro(
          "group", [](const PairsHandle& self) { return sibling_or_none(self, self.use().pairs().group(self.id)); },
          nb::sig("def group(self) -> Group | None"), "The particles that it acts on; None: all.")
      .def_prop_ro(
          "other", [](const PairsHandle& self) { return sibling_or_none(self, self.use().pairs().other(self.id)); },
          nb::sig("def other(self) -> Group | None"), "Set: only pairs of one of `group` and one of this group.")
      .def_prop_ro(
          "shifted", [](const PairsHandle& self) { return self.use().pairs().is_shifted(self.id); },
          "Whether its energy and force are zero at the cut-off and do not jump there.")
      .def_prop_ro(
          "energy", [](const PairsHandle& self) { return self.use().pairs().energy(self.id); },
          "Of all pairs within the cut-off at present, J; part of `System.energy.potential`.")
      .def(
          "set", [](const PairsHandle& self, const nb::kwargs& keywords) { set_all(self, to_parameters(keywords)); },
          "parameters"_a, nb::sig("def set(self, **parameters: float) -> None"), "Changes parameters of its law.")
      .def("__repr__", [](const PairsHandle& self) {
        if (!self.is_alive()) return stale_repr("PairForce", self);
        const System& engine = self.system->engine;
        return "<PairForce " + std::to_string(self.id.slot) + " " + engine.laws().name(engine.pairs().law(self.id)) +
               ">";
      });
}

}  // namespace

void def_fields(nb::class_<SystemObject>& system) {
  const auto def_list = [&]<class HandleType>(const char* name, const char* type, HandleType) {
    system.def_prop_ro(
        name,
        [](SystemObject& self) {
          return wrap_all<HandleType>(nb::find(&self), &self, view_of(self.use(), HandleType{}.id).ids());
        },
        nb::sig((std::string("def ") + name + "(self) -> list[" + type + "]").c_str()), "In the order of slots.");
  };
  def_list("groups", "Group", GroupHandle{});
  def_list("fields", "Field", FieldHandle{});
  def_list("pair_forces", "PairForce", PairsHandle{});
  system.def(
      "rehearse",
      [](SystemObject& self, nb::handle force, double dt) -> std::size_t {
        System& engine = self.use_between_steps("rehearse");
        const LawHandle* law = nullptr;
        const FieldHandle* field = nullptr;
        const PairsHandle* pairs = nullptr;
        self.failures.clear();
        if (nb::try_cast<const LawHandle*>(force, law) && law) return engine.laws().rehearse(law->id, dt);
        if (nb::try_cast<const FieldHandle*>(force, field) && field) return engine.fields().rehearse(field->id, dt);
        if (nb::try_cast<const PairsHandle*>(force, pairs) && pairs) return engine.pairs().rehearse(pairs->id, dt);
        throw nb::type_error(("rehearse takes a Law, a Field or a PairForce, not " + describe(force)).c_str());
      },
      "force"_a, "dt"_a = 1.0 / 120,
      nb::sig("def rehearse(self, force: Law | Field | PairForce, dt: float = ...) -> int"),
      "Evaluates forces without applying them, to measure their cost; see `profile`. Returns the number of bonds or\n"
      "particles.");
  system.def(
      "profile",
      [](nb::handle self, double dt) { return nb::module_::import_("iota.profiling").attr("profile")(self, dt); },
      "dt"_a = 1.0 / 120, nb::sig("def profile(self, dt: float = ...) -> typing.Any"),
      "The cost of each law, field and pair force, in ns for each bond or particle: an iota.types.ForceProfile.\n"
      "Forces are evaluated repeatedly at the present state, without being applied; functions of the script are\n"
      "called. Implicit bonds: force and stiffness once, as in each iteration of the solver.\n\n"
      "    print(system.profile())");
}

void bind_fields(nb::module_& module) {
  bind_particle_batch(module);
  bind_group(module);
  bind_field(module);
  bind_pair_force(module);
}

}  // namespace iota::bindings
