// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "names.h"

namespace iota::bindings {

namespace {

constexpr const char* doc =
    "A rigid set of particles in a system. Make its particles with `Particle(body, ...)`.\n\n"
    "kind: 'dynamic', 'static' (never moves), 'scripted' (moved by the script, infinite mass) or 'inactive' (kept, neither\n"
    "stepped nor drawn). damping: 1/s, adds to the system's.\n\n"
    "Two handles of the same body are equal. A handle whose body was destroyed or absorbed raises StaleIdError.\n\n"
    "    rod = iota.Body(system)\n"
    "    top, end = iota.Particle(rod, (0, 2, 0)), iota.Particle(rod, (0, 1, 0))";

nb::tuple to_tuple(const Quaternion& q) { return nb::make_tuple(q.x, q.y, q.z, q.w); }

std::string repr(const BodyHandle& self) {
  if (!self.is_alive()) return stale_repr("Body", self);
  const System& engine = self.system->engine;
  return "<Body " + std::to_string(self.id.slot) + ": " + to_word(kind_words, engine.kind(self.id)) + ", " +
         std::to_string(engine.particles(self.id).size()) + " particles>";
}

System& between_steps(const BodyHandle& self, const char* what) {
  System& engine = self.use();
  self.system->use_between_steps(what);
  return engine;
}

}  // namespace

void bind_body(nb::module_& module) {
  nb::class_<BodyHandle> type(module, "Body", doc, nb::type_slots(handle_slots<BodyHandle>),
                              nb::is_weak_referenceable());
  type.def(
      "__init__",
      [](BodyHandle* self, nb::handle_t<SystemObject> system, const KindWord& kind, double damping) {
        BodyOptions options;
        options.kind = to_kind(kind);
        options.damping = finite_not_negative(damping, "damping", "1/s");
        SystemObject* object = nb::inst_ptr<SystemObject>(system);
        const BodyId id = object->use_between_steps("Body(...)").create_body(options);
        new (self) BodyHandle{nb::borrow(system), object, id};
      },
      "system"_a, "kind"_a = KindWord{"dynamic"}, "damping"_a = 0.0);
  def_identity(type);
  def_survival(type, "def survivor(self) -> Body | None");
  type.def_prop_ro(
          "particles",
          [](const BodyHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().particles(self.id));
          },
          nb::sig("def particles(self) -> list[Particle]"), "In the order in which they were made.")
      .def_prop_rw(
          "kind", [](const BodyHandle& self) { return KindWord{to_word(kind_words, self.use().kind(self.id))}; },
          [](const BodyHandle& self, const KindWord& kind) {
            between_steps(self, "kind = ...").set_kind(self.id, to_kind(kind));
          },
          "'dynamic', 'static', 'scripted' or 'inactive'")
      .def_prop_rw(
          "damping", [](const BodyHandle& self) { return self.use().damping(self.id); },
          [](const BodyHandle& self, double value) {
            between_steps(self, "damping = ...").set_damping(self.id, finite_not_negative(value, "damping", "1/s"));
          },
          "1/s, adds to the system's.")
      .def_prop_ro(
          "mass", [](const BodyHandle& self) { return self.use().mass(self.id); }, "kg")
      .def_prop_ro(
          "centre_of_mass", [](const BodyHandle& self) { return self.use().centre_of_mass(self.id); }, "m")
      .def_prop_ro(
          "orientation", [](const BodyHandle& self) { return to_tuple(self.use().orientation(self.id)); },
          nb::sig("def orientation(self) -> tuple[float, float, float, float]"),
          "Of the drawn frame: unit quaternion x y z w that turns body-frame vectors into the world frame.")
      .def_prop_ro(
          "articulate", [](const BodyHandle& self) { return self.use().articulate(self.id); },
          "A number that is equal for bodies that hang together.")
      .def(
          "set_rod",
          [](const BodyHandle& self, double mass, double radius) {
            finite_positive(mass, "mass", "kg");
            finite_not_negative(radius, "radius", "m");
            between_steps(self, "set_rod").set_rod(self.id, mass, radius);
          },
          "mass"_a, "radius"_a,
          "Gives a body of exactly two particles the mass (kg) and inertia of a solid cylinder (radius in m) between them.\n"
          "It has no spin about its axis. Raises ValueError for any other number of particles.")
      .def(
          "destroy", [](const BodyHandle& self) { self.use().destroy(self.id); },
          "Removes it with its particles and their bonds. In a bond's function: right after the step.")
      .def("__repr__", &repr);
}

}  // namespace iota::bindings
