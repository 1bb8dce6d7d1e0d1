// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

namespace iota::bindings {

namespace {

using BalloonHandle = Handle<BalloonId>;

}  // namespace

void bind_balloons(nb::module_& module) {
  nb::class_<BalloonHandle> type(module, "Balloon", "A constant force on a particle; made by `System.balloon`.",
                                 nb::type_slots(handle_slots<BalloonHandle>), nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "balloon",
          [](SystemObject& self, const ParticleHandle& particle, double up) {
            System& engine = self.use_between_steps("balloon(...)");
            return sibling(particle, engine.balloons().create(particle.id, {0, up, 0}));
          },
          "particle"_a, "up"_a, "A constant force on a particle, N.");
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const BalloonHandle& self) { return self.is_alive(); }, "False once it was destroyed.")
      .def_prop_rw(
          "up", [](const BalloonHandle& self) { return self.use().balloons().lift(self.id).y; },
          [](const BalloonHandle& self, double up) { self.use().balloons().set_lift(self.id, {0, up, 0}); }, "N.")
      .def("destroy", [](const BalloonHandle& self) { self.use().balloons().destroy(self.id); }, "Removes it.");
}

}  // namespace iota::bindings
