// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "bond_view.h"
#include "restructure_result.h"

#include <limits>

namespace iota::bindings {

namespace {

constexpr const char* bond_doc =
    "A force between two particles, equal and opposite.\n\n"
    "law: 'spring' (stiffness in N/m, damping in N s/m along the line, length in m at rest, None for the distance now),\n"
    "'drag' (damping in N s/m) or a function of the script, called once a step with a BondState; it returns the force on\n"
    "p in N. Springs and drags are solved implicitly: any stiffness is stable. A function that raises or gives no finite\n"
    "force switches the bond off, and `System.step` raises BondError. It costs about a microsecond a call.\n\n"
    "    iota.Bond(p, q, 'spring', stiffness=200, damping=1)\n"
    "    iota.Bond(p, q, lambda bond: 50 * (bond.distance - 1) * bond.direction)";

constexpr const char* state_doc = "What the function of a bond is shown: its two ends at the start of the step.";

struct LawArguments {
  std::optional<double> stiffness, damping, length;
};

[[noreturn]] void raise_unused(const char* law, const char* argument) {
  const std::string text = std::string("a ") + law + " has no " + argument;
  throw nb::type_error(text.c_str());
}

SpringLaw make_spring(const LawArguments& arguments) {
  SpringLaw law;
  if (arguments.stiffness) law.stiffness = finite_not_negative(*arguments.stiffness, "stiffness", "N/m");
  if (arguments.damping) law.damping = finite_not_negative(*arguments.damping, "damping", "N s/m");
  if (arguments.length) law.length = finite_not_negative(*arguments.length, "length", "m");
  return law;
}

DragLaw make_drag(const LawArguments& arguments) {
  if (arguments.stiffness) raise_unused("drag", "stiffness");
  if (arguments.length) raise_unused("drag", "length");
  DragLaw law;
  if (arguments.damping) law.damping = finite_not_negative(*arguments.damping, "damping", "N s/m");
  return law;
}

std::string function_name(nb::handle function) {
  nb::object name = nb::getattr(function, "__qualname__", nb::none());
  return name.is_none() ? nb::type_name(function.type()).c_str() : nb::str(name).c_str();
}

void make_bond(BondHandle* self, const ParticleHandle& p, const ParticleHandle& q, nb::object law,
               std::optional<double> stiffness, std::optional<double> damping, std::optional<double> length) {
  check_one_system(p, q, "Bond");
  p.use();
  q.use();
  System& engine = p.system->use_between_steps("Bond(...)");
  const LawArguments arguments{stiffness, damping, length};
  std::shared_ptr<BondFunction> function;
  BondLaw engine_law;
  if (nb::isinstance<nb::str>(law)) {
    const std::string word = nb::cast<std::string>(law);
    if (word == "spring")
      engine_law = make_spring(arguments);
    else if (word == "drag")
      engine_law = make_drag(arguments);
    else
      throw nb::value_error(("law must be 'spring', 'drag' or a function, not '" + word + "'").c_str());
  } else if (PyCallable_Check(law.ptr())) {
    if (stiffness) raise_unused("function", "stiffness");
    if (damping) raise_unused("function", "damping");
    if (length) raise_unused("function", "length");
    function = std::make_shared<BondFunction>(BondFunction{law, {}, p.id, q.id});
    p.system->keep(function);
    engine_law = p.system->make_scripted_law(function, function_name(law));
  } else {
    throw nb::type_error(("law must be 'spring', 'drag' or a function, not " + describe(law)).c_str());
  }
  const BondId id = engine.create_bond(p.id, q.id, std::move(engine_law));
  if (function) function->bond = id;
  new (self) BondHandle{p.system_object, p.system, id};
}

std::string repr(const BondHandle& self) {
  if (!self.is_alive()) return stale_repr("Bond", self);
  const auto [p, q] = self.system->engine.ends(self.id);
  return "<Bond " + std::to_string(self.id.slot) + " between particles " + std::to_string(p.slot) + " and " +
         std::to_string(q.slot) + (self.system->engine.is_active(self.id) ? ">" : ", switched off>");
}

void bind_bond(nb::module_& module) {
  nb::class_<BondHandle> type(module, "Bond", bond_doc, nb::type_slots(handle_slots<BondHandle>),
                              nb::is_weak_referenceable());
  type.def("__init__", &make_bond, "p"_a, "q"_a, "law"_a, nb::kw_only(), "stiffness"_a = nb::none(),
           "damping"_a = nb::none(), "length"_a = nb::none(),
           nb::sig("def __init__(self, p: Particle, q: Particle, law: str | "
                   "collections.abc.Callable[[BondState], Vec3 | collections.abc.Sequence[float] | "
                   "numpy.typing.NDArray[numpy.float64]], *, stiffness: float | None = None, "
                   "damping: float | None = None, length: float | None = None) -> None"));
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const BondHandle& self) { return self.is_alive(); },
          "False once it or one of its ends was destroyed.")
      .def_prop_ro(
          "ends",
          [](const BondHandle& self) {
            const auto [p, q] = self.use().ends(self.id);
            return std::make_pair(sibling(self, p), sibling(self, q));
          },
          "The two particles.")
      .def_prop_rw(
          "active", [](const BondHandle& self) { return self.use().is_active(self.id); },
          [](const BondHandle& self, bool active) {
            self.use();
            self.system->use_between_steps("active = ...").set_active(self.id, active);
          },
          "False while it is switched off.")
      .def(
          "destroy", [](const BondHandle& self) { self.use().destroy(self.id); }, "Removes it.")
      .def("__repr__", &repr);
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
          "Unit vector from p to q; zero where they are at one place.")
      .def_prop_ro("time", [](const BondView& self) { return self.state.time; }, "s");
}

void bind_cosmetic_bond(nb::module_& module) {
  nb::class_<CosmeticBondHandle> type(
      module, "CBond",
      "A line to be drawn between two particles of one body; it has no force. A body whose lines are cut in two falls in two.",
      nb::type_slots(handle_slots<CosmeticBondHandle>), nb::is_weak_referenceable());
  type.def(
      "__init__",
      [](CosmeticBondHandle* self, const ParticleHandle& p, const ParticleHandle& q) {
        check_one_system(p, q, "CBond");
        p.use();
        q.use();
        const CosmeticBondId id = p.system->use_between_steps("CBond(...)").create_cosmetic_bond(p.id, q.id);
        p.system->cosmetic_bonds.push_back({id, p.id, q.id});
        new (self) CosmeticBondHandle{{p.system_object, p.system, id}, p.id, q.id};
      },
      "p"_a, "q"_a);
  def_identity(type);
  type.def_prop_ro(
          "ends",
          [](const CosmeticBondHandle& self) { return std::make_pair(sibling(self, self.p), sibling(self, self.q)); },
          "The two particles.")
      .def(
          "destroy",
          [](const CosmeticBondHandle& self) {
            System& engine = self.system->use();
            const std::optional<ParticleId> end = engine.survivor_of(self.p);
            RestructureResult result{self.system_object, self.system, engine.destroy(self.id)};
            std::erase_if(self.system->cosmetic_bonds, [&](const auto& bond) { return bond.id == self.id; });
            if (end && !result.report.created_bodies.empty()) self.system->note_edit("break", engine.position(*end));
            return result;
          },
          "Removes it. Where that disconnects its body's cosmetic bonds the rigid body falls into two pieces: one with the\n"
          "bond's first end, which stays this body, and one with the second. Particles that hang on neither end go with the\n"
          "nearer piece; a solid and its attachments are one piece. Velocities stay.")
      .def("__repr__", [](const CosmeticBondHandle& self) {
        return "<CBond " + std::to_string(self.id.slot) + " between particles " + std::to_string(self.p.slot) +
               " and " + std::to_string(self.q.slot) + ">";
      });
}

}  // namespace

void bind_bonds(nb::module_& module) {
  bind_bond_state(module);
  bind_bond(module);
  bind_cosmetic_bond(module);
}

}  // namespace iota::bindings
