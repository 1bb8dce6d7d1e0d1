// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"
#include "binders.h"
#include "pickled.h"
#include "typed_argument.h"

#include <algorithm>

namespace iota::bindings {

namespace {

struct ContactView {
  nb::object system_object;
  SystemObject* system;
  ContactPoint point;
};

/// All contacts of a step.
struct ContactsView {
  nb::object system_object;
  SystemObject* system;
  std::vector<ContactPoint> points;
};

struct ContactEventView {
  nb::object system_object;
  SystemObject* system;
  ContactEvent event;
};

struct ContactWatch {
  nb::object system_object;
  SystemObject* system;
  std::uint32_t number;
};

using PartyArgument = TypedArgument<"Body | Group">;
using SideArgument = TypedArgument<"Body | Group | collections.abc.Iterable[Body | Group]">;

bool try_party(SystemObject& system, nb::handle value, ContactParty& party) {
  const auto take = [&](const auto& handle, auto& id) {
    handle.use();
    if (handle.system != &system) throw nb::value_error("contacts are of bodies and groups of one system");
    id = handle.id;
    return true;
  };
  const BodyHandle* body = nullptr;
  if (nb::try_cast<const BodyHandle*>(value, body) && body) return take(*body, party.body);
  const GroupHandle* group = nullptr;
  return nb::try_cast<const GroupHandle*>(value, group) && group && take(*group, party.group);
}

ContactParty to_party(SystemObject& system, nb::handle value, const char* name) {
  ContactParty party;
  if (!try_party(system, value, party))
    throw nb::type_error((std::string(name) + " must be a body or a group, not " + describe(value)).c_str());
  return party;
}

/// Empty for None: any body.
std::vector<ContactParty> to_side(SystemObject& system, nb::handle value, const char* name) {
  std::vector<ContactParty> side;
  ContactParty party;
  if (value.is_none()) return side;
  if (try_party(system, value, party)) return {party};
  if (nb::isinstance<nb::iterable>(value) && !nb::isinstance<nb::str>(value))
    for (nb::handle each : nb::iter(value)) side.push_back(to_party(system, each, name));
  if (!side.empty()) return side;
  throw nb::type_error(
      (std::string(name) + " must be a body, a group, several of them, or None for any, not " + describe(value))
          .c_str());
}

nb::object party_object(const nb::object& system_object, SystemObject* system, const ContactParty& party) {
  return party.group ? nb::cast(GroupHandle{system_object, system, party.group})
                     : nb::cast(BodyHandle{system_object, system, party.body});
}

constexpr const char* material_doc =
    "How the outline of a body touches others: see `Body.material` and `System.usual_material`.\n\n"
    "friction: Coulomb's coefficient; of two bodies that touch the geometric mean counts.\n"
    "static_friction: the coefficient until a body slides, at least `friction`, which counts while it does; 0: the same one.\n"
    "restitution: speed at which two bodies leave each other after an impact, of that at which they met, 0 to 1; of two\n"
    "bodies the larger one counts.\n"
    "rolling: coefficient of rolling resistance; the torque against rolling is at most this times the normal force and the\n"
    "radius, so that a ball on level ground slows down by 5/7 rolling g. Of two bodies the larger one counts.\n"
    "spinning: coefficient of friction against spinning on the spot; the torque about the normal is at most this times the\n"
    "normal force and the radius. A ball of radius R with friction mu that touches with a disk of radius r has 2/3 mu r/R. Of two\n"
    "bodies the larger one counts.\n"
    "surface_velocity: of the surface against its body, in the world, m/s: a belt. Friction drives what lies on it.\n"
    "touches: 'all' bodies, 'obstacles' (those that never move), or 'nothing'. Two bodies touch if both agree.\n"
    "'sensor': it feels and gives no force; `World.on_contact` and `System.watch_contacts` tell what enters and leaves it.\n\n"
    "    ice = iota.Material(friction=0.02)\n"
    "    rubber = iota.Material(friction=0.9, restitution=0.8, rolling=0.01)\n"
    "    rink = system.obstacle(iota.HalfSpace((0, 1, 0)), material=ice)\n"
    "    puck.material = ice\n\n"
    "Raises ValueError for a negative or infinite coefficient, for a restitution above 1 and for a static friction below the\n"
    "friction.";

void bind_material(nb::module_& module) {
  nb::class_<Material> type(module, "Material", material_doc);
  const auto make = [](Material* self, double friction, double restitution, double rolling, const TouchesWord& touches,
                       VectorArgument surface_velocity, double static_friction, double spinning) {
    if (finite_not_negative(restitution, "restitution", "") > 1)
      throw std::invalid_argument(text("restitution must be at most 1, not ", restitution));
    if (finite_not_negative(static_friction, "static_friction", "") != 0 && static_friction < friction)
      throw std::invalid_argument(text("static_friction must be at least the friction ", friction,
                                       ", or 0 for the same, not ", static_friction));
    new (self) Material{finite_not_negative(friction, "friction", ""),
                        to_touches(touches),
                        restitution,
                        finite_not_negative(rolling, "rolling", ""),
                        to_vec3(surface_velocity, "surface_velocity"),
                        static_friction,
                        finite_not_negative(spinning, "spinning", "")};
  };
  const auto touches_of = [](const Material& self) { return TouchesWord{to_word(touches_words, self.touches)}; };
  type.def("__init__", make, nb::kw_only(), "friction"_a = Material{}.friction,
           "restitution"_a = Material{}.restitution, "rolling"_a = Material{}.rolling, "touches"_a = TouchesWord{"all"},
           "surface_velocity"_a = nb::make_tuple(0.0, 0.0, 0.0), "static_friction"_a = Material{}.static_friction,
           "spinning"_a = Material{}.spinning)
      .def(
          "__getstate__",
          [touches_of](const Material& self) {
            return nb::make_tuple(self.friction, self.restitution, self.rolling, touches_of(self),
                                  self.surface_velocity, self.static_friction, self.spinning);
          },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [make](Material& self,
                 const std::tuple<double, double, double, TouchesWord, nb::object, double, double>& state) {
            const auto& [friction, restitution, rolling, touches, surface_velocity, static_friction, spinning] = state;
            make(&self, friction, restitution, rolling, touches, VectorArgument{surface_velocity}, static_friction,
                 spinning);
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"))
      .def_ro("friction", &Material::friction)
      .def_ro("restitution", &Material::restitution)
      .def_ro("rolling", &Material::rolling)
      .def_prop_ro("touches", touches_of)
      .def_ro("surface_velocity", &Material::surface_velocity)
      .def_ro("static_friction", &Material::static_friction)
      .def_ro("spinning", &Material::spinning)
      .def(
          "__eq__", [](const Material& a, const Material& b) { return a == b; }, nb::is_operator(),
          nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const Material& self) { return std::hash<double>{}(self.friction); })
      .def("__repr__", [](const Material& self) {
        const auto unless_usual = [](const char* name, double value) {
          return value == 0 ? std::string() : text(", ", name, "=", value);
        };
        const std::string touches =
            self.touches == Touches::all ? "" : ", touches='" + to_word(touches_words, self.touches) + "'";
        const Vec3& v = self.surface_velocity;
        const std::string belt = v == Vec3{} ? "" : text(", surface_velocity=(", v.x, ", ", v.y, ", ", v.z, ")");
        return text("Material(friction=", self.friction, unless_usual("restitution", self.restitution),
                    unless_usual("rolling", self.rolling), touches, belt,
                    unless_usual("static_friction", self.static_friction), unless_usual("spinning", self.spinning),
                    ")");
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
          "`System.usual_material` counts; `iota.Material(touches='nothing')` is for what only looks.")
      .def_prop_ro(
          "contacts",
          [](const BodyHandle& self) {
            std::vector<ContactView> views;
            for (const ContactPoint& point : self.use().bodies().contacts(self.id))
              views.push_back({self.system_object, self.system, point});
            return views;
          },
          nb::sig("def contacts(self) -> list[ContactPoint]"),
          "Where it touched others in the last step. All bodies: `System.contacts`.")
      .def(
          "force_from",
          [](const BodyHandle& self, const BodyHandle& other) {
            other.use();
            check_one_system(self, other, "force_from");
            return self.use().contacts().force(self.id, other.id);
          },
          "other"_a,
          "Sum of the forces of contacts of another body on it in the last step, N; zero if they do not touch.\n\n"
          "    load = box.force_from(table).y");
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def_prop_rw(
          "usual_material", [](SystemObject& self) { return self.use().usual_material(); },
          [](SystemObject& self, const std::optional<Material>& material) {
            self.use_between_steps("usual_material = ...").set_usual_material(material);
          },
          nb::for_setter(nb::arg("material").none()),
          "Of bodies that have no material of their own, static ones too; None at first: they touch nothing. A World sets it\n"
          "as it begins, with friction 0.6: `iota.Material(touches='nothing')` before it turns contact off.");
}

// --- all contacts as arrays ---------------------------------------------------------------------------------------------

constexpr const char* floats = "numpy.typing.NDArray[numpy.float64]";

/// A property: rows of `width` numbers, written by write(point, row).
template <class Number = double, class Write>
void def_rows(nb::class_<ContactsView>& type, const char* name, std::size_t width, const char* array, Write write,
              const char* text) {
  type.def_prop_ro(
      name,
      [width, write](const ContactsView& self) {
        const std::size_t count = self.points.size();
        auto* const rows = new Number[std::max<std::size_t>(1, width * count)];
        nb::capsule owner(rows, [](void* p) noexcept { delete[] static_cast<Number*>(p); });
        for (std::size_t i = 0; i < count; ++i) write(self.points[i], rows + width * i);
        const std::size_t shape[2]{count, width};
        return nb::cast(nb::ndarray<nb::numpy, Number, nb::c_contig>(rows, width > 1 ? 2 : 1, shape, owner));
      },
      nb::sig(("def " + std::string(name) + "(self) -> " + array).c_str()), text);
}

/// A property: a vector of each.
template <class Read>
void def_vectors(nb::class_<ContactsView>& type, const char* name, Read read, const char* text) {
  def_rows(
      type, name, 3, floats,
      [read](const ContactPoint& point, double* row) {
        const Vec3 v = read(point);
        row[0] = v.x, row[1] = v.y, row[2] = v.z;
      },
      text);
}

void bind_arrays_of_contacts(nb::module_& module) {
  nb::class_<ContactsView> type(
      module, "Contacts",
      "All places where bodies touched in a step, in the order of their bodies; see `System.contacts`. Items are a\n"
      "`ContactPoint` each. Arrays are copies with a row for each place, made when they are asked for.\n\n"
      "    contacts = system.contacts\n"
      "    contacts.forces[contacts.sliding].sum(axis=0)\n"
      "    numpy.bincount(contacts.slots[:, 1], contacts.normal_forces)  # load of each body, by Body.slot",
      nb::type_slots(handle_slots<ContactsView>));
  type.def("__len__", [](const ContactsView& self) { return self.points.size(); })
      .def(
          "__getitem__",
          [](const ContactsView& self, Py_ssize_t index) {
            const auto size = static_cast<Py_ssize_t>(self.points.size());
            if (index < -size || index >= size)
              throw nb::index_error(text("there are ", size, " contacts, and no number ", index).c_str());
            return ContactView{self.system_object, self.system,
                               self.points[static_cast<std::size_t>(index < 0 ? index + size : index)]};
          },
          "index"_a)
      .def(
          "__iter__",
          [](const ContactsView& self) {
            nb::list points;
            for (const ContactPoint& point : self.points)
              points.append(ContactView{self.system_object, self.system, point});
            return nb::iter(points);
          },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[ContactPoint]"))
      .def("__repr__", [](const ContactsView& self) { return text("<Contacts: ", self.points.size(), ">"); });
  def_rows<std::uint32_t>(
      type, "slots", 2, "numpy.typing.NDArray[numpy.uint32]",
      [](const ContactPoint& point, std::uint32_t* row) { row[0] = point.body.slot, row[1] = point.other.slot; },
      "(n, 2): `Body.slot` of the body and of the other one. The first one can move.");
  def_vectors(type, "positions", [](const ContactPoint& point) { return point.position; }, "(n, 3): world, m.");
  def_vectors(
      type, "normals", [](const ContactPoint& point) { return point.normal; },
      "(n, 3): unit vectors towards the body.");
  def_vectors(
      type, "forces", [](const ContactPoint& point) { return point.force; },
      "(n, 3): on the body, with friction, N; the other one has the opposite force.");
  def_vectors(
      type, "friction", [](const ContactPoint& point) { return point.friction(); },
      "(n, 3): the part along the surface, N.");
  const auto def_numbers = [&](const char* name, auto read, const char* text) {
    def_rows(type, name, 1, floats, [read](const ContactPoint& point, double* row) { *row = read(point); }, text);
  };
  def_numbers("normal_forces", [](const ContactPoint& point) { return dot(point.force, point.normal); }, "(n,), N.");
  def_numbers(
      "gaps", [](const ContactPoint& point) { return point.gap; }, "(n,): between the outlines, m; negative: overlap.");
  def_numbers(
      "slips", [](const ContactPoint& point) { return point.slip; },
      "(n,): speed of the body along the other one's surface, m/s.");
  def_rows<bool>(
      type, "sliding", 1, "numpy.typing.NDArray[numpy.bool_]",
      [](const ContactPoint& point, bool* row) { *row = point.slides; },
      "(n,): True where friction has its largest value; other places stick.");
}

// --- touches that begin and end ---------------------------------------------------------------------------------------------

void bind_events(nb::module_& module) {
  nb::class_<ContactEventView>(module, "ContactEvent", "Two bodies begin or cease to touch, see `ContactWatch`.",
                               nb::type_slots(handle_slots<ContactEventView>))
      .def_prop_ro(
          "began", [](const ContactEventView& self) { return self.event.began; },
          "True if they began to touch, False if they parted.")
      .def_prop_ro(
          "body", [](const ContactEventView& self) { return sibling(self, self.event.body); },
          "The one of side a. It may be gone at an end.")
      .def_prop_ro(
          "other", [](const ContactEventView& self) { return sibling(self, self.event.other); }, "The one of side b.")
      .def_prop_ro(
          "position", [](const ContactEventView& self) { return self.event.position; },
          "The place, world, m; at an end the last one.")
      .def_prop_ro(
          "normal", [](const ContactEventView& self) { return self.event.normal; }, "Unit vector towards the body.")
      .def_prop_ro(
          "impulse", [](const ContactEventView& self) { return self.event.impulse; },
          "Between the two in the step in which they began to touch, N s.")
      .def_prop_ro(
          "speed", [](const ContactEventView& self) { return self.event.speed; },
          "Of the approach before that step, m/s.")
      .def("__repr__", [](const ContactEventView& self) {
        const ContactEvent& e = self.event;
        return text("<ContactEvent: bodies ", e.body.slot, " and ", e.other.slot,
                    e.began ? text(" touch, ", e.impulse, " N s>") : " part>");
      });
  nb::class_<ContactWatch>(module, "ContactWatch",
                           "Tells of touches that begin and end: see `System.watch_contacts`, `World.on_contact`.",
                           nb::type_slots(handle_slots<ContactWatch>))
      .def_prop_ro(
          "events",
          [](const ContactWatch& self) {
            std::vector<ContactEventView> views;
            if (!self.system) return views;
            self.system->use();
            for (const ContactEvent& event : self.system->contacts)
              if (event.watch == self.number) views.push_back({self.system_object, self.system, event});
            return views;
          },
          nb::sig("def events(self) -> list[ContactEvent]"),
          "Those of the last `System.step`, in the order of steps and bodies.")
      .def(
          "end",
          [](const ContactWatch& self) {
            if (self.system) self.system->use_between_steps("end").contacts().unwatch(self.number);
          },
          "Ends it. It has no events from the next step on.");
}

void bind_system(nb::class_<SystemObject>&& type) {
  type.def_prop_ro(
      "contacts",
      [](nb::handle_t<SystemObject> self) {
        SystemObject* const object = nb::inst_ptr<SystemObject>(self);
        return ContactsView{nb::borrow(self), object, object->use().contacts().points()};
      },
      nb::sig("def contacts(self) -> Contacts"), "Where bodies touched in the last step, as arrays.");
  type.def(
      "watch_contacts",
      [](nb::handle_t<SystemObject> self, SideArgument a, SideArgument b, double min_impulse, double min_speed,
         double cooldown) {
        SystemObject* const object = nb::inst_ptr<SystemObject>(self);
        System& engine = object->use_between_steps("watch_contacts");
        ContactFilter filter{.a = to_side(*object, a.value, "a"), .b = to_side(*object, b.value, "b")};
        filter.min_impulse = finite_not_negative(min_impulse, "min_impulse", "N s");
        filter.min_speed = finite_not_negative(min_speed, "min_speed", "m/s");
        filter.cooldown = finite_not_negative(cooldown, "cooldown", "s");
        return ContactWatch{nb::borrow(self), object, engine.contacts().watch(filter)};
      },
      "a"_a.none() = nb::none(), "b"_a.none() = nb::none(), nb::kw_only(), "min_impulse"_a = 0.0, "min_speed"_a = 0.0,
      "cooldown"_a = 0.0,
      "From the next step on, tells of touches that begin and end between a body of a and one of b: `ContactWatch.events`\n"
      "after each step. In a World, `on_contact` calls a function. It is not a part of the state: a restore keeps it.\n\n"
      "a, b: a body, a group, several of them, or None for any. min_impulse: N s, min_speed of the approach: m/s; weaker\n"
      "begins are not told. cooldown: after a begin, the next ones of the same two bodies are not told for so long, s. An\n"
      "end is told if its begin was. A touch ends when the bodies are further apart than 1e-4 of the smaller one.\n\n"
      "    hits = system.watch_contacts(ball, min_speed=0.5)\n"
      "    system.step(1 / 120)\n"
      "    for hit in hits.events: print(hit.began, hit.other, hit.impulse)");
  type.def(
          "ignore_contacts",
          [](SystemObject& self, PartyArgument a, PartyArgument b) {
            System& engine = self.use_between_steps("ignore_contacts");
            engine.contacts().ignore(to_party(self, a.value, "a"), to_party(self, b.value, "b"));
          },
          "a"_a, "b"_a,
          "Two bodies pass through each other: a and b, or each body with a particle in a group and each of the other\n"
          "side. Snapshots keep it, and so do `combine` and `separate`: a survivor takes over the exceptions of what it\n"
          "absorbed, and pieces have those of the whole.\n\n"
          "    system.ignore_contacts(ghost, wall)\n"
          "    system.ignore_contacts(fish, fish)  # a group: they pass through each other")
      .def(
          "allow_contacts",
          [](SystemObject& self, PartyArgument a, PartyArgument b) {
            System& engine = self.use_between_steps("allow_contacts");
            engine.contacts().allow(to_party(self, a.value, "a"), to_party(self, b.value, "b"));
          },
          "a"_a, "b"_a, "Ends `ignore_contacts` of the same two.");
  type.def_prop_ro(
      "ignored_contacts",
      [](nb::handle_t<SystemObject> self) {
        SystemObject* const object = nb::inst_ptr<SystemObject>(self);
        nb::list pairs;
        for (const auto& [a, b] : object->use().contacts().ignored())
          pairs.append(
              nb::make_tuple(party_object(nb::borrow(self), object, a), party_object(nb::borrow(self), object, b)));
        return pairs;
      },
      nb::sig("def ignored_contacts(self) -> list[tuple[Body | Group, Body | Group]]"),
      "The pairs of `ignore_contacts`.");
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
          "body", [](const ContactView& self) { return sibling(self, self.point.body); }, "The body.")
      .def_prop_ro(
          "other", [](const ContactView& self) { return sibling(self, self.point.other); }, "The body that it touches.")
      .def_prop_ro(
          "position", [](const ContactView& self) { return self.point.position; }, "World, m.")
      .def_prop_ro(
          "normal", [](const ContactView& self) { return self.point.normal; }, "Unit vector towards the body.")
      .def_prop_ro(
          "force", [](const ContactView& self) { return self.point.force; }, "On the body in the last step, N.")
      .def_prop_ro(
          "friction", [](const ContactView& self) { return self.point.friction(); },
          "The part of the force along the surface, N.")
      .def_prop_ro(
          "gap", [](const ContactView& self) { return self.point.gap; },
          "Between the outlines, m; negative: they overlap.")
      .def_prop_ro(
          "slip", [](const ContactView& self) { return self.point.slip; },
          "Speed of the body along the other one's surface, m/s.")
      .def_prop_ro(
          "sliding", [](const ContactView& self) { return self.point.slides; },
          "True if friction has its largest value; otherwise it sticks.")
      .def("__repr__", [](const ContactView& self) {
        const Vec3& at = self.point.position;
        return text("<ContactPoint: with body ", self.point.other.slot, " at (", at.x, ", ", at.y, ", ", at.z, "), ",
                    norm(self.point.force), " N>");
      });
  bind_use(module);
  bind_arrays_of_contacts(module);
  bind_events(module);
  bind_system(nb::borrow<nb::class_<SystemObject>>(module.attr("System")));
}

}  // namespace iota::bindings
