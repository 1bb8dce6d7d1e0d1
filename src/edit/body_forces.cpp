// SPDX-License-Identifier: Apache-2.0
#include "edit/body_forces.h"

#include "edit/law_checks.h"
#include "edit/particles.h"
#include "math/checks.h"
#include "math/mat3.h"

namespace iota::edit {

// Distributed over the massive particles as m (a + alpha x r), in proportion to the body's accelerations, so that there
// is no load within it.
void spread(const model::Model& model, std::uint32_t body, const Vec3& force, const Vec3& torque,
            std::vector<std::pair<ParticleId, Vec3>>& forces) {
  double mass = 0;
  Vec3 center;
  const auto each = [&](auto visit) {
    model.for_each_particle_of(body, [&](std::uint32_t p) {
      if (!model.particles[p].is_marker()) visit(p, model.particles[p].mass);
    });
  };
  each([&](std::uint32_t p, double m) { mass += m, center += m * model.position(p); });
  if (!(mass > 0)) throw std::invalid_argument(text("body ", body, " has no particles that a force could act on"));
  center *= 1 / mass;
  Mat3 inertia;  // of the points only: the forces on these must add up to the torque
  each([&](std::uint32_t p, double m) { inertia += point_inertia(m, model.position(p) - center); });
  const Vec3 turn = solve_semidefinite(inertia, torque), reached = inertia * turn;
  constexpr double round_off = 1e-9;
  if (!(norm(reached - torque) <= round_off * norm(torque)))
    throw std::invalid_argument(
        text("a torque of ", text_of(torque), " N m cannot act on body ", body,
             ": its particles are at one place or on one line, about which nothing has a lever; a body given by shape "
             "can be turned"));
  each([&](std::uint32_t p, double m) {
    forces.emplace_back(model.particles.id(p), (m / mass) * force + m * cross(turn, model.position(p) - center));
  });
}

namespace {

void push(Editor& e, std::uint32_t body, const Vec3& force, const Vec3& torque) {
  std::vector<std::pair<ParticleId, Vec3>> forces;
  spread(e.model, body, force, torque, forces);
  for (const auto& [particle, share] : forces) apply(e, ApplyForce{particle, share});
}

}  // namespace

void apply(Editor& e, const SetBodyName& c) {
  model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  ingredient::Names::Name name{};
  put_text(name, c.value, "the name of a body");
  if (c.value.empty())
    model.names.erase(body);
  else
    model.names.make(body) = name;
  model.note_body(body);
}

void check(const Editor& e, const SetBodyMass& c) {
  const model::Model& model = e.model;
  const std::uint32_t body = e.require(c.body);
  require_mass("mass", c.value);
  const double before = model.body_mass(body);
  if (!(before > 0)) throw std::invalid_argument(text("body ", body, " has no particles to have a mass"));
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    if (!model.particles[p].is_marker() && !model.particles[p].inactive)
      require_mass("the mass of each particle", c.value / before * model.particles[p].mass);
  });
}

void apply(Editor& e, const SetBodyMass& c) {
  check(e, c);
  model::Model& model = e.model;
  const std::uint32_t body = c.body.slot;
  const double factor = c.value / model.body_mass(body);
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.particles[p].mass *= factor;
    model.for_each_twin_of(p, [&](std::uint32_t twin) { model.twins[twin].mass *= factor; });
  });
  model.for_each_inertia_of(body, [&](std::uint32_t i) { model.inertia_pairs[i].inertia *= factor; });
  if (auto* const spin = model.spins.find(body)) spin->momentum *= factor;
  model.touch_body(body);
}

void apply(Editor& e, const ApplyBodyForce& c) {
  const std::uint32_t body = e.require(c.body);
  require_finite("force", c.force);
  if (c.at_center) return push(e, body, c.force, {});
  require_finite("at", c.at);
  push(e, body, c.force, cross(c.at - e.model.center_of_mass(body), c.force));
}

void apply(Editor& e, const ApplyBodyTorque& c) {
  const std::uint32_t body = e.require(c.body);
  require_finite("torque", c.value);
  push(e, body, {}, c.value);
}

}  // namespace iota::edit
