// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "ingredient/constraint.h"
#include "shape_argument.h"
#include "typed_argument.h"

#include <nanobind/stl/tuple.h>

#include <cmath>
#include <limits>

namespace iota::bindings {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr const char* constraint_doc =
    "A constraint between two bodies, or a body and the world; made by System.revolute, ball, rope ...\n\n"
    "It stays through `combine` and `separate`, and ends when its two bodies become one rigid body or one of them\n"
    "is destroyed. Forces and coordinates are those of body a against b.";

constexpr const char* coordinate_doc =
    "The angle about a joint's axis (rad) or the slide along it (m) of a relative to b, 0 when the joint is made, and\n"
    "its limits, motor, friction and spring. Torques in N m for an angle, forces in N for a slide.";

constexpr std::array coordinate_names{"angle", "slide", "second_angle"};  // as JointCoordinate counts them

std::string word_of(ConstraintKind kind) { return ingredient::info(kind).name; }

using Pair = std::pair<double, double>;

/// The keyword arguments for a joint's coordinate.
struct CoordinateArguments {
  std::optional<Pair> limits, motor;
  double friction = 0;
  nb::object spring = nb::none();
  double friction_coefficient = 0;
};

/// One number, or up to three; those left out are 0. `form`: what the argument must be, for errors.
std::array<double, 3> to_three(nb::handle argument, const char* form) {
  std::vector<double> numbers;
  if (double first = 0; nb::try_cast(argument, first)) numbers = {first};
  if ((numbers.empty() && !nb::try_cast(argument, numbers)) || numbers.empty() || numbers.size() > 3)
    throw nb::type_error((std::string(form) + ", not " + describe(argument)).c_str());
  numbers.resize(3, 0.0);
  return {numbers[0], numbers[1], numbers[2]};
}

/// (stiffness, damping=0, rest=0), or a number: the stiffness.
void read_spring(nb::handle spring, CoordinateOptions& options) {
  if (spring.is_none()) {
    options.stiffness = options.damping = options.rest = 0;
    return;
  }
  const auto numbers = to_three(spring, "spring must be a stiffness or (stiffness, damping, rest)");
  options.stiffness = finite_not_negative(numbers[0], "spring stiffness", "N/m or N m/rad");
  options.damping = finite_not_negative(numbers[1], "spring damping", "N s/m or N m s/rad");
  options.rest = finite(numbers[2], "spring rest");
  if (options.stiffness == 0 && options.rest != 0)
    throw nb::value_error("a spring with a rest needs a stiffness: give one, or a rest of 0");
}

/// (linear, angular=0, time=0), or a number: the linear compliance.
Compliance to_compliance(nb::handle compliance) {
  const auto numbers = to_three(compliance, "compliance must be m/N or (m/N, rad/(N m), relaxation time)");
  return {finite_not_negative(numbers[0], "compliance", "m/N"),
          finite_not_negative(numbers[1], "angular compliance", "rad/(N m)"),
          finite_not_negative(numbers[2], "the relaxation time of a compliance", "s")};
}

void read_limits(const std::optional<Pair>& limits, CoordinateOptions& options) {
  std::tie(options.lower, options.upper) = limits.value_or(Pair{-infinity, infinity});
}

void read_motor(const std::optional<Pair>& motor, CoordinateOptions& options) {
  options.servo = std::numeric_limits<double>::quiet_NaN();
  std::tie(options.motor_speed, options.motor_max) = motor.value_or(Pair{0, 0});
}

/// (target, largest effort, largest speed=inf).
void read_servo(nb::handle servo, CoordinateOptions& options) {
  std::vector<double> numbers;
  if (!servo.is_none() && (!nb::try_cast(servo, numbers) || numbers.size() < 2 || numbers.size() > 3))
    throw nb::type_error(
        ("servo must be (target, largest torque or force) or (target, largest torque or force, largest speed), not " +
         describe(servo))
            .c_str());
  if (servo.is_none()) {
    if (!std::isnan(options.servo)) read_motor(std::nullopt, options);
    return;
  }
  options.servo = finite(numbers[0], "the target of a servo");
  options.motor_max = finite_not_negative(numbers[1], "the largest torque or force of a servo", "N m or N");
  options.motor_speed =
      numbers.size() == 3 ? finite_not_negative(numbers[2], "the largest speed of a servo", "rad/s or m/s") : infinity;
}

CoordinateOptions to_options(const CoordinateArguments& arguments) {
  CoordinateOptions options;
  read_limits(arguments.limits, options);
  read_motor(arguments.motor, options);
  options.friction = finite_not_negative(arguments.friction, "friction", "N or N m");
  options.friction_coefficient =
      finite_not_negative(arguments.friction_coefficient, "friction_coefficient", "times the reaction");
  read_spring(arguments.spring, options);
  return options;
}

CoordinateArguments to_arguments(nb::handle dictionary, const char* name) {
  CoordinateArguments arguments;
  if (dictionary.is_none()) return arguments;
  if (!nb::isinstance<nb::dict>(dictionary))
    throw nb::type_error((std::string(name) +
                          " must be a dict of limits, motor, friction, friction_coefficient, spring, not " +
                          describe(dictionary))
                             .c_str());
  for (const auto& [key, value] : nb::borrow<nb::dict>(dictionary)) {
    const std::string word = nb::cast<std::string>(nb::str(key));
    bool good = true;
    if (word == "limits")
      good = nb::try_cast(value, arguments.limits);
    else if (word == "motor")
      good = nb::try_cast(value, arguments.motor);
    else if (word == "friction")
      good = nb::try_cast(value, arguments.friction);
    else if (word == "friction_coefficient")
      good = nb::try_cast(value, arguments.friction_coefficient);
    else if (word == "spring")
      arguments.spring = nb::borrow(value);
    else
      throw nb::type_error(
          (std::string(name) + " has no '" + word + "'; it has limits, motor, friction, friction_coefficient, spring")
              .c_str());
    if (!good) throw nb::type_error((std::string(name) + ": " + word + " cannot be " + describe(value)).c_str());
  }
  return arguments;
}

BreakLimits to_limits(double force, double torque) { return {force, torque}; }

ConstraintHandle make_joint(SystemObject& self, JointSpec spec, const BodyHandle& a, const BodyHandle* b,
                            VectorArgument at) {
  a.use();
  if (a.system != &self) throw nb::value_error("body a belongs to another system");
  if (b) check_one_system(a, *b, "a joint"), b->use();
  spec.a = a.id;
  if (b) spec.b = b->id;
  if (at.value) spec.at = to_vec3(at, "at");
  return {a.system_object, a.system, self.use_between_steps("making a joint").joints().create(spec)};
}

ConstraintHandle make_distance(SystemObject& self, ConstraintKind kind, const ParticleHandle& p,
                               const ParticleHandle& q, std::optional<double> length, double break_force) {
  check_one_system(p, q, "a rod or rope");
  p.use(), q.use();
  if (p.system != &self) throw nb::value_error("the particles belong to another system");
  DistanceSpec spec;
  spec.kind = kind, spec.p = p.id, spec.q = q.id;
  if (length) spec.length = finite(*length, "length");
  spec.breaks = to_limits(break_force, infinity);
  return {p.system_object, p.system, self.use_between_steps("making a rod or rope").joints().create(spec)};
}

// --- curves and surfaces ----------------------------------------------------------------------------------------------

/// Points of a path: a sequence of vectors, or samples of a function of one number.
std::vector<Vec3> to_points(nb::handle path, std::optional<Pair> given_interval, std::optional<int> given_samples,
                            bool closed) {
  std::vector<Vec3> points;
  if (PyCallable_Check(path.ptr())) {
    const Pair interval = given_interval.value_or(Pair{0, 1});
    const int samples = given_samples.value_or(256);
    if (samples < 2 || samples > 100000) throw nb::value_error("samples must be from 2 to 100000");
    if (!(interval.first < interval.second)) throw nb::value_error("interval must be two numbers, the lower one first");
    const int last = closed ? samples : samples - 1;  // a closed path does not repeat its first point
    for (int i = 0; i < samples; ++i) {
      const double u = interval.first + (interval.second - interval.first) * i / last;
      nb::object point = nb::borrow(path)(u);
      points.push_back(to_vec3({point}, "each point of the path"));
    }
    return points;
  }
  if (given_interval || given_samples)
    throw nb::value_error("interval and samples are of a path that is a function; this one is a sequence of points");
  nb::object list;
  try {
    list = nb::steal(PySequence_List(path.ptr()));
  } catch (nb::python_error&) {
  }
  if (!list.is_valid()) {
    PyErr_Clear();
    throw nb::type_error(("path must be a sequence of points or a function, not " + describe(path)).c_str());
  }
  for (nb::handle point : list) points.push_back(to_vec3({point}, "each point of the path"));
  return points;
}

std::variant<Shape, SurfaceFunction> to_surface_shape(SystemObject& self, nb::handle value,
                                                      std::optional<double> given_size) {
  if (is_shape(value) || !PyCallable_Check(value.ptr())) {
    if (given_size) throw nb::value_error("size is of a surface that is a function; a shape has its own");
    return to_shape(value);
  }
  const double size = finite_positive(given_size.value_or(1), "size", "m");
  auto function = std::make_shared<ScriptFunction>(ScriptFunction{nb::borrow(value), "a surface"});
  self.keep(function);
  self.new_surfaces.push_back(function);
  return SurfaceFunction{
      [&self, function = std::move(function)](const Vec3& r) { return self.call_surface(function, r); }, size};
}

/// Frame of a surface: the given one, otherwise that of the body or of the world.
Surface to_surface(SystemObject& self, nb::handle shape, nb::handle at, nb::handle orientation, const BodyHandle* body,
                   std::optional<double> size) {
  Surface surface{to_surface_shape(self, shape, size), {}, {}};
  if (!at.is_none())
    surface.position = to_vec3({at}, "at");
  else if (body)
    surface.position = body->use().bodies().center_of_mass(body->id);
  if (!orientation.is_none())
    surface.orientation = to_quaternion(orientation, "orientation");
  else if (body)
    surface.orientation = body->use().bodies().orientation(body->id);
  return surface;
}

nb::list surfaces_of(const ConstraintHandle& self) {
  std::vector<nb::object> functions;
  nb::list given;
  std::size_t next = 0;
  const std::vector<Surface> surfaces = self.use().joints().surfaces(self.id);
  for (const auto& script : self.system->functions)
    if (script->constraint == self.id) functions.push_back(script->function);
  for (const Surface& surface : surfaces) {
    nb::dict arguments;
    if (const auto* shape = std::get_if<Shape>(&surface.shape)) {
      arguments["surface"] = from_shape(*shape);
    } else {
      arguments["surface"] = next < functions.size() ? functions[next++] : nb::object(nb::none());
      arguments["size"] = std::get<SurfaceFunction>(surface.shape).size;
    }
    const Quaternion& q = surface.orientation;
    arguments["at"] = nb::cast(surface.position), arguments["orientation"] = nb::make_tuple(q.x, q.y, q.z, q.w);
    given.append(arguments);
  }
  return given;
}

// --- coordinates ------------------------------------------------------------------------------------------------------

struct CoordinateView {
  ConstraintHandle joint;
  JointCoordinate which;

  std::size_t index() const { return static_cast<std::size_t>(which); }
  CoordinateOptions options() const { return joint.use().joints().coordinate(joint.id, which); }
  void set(const CoordinateOptions& options) const { joint.use().joints().set_coordinate(joint.id, which, options); }
};

ConstraintHandle& holder_of(CoordinateView& coordinate) { return coordinate.joint; }

void bind_coordinate(nb::module_& module) {
  nb::class_<CoordinateView>(module, "JointCoordinate", coordinate_doc, nb::type_slots(handle_slots<CoordinateView>))
      .def_prop_ro(
          "joint", [](const CoordinateView& self) { return self.joint; },
          nb::for_getter(nb::sig("def joint(self) -> Constraint")), "The joint whose coordinate it is.")
      .def_prop_ro(
          "name", [](const CoordinateView& self) { return coordinate_names[self.index()]; },
          "'angle', 'slide' or 'second_angle': its name in the joint.")
      .def_prop_rw(
          "value",
          [](const CoordinateView& self) {
            return self.joint.use().joints().state(self.joint.id).coordinate[self.index()];
          },
          [](const CoordinateView& self, double value) {
            self.joint.use();
            System& engine = self.joint.system->use_between_steps("value = ...");
            engine.joints().set_value(self.joint.id, self.which, finite(value, "value"));
          },
          "rad, counted through full turns, or m. Assigning moves the mechanism: everything attached to a as one\n"
          "rigid body (or to b, if a is fixed); in a loop all bodies make the least motion. ValueError beyond the\n"
          "limits and if the mechanism cannot reach it; then nothing changes.")
      .def("__float__",
           [](const CoordinateView& self) {
             return self.joint.use().joints().state(self.joint.id).coordinate[self.index()];
           })
      .def_prop_ro(
          "speed",
          [](const CoordinateView& self) { return self.joint.use().joints().state(self.joint.id).speed[self.index()]; },
          "rad/s or m/s")
      .def_prop_ro(
          "effort",
          [](const CoordinateView& self) {
            return self.joint.use().joints().state(self.joint.id).effort[self.index()].total();
          },
          "Sum of stops, motor, friction and spring along it on a in the last step, N m or N.")
      .def_prop_ro(
          "efforts",
          [](const CoordinateView& self) {
            const CoordinateEfforts of = self.joint.use().joints().state(self.joint.id).effort[self.index()];
            nb::dict all;
            all["stop"] = of.stop, all["motor"] = of.motor, all["friction"] = of.friction, all["spring"] = of.spring;
            return all;
          },
          nb::sig("def efforts(self) -> dict[str, float]"),
          "The parts of its effort by name: stop, motor, friction, spring.")
      .def_prop_rw(
          "limits",
          [](const CoordinateView& self) {
            const CoordinateOptions o = self.options();
            return std::isfinite(o.lower) || std::isfinite(o.upper) ? std::optional<Pair>({o.lower, o.upper})
                                                                    : std::nullopt;
          },
          [](const CoordinateView& self, std::optional<Pair> limits) {
            CoordinateOptions options = self.options();
            read_limits(limits, options);
            self.set(options);
          },
          nb::for_setter(nb::arg("limits").none()), "(lower, upper), rad or m: inelastic stops; None for none.")
      .def_prop_rw(
          "motor",
          [](const CoordinateView& self) {
            const CoordinateOptions o = self.options();
            return o.motor_max > 0 && std::isnan(o.servo) ? std::optional<Pair>({o.motor_speed, o.motor_max})
                                                          : std::nullopt;
          },
          [](const CoordinateView& self, std::optional<Pair> motor) {
            CoordinateOptions options = self.options();
            read_motor(motor, options);
            self.set(options);
          },
          nb::for_setter(nb::arg("motor").none()),
          "(speed, largest torque or force); None for none. Speed 0 is a brake.")
      .def_prop_rw(
          "servo",
          [](const CoordinateView& self) -> std::optional<std::tuple<double, double, double>> {
            const CoordinateOptions o = self.options();
            if (std::isnan(o.servo) || o.motor_max == 0) return std::nullopt;
            return std::tuple{o.servo, o.motor_max, o.motor_speed};
          },
          [](const CoordinateView& self, ServoArgument servo) {
            CoordinateOptions options = self.options();
            read_servo(servo.value, options);
            self.set(options);
          },
          nb::for_setter(nb::arg("servo").none()),
          "(target, largest torque or force, largest speed=inf): a motor that moves to the target and holds it; None\n"
          "for none. It slows down such that the distance falls as exp(-t / 0.05 s). A motor and a servo replace each\n"
          "other.")
      .def_prop_rw(
          "friction", [](const CoordinateView& self) { return self.options().friction; },
          [](const CoordinateView& self, double friction) {
            CoordinateOptions options = self.options();
            options.friction = finite_not_negative(friction, "friction", "N or N m");
            self.set(options);
          },
          "Dry: up to this torque or force against any motion.")
      .def_prop_rw(
          "friction_coefficient", [](const CoordinateView& self) { return self.options().friction_coefficient; },
          [](const CoordinateView& self, double coefficient) {
            CoordinateOptions options = self.options();
            options.friction_coefficient =
                finite_not_negative(coefficient, "friction_coefficient", "times the reaction");
            self.set(options);
          },
          "Of the slide of a prismatic or cylindrical joint: dry friction of up to this times the reaction across the\n"
          "axis (Coulomb). 0: none. ValueError for other coordinates, and with a compliance.")
      .def_prop_rw(
          "spring",
          [](const CoordinateView& self) -> std::optional<std::tuple<double, double, double>> {
            const CoordinateOptions o = self.options();
            if (o.stiffness == 0 && o.damping == 0) return std::nullopt;
            return std::tuple{o.stiffness, o.damping, o.rest};
          },
          [](const CoordinateView& self, SpringArgument spring) {
            CoordinateOptions options = self.options();
            read_spring(spring, options);
            self.set(options);
          },
          nb::for_setter(nb::arg("spring").none()), "(stiffness, damping, rest) or a stiffness; None for none.")
      .def("__repr__", [](const CoordinateView& self) {
        const ConstraintState state = self.joint.use().joints().state(self.joint.id);
        const bool is_slide = self.which == JointCoordinate::slide;
        return std::string("<") + coordinate_names[self.index()] + " " +
               std::to_string(state.coordinate[self.index()]) + (is_slide ? " m>" : " rad>");
      });
}

CoordinateView coordinate_of(const ConstraintHandle& self, JointCoordinate which) {
  (void)self.use();
  const ConstraintKind kind = self.system->engine.joints().state(self.id).kind;
  if (!has_coordinate(kind, which)) {
    const std::string text = "a " + word_of(kind) + " has no " + coordinate_names[static_cast<std::size_t>(which)];
    PyErr_SetString(PyExc_AttributeError, text.c_str());
    throw nb::python_error();
  }
  return {self, which};
}

/// A coordinate, or the only one of a joint.
CoupledCoordinate to_coupled(SystemObject& self, nb::handle value, double ratio) {
  CoupledCoordinate term{.constraint = {}, .ratio = finite(ratio, "ratio")};
  const ConstraintHandle* joint = nullptr;
  if (nb::isinstance<CoordinateView>(value)) {
    const CoordinateView* const coordinate = nb::inst_ptr<CoordinateView>(value);
    joint = &coordinate->joint;
    term.coordinate = coordinate->which;
  } else if (nb::isinstance<ConstraintHandle>(value)) {
    joint = nb::inst_ptr<ConstraintHandle>(value);
    const ConstraintKind kind = joint->use().joints().state(joint->id).kind;
    std::vector<JointCoordinate> found;
    for (const JointCoordinate which : joint_coordinates)
      if (has_coordinate(kind, which)) found.push_back(which);
    if (found.size() != 1)
      throw nb::type_error(
          ("a " + word_of(kind) + " has " +
           (found.empty() ? "no coordinate to couple" : "several coordinates: name one, as in joint.angle"))
              .c_str());
    term.coordinate = found.front();
  } else {
    throw nb::type_error(("a coupling takes joint.angle, joint.slide or a joint, not " + describe(value)).c_str());
  }
  joint->use();
  if (joint->system != &self) throw nb::value_error("a joint belongs to another system");
  term.constraint = joint->id;
  return term;
}

// --- the handle -------------------------------------------------------------------------------------------------------

template <class Member>
auto read(Member ConstraintState::* member) {
  return [member](const ConstraintHandle& self) { return self.use().joints().state(self.id).*member; };
}

nb::object body_or_none(const ConstraintHandle& self, BodyId id) {
  return id ? nb::cast(sibling(self, id)) : nb::none();
}

std::string repr_constraint(const ConstraintHandle& self) {
  if (!self.is_alive()) return stale_repr("Constraint", self);
  const ConstraintState state = self.system->engine.joints().state(self.id);
  return "<Constraint " + std::to_string(self.id.slot) + ": " + word_of(state.kind) + " of body " +
         std::to_string(state.a.slot) + " and " + (state.b ? "body " + std::to_string(state.b.slot) : "the world") +
         (state.broken   ? ", broken>"
          : state.active ? ">"
                         : ", switched off>");
}

void bind_handle(nb::module_& module) {
  nb::class_<ConstraintHandle> type(module, "Constraint", constraint_doc,
                                    nb::type_slots(handle_slots<ConstraintHandle>), nb::is_weak_referenceable());
  def_identity(type);
  type.def_prop_ro(
          "alive", [](const ConstraintHandle& self) { return self.is_alive(); },
          "False once it or one of the things it connects was destroyed.")
      .def_prop_ro(
          "kind", [](const ConstraintHandle& self) { return word_of(self.use().joints().state(self.id).kind); },
          "'revolute', 'rope' ...")
      .def_prop_ro(
          "a", [](const ConstraintHandle& self) { return body_or_none(self, self.use().joints().state(self.id).a); },
          nb::sig("def a(self) -> Body"))
      .def_prop_ro(
          "b", [](const ConstraintHandle& self) { return body_or_none(self, self.use().joints().state(self.id).b); },
          nb::sig("def b(self) -> Body | None"), "None: the world.")
      .def_prop_ro(
          "particles",
          [](const ConstraintHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().joints().particles(self.id));
          },
          nb::sig("def particles(self) -> list[Particle]"), "All particles of it, its own markers included.")
      .def_prop_rw(
          "active", read(&ConstraintState::active),
          [](const ConstraintHandle& self, bool active) { self.use().joints().set_active(self.id, active); },
          "False while it is switched off or broken; True repairs it in the pose in which its bodies were joined.")
      .def_prop_ro("broken", read(&ConstraintState::broken), "By a load beyond break_force or break_torque.")
      .def_prop_ro("position", read(&ConstraintState::position), "Where it acts on a, m.")
      .def_prop_ro("axis", read(&ConstraintState::axis), "Unit vector, world frame; zero for kinds without one.")
      .def_prop_ro("second_axis", read(&ConstraintState::second_axis),
                   "The same, of b in a universal joint; zero for other kinds.")
      .def_prop_ro("force", read(&ConstraintState::force), "On a in the last step, N; the opposite acts on b.")
      .def_prop_ro("torque", read(&ConstraintState::torque), "On a about `position` in the last step, N m.")
      .def_prop_ro("gap", read(&ConstraintState::gap), "Largest violation after the last step, m.")
      .def_prop_rw(
          "length", read(&ConstraintState::length),
          [](const ConstraintHandle& self, double length) {
            self.use().joints().set_length(self.id, finite(length, "length"));
          },
          "Of a rod or rope, m. Of a coupling: the sum of ratio times coordinate. A change runs evenly within the next step;\n"
          "one of more than a tenth closes as a gap, at no velocity.")
      .def_prop_ro(
          "terms",
          [](const ConstraintHandle& self) {
            nb::list terms;
            for (const CoupledCoordinate& term : self.use().joints().terms(self.id))
              terms.append(nb::make_tuple(
                  CoordinateView{{self.system_object, self.system, term.constraint}, term.coordinate}, term.ratio));
            return terms;
          },
          nb::sig("def terms(self) -> list[tuple[JointCoordinate, float]]"),
          "Of a coupling: the coordinates of its sum, each with its ratio.")
      .def_prop_ro(
          "path",
          [](const ConstraintHandle& self) {
            const PathSpec spec = self.use().joints().path(self.id);
            const bool smooth = spec.curve == CurveKind::spline;
            nb::list points;
            for (const Vec3& point : spec.points) points.append(nb::cast(point));
            nb::dict given;
            given["path"] = points, given["closed"] = spec.closed, given["smooth"] = smooth;
            if (!smooth && spec.rounding >= 0) given["rounding"] = spec.rounding;
            return given;
          },
          nb::sig("def path(self) -> dict[str, Any]"),
          "Of `System.on_path`: its arguments path, closed, smooth and rounding, where the points are now. Raises\n"
          "ValueError for other kinds.")
      .def_prop_ro(
          "surfaces", &surfaces_of, nb::sig("def surfaces(self) -> list[dict[str, Any]]"),
          "Of surface constraints: the arguments surface, at, orientation and, of a function, size of each surface,\n"
          "where it is now; that of a before that of b. Empty for other kinds.")
      .def_prop_ro("angle", [](const ConstraintHandle& self) { return coordinate_of(self, JointCoordinate::angle); })
      .def_prop_ro("slide", [](const ConstraintHandle& self) { return coordinate_of(self, JointCoordinate::slide); })
      .def_prop_ro(
          "second_angle",
          [](const ConstraintHandle& self) { return coordinate_of(self, JointCoordinate::second_angle); },
          "Of a universal joint, about b's axis.")
      .def_prop_rw(
          "compliance",
          [](const ConstraintHandle& self) {
            const Compliance c = self.use().joints().compliance(self.id);
            return nb::make_tuple(c.linear, c.angular, c.time);
          },
          [](const ConstraintHandle& self, nb::handle compliance) {
            self.use().joints().set_compliance(self.id, to_compliance(compliance));
          },
          nb::for_getter(nb::sig("def compliance(self) -> tuple[float, float, float]")),
          nb::for_setter(nb::sig("def compliance(self, compliance: float | Sequence[float]) -> None")),
          "How far it yields in the directions that it holds: (m/N, rad/(N m), relaxation time in s); 0: exact. A load F\n"
          "moves its bodies apart by F times the first, a torque turns them by the second; once the load is gone they\n"
          "return within about the relaxation time. Of joints, rods and ropes. One number is m/N.\n\n"
          "    shoulder.compliance = (1e-6, 1e-3, 0.02)")
      .def_prop_rw(
          "break_force", [](const ConstraintHandle& self) { return self.use().joints().break_limits(self.id).force; },
          [](const ConstraintHandle& self, double force) {
            between_steps(self, "break_force = ...")
                .joints()
                .set_break_limits(self.id, {force, self.system->engine.joints().break_limits(self.id).torque});
          },
          "N; inf: never.")
      .def_prop_rw(
          "break_torque", [](const ConstraintHandle& self) { return self.use().joints().break_limits(self.id).torque; },
          [](const ConstraintHandle& self, double torque) {
            between_steps(self, "break_torque = ...")
                .joints()
                .set_break_limits(self.id, {self.system->engine.joints().break_limits(self.id).force, torque});
          },
          "N m; inf: never.")
      .def(
          "destroy", [](const ConstraintHandle& self) { self.use().joints().destroy(self.id); }, "Removes it.")
      .def("__repr__", &repr_constraint);
}

// --- breaking ---------------------------------------------------------------------------------------------------------

struct BrokenView {
  nb::object system_object;
  SystemObject* system;
  Broken broken;
};

void bind_broken(nb::module_& module) {
  nb::class_<BrokenView>(module, "Broken", "A constraint, bond, hinge or nail that broke because of its load.",
                         nb::type_slots(handle_slots<BrokenView>))
      .def_prop_ro(
          "constraint",
          [](const BrokenView& self) {
            return self.broken.constraint ? nb::cast(sibling(self, self.broken.constraint)) : nb::none();
          },
          nb::sig("def constraint(self) -> Constraint | None"), "Now inactive; None where something else broke.")
      .def_prop_ro(
          "bond",
          [](const BrokenView& self) {
            return self.broken.bond ? nb::cast(sibling(self, self.broken.bond)) : nb::none();
          },
          nb::sig("def bond(self) -> Bond | None"), "Now inactive; None where something else broke.")
      .def_prop_ro(
          "particle",
          [](const BrokenView& self) {
            return self.broken.particle ? nb::cast(sibling(self, self.broken.particle)) : nb::none();
          },
          nb::sig("def particle(self) -> Particle | None"),
          "The one that left its hinge or lost its nail; None if something else broke.")
      .def_prop_ro(
          "position", [](const BrokenView& self) { return self.broken.position; }, "m")
      .def_prop_ro(
          "force", [](const BrokenView& self) { return self.broken.force; }, "N")
      .def_prop_ro(
          "torque", [](const BrokenView& self) { return self.broken.torque; }, "N m")
      .def("__repr__", [](const BrokenView& self) {
        const std::string what = self.broken.constraint ? name_of(self.broken.constraint)
                                 : self.broken.bond     ? name_of(self.broken.bond)
                                                        : name_of(self.broken.particle);
        return "<Broken: " + what + " at " + std::to_string(self.broken.force) + " N, " +
               std::to_string(self.broken.torque) + " N m>";
      });
}

// --- reaching and leaving stops ---------------------------------------------------------------------------------------

struct StopView {
  nb::object system_object;
  SystemObject* system;
  StopEvent event;
};

void bind_stop(nb::module_& module) {
  nb::class_<StopView>(
      module, "StopEvent",
      "A one-sided constraint began or ceased to carry a load: surfaces met or parted, a rope became taut or slack, a\n"
      "coordinate reached or left a stop.",
      nb::type_slots(handle_slots<StopView>))
      .def_prop_ro(
          "met", [](const StopView& self) { return self.event.kind == StopEvent::Kind::met; },
          "True if it began, False if it ceased.")
      .def_prop_ro(
          "constraint", [](const StopView& self) { return sibling(self, self.event.constraint); }, "What carries.")
      .def_prop_ro(
          "coordinate",
          [](const StopView& self) -> std::optional<std::string> {
            if (!self.event.coordinate) return std::nullopt;
            return coordinate_names[static_cast<std::size_t>(*self.event.coordinate)];
          },
          "Whose stop it is: 'angle', 'slide' or 'second_angle'; None for the constraint itself.")
      .def_prop_ro(
          "position", [](const StopView& self) { return self.event.position; }, "Where it acts on a, m.")
      .def("__repr__", [](const StopView& self) {
        const StopEvent& e = self.event;
        const std::string what =
            e.coordinate ? std::string(" a stop of its ") + coordinate_names[static_cast<std::size_t>(*e.coordinate)]
                         : "";
        const bool met = e.kind == StopEvent::Kind::met;
        return "<StopEvent: " + name_of(e.constraint) +
               (e.coordinate ? (met ? " reached" : " left") : (met ? " met" : " parted")) + what + ">";
      });
}

// --- making -----------------------------------------------------------------------------------------------------------

void bind_constraint_makers(nb::class_<SystemObject>& type) {
  type.def(
      "ball",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, double break_force,
         double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::ball, spec.breaks = to_limits(break_force, break_torque);
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "break_force"_a = infinity, "break_torque"_a = infinity,
      "A point of a stays at a point of b (None: of the world). at: where, m.");
  type.def(
      "weld",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, std::optional<VectorArgument> at,
         double break_force, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::weld, spec.breaks = to_limits(break_force, break_torque);
        spec.at = a.use().bodies().center_of_mass(a.id);
        return make_joint(self, spec, a, b, at.value_or(VectorArgument{}));
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a.none() = nb::none(), "break_force"_a = infinity,
      "break_torque"_a = infinity,
      "b (None: the world) holds a in its present pose. at: point of its force and torque, m, None: a's center of mass. Unlike\n"
      "`combine` it keeps two bodies, reports its load, and can break.");

  const auto with_coordinate = [&](const char* name, ConstraintKind kind, const char* text) {
    type.def(
        name,
        [kind](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, VectorArgument axis,
               std::optional<Pair> limits, std::optional<Pair> motor, double friction, SpringArgument spring,
               double break_force, double break_torque) {
          JointSpec spec;
          spec.kind = kind, spec.breaks = to_limits(break_force, break_torque);
          spec.axis = to_vec3(axis, "axis");
          spec.angle = to_options({limits, motor, friction, spring});
          return make_joint(self, spec, a, b, at);
        },
        "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "axis"_a, "limits"_a.none() = nb::none(),
        "motor"_a.none() = nb::none(), "friction"_a = 0.0, "spring"_a.none() = nb::none(), "break_force"_a = infinity,
        "break_torque"_a = infinity, text);
  };
  with_coordinate(
      "revolute", ConstraintKind::revolute,
      "a turns relative to b (None: the world) about an axis through `at` (m). limits: (lower, upper) in rad. motor:\n"
      "(speed in rad/s, largest torque in N m). friction: N m, dry. spring: (N m/rad, N m s/rad, rest in rad).");
  type.def(
      "prismatic",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, VectorArgument axis,
         std::optional<Pair> limits, std::optional<Pair> motor, double friction, double friction_coefficient,
         SpringArgument spring, double break_force, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::prismatic, spec.breaks = to_limits(break_force, break_torque);
        spec.axis = to_vec3(axis, "axis");
        spec.slide = to_options({limits, motor, friction, spring, friction_coefficient});
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "axis"_a, "limits"_a.none() = nb::none(),
      "motor"_a.none() = nb::none(), "friction"_a = 0.0, "friction_coefficient"_a = 0.0, "spring"_a.none() = nb::none(),
      "break_force"_a = infinity, "break_torque"_a = infinity,
      "a slides relative to b (None: the world) along an axis, without turning. limits: (lower, upper) in m. motor:\n"
      "(speed in m/s, largest force in N). friction: N, dry. friction_coefficient: dry friction of up to this times the\n"
      "reaction across the axis (Coulomb). spring: (N/m, N s/m, rest in m).");
  with_coordinate(
      "planar", ConstraintKind::planar,
      "a slides and turns relative to b (None: the world) in a plane through `at` (m) normal to the axis. limits,\n"
      "motor, friction and spring act on the angle about it.");
  type.def(
      "screw",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, VectorArgument axis,
         double lead, DriveArgument angle, DriveArgument slide, double break_force, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::screw, spec.breaks = to_limits(break_force, break_torque);
        spec.axis = to_vec3(axis, "axis");
        spec.lead = finite(lead, "lead");
        spec.angle = to_options(to_arguments(angle, "angle"));
        spec.slide = to_options(to_arguments(slide, "slide"));
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "axis"_a, "lead"_a, "angle"_a.none() = nb::none(),
      "slide"_a.none() = nb::none(), "break_force"_a = infinity, "break_torque"_a = infinity,
      "a turns about an axis of b (None: the world) and slides along it by `lead` (m; negative: left-handed) with each full\n"
      "turn. angle, slide: dicts of limits, motor, friction, spring.");
  type.def(
      "cylindrical",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, VectorArgument axis,
         DriveArgument angle, DriveArgument slide, double break_force, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::cylindrical, spec.breaks = to_limits(break_force, break_torque);
        spec.axis = to_vec3(axis, "axis");
        spec.angle = to_options(to_arguments(angle, "angle"));
        spec.slide = to_options(to_arguments(slide, "slide"));
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "axis"_a, "angle"_a.none() = nb::none(),
      "slide"_a.none() = nb::none(), "break_force"_a = infinity, "break_torque"_a = infinity,
      "a turns about and slides along an axis of b (None: the world). angle, slide: dicts of limits, motor, friction,\n"
      "spring; slide may have a friction_coefficient, as that of `prismatic`.");
  type.def(
      "universal",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, VectorArgument at, VectorArgument axis,
         std::optional<VectorArgument> second_axis, std::optional<Pair> limits, std::optional<Pair> motor,
         double friction, SpringArgument spring, DriveArgument second_angle, double break_force, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::universal, spec.breaks = to_limits(break_force, break_torque);
        spec.axis = to_vec3(axis, "axis");
        if (second_axis) spec.second_axis = to_vec3(*second_axis, "second_axis");
        spec.angle = to_options({limits, motor, friction, spring});
        spec.second_angle = to_options(to_arguments(second_angle, "second_angle"));
        return make_joint(self, spec, a, b, at);
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "at"_a, "axis"_a, "second_axis"_a.none() = nb::none(),
      "limits"_a.none() = nb::none(), "motor"_a.none() = nb::none(), "friction"_a = 0.0, "spring"_a.none() = nb::none(),
      "second_angle"_a.none() = nb::none(), "break_force"_a = infinity, "break_torque"_a = infinity,
      "A ball joint with `axis` of a at right angles to `second_axis` of b (None: the world): a shaft's cross. The\n"
      "angle is about a's axis, the second angle about b's: second_angle, a dict of limits, motor, friction, spring, acts\n"
      "on that.");
  type.def(
      "orientation",
      [](SystemObject& self, const BodyHandle& a, const BodyHandle* b, double break_torque) {
        JointSpec spec;
        spec.kind = ConstraintKind::orientation, spec.breaks = to_limits(infinity, break_torque);
        return make_joint(self, spec, a, b, {});
      },
      "a"_a, "b"_a.none() = nb::none(), nb::kw_only(), "break_torque"_a = infinity,
      "a keeps its orientation relative to b (None: the world) but moves freely.");
  const auto between = [&](const char* name, ConstraintKind kind, const char* text) {
    type.def(
        name,
        [kind](SystemObject& self, const ParticleHandle& p, const ParticleHandle& q, std::optional<double> length,
               double break_force) { return make_distance(self, kind, p, q, length, break_force); },
        "p"_a, "q"_a, "length"_a.none() = nb::none(), nb::kw_only(), "break_force"_a = infinity, text);
  };
  between("rod", ConstraintKind::rod,
          "Two particles of different bodies keep their distance: length in m, None for the present one.");
  between("rope", ConstraintKind::rope,
          "The distance of two particles of different bodies is at most length (m, None: the present one).");
  type.def(
      "rope",
      [](SystemObject& self, const std::vector<ParticleHandle>& points, std::optional<double> length,
         double break_force) {
        TackleSpec spec;
        for (const ParticleHandle& point : points) {
          point.use();
          if (point.system != &self) throw nb::value_error("the points belong to another system");
          spec.points.push_back(point.id);
        }
        if (length) spec.length = finite_positive(*length, "length", "m");
        spec.breaks = to_limits(break_force, infinity);
        System& engine = self.use_between_steps("making a rope");
        return ConstraintHandle{nb::find(self), &self, engine.joints().create(spec)};
      },
      "points"_a, "length"_a.none() = nb::none(), nb::kw_only(), "break_force"_a = infinity,
      "A rope that runs without friction or mass from the first point over the others to the last: the sum of the\n"
      "distances from each to the next is at most length (m, None: the present one). Repeat a point to lead the rope\n"
      "back to it: a block and tackle is [ceiling, block, ceiling, block].");
  type.def(
      "span",
      [](SystemObject& self, const ParticleHandle& p, const ParticleHandle& q, std::optional<Pair> limits,
         std::optional<Pair> motor, double friction, SpringArgument spring, double break_force) {
        check_one_system(p, q, "a span");
        p.use(), q.use();
        if (p.system != &self) throw nb::value_error("the particles belong to another system");
        SpanSpec spec{p.id, q.id, to_options({limits, motor, friction, spring}), to_limits(break_force, infinity)};
        return ConstraintHandle{p.system_object, p.system,
                                self.use_between_steps("making a span").joints().create(spec)};
      },
      "p"_a, "q"_a, nb::kw_only(), "limits"_a.none() = nb::none(), "motor"_a.none() = nb::none(), "friction"_a = 0.0,
      "spring"_a.none() = nb::none(), "break_force"_a = infinity,
      "Makes the distance of two particles a coordinate, `span.slide` (m), without constraining it. A ram or a muscle\n"
      "with a motor or servo, a damper with a spring, or part of a coupling, such as a rope on a winch.");
  type.def(
      "couple",
      [](SystemObject& self, TermsArgument terms, std::optional<double> length, bool one_sided, double break_force,
         double break_torque) {
        CouplingSpec spec;
        spec.kind = one_sided ? ConstraintKind::tackle : ConstraintKind::coupling;
        if (length) spec.length = finite(*length, "length");
        for (nb::handle term : nb::iter(terms.value)) {
          double ratio = 0;
          if (!nb::isinstance<nb::tuple>(term) || nb::len(term) != 2 || !nb::try_cast(nb::object(term[1]), ratio))
            throw nb::type_error(("each term must be (coordinate, ratio), not " + describe(term)).c_str());
          spec.terms.push_back(to_coupled(self, nb::object(term[0]), ratio));
        }
        spec.breaks = to_limits(break_force, break_torque);
        System& engine = self.use_between_steps("coupling");
        return ConstraintHandle{nb::find(self), &self, engine.joints().create(spec)};
      },
      "terms"_a, nb::kw_only(), "length"_a.none() = nb::none(), "one_sided"_a = false, "break_force"_a = infinity,
      "break_torque"_a = infinity,
      "The sum of ratio times coordinate is length (None: what it is now), or with one_sided at most that. terms:\n"
      "(joint.angle, ratio), (joint.slide, ratio) ... A differential: [(left.angle, 1), (right.angle, 1),\n"
      "(carrier.angle, -2)].");
  type.def(
      "gear",
      [](SystemObject& self, CoordinateArgument a, CoordinateArgument b, double ratio, double break_torque) {
        CouplingSpec spec;
        spec.terms = {to_coupled(self, a.value, ratio), to_coupled(self, b.value, -1)};
        if (ratio == 0) throw nb::value_error("ratio must not be zero");
        spec.breaks = to_limits(infinity, break_torque);
        System& engine = self.use_between_steps("making a gear");
        return ConstraintHandle{nb::find(self), &self, engine.joints().create(spec)};
      },
      "a"_a, "b"_a, "ratio"_a, nb::kw_only(), "break_torque"_a = infinity,
      "Two coordinates (joint.angle, joint.slide) move together: b by ratio when a moves by 1. Wheels with outer teeth:\n"
      "minus the teeth of a over those of b; a belt or inner teeth: plus. Rack and pinion: the slide by the radius (m) when\n"
      "the angle moves by 1 rad; a screw: by its lead / 2 pi.");
  type.def(
      "on_path",
      [](SystemObject& self, const ParticleHandle& p, PathArgument path, const BodyHandle* body, bool closed,
         std::optional<bool> smooth, std::optional<double> rounding, std::optional<Pair> interval,
         std::optional<int> samples, std::optional<Pair> limits, std::optional<Pair> motor, double friction,
         SpringArgument spring, double break_force) {
        p.use();
        if (p.system != &self || (body && body->system != &self))
          throw nb::value_error("the particle or body belongs to another system");
        PathSpec spec;
        spec.particle = p.id;
        if (body) body->use(), spec.body = body->id;
        spec.points = to_points(path, interval, samples, closed);
        if (rounding && smooth.value_or(false))
          throw nb::value_error("rounding is of the corners of straight pieces; a smooth path has none");
        spec.curve = smooth.value_or(!rounding) ? CurveKind::spline : CurveKind::polyline;
        spec.closed = closed;
        if (rounding) spec.rounding = finite_not_negative(*rounding, "rounding", "m");
        spec.slide = to_options({limits, motor, friction, spring});
        spec.breaks = to_limits(break_force, infinity);
        return ConstraintHandle{p.system_object, p.system, self.use_between_steps("on_path").joints().create(spec)};
      },
      "p"_a, "path"_a, "body"_a.none() = nb::none(), nb::kw_only(), "closed"_a = false, "smooth"_a.none() = nb::none(),
      "rounding"_a.none() = nb::none(), "interval"_a.none() = nb::none(), "samples"_a.none() = nb::none(),
      "limits"_a.none() = nb::none(), "motor"_a.none() = nb::none(), "friction"_a = 0.0, "spring"_a.none() = nb::none(),
      "break_force"_a = infinity,
      "A particle stays on a curve of body (None: the world). path: points (world, m), or a function of a number in\n"
      "`interval` (None: 0 to 1), evaluated at `samples` (None: 256). smooth: a cubic spline through them (None:\n"
      "unless there is a rounding), else straight pieces with corners of radius `rounding` (m; None: a tenth of the\n"
      "shorter piece). Its slide is the length along the path (m); an open path ends at its ends unless `limits` are\n"
      "given.");
  const auto on_surface = [&](const char* name, ConstraintKind kind, const char* text) {
    type.def(
        name,
        [kind](SystemObject& self, const ParticleHandle& p, SurfaceArgument surface, const BodyHandle* body,
               PlaceArgument at, QuaternionArgument orientation, std::optional<double> size, double break_force) {
          p.use();
          if (p.system != &self || (body && body->system != &self))
            throw nb::value_error("the particle or body belongs to another system");
          SurfaceSpec spec;
          spec.kind = kind, spec.particle = p.id;
          self.use_between_steps("a surface");
          self.new_surfaces.clear();
          spec.surface = to_surface(self, surface, at, orientation, body, size);
          if (body) spec.body = body->id;
          spec.breaks = to_limits(break_force, infinity);
          return ConstraintHandle{p.system_object, p.system, self.create_surface_constraint(spec)};
        },
        "p"_a, "surface"_a, "body"_a.none() = nb::none(), nb::kw_only(), "at"_a.none() = nb::none(),
        "orientation"_a.none() = nb::none(), "size"_a.none() = nb::none(), "break_force"_a = infinity, text);
  };
  on_surface(
      "on_surface", ConstraintKind::surface,
      "A particle stays on a surface of body (None: the world). surface: a shape without sharp edges (a box or\n"
      "cylinder with a rounding, no cone or mesh), or a function of x, y, z that is 0 on it, negative inside and\n"
      "about the distance (m) near it; `size`, m (None: 1), is then the size of the surface. It must not use the\n"
      "system; if it raises or returns no finite number, the constraint is switched off and `step` raises\n"
      "ConstraintError. at, orientation: of the surface's frame, None: the body's.");
  on_surface("inside", ConstraintKind::inside,
             "A particle stays on the inner side of a surface: as `on_surface`, one-sided; edges may be sharp.");
  on_surface("outside", ConstraintKind::outside,
             "A particle stays on the outer side of a surface: as `on_surface`, one-sided; edges may be sharp.");
  type.def(
      "surface_to_surface",
      [](SystemObject& self, const BodyHandle& a, SurfaceArgument surface_a, const BodyHandle* b,
         SurfaceArgument surface_b, bool one_sided, PlaceArgument at_a, QuaternionArgument orientation_a,
         PlaceArgument at_b, QuaternionArgument orientation_b, double break_force) {
        a.use();
        if (a.system != &self) throw nb::value_error("body a belongs to another system");
        if (b) check_one_system(a, *b, "surface_to_surface"), b->use();
        self.use_between_steps("surface_to_surface");
        self.new_surfaces.clear();
        SurfacePairSpec spec;
        spec.kind = one_sided ? ConstraintKind::apart : ConstraintKind::touching;
        spec.a = a.id;
        if (b) spec.b = b->id;
        spec.surface_a = to_surface(self, surface_a, at_a, orientation_a, &a, std::nullopt);
        spec.surface_b = to_surface(self, surface_b, at_b, orientation_b, b, std::nullopt);
        spec.breaks = to_limits(break_force, infinity);
        return ConstraintHandle{a.system_object, a.system, self.create_surface_constraint(spec)};
      },
      "a"_a, "surface_a"_a, "b"_a.none(), "surface_b"_a, nb::kw_only(), "one_sided"_a = true,
      "at_a"_a.none() = nb::none(), "orientation_a"_a.none() = nb::none(), "at_b"_a.none() = nb::none(),
      "orientation_b"_a.none() = nb::none(), "break_force"_a = infinity,
      "Two convex surfaces, one of body a and one of b (None: the world), do not overlap, or, with one_sided=False, stay in\n"
      "touch; without friction. Frames as in `on_surface`.");
  type.def_prop_ro(
      "constraints",
      [](nb::handle_t<SystemObject> self) {
        SystemObject* object = nb::inst_ptr<SystemObject>(self);
        return wrap_all<ConstraintHandle>(nb::borrow(self), object, object->use().joints().ids());
      },
      nb::sig("def constraints(self) -> list[Constraint]"), "In order of slots.");
  type.def_prop_ro(
      "stops",
      [](nb::handle_t<SystemObject> self) {
        SystemObject* object = nb::inst_ptr<SystemObject>(self);
        object->use();
        std::vector<StopView> out;
        for (const StopEvent& event : object->stops) out.push_back({nb::borrow(self), object, event});
        return out;
      },
      nb::sig("def stops(self) -> list[StopEvent]"),
      "The one-sided constraints that began or ceased to carry a load in the last step.");
  type.def_prop_ro(
      "broken",
      [](nb::handle_t<SystemObject> self) {
        SystemObject* object = nb::inst_ptr<SystemObject>(self);
        object->use();
        std::vector<BrokenView> out;
        for (const Broken& broken : object->broken) out.push_back({nb::borrow(self), object, broken});
        return out;
      },
      nb::sig("def broken(self) -> list[Broken]"), "Constraints, bonds, hinges and nails that broke in the last step.");
}

}  // namespace

void bind_constraints(nb::module_& module) {
  bind_coordinate(module);
  bind_handle(module);
  bind_broken(module);
  bind_stop(module);
  nb::object system = module.attr("System");
  auto type = nb::borrow<nb::class_<SystemObject>>(system);
  bind_constraint_makers(type);
}

}  // namespace iota::bindings
