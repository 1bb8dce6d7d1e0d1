// SPDX-License-Identifier: Apache-2.0
#include "step/lifetimes.h"

#include "edit/particles.h"
#include "ingredient/quantities.h"
#include "math/mat3.h"
#include "shape/traits.h"

#include <algorithm>
#include <cmath>

namespace iota::step {

namespace {

/// The n-th number of a seed in [0, 1): SplitMix64 (Steele, Lea, Flood 2014) as a counter-based generator.
double dice(std::uint64_t seed, std::uint64_t n) {
  std::uint64_t z = seed * 0xd1342543de82ef95ull + (n + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ z >> 27) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
}

class Draw {
 public:
  explicit Draw(ingredient::Emitter& emitter) : emitter_(emitter) {}
  double number(double low, double high) { return low + (high - low) * dice(emitter_.seed, emitter_.draws++); }
  Vec3 in_ball(double radius) {
    const auto draw = [this](double low, double high) { return number(low, high); };
    return radius * shape::in_ball(draw);
  }
  Vec3 in_source() {
    return shape::inside(shape::from_data(emitter_.source),
                         [this](double low, double high) { return number(low, high); });
  }

 private:
  ingredient::Emitter& emitter_;
};

// The births of a step are spread over it: each particle has already moved since its birth.
void bear_particles(edit::Editor& editor, std::uint32_t slot, StepReport& report) {
  model::Model& model = editor.model;
  const double h = report.dt;
  const Vec3 gravity = model.acting_gravity();
  const double rate = model.emitters[slot].rate, owed = model.emitters[slot].due + rate * h;
  const auto count = static_cast<std::uint64_t>(owed);
  model.emitters[slot].due = owed - static_cast<double>(count);
  if (count > 0) ingredient::begin_edits(model);
  for (std::uint64_t i = 0; i < count; ++i) {
    ingredient::Emitter& e = model.emitters[slot];
    if (e.alive >= e.max_count) return;
    Draw draw(e);
    const double since = std::min(h, (owed - static_cast<double>(i + 1)) / rate);
    Vec3 position = e.position + rotate(e.orientation, draw.in_source());
    Vec3 velocity = rotate(e.orientation, e.velocity) + draw.in_ball(e.velocity_spread);
    const double lifetime = e.lifetime + draw.number(-e.lifetime_spread, e.lifetime_spread);
    position += since * velocity + (since * since / 2) * gravity;
    velocity += since * gravity;
    if (!(since < lifetime)) continue;
    const std::uint32_t body = model.make_body(BodyKind::dynamic, e.damping);
    const std::uint32_t particle = model.make_particle(body, position, e.mass, velocity);
    model.rebuild_basis(body);
    model::Attributes a;
    a.particle = particle, a.emitter = slot, a.age = since, a.lifetime = lifetime;
    model.particles[particle].attributes = model.attributes.create(a).slot;
    ++e.alive, ++e.born;
    report.born.push_back(model.particles.id(particle));
    editor.structure_changed();
    ++model.spark_changes;
  }
}

// Free spin is exact: angular velocity is constant, and the rotation is by its length. The torque towards a direction
// is linearly implicit, so that any stiffness is stable.
void turn(model::Model& model, model::Attributes& a, double h) {
  const model::Particle& p = model.particles[a.particle];
  if (model.bodies[p.body].kind == BodyKind::inactive) return;
  const auto energy = [&] { return 0.5 * a.moment * dot(a.spin, a.spin); };
  const double before = energy();
  const Vec3 old = a.spin;
  Vec3 impulse = h * a.torque;
  double divisor = 1;
  if (a.stiffness > 0 || a.alignment_damping > 0) {
    const Vec3 normal = rotate(a.orientation, {0, 0, 1});
    impulse += (h * a.stiffness) * cross(normal, a.preferred);
    divisor += h * (a.alignment_damping + h * a.stiffness) / a.moment;
  }
  a.spin = (1 / divisor) * (a.spin + (1 / a.moment) * impulse);
  a.orientation = normalized(multiply(turn_by((h / 2) * (old + a.spin)), a.orientation));
  a.torque = {};
  model.external_work += energy() - before;
  const double lost = model.damping + a.damping;
  if (lost > 0) {
    const double start = energy();
    a.spin *= std::exp(-lost * h);
    model.dissipated += start - energy();
  }
}

}  // namespace

void turn_particles(model::Model& model, double h) {
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    if (a.oriented) turn(model, a, h);
  });
}

void update_lifetimes(edit::Editor& editor, StepReport& report) {
  model::Model& model = editor.model;
  if (model.attributes.size() + model.emitters.size() == 0) return;
  const double h = report.dt;
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    a.age += h;
    if (a.age >= a.lifetime) report.died.push_back(model.particles.id(a.particle));
  });
  if (!report.died.empty()) ingredient::begin_edits(model);
  std::erase_if(report.died, [&](ParticleId particle) {
    if (!model.particles.contains(particle)) return true;  // destroyed with another one
    const std::uint32_t before = model.structure_version, is_spark = model.is_spark(particle.slot);
    apply(editor, edit::Destroy<ParticleId>{particle});
    if (is_spark) model.spark_changes += model.structure_version - before;
    return false;
  });
  for (std::uint32_t e = 0; e < model.emitters.slot_count(); ++e)
    if (model.emitters.is_alive(e) && model.emitters[e].active) bear_particles(editor, e, report);
}

}  // namespace iota::step
