// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "shape_argument.h"
#include "typed_argument.h"

#include <nanobind/stl/array.h>

namespace iota::bindings {

namespace {

constexpr const char* emitter_doc = "A source of particles; made by `System.emitter`.";

constexpr const char* make_emitter_doc =
    "A new source of particles; each is a body of its own, and is destroyed at the end of its lifetime.\n\n"
    "rate: births a second. source: any shape but a Mesh or HalfSpace; places of birth are uniform within it.\n"
    "position (m), orientation (quaternion x y z w): of the source. velocity: in its frame, m/s, plus a random\n"
    "velocity of at most velocity_spread m/s. lifetime: s; lifetimes differ by at most lifetime_spread. mass: kg.\n"
    "damping: 1/s. max_count: alive at once. curve: at most 8 of (life, radius, color), life rising from 0 at birth\n"
    "to 1 at death, radius in m, color as of `Particle.color`. Equal seeds give equal particles.\n\n"
    "    fire = system.emitter(rate=300, velocity=(0, 2, 0), velocity_spread=0.4, lifetime=0.8,\n"
    "                          curve=[(0, 0.02, (1, 0.9, 0.3)), (1, 0.06, (0.3, 0, 0, 0))])";

nb::tuple from_color(const Color& c) { return nb::make_tuple(c[0], c[1], c[2], c[3]); }
nb::tuple from_quaternion(const Quaternion& q) { return nb::make_tuple(q.x, q.y, q.z, q.w); }

std::vector<AttributeKey> to_curve(nb::iterable curve) {
  std::vector<AttributeKey> keys;
  for (nb::handle item : curve) {
    nb::object parts = nb::steal(PySequence_Fast(item.ptr(), ""));
    if (!parts.is_valid() || PySequence_Fast_GET_SIZE(parts.ptr()) != 3) {
      PyErr_Clear();
      throw nb::value_error(("each key of the curve must be (life, radius, color), not " + describe(item)).c_str());
    }
    AttributeKey key;
    key.life = finite(nb::cast<double>(nb::handle(PySequence_Fast_GET_ITEM(parts.ptr(), 0))), "life");
    key.radius =
        finite_not_negative(nb::cast<double>(nb::handle(PySequence_Fast_GET_ITEM(parts.ptr(), 1))), "radius", "m");
    key.color = to_color(PySequence_Fast_GET_ITEM(parts.ptr(), 2));
    keys.push_back(key);
  }
  return keys;
}

EmitterHandle make_emitter(nb::handle_t<SystemObject> self, double rate, nb::object source, VectorArgument position,
                           nb::object orientation, VectorArgument velocity, double velocity_spread, double lifetime,
                           double lifetime_spread, double mass, double damping, std::uint32_t max_count,
                           nb::iterable curve, std::uint64_t seed) {
  EmitterOptions o;
  o.rate = finite_not_negative(rate, "rate", "1/s");
  if (!source.is_none()) o.source = to_shape(source);
  o.position = to_vec3(position, "position"), o.orientation = to_quaternion(orientation, "orientation");
  o.velocity = to_vec3(velocity, "velocity");
  o.velocity_spread = finite_not_negative(velocity_spread, "velocity_spread", "m/s");
  o.lifetime = finite_positive(lifetime, "lifetime", "s");
  o.lifetime_spread = finite_not_negative(lifetime_spread, "lifetime_spread", "s");
  o.mass = finite_positive(mass, "mass", "kg"), o.damping = finite_not_negative(damping, "damping", "1/s");
  o.max_count = max_count, o.curve = to_curve(curve), o.seed = seed;
  return handle_of(self, nb::inst_ptr<SystemObject>(self)->use_between_steps("emitter(...)").emitters().create(o));
}

void bind_emitter(nb::module_& module) {
  const nb::tuple zero = nb::make_tuple(0.0, 0.0, 0.0);
  nb::class_<EmitterHandle> type(module, "Emitter", emitter_doc, nb::type_slots(handle_slots<EmitterHandle>),
                                 nb::is_weak_referenceable());
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def(
          "emitter", &make_emitter, nb::kw_only(), "rate"_a = 10.0, "source"_a = nb::none(), "position"_a = zero,
          "orientation"_a = nb::make_tuple(0.0, 0.0, 0.0, 1.0), "velocity"_a = nb::make_tuple(0.0, 1.0, 0.0),
          "velocity_spread"_a = 0.0, "lifetime"_a = 1.0, "lifetime_spread"_a = 0.0, "mass"_a = 0.001, "damping"_a = 0.0,
          "max_count"_a = 1000, "curve"_a = nb::tuple(), "seed"_a = 1,
          nb::sig(
              "def emitter(self, *, rate: float = 10.0, source: Shape | None = "
              "None, position: Vec3 | collections.abc.Sequence[float] = (0.0, 0.0, 0.0), orientation: "
              "collections.abc.Sequence[float] = (0.0, 0.0, 0.0, 1.0), velocity: Vec3 | "
              "collections.abc.Sequence[float] = (0.0, 1.0, 0.0), velocity_spread: float = 0.0, lifetime: float = 1.0, "
              "lifetime_spread: float = 0.0, mass: float = 0.001, damping: float = 0.0, max_count: int = 1000, curve: "
              "collections.abc.Iterable[tuple[float, float, collections.abc.Sequence[float]]] = (), seed: int = 1) -> "
              "Emitter"),
          make_emitter_doc);
  def_identity(type);
  const auto checked = [](const EmitterHandle& self, const char* what) -> System& {
    System& engine = self.use();
    self.system->use_between_steps(what);
    return engine;
  };
  type.def_prop_ro("alive", [](const EmitterHandle& self) { return self.is_alive(); })
      .def_prop_rw(
          "active", [](const EmitterHandle& self) { return self.use().emitters().is_active(self.id); },
          [](const EmitterHandle& self, bool on) { self.use().emitters().set_active(self.id, on); },
          "False: no births.")
      .def_prop_rw(
          "rate", [](const EmitterHandle& self) { return self.use().emitters().rate(self.id); },
          [checked](const EmitterHandle& self, double value) {
            checked(self, "rate = ...").emitters().set_rate(self.id, finite_not_negative(value, "rate", "1/s"));
          },
          "Births a second.")
      .def_prop_ro(
          "count", [](const EmitterHandle& self) { return self.use().emitters().count(self.id); },
          "Its particles alive now.")
      .def_prop_ro(
          "born", [](const EmitterHandle& self) { return self.use().emitters().born(self.id); }, "Births so far.")
      .def_prop_ro(
          "particles",
          [](const EmitterHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().emitters().particles(self.id));
          },
          nb::sig("def particles(self) -> list[Particle]"))
      .def(
          "move",
          [checked](const EmitterHandle& self, VectorArgument position, nb::object orientation) {
            checked(self, "move")
                .emitters()
                .move(self.id, to_vec3(position, "position"), to_quaternion(orientation, "orientation"));
          },
          "position"_a, "orientation"_a = nb::make_tuple(0.0, 0.0, 0.0, 1.0),
          nb::sig("def move(self, position: Vec3 | collections.abc.Sequence[float], orientation: "
                  "collections.abc.Sequence[float] = (0.0, 0.0, 0.0, 1.0)) -> None"),
          "Moves its source: m, quaternion x y z w.")
      .def(
          "destroy", [](const EmitterHandle& self) { self.use().emitters().destroy(self.id); },
          "Its particles remain, with their present look.")
      .def("__repr__", [](const EmitterHandle& self) {
        return self.is_alive() ? "<Emitter " + std::to_string(self.id.slot) + ": " +
                                     std::to_string(self.system->engine.emitters().count(self.id)) + " particles>"
                               : stale_repr("Emitter", self);
      });
}

void bind_attributes(nb::class_<ParticleHandle>& type) {
  type.def_prop_ro(
          "has_attributes", [](const ParticleHandle& self) { return self.use().particles().has_attributes(self.id); },
          "Whether age, lifetime, radius, color or orientation was ever set.")
      .def_prop_ro(
          "age", [](const ParticleHandle& self) { return self.use().particles().attributes(self.id).age; },
          "s, since its birth or since its lifetime or look was set; 0 for all others.")
      .def_prop_rw(
          "lifetime", [](const ParticleHandle& self) { return self.use().particles().attributes(self.id).lifetime; },
          [](const ParticleHandle& self, double value) {
            System& engine = between_steps(self, "lifetime = ...");
            ParticleAttributes attributes = engine.particles().attributes(self.id);
            attributes.lifetime = value;
            engine.particles().set_attributes(self.id, attributes);
          },
          "s: it is destroyed, with its bonds, in the step in which its age reaches it. math.inf for never.")
      .def_prop_rw(
          "radius", [](const ParticleHandle& self) { return self.use().particles().attributes(self.id).radius; },
          [](const ParticleHandle& self, double value) {
            System& engine = between_steps(self, "radius = ...");
            ParticleAttributes attributes = engine.particles().attributes(self.id);
            attributes.radius = finite_not_negative(value, "radius", "m");
            engine.particles().set_attributes(self.id, attributes);
          },
          "m, for drawing and for forces that use it; 0: not set. An emitted particle's follows its emitter's\n"
          "curve.")
      .def_prop_rw(
          "color",
          [](const ParticleHandle& self) { return from_color(self.use().particles().attributes(self.id).color); },
          [](const ParticleHandle& self, nb::object value) {
            System& engine = between_steps(self, "color = ...");
            ParticleAttributes attributes = engine.particles().attributes(self.id);
            attributes.color = to_color(value);
            engine.particles().set_attributes(self.id, attributes);
          },
          nb::for_getter(nb::sig("def color(self) -> tuple[float, float, float, float]")),
          nb::for_setter(nb::sig("def color(self, value: " IOTA_COLOR ", /) -> None")),
          "Red, green, blue, opacity from 0 to 1. Assign these, a name such as 'tomato', '#rrggbb' or 0xRRGGBB.");
}

void bind_orientation(nb::class_<ParticleHandle>& type) {
  type.def_prop_ro("is_oriented",
                   [](const ParticleHandle& self) { return self.use().particles().is_oriented(self.id); })
      .def_prop_rw(
          "orientation",
          [](const ParticleHandle& self) { return from_quaternion(self.use().particles().orientation(self.id)); },
          [](const ParticleHandle& self, nb::object value) {
            between_steps(self, "orientation = ...")
                .particles()
                .set_orientation(self.id, to_quaternion(value, "orientation"));
          },
          nb::for_getter(nb::sig("def orientation(self) -> tuple[float, float, float, float]")),
          nb::for_setter(nb::sig("def orientation(self, value: " IOTA_ROTATION ", /) -> None")),
          "Quaternion x y z w. Assigning makes it an oriented particle: it rotates like a free ball of its radius\n"
          "(0.05 m if it has none), independently of its body.")
      .def_prop_ro(
          "normal", [](const ParticleHandle& self) { return self.use().particles().normal(self.id); },
          "Its preferred direction: its local z in the world frame.")
      .def_prop_rw(
          "spin", [](const ParticleHandle& self) { return self.use().particles().spin(self.id); },
          [](const ParticleHandle& self, VectorArgument value) {
            between_steps(self, "spin = ...").particles().set_spin(self.id, to_vec3(value, "spin"));
          },
          "rad/s, world axes; constant in free flight.")
      .def_prop_rw(
          "moment", [](const ParticleHandle& self) { return self.use().particles().moment(self.id); },
          [](const ParticleHandle& self, double value) {
            between_steps(self, "moment = ...")
                .particles()
                .set_moment(self.id, finite_positive(value, "moment", "kg m^2"));
          },
          "Of inertia, kg m^2.")
      .def(
          "apply_torque",
          [](const ParticleHandle& self, VectorArgument torque) {
            between_steps(self, "apply_torque").particles().apply_torque(self.id, to_vec3(torque, "torque"));
          },
          "torque"_a, "Adds a torque (N m) during the next step only.")
      .def(
          "align",
          [](const ParticleHandle& self, VectorArgument direction, double stiffness, double damping) {
            between_steps(self, "align")
                .particles()
                .align(self.id, to_vec3(direction, "direction"), finite_not_negative(stiffness, "stiffness", "N m"),
                       finite_not_negative(damping, "damping", "N m s"));
          },
          "direction"_a, "stiffness"_a = 1.0, "damping"_a = 0.0,
          "Turns its normal to a direction: torque stiffness (normal x direction) - damping spin, N m, stable for any\n"
          "stiffness. stiffness=0: no torque.");
}

/// One row of `width` numbers a particle.
template <class Fill>
nb::object array_of(SystemObject& self, std::size_t width, Fill fill) {
  System& engine = self.use();
  const auto particles = engine.particles().ids();
  auto* numbers = new double[particles.size() * width + 1];
  for (std::size_t i = 0; i < particles.size(); ++i)
    fill(engine.particles().attributes(particles[i]), numbers + i * width);
  nb::capsule owner(numbers, [](void* p) noexcept { delete[] static_cast<double*>(p); });
  if (width == 1) return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(numbers, {particles.size()}, owner));
  return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<2>>(numbers, {particles.size(), width}, owner));
}

}  // namespace

void bind_emitters(nb::module_& module) {
  bind_emitter(module);
  auto particle = nb::borrow<nb::class_<ParticleHandle>>(module.attr("Particle"));
  bind_attributes(particle);
  bind_orientation(particle);
  auto system = nb::borrow<nb::class_<SystemObject>>(module.attr("System"));
  system
      .def_prop_ro(
          "ages",
          [](SystemObject& self) {
            return array_of(self, 1, [](const ParticleAttributes& a, double* out) { *out = a.age; });
          },
          nb::sig("def ages(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,), s, in the order of `particles`.")
      .def_prop_ro(
          "radii",
          [](SystemObject& self) {
            return array_of(self, 1, [](const ParticleAttributes& a, double* out) { *out = a.radius; });
          },
          nb::sig("def radii(self) -> numpy.typing.NDArray[numpy.float64]"), "(n,), m, in the order of `particles`.")
      .def_prop_ro(
          "colors",
          [](SystemObject& self) {
            return array_of(self, 4, [](const ParticleAttributes& a, double* out) {
              std::copy(a.color.begin(), a.color.end(), out);
            });
          },
          nb::sig("def colors(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(n, 4), red, green, blue, opacity from 0 to 1, in the order of `particles`.");
}

}  // namespace iota::bindings
