// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

namespace iota::bindings {

namespace {

constexpr const char* grip_doc = "A user's grip on a body; made by `System.grip`.";

constexpr const char* make_grip_doc =
    "Grips a body: a critically damped spring of limited pull from a point of the body to a target.\n\n"
    "local_point: in the body's drawn frame, m; it is moved to the nearest place that the body's particles span.\n"
    "target: world, m, None: the center of mass. client, hold: whose grip; carried to the viewers. frequency: Hz.\n"
    "max_acceleration: m/s^2, limits the pull of the spring to this times the effective mass; the damping comes on top.\n"
    "Forces of several grips are added.";

}  // namespace

void bind_grip(nb::module_& module) {
  nb::class_<GripHandle> type(module, "Grip", grip_doc, nb::type_slots(handle_slots<GripHandle>),
                              nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "grip",
          [](SystemObject& self, const BodyHandle& body, VectorArgument local_point,
             std::optional<VectorArgument> target, std::uint32_t client, std::uint32_t hold, double frequency,
             double max_acceleration) {
            const Vec3 point = to_vec3(local_point, "local_point");
            GripOptions options{client, hold, finite_positive(frequency, "frequency", "Hz"),
                                finite_positive(max_acceleration, "max_acceleration", "m/s^2")};
            body.use();
            if (body.system != &self) throw nb::value_error("grip: the body belongs to another system");
            System& engine = self.use_between_steps("grip(...)");
            const Vec3 goal = target ? to_vec3(*target, "target") : engine.bodies().center_of_mass(body.id);
            return sibling(body, engine.grips().create(body.id, point, goal, options));
          },
          "body"_a, "local_point"_a = nb::make_tuple(0.0, 0.0, 0.0), "target"_a.none() = nb::none(), nb::kw_only(),
          "client"_a = 0, "hold"_a = 0, "frequency"_a = GripOptions{}.frequency,
          "max_acceleration"_a = GripOptions{}.max_acceleration, make_grip_doc);
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const GripHandle& self) { return self.is_alive(); },
          "False once it was released or its body was destroyed.")
      .def_prop_ro(
          "body", [](const GripHandle& self) { return sibling(self, self.use().grips().body(self.id)); },
          "The body that is held: after an edit what that became part of, or the part at the held point that was taken "
          "from it.")
      .def(
          "move",
          [](const GripHandle& self, VectorArgument target) {
            self.use();
            self.system->use_between_steps("move").grips().move(self.id, to_vec3(target, "target"));
          },
          "target"_a, "Moves its target (world, m).")
      .def(
          "destroy", [](const GripHandle& self) { self.use().grips().destroy(self.id); }, "Lets go.")
      .def("__repr__", [](const GripHandle& self) {
        return self.is_alive() ? "<Grip " + std::to_string(self.id.slot) + ">" : stale_repr("Grip", self);
      });
}

}  // namespace iota::bindings
