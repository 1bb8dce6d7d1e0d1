// SPDX-License-Identifier: Apache-2.0
// Particles that are born, age, turn and die.
#include "ingredient/quantities.h"
#include "math/mat3.h"
#include "shape/traits.h"
#include "step/checks.h"
#include "step/execute.h"

#include <algorithm>
#include <cmath>

namespace iota {

using namespace step;
using model::none;

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
  explicit Draw(model::Emitter& emitter) : emitter_(emitter) {}
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
  model::Emitter& emitter_;
};

/// Radius and color on an emitter's curve.
void look_at(const model::Emitter& emitter, double life, ParticleAttributes& out) {
  if (emitter.key_count == 0) return;
  std::uint32_t next = 0;
  while (next < emitter.key_count && emitter.keys[next].life < life) ++next;
  const AttributeKey& b = emitter.keys[std::min(next, emitter.key_count - 1)];
  const AttributeKey& a = emitter.keys[next > 0 ? next - 1 : 0];
  const double t = b.life > a.life ? std::clamp((life - a.life) / (b.life - a.life), 0.0, 1.0) : 1;
  out.radius = a.radius + t * (b.radius - a.radius);
  for (std::size_t i = 0; i < 4; ++i) out.color[i] = static_cast<float>(a.color[i] + t * (b.color[i] - a.color[i]));
}

/// The turn about a vector by its length.
Quaternion turn_by(const Vec3& v) {
  const double angle = norm(v);
  return angle > 0 ? axis_angle((1 / angle) * v, angle) : Quaternion{};
}

}  // namespace

// --- stepping ---------------------------------------------------------------------------------------------------------

void System::Implementation::live(StepReport& report) {
  const double h = report.dt;
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    if (a.oriented) turn(a, h);
    a.age += h;
    if (a.age >= a.lifetime) report.died.push_back(model.particles.id(a.particle));
  });
  if (!report.died.empty()) ingredient::begin_edits(model);
  std::erase_if(report.died, [&](ParticleId particle) {
    if (!model.particles.contains(particle)) return true;  // it went with another one
    const std::uint32_t before = model.structure_version, is_spark = model.is_spark(particle.slot);
    apply(Destroy<ParticleId>{particle});
    if (is_spark) model.spark_changes += model.structure_version - before;
    return false;
  });
  for (std::uint32_t e = 0; e < model.emitters.slot_count(); ++e)
    if (model.emitters.is_alive(e) && model.emitters[e].active) emit(e, report);
}

// The births of a step are spread over it: each particle has already moved since its own.
void System::Implementation::emit(std::uint32_t slot, StepReport& report) {
  const double h = report.dt;
  const Vec3 gravity = model.acting_gravity();
  const double rate = model.emitters[slot].rate, owed = model.emitters[slot].due + rate * h;
  const auto count = static_cast<std::uint64_t>(owed);
  model.emitters[slot].due = owed - static_cast<double>(count);
  if (count > 0) ingredient::begin_edits(model);
  for (std::uint64_t i = 0; i < count; ++i) {
    model::Emitter& e = model.emitters[slot];
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
    structure_changed();
    ++model.spark_changes;
  }
}

// Free spin is exact: angular velocity is constant, and the turn about it is by its length. The pull towards a direction is
// taken linearly implicit, so that any stiffness is stable.
void System::Implementation::turn(model::Attributes& a, double h) {
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

// --- commands ---------------------------------------------------------------------------------------------------------

model::Attributes& System::Implementation::attributes_of(std::uint32_t particle) {
  std::uint32_t& slot = model.particles[particle].attributes;
  if (slot == none) {
    model::Attributes a;
    a.particle = particle;
    slot = model.attributes.create(a).slot;
  }
  return model.attributes[slot];
}

EmitterId System::Implementation::apply(const CreateEmitter& c) {
  const model::Emitter& e = c.emitter;
  shape::check(shape::from_data(e.source));
  require_not_negative("rate", e.rate);
  require_finite("position", e.position);
  require_finite("velocity", e.velocity);
  require_not_negative("velocity_spread", e.velocity_spread);
  require_finite("velocity_spread", {e.velocity_spread, 0, 0});
  require_positive("lifetime", e.lifetime);
  require_not_negative("lifetime_spread", e.lifetime_spread);
  if (!(e.lifetime_spread < e.lifetime))
    throw std::invalid_argument(
        text("lifetime_spread (", e.lifetime_spread, " s) must be below the lifetime (", e.lifetime, " s)"));
  require_mass("mass", e.mass);
  require_not_negative("damping", e.damping);
  const EmitterId emitter = model.emitters.create(e);
  model.scene.emitters.note(emitter.slot);
  return emitter;
}

void System::Implementation::apply(const SetEmitter& c) {
  const std::uint32_t slot = require(c.emitter);
  require_not_negative("rate", c.rate);
  require_finite("position", c.position);
  require_finite("velocity", c.velocity);
  model::Emitter& e = model.emitters[slot];
  e.active = c.active, e.rate = c.rate, e.position = c.position, e.velocity = c.velocity;
  e.orientation = normalized(c.orientation);
  model.scene.emitters.note(slot);
}

void System::Implementation::apply(const Destroy<EmitterId>& c) {
  const std::uint32_t slot = require(c.id);
  model.attributes.for_each([&](std::uint32_t, model::Attributes& a) {
    if (a.emitter != slot) return;
    ParticleAttributes look{a.age, a.lifetime, a.radius, a.color};
    look_at(model.emitters[slot], a.age / a.lifetime, look);  // they keep the look of this moment
    a.radius = look.radius, a.color = look.color, a.emitter = none;
    model.scene.bodies.note(model.particles[a.particle].body);
  });
  model.emitters.destroy(slot);
  model.scene.emitters.note(slot);
  structure_changed();
}

void System::Implementation::apply(const SetAttributes& c) {
  const std::uint32_t particle = require(c.particle);
  require_not_negative("age", c.value.age);
  if (!(c.value.lifetime > 0)) throw std::invalid_argument(text("lifetime must be above 0 s, got ", c.value.lifetime));
  require_not_negative("radius", c.value.radius);
  model::Attributes& a = attributes_of(particle);
  a.age = c.value.age, a.lifetime = c.value.lifetime, a.radius = c.value.radius, a.color = c.value.color;
  model.scene.bodies.note(model.particles[particle].body);
}

void System::Implementation::apply(const SetTurn& c) {
  const std::uint32_t particle = require(c.particle);
  const auto set = [&](auto what, const auto& value) { attributes_of(particle).*what = value; };
  const auto require_oriented = [&](std::string_view what) {
    const std::uint32_t slot = model.particles[particle].attributes;
    if (slot == none || !model.attributes[slot].oriented)
      throw std::invalid_argument(
          text(what, " needs an oriented particle; give particle ", particle, " an orientation first"));
  };
  require_finite("the value", c.vector);
  switch (c.what) {
    case SetTurn::What::orientation: {
      const Quaternion q = normalized(c.quaternion);
      model::Attributes& a = attributes_of(particle);
      if (!a.oriented) {
        a.oriented = 1;
        const double r = a.radius > 0 ? a.radius : 0.05;  // a ball's
        a.moment = 0.4 * model.particles[particle].mass * r * r;
        if (!(a.moment > 0)) a.moment = 1e-6;
      }
      return set(&model::Attributes::orientation, q);
    }
    case SetTurn::What::spin: {
      require_oriented("spin");
      return set(&model::Attributes::spin, c.vector);
    }
    case SetTurn::What::torque: {
      require_oriented("a torque");
      attributes_of(particle).torque += c.vector;
      return;
    }
    case SetTurn::What::moment: {
      require_oriented("moment");
      require_positive("moment", c.number);
      return set(&model::Attributes::moment, c.number);
    }
    case SetTurn::What::damping: {
      require_oriented("spin damping");
      require_not_negative("damping", c.number);
      return set(&model::Attributes::damping, c.number);
    }
    case SetTurn::What::align: {
      require_oriented("a preferred direction");
      require_not_negative("stiffness", c.number);
      require_not_negative("damping", c.second);
      const double length = norm(c.vector);
      require_positive("the length of the preferred direction", length);
      model::Attributes& a = attributes_of(particle);
      a.preferred = (1 / length) * c.vector, a.stiffness = c.number, a.alignment_damping = c.second;
    }
  }
}

std::uint32_t System::Implementation::require(EmitterId id) const {
  if (!model.emitters.contains(id)) throw_stale("emitter", id, std::optional<EmitterId>{});
  return id.slot;
}

// --- the public side --------------------------------------------------------------------------------------------------

EmitterId System::create_emitter(const EmitterOptions& o) {
  shape::check(o.source);
  if (!shape::is_source(o.source))
    throw std::invalid_argument(text("particles cannot be born in a ", shape::name(o.source)));
  model::Emitter e;
  if (o.curve.size() > e.keys.size())
    throw std::invalid_argument(
        text("the curve of an emitter has at most ", e.keys.size(), " keys, got ", o.curve.size()));
  for (std::size_t i = 0; i < o.curve.size(); ++i) {
    if (!(o.curve[i].life >= (i > 0 ? o.curve[i - 1].life : 0) && o.curve[i].life <= 1))
      throw std::invalid_argument("the keys of a curve must come by rising life, from 0 to 1");
    require_not_negative("radius", o.curve[i].radius);
    e.keys[i] = o.curve[i];
  }
  e.source = shape::to_data(o.source);
  e.rate = o.rate, e.position = o.position, e.velocity = o.velocity, e.orientation = normalized(o.orientation);
  e.velocity_spread = o.velocity_spread, e.lifetime = o.lifetime, e.lifetime_spread = o.lifetime_spread;
  e.mass = o.mass, e.damping = o.damping, e.max_count = o.max_count, e.seed = o.seed;
  e.key_count = static_cast<std::uint32_t>(o.curve.size());
  return implementation_->execute(CreateEmitter{e});
}

namespace {

SetEmitter as_it_is(const model::Model& model, EmitterId id) {
  const model::Emitter& e = model.emitters[id.slot];
  return {id, e.active != 0, e.rate, e.position, e.velocity, e.orientation};
}

const model::Attributes* find_attributes(const model::Model& model, std::uint32_t particle) {
  const std::uint32_t slot = model.particles[particle].attributes;
  return slot == none ? nullptr : &model.attributes[slot];
}

const model::Attributes& oriented(const model::Model& model, std::uint32_t particle) {
  const model::Attributes* a = find_attributes(model, particle);
  if (!a || !a->oriented) throw std::invalid_argument(text("particle ", particle, " has no orientation of its own"));
  return *a;
}

}  // namespace

void System::destroy(EmitterId id) { implementation_->execute(Destroy<EmitterId>{id}); }
void System::set_active(EmitterId id, bool active) {
  (void)implementation_->require(id);
  SetEmitter command = as_it_is(implementation_->model, id);
  command.active = active;
  implementation_->execute(command);
}
void System::set_rate(EmitterId id, double rate) {
  (void)implementation_->require(id);
  SetEmitter command = as_it_is(implementation_->model, id);
  command.rate = rate;
  implementation_->execute(command);
}
void System::move_emitter(EmitterId id, const Vec3& position, const Quaternion& orientation) {
  (void)implementation_->require(id);
  SetEmitter command = as_it_is(implementation_->model, id);
  command.position = position, command.orientation = orientation;
  implementation_->execute(command);
}
bool System::contains(EmitterId id) const { return implementation_->model.emitters.contains(id); }
bool System::is_active(EmitterId id) const {
  return implementation_->model.emitters[implementation_->require(id)].active;
}
double System::rate(EmitterId id) const { return implementation_->model.emitters[implementation_->require(id)].rate; }
std::uint32_t System::count(EmitterId id) const {
  return implementation_->model.emitters[implementation_->require(id)].alive;
}
std::uint64_t System::born(EmitterId id) const {
  return implementation_->model.emitters[implementation_->require(id)].born;
}
std::vector<ParticleId> System::particles(EmitterId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t slot = implementation_->require(id);
  std::vector<ParticleId> ids;
  m.attributes.for_each([&](std::uint32_t, const model::Attributes& a) {
    if (a.emitter == slot) ids.push_back(m.particles.id(a.particle));
  });
  return ids;
}

ParticleAttributes System::attributes(ParticleId id) const {
  const model::Model& m = implementation_->model;
  const model::Attributes* a = find_attributes(m, implementation_->require(id));
  if (!a) return {};
  ParticleAttributes value{a->age, a->lifetime, a->radius, a->color};
  if (a->emitter != none) look_at(m.emitters[a->emitter], a->age / a->lifetime, value);
  return value;
}
bool System::has_attributes(ParticleId id) const {
  return implementation_->model.particles[implementation_->require(id)].attributes != none;
}
void System::set_attributes(ParticleId id, const ParticleAttributes& value) {
  implementation_->execute(SetAttributes{id, value});
}

bool System::is_oriented(ParticleId id) const {
  const model::Attributes* a = find_attributes(implementation_->model, implementation_->require(id));
  return a && a->oriented;
}
Quaternion System::orientation(ParticleId id) const {
  return oriented(implementation_->model, implementation_->require(id)).orientation;
}
Vec3 System::normal(ParticleId id) const { return rotate(orientation(id), {0, 0, 1}); }
Vec3 System::spin(ParticleId id) const { return oriented(implementation_->model, implementation_->require(id)).spin; }
double System::moment(ParticleId id) const {
  return oriented(implementation_->model, implementation_->require(id)).moment;
}
void System::set_orientation(ParticleId id, const Quaternion& q) {
  if (!(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w > 1e-12))
    throw std::invalid_argument("orientation must be a quaternion x y z w that is finite and not zero");
  implementation_->execute(SetTurn{SetTurn::What::orientation, id, {}, q, 0, 0});
}
void System::set_spin(ParticleId id, const Vec3& value) {
  implementation_->execute(SetTurn{SetTurn::What::spin, id, value, {}, 0, 0});
}
void System::set_moment(ParticleId id, double value) {
  implementation_->execute(SetTurn{SetTurn::What::moment, id, {}, {}, value, 0});
}
void System::set_spin_damping(ParticleId id, double value) {
  implementation_->execute(SetTurn{SetTurn::What::damping, id, {}, {}, value, 0});
}
void System::apply_torque(ParticleId id, const Vec3& value) {
  implementation_->execute(SetTurn{SetTurn::What::torque, id, value, {}, 0, 0});
}
void System::align(ParticleId id, const Vec3& direction, double stiffness, double damping) {
  implementation_->execute(SetTurn{SetTurn::What::align, id, direction, {}, stiffness, damping});
}

}  // namespace iota
