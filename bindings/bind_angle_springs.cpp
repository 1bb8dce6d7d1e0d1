// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

#include <nanobind/stl/tuple.h>

#include <cmath>
#include <limits>

namespace iota::bindings {

namespace {

using AngleSpringHandle = Handle<AngleSpringId>;

constexpr const char* angle_spring_doc =
    "A spring on the angle that three particles span; made by `System.angle_spring`.";

constexpr const char* make_angle_spring_doc =
    "A spring on the angle between the legs from `middle` to p and to q: the bending stiffness of ropes and beams, the\n"
    "angle terms of molecules. Its forces add up to zero, and so do their moments.\n\n"
    "stiffness: N m/rad, at the rest angle; damping: N m s/rad; rest: its angle without a moment, rad, 0.01 to pi (straight), None:\n"
    "the present one. Its energy is a function of the angle as long as the legs keep the lengths that they have now. A chain\n"
    "of rods of length l with springs of EI / l at its joints bends like a beam with the bending stiffness EI, N m^2.\n\n"
    "    for before, after in itertools.pairwise(rods):  # a springy rope\n"
    "        system.angle_spring(before.particles[0], after.particles[0], after.particles[1], 0.5, rest=math.pi)";

AngleSprings springs_of(const AngleSpringHandle& self) { return self.use().angle_springs(); }

/// Changes one of its options.
template <double AngleSpringOptions::* option>
void def_option(nb::class_<AngleSpringHandle>& type, const char* name, const char* text) {
  type.def_prop_rw(
      name, [](const AngleSpringHandle& self) { return springs_of(self).options(self.id).*option; },
      [name](const AngleSpringHandle& self, double value) {
        AngleSpringOptions options = springs_of(self).options(self.id);
        if (std::isnan(value)) throw nb::value_error((std::string(name) + " must be a number, not nan").c_str());
        options.*option = value;
        self.system->use_between_steps((std::string(name) + " = ...").c_str()).angle_springs().set(self.id, options);
      },
      text);
}

}  // namespace

void bind_angle_springs(nb::module_& module) {
  nb::class_<AngleSpringHandle> type(module, "AngleSpring", angle_spring_doc,
                                     nb::type_slots(handle_slots<AngleSpringHandle>), nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "angle_spring",
          [](SystemObject& self, const ParticleHandle& p, const ParticleHandle& middle, const ParticleHandle& q,
             double stiffness, double damping, std::optional<double> rest) {
            for (const ParticleHandle* end : {&p, &middle, &q}) {
              end->use();
              if (end->system != &self) throw nb::value_error("angle_spring: the particles belong to another system");
            }
            if (rest && std::isnan(*rest)) throw nb::value_error("rest must be a number or None, not nan");
            const AngleSpringOptions options{stiffness, damping,
                                             rest.value_or(std::numeric_limits<double>::quiet_NaN())};
            System& engine = self.use_between_steps("angle_spring(...)");
            return sibling(p, engine.angle_springs().create(p.id, middle.id, q.id, options));
          },
          "p"_a, "middle"_a, "q"_a, "stiffness"_a, "damping"_a = 0.0, "rest"_a = nb::none(), make_angle_spring_doc)
      .def_prop_ro("angle_springs",
                   all_of<AngleSpringHandle>([](System& engine) { return engine.angle_springs().ids(); }),
                   "In order of slots.");
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const AngleSpringHandle& self) { return self.is_alive(); },
          "False once it or one of its particles was destroyed.")
      .def_prop_ro(
          "ends",
          [](const AngleSpringHandle& self) {
            const auto [p, middle, q] = springs_of(self).ends(self.id);
            return std::make_tuple(sibling(self, p), sibling(self, middle), sibling(self, q));
          },
          "Its particles: first, middle, last.")
      .def_prop_ro(
          "angle", [](const AngleSpringHandle& self) { return springs_of(self).angle(self.id); },
          "At present, rad, 0 to pi.")
      .def_prop_ro(
          "moment", [](const AngleSpringHandle& self) { return springs_of(self).moment(self.id); },
          "Of its stiffness at present, N m; positive: it opens the angle.")
      .def(
          "destroy", [](const AngleSpringHandle& self) { springs_of(self).destroy(self.id); }, "Removes it.")
      .def("__repr__", [](const AngleSpringHandle& self) {
        return self.is_alive() ? "<AngleSpring " + std::to_string(self.id.slot) + ">" : stale_repr("AngleSpring", self);
      });
  def_option<&AngleSpringOptions::stiffness>(type, "stiffness", "N m/rad, at the rest angle.");
  def_option<&AngleSpringOptions::damping>(type, "damping", "N m s/rad.");
  def_option<&AngleSpringOptions::rest>(type, "rest", "Its angle at rest, rad, 0.01 to pi.");
}

}  // namespace iota::bindings
