// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "bond_view.h"
#include "law_argument.h"
#include "restructure_result.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::bindings {

namespace {

constexpr const char* bond_doc = "A force between two particles, equal and opposite; made by `System.bond`.";

constexpr const char* make_bond_doc =
    "A new force between two particles, equal and opposite.\n\n"
    "law: a name, an expression such as 'energy = 0.5*k*(r - r0)^2', a Law, or a function of the script, called once\n"
    "a step with a BondState; it returns the force on p in N. A name is that of a predefined law ('spring', 'drag',\n"
    "'dashpot', 'tether', 'soft_repulsion', 'gravity', 'coulomb', 'lennard_jones', 'morse', 'attract_repel'), of a\n"
    "law made by `law(..., name=...)`, or of a function of the calling script. Parameters of the law are keywords;\n"
    "None is the present distance. Laws with a derivative are solved implicitly, unless implicit=False: any stiffness\n"
    "is stable. A function that raises, or a law without a finite force, switches the bond off, and `System.step`\n"
    "raises BondError. docs/forces.md lists the costs.\n\n"
    "    system.bond(p, q, 'spring', stiffness=200, damping=1)\n"
    "    system.bond(p, q, 'energy = k*(r - r0)^4; force = -c*v', k=50, r0=None, c=0.1)\n"
    "    system.bond(p, q, lambda bond: 50 * (bond.distance - 1) * bond.direction)";

constexpr const char* state_doc =
    "The argument of a bond's function: its two ends. In the energy-keeping mode positions are those of the middle of\n"
    "the step, extrapolated by half a step; see docs/forces.md.";

/// Checks that both ends exist and are of this system.
void check_ends(const SystemObject& self, const ParticleHandle& p, const ParticleHandle& q, const char* what) {
  check_one_system(p, q, what);
  p.use(), q.use();
  if (p.system != &self)
    throw nb::value_error((std::string(what) + ": the particles belong to another system").c_str());
}

/// The local or global function of the calling script with that name, for words that are not names of laws. Null if
/// there is none. Source: thesis, Fig. D.1.
nb::object function_called(const System& engine, const std::string& word) {
  if (word.find('=') != std::string::npos) return {};
  try {
    (void)engine.laws().find(word);
    return {};
  } catch (const std::invalid_argument&) {
  }
  for (PyObject* names : {PyEval_GetLocals(), PyEval_GetGlobals()}) {
    PyObject* found = names ? PyDict_GetItemString(names, word.c_str()) : nullptr;
    if (found && PyCallable_Check(found)) return nb::borrow(found);
  }
  return {};
}

BondHandle make_bond(SystemObject& self, const ParticleHandle& p, const ParticleHandle& q, nb::object law,
                     std::optional<bool> implicit, double break_force, const nb::kwargs& keywords) {
  check_ends(self, p, q, "bond");
  System& engine = self.use_between_steps("bond(...)");
  std::vector<LawParameter> parameters = to_parameters(keywords);
  std::shared_ptr<BondFunction> function;
  BondLaw engine_law;
  const LawHandle* shared = nullptr;
  const std::string text = nb::isinstance<nb::str>(law) ? nb::cast<std::string>(law) : "";
  if (!text.empty())
    if (nb::object named = function_called(engine, text); named.is_valid()) law = named;
  if (nb::isinstance<nb::str>(law)) {
    const LawId id = law_of_text(self, text, parameters);
    engine_law = SharedLaw{id, std::move(parameters), implicit};
  } else if (nb::try_cast<const LawHandle*>(law, shared) && shared) {
    shared->use();
    if (shared->system != &self) throw nb::value_error("a bond takes a law of its own system");
    engine_law = SharedLaw{shared->id, std::move(parameters), implicit};
  } else if (PyCallable_Check(law.ptr())) {
    if (!parameters.empty()) throw nb::type_error(("a function has no " + parameters.front().name).c_str());
    if (implicit.value_or(false)) throw nb::value_error("a function has no derivative: its bond cannot be implicit");
    const std::string name = function_name(law);
    function = std::make_shared<BondFunction>(BondFunction{{law, "function " + name}, {}, p.id, q.id});
    self.keep(function);
    engine_law = self.make_scripted_law(function, name);
  } else {
    throw nb::type_error(
        ("law must be a predefined law, an expression, a Law or a function, not " + describe(law)).c_str());
  }
  if (const auto* chosen = std::get_if<SharedLaw>(&engine_law))
    require_stiffness(engine, chosen->law, chosen->parameters);
  const BondId id = engine.bonds().create(p.id, q.id, std::move(engine_law));
  if (function) function->bond = id;
  if (std::isfinite(break_force)) engine.bonds().set_break_force(id, break_force);
  return sibling(p, id);
}

void set_parameters(const BondHandle& self, const nb::kwargs& keywords) {
  System& engine = self.use();
  self.system->use_between_steps("set of a bond");
  const std::vector<LawParameter> changes = to_parameters(keywords);
  const auto [p, q] = engine.bonds().ends(self.id);
  const double distance = norm(engine.particles().position(q) - engine.particles().position(p));
  std::vector<LawParameter> before = engine.bonds().parameters(self.id);
  try {
    for (const LawParameter& c : changes)
      engine.bonds().set_parameter(self.id, c.name, std::isnan(c.value) ? distance : c.value);
  } catch (...) {  // all or none
    for (const LawParameter& b : before) engine.bonds().set_parameter(self.id, b.name, b.value);
    throw;
  }
}

std::string repr_bond(const BondHandle& self) {
  if (!self.is_alive()) return stale_repr("Bond", self);
  const auto [p, q] = self.system->engine.bonds().ends(self.id);
  return "<Bond " + std::to_string(self.id.slot) + " between particles " + std::to_string(p.slot) + " and " +
         std::to_string(q.slot) + (self.system->engine.bonds().is_active(self.id) ? ">" : ", switched off>");
}

void bind_bond(nb::module_& module) {
  nb::class_<BondHandle> type(module, "Bond", bond_doc, nb::type_slots(handle_slots<BondHandle>),
                              nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def("bond", &make_bond, "p"_a, "q"_a, "law"_a, nb::kw_only(), "implicit"_a = nb::none(),
           "break_force"_a = std::numeric_limits<double>::infinity(), "parameters"_a,
           nb::sig("def bond(self, p: Particle, q: Particle, law: str | Law | "
                   "collections.abc.Callable[[BondState], Vec3 | collections.abc.Sequence[float] | "
                   "numpy.typing.NDArray[numpy.float64]], *, implicit: bool | None = None, "
                   "break_force: float = float('inf'), **parameters: float | None) -> Bond"),
           make_bond_doc);
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const BondHandle& self) { return self.is_alive(); },
          "False once it or one of its ends was destroyed.")
      .def_prop_ro(
          "ends",
          [](const BondHandle& self) {
            const auto [p, q] = self.use().bonds().ends(self.id);
            return std::make_pair(sibling(self, p), sibling(self, q));
          },
          "The two particles.")
      .def_prop_rw(
          "active", [](const BondHandle& self) { return self.use().bonds().is_active(self.id); },
          [](const BondHandle& self, bool active) { self.use().bonds().set_active(self.id, active); },
          "False while it is switched off or broken; True repairs it.")
      .def_prop_ro(
          "force", [](const BondHandle& self) { return self.use().bonds().force(self.id); },
          "On its first particle, N (the second gets the opposite): of an implicit bond at present, of a held one in "
          "the last step.")
      .def_prop_rw(
          "break_force", [](const BondHandle& self) { return self.use().bonds().break_force(self.id); },
          [](const BondHandle& self, double force) {
            self.use();
            self.system->use_between_steps("break_force = ...").bonds().set_break_force(self.id, force);
          },
          "N; above it the bond is switched off at the end of a step: see `System.broken`. inf: never.")
      .def_prop_ro(
          "broken", [](const BondHandle& self) { return self.use().bonds().is_broken(self.id); },
          "By a load beyond break_force.")
      .def_prop_ro(
          "law", [](const BondHandle& self) { return sibling(self, self.use().bonds().law(self.id)); }, "Its Law.")
      .def_prop_ro(
          "implicit", [](const BondHandle& self) { return self.use().bonds().is_implicit(self.id); },
          "Whether it is solved together with the joints; otherwise it is evaluated once a step and held.")
      .def_prop_ro(
          "parameters", [](const BondHandle& self) { return to_dict(self.use().bonds().parameters(self.id)); },
          nb::sig("def parameters(self) -> dict[str, float]"), "A copy; change them with `set`.")
      .def("set", &set_parameters, "parameters"_a, nb::sig("def set(self, **parameters: float | None) -> None"),
           "Changes parameters of its law; None is the present distance.\n\n    bond.set(stiffness=500, length=None)")
      .def(
          "destroy", [](const BondHandle& self) { self.use().bonds().destroy(self.id); }, "Removes it.")
      .def("__repr__", &repr_bond);
}

void bind_bond_state(nb::module_& module) {
  nb::class_<BondView>(module, "BondState", state_doc)
      .def_prop_ro(
          "bond", [](const BondView& self) { return sibling(self, self.state.bond); }, "The bond itself.")
      .def_prop_ro(
          "p", [](const BondView& self) { return sibling(self, self.function->p); },
          "The particle that the returned force acts on.")
      .def_prop_ro(
          "q", [](const BondView& self) { return sibling(self, self.function->q); },
          "The particle that gets the opposite.")
      .def_prop_ro(
          "position_p", [](const BondView& self) { return self.state.position_p; }, "m")
      .def_prop_ro(
          "position_q", [](const BondView& self) { return self.state.position_q; }, "m")
      .def_prop_ro(
          "velocity_p", [](const BondView& self) { return self.state.velocity_p; }, "m/s")
      .def_prop_ro(
          "velocity_q", [](const BondView& self) { return self.state.velocity_q; }, "m/s")
      .def_prop_ro(
          "distance", [](const BondView& self) { return norm(self.state.position_q - self.state.position_p); }, "m")
      .def_prop_ro(
          "direction",
          [](const BondView& self) {
            const Vec3 line = self.state.position_q - self.state.position_p;
            const double length = norm(line);
            return length > 0 ? line * (1 / length) : Vec3{};
          },
          "Unit vector from p to q; zero if they coincide.")
      .def_prop_ro(
          "time", [](const BondView& self) { return self.state.time; },
          "Of the positions, s: at the start of the step in the robust mode, else in its middle.");
}

void bind_cosmetic_bond(nb::module_& module) {
  nb::class_<CosmeticBondHandle> type(
      module, "CosmeticBond",
      "A line drawn between two particles of one body, without a force; made by `System.cosmetic_bond`. Destroying\n"
      "lines can split the body, see `destroy`.",
      nb::type_slots(handle_slots<CosmeticBondHandle>), nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "cosmetic_bond",
          [](SystemObject& self, const ParticleHandle& p, const ParticleHandle& q) {
            check_ends(self, p, q, "cosmetic_bond");
            return sibling(p, self.use_between_steps("cosmetic_bond(...)").cosmetic_bonds().create(p.id, q.id));
          },
          "p"_a, "q"_a, "A new line between two particles of one body.");
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const CosmeticBondHandle& self) { return self.is_alive(); },
          "False once it or one of its ends was destroyed.")
      .def_prop_ro(
          "ends",
          [](const CosmeticBondHandle& self) {
            const auto [p, q] = self.use().cosmetic_bonds().ends(self.id);
            return std::make_pair(sibling(self, p), sibling(self, q));
          },
          "The two particles.")
      .def(
          "destroy",
          [](const CosmeticBondHandle& self) {
            return RestructureResult{self.system_object, self.system, self.use().cosmetic_bonds().destroy(self.id)};
          },
          "Removes it. If that disconnects its body's cosmetic bonds, the rigid body is split into two: the piece\n"
          "with the bond's first end stays this body, the other one is new. Particles connected to neither end go\n"
          "with the nearer piece; a solid and its attachments are one piece. Velocities do not change.")
      .def("__repr__", [](const CosmeticBondHandle& self) {
        if (!self.is_alive()) return stale_repr("CosmeticBond", self);
        const auto [p, q] = self.use().cosmetic_bonds().ends(self.id);
        return "<CosmeticBond " + std::to_string(self.id.slot) + " between particles " + std::to_string(p.slot) +
               " and " + std::to_string(q.slot) + ">";
      });
}

}  // namespace

void require_stiffness(const System& engine, LawId law, const std::vector<LawParameter>& given) {
  if (engine.laws().kind(law) != "predefined") return;
  const auto has = [](const std::vector<LawParameter>& list, const std::string& name) {
    return std::any_of(list.begin(), list.end(), [&](const LawParameter& p) { return p.name == name; });
  };
  const std::vector<LawParameter> known = engine.laws().parameters(law);
  for (const LawParameter& p : given)
    if (!has(known, p.name)) return;  // refused with a better text
  if (has(known, "stiffness") && !has(given, "stiffness"))
    throw nb::value_error(("a " + engine.laws().name(law) + " needs stiffness=..., N/m").c_str());
}

void bind_bonds(nb::module_& module) {
  bind_bond_state(module);
  bind_bond(module);
  bind_cosmetic_bond(module);
}

}  // namespace iota::bindings
