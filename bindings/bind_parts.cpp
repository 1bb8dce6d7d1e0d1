// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "restructure_result.h"

namespace iota::bindings {

namespace {

/// One of the bodies that a body was combined from.
struct PartView {
  BodyHandle body;
  BodyId part;

  System& use() const { return body.use(); }
  std::vector<ParticleHandle> particles() const {
    return wrap_all<ParticleHandle>(body.system_object, body.system, use().bodies().particles(body.id, part));
  }
};

BodyHandle& holder_of(PartView& part) { return part.body; }

}  // namespace

void bind_parts(nb::module_& module) {
  nb::class_<PartView> type(module, "Part", "One of the bodies that a body was combined from.",
                            nb::type_slots(handle_slots<PartView>));
  type.def_prop_ro(
          "origin", [](const PartView& self) { return sibling(self.body, self.part); },
          nb::sig("def origin(self) -> Body"),
          "Its former body: equal to the old handle, which is stale unless this body absorbed the others.")
      .def_prop_ro(
          "body", [](const PartView& self) { return self.body; }, nb::sig("def body(self) -> Body"),
          "The body that it is a part of.")
      .def_prop_ro("particles", &PartView::particles, nb::sig("def particles(self) -> list[Particle]"))
      .def_prop_ro(
          "mass",
          [](const PartView& self) {
            double mass = 0;
            for (const ParticleId p : self.use().bodies().particles(self.body.id, self.part))
              mass += self.use().particles().mass(p);
            return mass;
          },
          "kg")
      .def_prop_ro(
          "net_force", [](const PartView& self) { return self.use().bodies().net_force(self.body.id, self.part); },
          "Sum of all forces in the last step, those of the other parts included, N.")
      .def_prop_ro(
          "net_torque", [](const PartView& self) { return self.use().bodies().net_torque(self.body.id, self.part); },
          "About its own center of mass, N m.")
      .def_prop_ro(
          "outside_force",
          [](const PartView& self) { return self.use().bodies().outside_force(self.body.id, self.part); },
          "Load from outside of the whole body in the last step, N. net_force minus this is the force of the other\n"
          "parts: the load of the rigid connection.")
      .def_prop_ro(
          "outside_torque",
          [](const PartView& self) { return self.use().bodies().outside_torque(self.body.id, self.part); },
          "Moment of those forces about its own center of mass, N m.")
      .def(
          "separate",
          [](const PartView& self) {
            return RestructureResult{self.body.system_object, self.body.system,
                                     self.use().edits().separate(self.body.id, self.part)};
          },
          "Makes it a body of its own again, with the hinges that combining had made rigid: it is the first of the\n"
          "report's created_bodies.")
      .def(
          "__eq__",
          [](const PartView& a, nb::handle other) {
            const PartView* b = nullptr;
            return nb::try_cast<const PartView*>(other, b) && b && a.body.same_as(b->body) && a.part == b->part;
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", [](const PartView& self) {
        return "<Part " + std::to_string(self.part.slot) + " of body " + std::to_string(self.body.id.slot) + ">";
      });

  auto body = nb::borrow<nb::class_<BodyHandle>>(module.attr("Body"));
  body.def_prop_ro(
          "parts",
          [](const BodyHandle& self) {
            std::vector<PartView> parts;
            for (const BodyId part : self.use().bodies().parts(self.id)) parts.push_back({self, part});
            return parts;
          },
          nb::sig("def parts(self) -> list[Part]"),
          "The bodies that it was combined from: each has its forces, and can be separated again.")
      .def_prop_ro(
          "net_force", [](const BodyHandle& self) { return self.use().bodies().net_force(self.id); },
          "Sum of all forces from outside in the last step, N: mass times acceleration.")
      .def_prop_ro(
          "net_torque", [](const BodyHandle& self) { return self.use().bodies().net_torque(self.id); },
          "Sum of their moments about the center of mass, N m.");
  auto particle = nb::borrow<nb::class_<ParticleHandle>>(module.attr("Particle"));
  particle.def_prop_ro(
      "net_force", [](const ParticleHandle& self) { return self.use().particles().net_force(self.id); },
      "Sum of all forces on its share of mass in the last step, N.");
}

}  // namespace iota::bindings
