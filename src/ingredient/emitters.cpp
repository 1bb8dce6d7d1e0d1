// SPDX-License-Identifier: Apache-2.0
#include "ingredient/emitters.h"

#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "math/damped_flight.h"
#include "math/mat3.h"
#include "shape/shape.h"
#include "shape/traits.h"

#include <iota/scene.h>

#include <algorithm>

namespace iota::ingredient {

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
  explicit Draw(Emitter& emitter) : emitter_(emitter) {}
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
  Emitter& emitter_;
};

}  // namespace

void Emitters::check_links(const Model& model, model::Audit& audit) {
  model.attributes.for_each([&](std::uint32_t slot, const model::Attributes& a) {
    audit.require(a.emitter == none || model.emitters.is_alive(a.emitter), "attributes ", slot, " are of no emitter");
  });
  model.emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    audit.require(e.key_count <= e.keys.size(), "emitter ", slot, " has ", e.key_count, " keys");
    audit.require(e.rate >= 0 && e.rate <= 1e9 && e.due >= 0 && e.due <= 1, "emitter ", slot, " owes ", e.due,
                  " births, and ", e.rate, " a second");
    audit.require(e.mass > 0 && std::isfinite(e.mass), "emitter ", slot, " gives a mass of ", e.mass);
    audit.require_shape("emitter", slot, e.source);
  });
}

void Emitters::validate(const Model& model, model::Audit& audit) {
  std::vector<std::uint32_t> emitted(model.emitters.slot_count(), 0);
  model.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
    if (a.emitter == none) return;
    ++emitted[a.emitter];
  });
  model.emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    audit.require(e.alive == emitted[slot], "emitter ", slot, " counts ", e.alive, " particles, has ", emitted[slot]);
  });
}

void Emitters::forget_particle(Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].attributes;
  if (slot == none) return;
  if (const std::uint32_t emitter = model.attributes[slot].emitter; emitter != none) --model.emitters[emitter].alive;
}

model::ChangedSlots* Emitters::scene_log(Model& model) { return &model.changed_emitters; }

void Emitters::describe(const SceneView& view, SceneChanges& changes) {
  const Model& model = view.model;
  const auto none_of = [](std::uint32_t, std::vector<std::uint32_t>&) {};
  for (const std::uint32_t slot : view.slots(model.emitters, model.changed_emitters, none_of)) {
    if (model.emitters.is_alive(slot))
      changes.particle_sets.set.push_back({slot, model.emitters[slot].active != 0, model.emitters[slot].max_count});
    else
      changes.particle_sets.gone.push_back(slot);
  }
}

ParticleAttributes Emitters::look(const Model& model, const model::Attributes& a) {
  ParticleAttributes look{a.age, a.lifetime, a.radius, a.color};
  if (a.emitter == none || model.emitters[a.emitter].key_count == 0) return look;
  const Emitter& emitter = model.emitters[a.emitter];
  const double life = a.age / a.lifetime;  // 0: birth, 1: death
  std::uint32_t next = 0;
  while (next < emitter.key_count && emitter.keys[next].life < life) ++next;
  const AttributeKey& to = emitter.keys[std::min(next, emitter.key_count - 1)];
  const AttributeKey& from = emitter.keys[next > 0 ? next - 1 : 0];
  const double t = to.life > from.life ? std::clamp((life - from.life) / (to.life - from.life), 0.0, 1.0) : 1;
  look.radius = from.radius + t * (to.radius - from.radius);
  for (std::size_t i = 0; i < 4; ++i)
    look.color[i] = static_cast<float>(from.color[i] + t * (to.color[i] - from.color[i]));
  return look;
}

double Emitters::ball_radius(const Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].attributes;
  return slot == none || model.attributes[slot].emitter == none ? 0 : look(model, model.attributes[slot]).radius;
}

void Emitters::end_step(Model& model, double h) {
  model.emitters.for_each([&](std::uint32_t, Emitter& e) {
    if (e.active) e.due += e.rate * h;
  });
}

void Emitters::tell(Model& model, Outcome& outcome) {
  model.emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    if (e.active && e.due >= 1) outcome.due.push_back(model.emitters.id(slot));
  });
}

// The births of a step are spread over it: each particle has already moved since its birth.
void Emitters::bear(Model& model, std::uint32_t slot, double h, std::vector<ParticleId>& born) {
  const Vec3 gravity = model.acting_gravity();
  const double rate = model.emitters[slot].rate, owed = model.emitters[slot].due;
  const auto count = static_cast<std::uint64_t>(owed);
  model.emitters[slot].due = owed - static_cast<double>(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    Emitter& e = model.emitters[slot];
    if (e.alive >= e.max_count) return;
    Draw draw(e);
    const double since = std::min(h, (owed - static_cast<double>(i + 1)) / rate);
    Vec3 position = e.position + rotate(e.orientation, draw.in_source());
    Vec3 velocity = rotate(e.orientation, e.velocity) + draw.in_ball(e.velocity_spread);
    const double lifetime = e.lifetime + draw.number(-e.lifetime_spread, e.lifetime_spread);
    if (const double damping = model.damping + e.damping; damping > 0) {
      const DampedFlight flight = fly_damped(velocity, gravity, damping, since);
      position += flight.moved, velocity = flight.after;
    } else {
      position += since * velocity + (since * since / 2) * gravity, velocity += since * gravity;
    }
    if (!(since < lifetime)) continue;
    const std::uint32_t body = model.make_body(BodyKind::dynamic, e.damping);
    const std::uint32_t particle = model.make_particle(body, position, e.mass, velocity);
    model.rebuild_basis(body);
    model::Attributes a;
    a.particle = particle, a.emitter = slot, a.age = since, a.lifetime = lifetime;
    model.particles[particle].attributes = model.attributes.create(a).slot;
    ++e.alive, ++e.born;
    born.push_back(model.particles.id(particle));
    ++model.structure_version, ++model.spark_changes;
  }
}

}  // namespace iota::ingredient
