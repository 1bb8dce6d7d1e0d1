// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"
#include "binders.h"
#include "pickled.h"

namespace iota::bindings {

namespace {

struct ContactView {
  nb::object system_object;
  SystemObject* system;
  ContactPoint point;
};

constexpr const char* material_doc =
    "How the outline of a body touches others: see `Body.material` and `System.usual_material`.\n\n"
    "friction: Coulomb's coefficient; of two bodies that touch the geometric mean counts.\n"
    "touches: 'all' bodies, 'obstacles' (those that never move), or 'nothing'. Two bodies touch if both agree.\n\n"
    "    ice = iota.Material(friction=0.02)\n"
    "    rink = system.obstacle(iota.HalfSpace((0, 1, 0)), material=ice)\n"
    "    puck.material = ice";

void bind_material(nb::module_& module) {
  nb::class_<Material> type(module, "Material", material_doc);
  const auto make = [](Material* self, double friction, const TouchesWord& touches) {
    new (self) Material{finite_not_negative(friction, "friction", ""), to_touches(touches)};
  };
  const auto touches_of = [](const Material& self) { return TouchesWord{to_word(touches_words, self.touches)}; };
  type.def("__init__", make, nb::kw_only(), "friction"_a = Material{}.friction, "touches"_a = TouchesWord{"all"})
      .def(
          "__getstate__",
          [touches_of](const Material& self) { return nb::make_tuple(self.friction, touches_of(self)); },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [make](Material& self, const std::tuple<double, TouchesWord>& state) {
            make(&self, std::get<0>(state), std::get<1>(state));
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"))
      .def_ro("friction", &Material::friction)
      .def_prop_ro("touches", touches_of)
      .def(
          "__eq__", [](const Material& a, const Material& b) { return a == b; }, nb::is_operator(),
          nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const Material& self) { return std::hash<double>{}(self.friction); })
      .def("__repr__", [](const Material& self) {
        const std::string touches =
            self.touches == Touches::all ? "" : ", touches='" + to_word(touches_words, self.touches) + "'";
        return text("Material(friction=", self.friction, touches, ")");
      });
}

void bind_use(nb::module_& module) {
  nb::borrow<nb::class_<BodyHandle>>(module.attr("Body"))
      .def_prop_rw(
          "material", [](const BodyHandle& self) { return self.use().bodies().material(self.id); },
          [](const BodyHandle& self, const std::optional<Material>& material) {
            self.use().bodies().set_material(self.id, material);
          },
          nb::for_setter(nb::arg("material").none()),
          "Its own. With a material its outline touches others that have one: it rests, slides, rolls and stacks. None:\n"
          "`System.usual_material` counts, but for static bodies, which then touch nothing.")
      .def_prop_ro(
          "contacts",
          [](const BodyHandle& self) {
            std::vector<ContactView> views;
            for (const ContactPoint& point : self.use().bodies().contacts(self.id))
              views.push_back({self.system_object, self.system, point});
            return views;
          },
          nb::sig("def contacts(self) -> list[ContactPoint]"), "Where it touched others in the last step.");
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def_prop_rw(
          "usual_material", [](SystemObject& self) { return self.use().usual_material(); },
          [](SystemObject& self, const std::optional<Material>& material) {
            self.use_between_steps("usual_material = ...").set_usual_material(material);
          },
          nb::for_setter(nb::arg("material").none()),
          "Of bodies that can move and have no material of their own; None at first: they touch nothing. A World sets it\n"
          "where it has a ground, so that this holds all bodies.");
}

}  // namespace

void bind_contacts(nb::module_& module) {
  bind_material(module);
  nb::class_<Impact> impact(module, "Impact", "The hardest touch that began in a step, see `StepReport.impact`.");
  def_pickled(impact, &Impact::position, &Impact::speed);
  impact.def_ro("position", &Impact::position, "World, m.")
      .def_ro("speed", &Impact::speed, "Of the approach, m/s.")
      .def(
          "__eq__", [](const Impact& a, const Impact& b) { return a == b; }, nb::is_operator(),
          nb::sig("def __eq__(self, other: object, /) -> bool"));
  nb::class_<ContactView>(module, "ContactPoint", "A place where a body touches another one, see `Body.contacts`.",
                          nb::type_slots(handle_slots<ContactView>))
      .def_prop_ro(
          "other", [](const ContactView& self) { return sibling(self, self.point.other); }, "The body that it touches.")
      .def_prop_ro(
          "position", [](const ContactView& self) { return self.point.position; }, "World, m.")
      .def_prop_ro(
          "normal", [](const ContactView& self) { return self.point.normal; }, "Unit vector towards the body.")
      .def_prop_ro(
          "force", [](const ContactView& self) { return self.point.force; }, "On the body in the last step, N.")
      .def("__repr__", [](const ContactView& self) {
        const Vec3& at = self.point.position;
        return text("<ContactPoint: with body ", self.point.other.slot, " at (", at.x, ", ", at.y, ", ", at.z, "), ",
                    norm(self.point.force), " N>");
      });
  bind_use(module);
}

}  // namespace iota::bindings
