// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "typed_argument.h"

#include <numeric>

namespace iota::bindings {

namespace {

constexpr const char* particle_doc =
    "A point with mass, in one body; made by `Body.particle`. Particles of different bodies that were combined share one\n"
    "place: a hinge.";

constexpr const char* make_particle_doc =
    "A new particle of the body.\n\n"
    "position: m. mass: kg, its own share. velocity: m/s. Vectors are any 2 or 3 numbers; z is then 0. mass=0 makes a\n"
    "marker: a massless particle fixed to the massive ones of the body, within the line, plane or space that they\n"
    "span. It can be hinged, nailed, bonded and constrained as any other particle. lifetime: s, radius: m, color: see\n"
    "the properties of these names.\n\n"
    "    p = body.particle((0, 1, 0), mass=0.2)\n"
    "    p.velocity = (1, 0, 0)";

std::string repr_particle(const ParticleHandle& self) {
  if (!self.is_alive()) return stale_repr("Particle", self);
  const System& engine = self.system->engine;
  return "<Particle " + std::to_string(self.id.slot) + " of body " +
         std::to_string(engine.particles().body(self.id).slot) + " at " +
         describe(engine.particles().position(self.id)) + ">";
}

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Makes bodies with their particles in one call: one call for each of them from Python takes five times as long.
std::pair<std::vector<BodyHandle>, std::vector<ParticleHandle>> make_bodies(nb::handle_t<SystemObject> system,
                                                                            const std::vector<std::uint32_t>& counts,
                                                                            Rows position, Numbers mass,
                                                                            Rows velocity) {
  System& engine = nb::inst_ptr<SystemObject>(system)->use_between_steps("make_bodies");
  const std::size_t total = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  if (position.shape(0) != total || velocity.shape(0) != total || mass.shape(0) != total)
    throw nb::value_error("position, velocity and mass must have a row for each particle");
  std::vector<BodyHandle> bodies;
  std::vector<ParticleHandle> particles;
  bodies.reserve(counts.size()), particles.reserve(total);
  std::size_t next = 0;
  for (const std::uint32_t count : counts) {
    bodies.push_back(handle_of(system, engine.bodies().create()));
    for (const std::size_t end = next + count; next < end; ++next) {
      const auto row = [next](const Rows& rows) { return Vec3{rows(next, 0), rows(next, 1), rows(next, 2)}; };
      const ParticleId id = engine.particles().create(bodies.back().id, row(position), mass(next), row(velocity));
      particles.push_back(handle_of(system, id));
    }
  }
  return {std::move(bodies), std::move(particles)};
}

void bind_nails(nb::class_<ParticleHandle>& type) {
  type.def(
          "nail",
          [](const ParticleHandle& self, std::optional<VectorArgument> position) {
            System& engine = self.use();
            if (position)
              engine.particles().nail(self.id, to_vec3(*position, "position"));
            else
              engine.particles().nail(self.id);
          },
          "position"_a = nb::none(),
          "Nails it at its place, or at a given one (m). A further call with another place moves the nail.")
      .def(
          "release", [](const ParticleHandle& self) { self.use().particles().release(self.id); }, "Removes its nail.")
      .def_prop_ro("is_nailed", [](const ParticleHandle& self) { return self.use().particles().is_nailed(self.id); })
      .def_prop_ro(
          "nail_force", [](const ParticleHandle& self) { return self.use().particles().nail_force(self.id); },
          "By the nail on the particle in the last step, N.")
      .def_prop_ro(
          "hinge_force", [](const ParticleHandle& self) { return self.use().particles().hinge_force(self.id); },
          "On its body by everything that shares or nails its place in the last step, N: the load of the hinge. A\n"
          "force applied to the shared particle itself is distributed equally over its bodies.")
      .def_prop_rw(
          "break_force", [](const ParticleHandle& self) { return self.use().particles().break_force(self.id); },
          [](const ParticleHandle& self, double force) {
            between_steps(self, "break_force = ...").particles().set_break_force(self.id, force);
          },
          "Above this hinge_force (N; inf: never) it leaves its hinge or nail: see `System.broken`.");
}

}  // namespace

void bind_particle(nb::module_& module) {
  nb::class_<ParticleHandle> type(module, "Particle", particle_doc, nb::type_slots(handle_slots<ParticleHandle>),
                                  nb::is_weak_referenceable());
  nb::borrow<nb::class_<BodyHandle>>(module.attr("Body"))
      .def(
          "particle",
          [](const BodyHandle& self, VectorArgument position, double mass, VectorArgument velocity,
             std::optional<double> lifetime, std::optional<double> radius, ColorArgument color, bool nailed) {
            const Vec3 place = to_vec3(position, "position"), speed = to_vec3(velocity, "velocity");
            if (mass != 0) finite_positive(mass, "mass", "kg");
            self.use();
            System& engine = self.system->use_between_steps("particle(...)");
            ParticleAttributes attributes;
            if (lifetime && *lifetime != attributes.lifetime)
              attributes.lifetime = finite_positive(*lifetime, "lifetime", "s");
            if (radius) attributes.radius = finite_not_negative(*radius, "radius", "m");
            if (!color.value.is_none()) attributes.color = to_color(color.value);
            const ParticleHandle made = sibling(self, engine.particles().create(self.id, place, mass, speed));
            if (lifetime || radius || !color.value.is_none()) engine.particles().set_attributes(made.id, attributes);
            if (nailed) engine.particles().nail(made.id);
            return made;
          },
          "position"_a = nb::make_tuple(0.0, 0.0, 0.0), "mass"_a = 1.0, "velocity"_a = nb::make_tuple(0.0, 0.0, 0.0),
          nb::kw_only(), "lifetime"_a = nb::none(), "radius"_a = nb::none(), "color"_a = nb::none(), "nailed"_a = false,
          make_particle_doc);
  module.def(
      "make_bodies", &make_bodies, "system"_a, "counts"_a, "position"_a, "mass"_a, "velocity"_a,
      "For iota.builder: a body of counts[i] particles for each i. position, velocity: (n, 3), m and m/s. mass: (n,), kg.");
  def_identity(type);
  def_survival(type, "def survivor(self) -> Particle | None");
  bind_nails(type);
  type.def_prop_ro(
          "body", [](const ParticleHandle& self) { return sibling(self, self.use().particles().body(self.id)); },
          "Its body.")
      .def_prop_ro(
          "ring",
          [](const ParticleHandle& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.use().particles().ring(self.id));
          },
          "All particles hinged with it, and itself.")
      .def_prop_rw(
          "position", [](const ParticleHandle& self) { return self.use().particles().position(self.id); },
          [](const ParticleHandle& self, VectorArgument v) {
            between_steps(self, "position = ...").particles().set_position(self.id, to_vec3(v, "position"));
          },
          "m. Assigning moves the whole ring and changes the rigid distances of its bodies.")
      .def_prop_rw(
          "velocity", [](const ParticleHandle& self) { return self.use().particles().velocity(self.id); },
          [](const ParticleHandle& self, VectorArgument v) {
            between_steps(self, "velocity = ...").particles().set_velocity(self.id, to_vec3(v, "velocity"));
          },
          "m/s. The next step projects it on the motions of the rigid body.")
      .def_prop_rw(
          "mass", [](const ParticleHandle& self) { return self.use().particles().mass(self.id); },
          [](const ParticleHandle& self, double value) {
            between_steps(self, "mass = ...").particles().set_mass(self.id, finite_positive(value, "mass", "kg"));
          },
          "Its own share, kg; 0 only for markers. The mass of a ring is the sum of its particles'.")
      .def_prop_rw(
          "active", [](const ParticleHandle& self) { return self.use().particles().is_active(self.id); },
          [](const ParticleHandle& self, bool active) { self.use().particles().set_active(self.id, active); },
          "False: its bonds do not act, and only a millionth of its mass counts, so that its body keeps its shape;\n"
          "its hinges and nails still act.")
      .def(
          "apply_force",
          [](const ParticleHandle& self, VectorArgument force) {
            between_steps(self, "apply_force").particles().apply_force(self.id, to_vec3(force, "force"));
          },
          "force"_a, "Adds a force (N) during the next step only.")
      .def(
          "destroy", [](const ParticleHandle& self) { self.use().particles().destroy(self.id); },
          "Removes it with its bonds; its body too if it was the last one.")
      .def("__repr__", &repr_particle);
}

}  // namespace iota::bindings
