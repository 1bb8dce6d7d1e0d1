// SPDX-License-Identifier: Apache-2.0
#include "array_argument.h"
#include "binders.h"
#include "names.h"
#include "shape_argument.h"
#include "typed_argument.h"

#include <cstdio>

namespace iota::bindings {

namespace {

constexpr const char* body_doc =
    "A rigid set of particles in a system; made by `System.body`.\n\n"
    "Two handles of the same body are equal. A handle whose body was destroyed or absorbed raises StaleIdError.";

constexpr const char* make_body_doc =
    "A new body. Make its particles with `Body.particle`, or give the body as a solid:\n\n"
    "shape: any shape, of density (kg/m^3, default 1000) or mass (kg), with its origin at position\n"
    "(m) and its frame turned by orientation: ('z', 30) or ((1, 1, 0), 30), axis and degrees, or a quaternion x y z w. Four equal point masses represent it, with exactly\n"
    "its mass, center and inertia. velocity: of the center of mass, m/s. spin: rad/s, world axes. attachments: places in the\n"
    "shape's frame (m) for particles to hinge, nail or bond, see `Body.attachment`.\n\n"
    "material: with which it touches, see `Body.material`. color: see `Body.color`.\n"
    "kind: 'dynamic', 'static' (never moves), 'scripted' (moved by the script, infinite mass), 'inactive' (kept, neither\n"
    "stepped nor drawn) or 'resting' (dynamic but asleep, see `rest_after`). damping: 1/s, adds to the system's.\n\n"
    "Raises ValueError for numbers that are out of range, TypeError for mass, position, ... without a shape.\n\n"
    "    rod = system.body()\n"
    "    top, end = rod.particle((0, 2, 0)), rod.particle((0, 1, 0))\n"
    "    door = system.body(shape=iota.Box((0.9, 2, 0.04)), density=600, attachments=[(-0.45, 0.8, 0), (-0.45, -0.8, 0)])\n"
    "    for hinge in door.attachments:\n"
    "        hinge.nail()";

constexpr const char* make_obstacle_doc =
    "A static body without particles: the ground, a wall, a table. Queries find it, and it is drawn and saved; but nothing\n"
    "can be tied to it, and `bodies`, masses, energies and articulates do not count it. `World.add_static` makes one with a\n"
    "look.\n\n"
    "shape: any; a Mesh need not be closed, and has then two sides and no inside. position: of its origin, m.\n"
    "orientation: as of `System.body`. Assigning `Body.position` moves it. material: as of `Body.material`, None: the usual one\n"
    "of the system. color: see `Body.color`.\n\n"
    "    wall = system.obstacle(iota.Box((4, 2, 0.1)), position=(0, 1, -2))\n"
    "    ground = system.obstacle(iota.HalfSpace((0, 1, 0)))";

nb::object to_array(const Matrix3& rows) {
  std::vector<double> numbers;
  for (const Vec3& row : rows) numbers.insert(numbers.end(), {row.x, row.y, row.z});
  return nb::cast(make_vector3_array(std::move(numbers)));
}

nb::tuple to_tuple(const Quaternion& q) { return nb::make_tuple(q.x, q.y, q.z, q.w); }

std::string repr_body(const BodyHandle& self) {
  if (!self.is_alive()) return stale_repr("Body", self);
  const System& engine = self.system->engine;
  if (engine.bodies().is_obstacle(self.id)) return "<Body " + std::to_string(self.id.slot) + ": obstacle>";
  return "<Body " + std::to_string(self.id.slot) + ": " + to_word(kind_words, engine.bodies().kind(self.id)) + ", " +
         std::to_string(engine.bodies().particles(self.id).size()) + " particles>";
}

/// Without a shape a body has no mass, place or velocity until it has particles.
void refuse_without_shape(const std::optional<double>& density, const std::optional<double>& mass,
                          VectorArgument position, nb::handle orientation, VectorArgument velocity, VectorArgument spin,
                          nb::handle attachments) {
  const Quaternion q = to_quaternion(orientation, "orientation");
  if (!density && !mass && to_vec3(position, "position") == Vec3{} && q == Quaternion{} &&
      to_vec3(velocity, "velocity") == Vec3{} && to_vec3(spin, "spin") == Vec3{} && nb::len_hint(attachments) == 0)
    return;
  throw nb::type_error(
      "density, mass, position, orientation, velocity, spin and attachments are of bodies with a shape: give shape=..., or make "
      "particles with body.particle(position, mass, velocity)");
}

void set_pose(const BodyHandle& self, const Vec3& position, const Quaternion& orientation) {
  between_steps(self, "moving a body").bodies().set_pose(self.id, position, orientation);
}

void bind_making(nb::class_<SystemObject>& system) {
  const nb::tuple zero = nb::make_tuple(0.0, 0.0, 0.0);
  system.def(
      "body",
      [](nb::handle_t<SystemObject> self, const KindWord& kind, double damping, nb::object shape,
         std::optional<double> density, std::optional<double> mass, VectorArgument position, nb::object orientation,
         VectorArgument velocity, VectorArgument spin, nb::iterable attachments,
         const std::optional<Material>& material, nb::object color) {
        System& engine = nb::inst_ptr<SystemObject>(self)->use_between_steps("body(...)");
        finite_not_negative(damping, "damping", "1/s");
        const std::optional<std::uint32_t> rgb = to_opaque_color(color);
        const auto made = [&](BodyId body) {
          if (material) engine.bodies().set_material(body, material);
          if (rgb) engine.bodies().set_color(body, rgb);
          return handle_of(self, body);
        };
        if (shape.is_none()) {
          refuse_without_shape(density, mass, position, orientation, velocity, spin, attachments);
          return made(engine.bodies().create({to_kind(kind), damping}));
        }
        SolidOptions options;
        options.kind = to_kind(kind), options.damping = damping;
        if (density && mass)
          throw nb::value_error("give density or mass: a shape's mass is its density times its volume");
        if (density) options.density = finite_positive(*density, "density", "kg/m^3");
        if (mass) options.mass = finite_positive(*mass, "mass", "kg");
        options.position = to_vec3(position, "position"),
        options.orientation = to_quaternion(orientation, "orientation");
        options.velocity = to_vec3(velocity, "velocity"), options.spin = to_vec3(spin, "spin");
        for (nb::handle place : attachments) options.attachments.push_back(to_vec3({place}, "each attachment"));
        return made(engine.bodies().create(to_shape(shape), options));
      },
      "kind"_a = KindWord{"dynamic"}, "damping"_a = 0.0, nb::kw_only(), "shape"_a = nb::none(),
      "density"_a = nb::none(), "mass"_a = nb::none(), "position"_a = zero,
      "orientation"_a = nb::make_tuple(0.0, 0.0, 0.0, 1.0), "velocity"_a = zero, "spin"_a = zero,
      "attachments"_a = nb::tuple(), "material"_a.none() = nb::none(), "color"_a = nb::none(),
      nb::sig(
          "def body(self, kind: typing.Literal['dynamic', 'static', 'scripted', 'inactive', 'resting'] = 'dynamic', "
          "damping: float = 0.0, *, shape: Shape | None = None, "
          "density: float | None = None, mass: float | None = None, "
          "position: Vec3 | collections.abc.Sequence[float] = (0.0, 0.0, 0.0), "
          "orientation: " IOTA_ROTATION " = (0.0, 0.0, 0.0, 1.0), "
          "velocity: Vec3 | collections.abc.Sequence[float] = (0.0, 0.0, 0.0), "
          "spin: Vec3 | collections.abc.Sequence[float] = (0.0, 0.0, 0.0), "
          "attachments: collections.abc.Iterable[Vec3 | collections.abc.Sequence[float]] = (), "
          "material: Material | None = None, color: " IOTA_COLOR " | None = None) -> Body"),
      make_body_doc);
  system.def(
      "obstacle",
      [](nb::handle_t<SystemObject> self, nb::handle shape, VectorArgument position, nb::object orientation,
         const std::optional<Material>& material, nb::object color) {
        System& engine = nb::inst_ptr<SystemObject>(self)->use_between_steps("obstacle(...)");
        const std::optional<std::uint32_t> rgb = to_opaque_color(color);
        const BodyId body = engine.bodies().create_obstacle(to_shape(shape), to_vec3(position, "position"),
                                                            to_quaternion(orientation, "orientation"));
        if (material) engine.bodies().set_material(body, material);
        if (rgb) engine.bodies().set_color(body, rgb);
        return handle_of(self, body);
      },
      "shape"_a, "position"_a = zero, "orientation"_a = nb::make_tuple(0.0, 0.0, 0.0, 1.0), nb::kw_only(),
      "material"_a.none() = nb::none(), "color"_a = nb::none(),
      nb::sig("def obstacle(self, shape: Shape, position: Vec3 | collections.abc.Sequence[float] = (0.0, 0.0, 0.0), "
              "orientation: " IOTA_ROTATION " = (0.0, 0.0, 0.0, 1.0), *, material: Material | None = None, "
              "color: " IOTA_COLOR " | None = None) -> Body"),
      make_obstacle_doc);
}

}  // namespace

void bind_body(nb::module_& module) {
  nb::class_<BodyHandle> type(module, "Body", body_doc, nb::type_slots(handle_slots<BodyHandle>),
                              nb::is_weak_referenceable());
  auto system = nb::borrow<nb::class_<SystemObject>>(module.attr("System"));
  bind_making(system);
  def_identity(type);
  def_survival(type, "def survivor(self) -> Body | None");
  type.def_prop_ro(
          "particles",
          [](const BodyHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().bodies().particles(self.id));
          },
          nb::sig("def particles(self) -> list[Particle]"), "In the order in which they were made.")
      .def_prop_ro(
          "is_spark", [](const BodyHandle& self) { return self.use().viewer().is_spark(self.id); },
          "A free particle of an emitter: viewers draw a dot that users cannot grab.")
      .def_prop_rw(
          "kind",
          [](const BodyHandle& self) { return KindWord{to_word(kind_words, self.use().bodies().kind(self.id))}; },
          [](const BodyHandle& self, const KindWord& kind) { self.use().bodies().set_kind(self.id, to_kind(kind)); },
          "'dynamic', 'static', 'scripted', 'inactive' or 'resting'. A resting body is asleep with all bodies tied to\n"
          "it; see `System.rest_after`.")
      .def_prop_rw(
          "active", [](const BodyHandle& self) { return self.use().bodies().is_active(self.id); },
          [](const BodyHandle& self, bool active) { self.use().bodies().set_active(self.id, active); },
          "False: kind 'inactive'; its bonds do not act. Active again, it has its former kind, is at rest at its old\n"
          "place, and its hinges close.")
      .def_prop_rw(
          "damping", [](const BodyHandle& self) { return self.use().bodies().damping(self.id); },
          [](const BodyHandle& self, double value) {
            between_steps(self, "damping = ...")
                .bodies()
                .set_damping(self.id, finite_not_negative(value, "damping", "1/s"));
          },
          "1/s, adds to the system's.")
      .def_prop_rw(
          "stride", [](const BodyHandle& self) { return self.use().bodies().stride(self.id); },
          [](const BodyHandle& self, int steps) {
            between_steps(self, "stride = ...").bodies().set_stride(self.id, steps);
          },
          "How many steps are taken at once: 1 (at first) to 16; 0: frozen, with its velocities kept. Places and velocities\n"
          "are interpolated in between, so that all that reads them sees the present time. Of bodies that are solved together the\n"
          "shortest one counts, and all get it. It is 1 again as soon as an edit, a hand or a force of the script touches the\n"
          "articulate. Free particles take every step unless they are frozen. Raises ValueError for other numbers.")
      .def_prop_rw(
          "radius", [](const BodyHandle& self) { return self.use().bodies().radius(self.id); },
          [](const BodyHandle& self, double value) {
            self.use().bodies().set_radius(self.id, finite_positive(value, "radius", "m"));
          },
          "m, of the lines between its particles, or of the ball of its only particle: with it the body is drawn, met by\n"
          "queries and stands on the ground. Its own if it was assigned (that of a single particle: `Particle.radius`),\n"
          "otherwise `System.usual_radius`, twice that for a single particle. `World.draw` with a round look assigns it.\n"
          "0 for a body given by shape, which refuses another one (ValueError).")
      .def_prop_rw(
          "mass", [](const BodyHandle& self) { return self.use().bodies().mass(self.id); },
          [](const BodyHandle& self, double value) {
            between_steps(self, "mass = ...").bodies().set_mass(self.id, finite_positive(value, "mass", "kg"));
          },
          "kg. Assigning scales the masses of its particles, and its inertia with them.")
      .def_prop_ro(
          "center_of_mass", [](const BodyHandle& self) { return self.use().bodies().center_of_mass(self.id); }, "m")
      .def_prop_rw(
          "position", [](const BodyHandle& self) { return self.use().bodies().center_of_mass(self.id); },
          [](const BodyHandle& self, VectorArgument position) {
            const Bodies& bodies = between_steps(self, "position = ...").bodies();
            set_pose(self, to_vec3(position, "position"), bodies.orientation(self.id));
          },
          "Of the center of mass, m. Assigning moves it as `set_pose` does, without turning it.")
      .def_prop_rw(
          "orientation", [](const BodyHandle& self) { return to_tuple(self.use().bodies().orientation(self.id)); },
          [](const BodyHandle& self, QuaternionArgument orientation) {
            const Bodies& bodies = between_steps(self, "orientation = ...").bodies();
            set_pose(self, bodies.center_of_mass(self.id), to_quaternion(orientation.value, "orientation"));
          },
          nb::for_getter(nb::sig("def orientation(self) -> tuple[float, float, float, float]")),
          nb::for_setter(nb::sig("def orientation(self, value: " IOTA_ROTATION ", /) -> None")),
          "Of the drawn frame: unit quaternion x y z w that turns body-frame vectors into the world frame. For a body\n"
          "given by shape it is the shape's frame. Assigning turns it about its center of mass as `set_pose` does; axis and\n"
          "degrees as in ('z', 30) will do, too.")
      .def(
          "set_pose",
          [](const BodyHandle& self, VectorArgument position, nb::object orientation) {
            System& engine = between_steps(self, "set_pose");
            const Quaternion turn = orientation.is_none() ? engine.bodies().orientation(self.id)
                                                          : to_quaternion(orientation, "orientation");
            engine.bodies().set_pose(self.id, to_vec3(position, "position"), turn);
          },
          "position"_a, "orientation"_a = nb::none(),
          nb::sig("def set_pose(self, position: Vec3 | collections.abc.Sequence[float], orientation: " IOTA_ROTATION
                  " | None = None) -> None"),
          "Moves it and rigidly everything hinged to it, nails included. A scripted body arrives at the end of the\n"
          "next step. position: of the center of mass, m. orientation: as assigned, None for the present one.")
      .def_prop_ro(
          "inertia", [](const BodyHandle& self) { return to_array(self.use().bodies().inertia(self.id)); },
          nb::sig("def inertia(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(3, 3), about the center of mass, world axes, kg m^2.")
      .def_prop_rw(
          "velocity", [](const BodyHandle& self) { return self.use().bodies().velocity(self.id); },
          [](const BodyHandle& self, VectorArgument v) {
            between_steps(self, "velocity = ...").bodies().set_velocity(self.id, to_vec3(v, "velocity"));
          },
          "Of the center of mass, m/s.")
      .def_prop_rw(
          "angular_velocity", [](const BodyHandle& self) { return self.use().bodies().angular_velocity(self.id); },
          [](const BodyHandle& self, VectorArgument v) {
            between_steps(self, "angular_velocity = ...")
                .bodies()
                .set_angular_velocity(self.id, to_vec3(v, "angular_velocity"));
          },
          "rad/s, world axes. Assigning a component about an axis without inertia raises ValueError: of one point, or\n"
          "of points on a line without `set_rod`. Assigning keeps the velocity of the center; the next step projects\n"
          "it on the joints.")
      .def_prop_ro(
          "angular_momentum", [](const BodyHandle& self) { return self.use().bodies().angular_momentum(self.id); },
          "About its center of mass, kg m^2/s.")
      .def_prop_rw(
          "name", [](const BodyHandle& self) { return self.use().bodies().name(self.id); },
          [](const BodyHandle& self, const std::string& name) {
            between_steps(self, "name = ...").bodies().set_name(self.id, name);
          },
          "A name given by the script: at most 63 bytes, '' for none. Names need not be unique.")
      .def_prop_rw(
          "color",
          [](const BodyHandle& self) -> std::optional<std::string> {
            const std::optional<std::uint32_t> rgb = self.use().bodies().color(self.id);
            if (!rgb) return std::nullopt;
            char text[8];
            std::snprintf(text, sizeof text, "#%06x", *rgb & 0xffffffU);
            return text;
          },
          [](const BodyHandle& self, ColorArgument color) {
            self.use().bodies().set_color(self.id, to_opaque_color(color.value));
          },
          nb::for_getter(nb::sig("def color(self) -> str | None")), nb::for_setter(nb::arg("value").none()),
          nb::for_setter(nb::sig("def color(self, value: " IOTA_COLOR " | None, /) -> None")),
          "'#rrggbb', in which viewers draw it instead of in the colors of its look; None: in those. Assign that, a name of\n"
          "CSS such as 'tomato', 0xRRGGBB, or three numbers from 0 to 1. Pieces that are split off it have it too.")
      .def_prop_ro(
          "energy",
          [](const BodyHandle& self) {
            const BodyEnergy energy = self.use().bodies().energy(self.id);
            return Energy{.kinetic = energy.kinetic, .potential = energy.potential};
          },
          "Kinetic, and potential of its weight and of bonds and joints that it is the first body of, J.")
      .def(
          "apply_force",
          [](const BodyHandle& self, VectorArgument force, std::optional<VectorArgument> at) {
            auto bodies = between_steps(self, "apply_force").bodies();
            if (at)
              bodies.apply_force(self.id, to_vec3(force, "force"), to_vec3(*at, "at"));
            else
              bodies.apply_force(self.id, to_vec3(force, "force"));
          },
          "force"_a, "at"_a = nb::none(),
          "Adds a force (N) during the next step only, at a place (world, m) or the center of mass.")
      .def(
          "apply_torque",
          [](const BodyHandle& self, VectorArgument torque) {
            between_steps(self, "apply_torque").bodies().apply_torque(self.id, to_vec3(torque, "torque"));
          },
          "torque"_a,
          "Adds a torque (N m, world axes) during the next step only. ValueError about an axis without inertia: of a\n"
          "point, or the line that all particles are on.")
      .def_prop_ro(
          "solids", [](const BodyHandle& self) { return self.use().bodies().solids(self.id); },
          "Its solids: several after combining bodies, none for a body made only of particles.")
      .def_prop_ro(
          "attachments",
          [](const BodyHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().bodies().attachments(self.id));
          },
          nb::sig("def attachments(self) -> list[Particle]"),
          "Its particles except for a solid's own four points, in the order in which they were made.")
      .def(
          "attachment",
          [](const BodyHandle& self, VectorArgument position) {
            System& engine = between_steps(self, "attachment(...)");
            return sibling(self, engine.bodies().create_attachment(self.id, to_vec3(position, "position")));
          },
          "position"_a, nb::sig("def attachment(self, position: Vec3 | collections.abc.Sequence[float]) -> Particle"),
          "A further particle of a body given by shape, at any place (world, m). Mass, center, inertia and motion of\n"
          "the body do not change. Raises ValueError for bodies without a shape.")
      .def(
          "set_rod",
          [](const BodyHandle& self, double mass, double radius) {
            finite_positive(mass, "mass", "kg");
            finite_not_negative(radius, "radius", "m");
            between_steps(self, "set_rod").bodies().set_rod(self.id, mass, radius);
          },
          "mass"_a, "radius"_a,
          "Gives a body of exactly two particles the mass (kg) and inertia of a solid cylinder (radius in m) between\n"
          "them. It keeps the spin about its axis set by `angular_velocity`, since no torque acts about the axis.\n"
          "Raises ValueError for any other number of particles.")
      .def(
          "set_mass_properties",
          [](const BodyHandle& self, double mass, VectorArgument center, nb::handle inertia) {
            finite_positive(mass, "mass", "kg");
            nb::object array;
            const std::span<const double> v = view_rows(inertia, 3, "inertia", "row of the tensor", array);
            const Matrix3 given{Vec3{v[0], v[1], v[2]}, Vec3{v[3], v[4], v[5]}, Vec3{v[6], v[7], v[8]}};
            between_steps(self, "set_mass_properties")
                .bodies()
                .set_mass_properties(self.id, mass, to_vec3(center, "center"), given);
          },
          "mass"_a, "center"_a, "inertia"_a,
          nb::sig("def set_mass_properties(self, mass: float, center: Vec3 | collections.abc.Sequence[float], "
                  "inertia: numpy.typing.ArrayLike) -> None"),
          "Gives a body of shapes, without attachments yet, another mass (kg), center of mass (world, m) and inertia, (3, 3), about\n"
          "it, world axes, kg m^2, than a homogeneous one has: of a hollow shell, a loaded die, a robot's link with its\n"
          "motors. Its shapes stay where they are, and touch. Raises ValueError for an inertia that no body has.\n\n"
          "    die = system.body(shape=iota.Box((0.02, 0.02, 0.02), rounding=0.002), mass=0.01, position=(0, 1, 0))\n"
          "    die.set_mass_properties(0.01, (0, 0.996, 0), die.inertia)  # it falls on its heavy side")
      .def(
          "destroy", [](const BodyHandle& self) { self.use().bodies().destroy(self.id); },
          "Removes it with its particles and their bonds.")
      .def("__repr__", &repr_body);
}

}  // namespace iota::bindings
