// SPDX-License-Identifier: Apache-2.0
#include "ingredient/quantities.h"
#include "ingredient/tables.h"
#include "math/mat3.h"
#include "step/execute.h"

#include <iota/solver.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace iota {

namespace {

static_assert(std::is_trivially_copyable_v<step::Command>);

/// Calls visit with a default-constructed command of the index-th type.
template <std::size_t I = 0, class Visit>
void with_command_type(std::size_t index, Visit visit) {
  if constexpr (I < std::variant_size_v<step::Command>) {
    if (index == I)
      visit(std::variant_alternative_t<I, step::Command>{});
    else
      with_command_type<I + 1>(index, visit);
  }
}

constexpr std::uint64_t snapshot_magic = 0x33'70616e'73'61746full;  // says what the bytes are, and their version

std::uint64_t check_sum(const std::vector<std::byte>& bytes) {
  Hasher hasher;
  hasher.bytes(bytes.data(), bytes.size());
  return hasher.result();
}

}  // namespace

System::System(const SystemOptions& options) : implementation_(std::make_unique<Implementation>()) {
  set_threads(options.threads);
  set_gravity(options.gravity);
  set_damping(options.damping);
  set_rest(options.rest);
  set_mode(options.mode);
}
System::~System() = default;
System::System(System&&) noexcept = default;
System& System::operator=(System&&) noexcept = default;

// --- changing ---------------------------------------------------------------------------------------------------------

BodyId System::create_body(const BodyOptions& options) { return implementation_->execute(step::CreateBody{options}); }
ParticleId System::create_particle(BodyId body, const Vec3& position, double mass, const Vec3& velocity) {
  return implementation_->execute(step::CreateParticle{body, position, velocity, mass});
}
void System::set_rod(BodyId body, double mass, double radius) {
  implementation_->execute(step::SetRod{body, mass, radius});
}
CosmeticBondId System::create_cosmetic_bond(ParticleId p, ParticleId q) {
  return implementation_->execute(step::CreateCosmeticBond{p, q});
}
void System::destroy(BodyId id) { implementation_->execute(step::Destroy<BodyId>{id}); }
void System::destroy(ParticleId id) { implementation_->execute(step::Destroy<ParticleId>{id}); }
void System::destroy(BondId id) { implementation_->execute(step::Destroy<BondId>{id}); }
RestructureReport System::destroy(CosmeticBondId id) {
  return implementation_->execute(step::Destroy<CosmeticBondId>{id});
}
void System::destroy(GripId id) { implementation_->execute(step::Destroy<GripId>{id}); }

RestructureReport System::combine(ParticleId p, ParticleId q, double over) {
  return implementation_->execute(step::CombineParticles{p, q, over});
}
RestructureReport System::combine(BodyId a, BodyId b) { return implementation_->execute(step::CombineBodies{a, b}); }
RestructureReport System::separate(ParticleId p, ParticleId q) {
  return implementation_->execute(step::Separate{p, q});
}
void System::nail(ParticleId particle) { implementation_->execute(step::Nail{particle, true, {}}); }
void System::nail(ParticleId particle, const Vec3& position) {
  implementation_->execute(step::Nail{particle, false, position});
}
void System::release(ParticleId particle) { implementation_->execute(step::Release{particle}); }

GripId System::create_grip(BodyId body, const Vec3& local_point, const Vec3& target, const GripOptions& options) {
  return implementation_->execute(step::CreateGrip{body, local_point, target, options});
}
void System::move_grip(GripId grip, const Vec3& target) { implementation_->execute(step::MoveGrip{grip, target}); }

void System::set_gravity(const Vec3& value) { implementation_->execute(step::SetGravity{value}); }
void System::set_mode(IntegrationMode mode) { implementation_->execute(step::SetMode{mode}); }
void System::set_solver(std::string_view name) {
  step::SetSolver command{};
  if (name.empty() || name.size() > max_solver_name)
    throw std::invalid_argument("set_solver: a name has 1 to " + std::to_string(max_solver_name) +
                                " characters, not \"" + std::string(name) + "\"");
  if (name != "direct") std::copy(name.begin(), name.end(), command.name.begin());
  implementation_->execute(command);
}
void System::set_damping(double per_second) { implementation_->execute(step::SetSystemDamping{per_second}); }
void System::set_kind(BodyId body, BodyKind kind) { implementation_->execute(step::SetKind{body, kind}); }
void System::set_damping(BodyId body, double per_second) {
  implementation_->execute(step::SetBodyDamping{body, per_second});
}
void System::set_position(ParticleId p, const Vec3& value) { implementation_->execute(step::SetPosition{p, value}); }
void System::set_velocity(ParticleId p, const Vec3& value) { implementation_->execute(step::SetVelocity{p, value}); }
void System::set_mass(ParticleId p, double value) { implementation_->execute(step::SetMass{p, value}); }
void System::apply_force(ParticleId p, const Vec3& value) { implementation_->execute(step::ApplyForce{p, value}); }
void System::set_active(BondId bond, bool active) { implementation_->execute(step::SetActive{bond, active}); }
int System::threads() const { return implementation_->parallel.threads(); }
void System::set_threads(int threads) {
  if (implementation_->stepping) throw std::logic_error("set_threads: not while the system steps");
  implementation_->parallel = Parallel(threads);
}
StepReport System::step(double dt) { return implementation_->execute(step::Step{dt}); }

// --- reading ----------------------------------------------------------------------------------------------------------

Vec3 System::gravity() const { return implementation_->model.gravity; }
std::string System::solver() const {
  const char* const name = implementation_->model.solver.data();
  return *name ? name : "direct";
}
IntegrationMode System::mode() const { return implementation_->model.mode; }
double System::damping() const { return implementation_->model.damping; }
double System::time() const { return implementation_->model.time; }
std::uint64_t System::step_count() const { return implementation_->model.step; }
std::uint32_t System::structure_version() const { return implementation_->model.structure_version; }
std::uint32_t System::scene_version() const {
  return implementation_->model.structure_version - implementation_->model.spark_changes;
}
bool System::is_spark(BodyId id) const {
  const model::Model& m = implementation_->model;
  const std::uint32_t first = m.bodies[implementation_->require(id)].first;
  return first != model::none && m.is_spark(first);
}
Vec3 System::momentum() const { return ingredient::calc_momenta(implementation_->model).linear; }
Vec3 System::angular_momentum() const { return ingredient::calc_momenta(implementation_->model).angular; }
double System::worst_gap() const { return ingredient::worst_gap(implementation_->model); }
std::uint32_t System::closing_count() const { return implementation_->model.closings.size(); }
std::uint32_t System::articulate_count() const { return implementation_->model.articulates.size(); }
bool System::is_stepping() const { return implementation_->stepping; }
std::vector<std::string> System::validate() const { return ingredient::validate(implementation_->model); }
std::uint64_t System::state_hash() const { return implementation_->model.hash(); }

Energy System::energy() const { return implementation_->energy(); }

bool System::contains(BodyId id) const { return implementation_->model.bodies.contains(id); }
bool System::contains(ParticleId id) const { return implementation_->model.particles.contains(id); }
bool System::contains(BondId id) const { return implementation_->model.bonds.contains(id); }
bool System::contains(CosmeticBondId id) const { return implementation_->model.cosmetic_bonds.contains(id); }
bool System::contains(GripId id) const { return implementation_->model.grips.contains(id); }
std::optional<ParticleId> System::survivor_of(ParticleId id) const { return implementation_->model.survivor_of(id); }
std::optional<BodyId> System::survivor_of(BodyId id) const { return implementation_->model.survivor_of(id); }

std::vector<BodyId> System::bodies() const { return implementation_->model.bodies.ids(); }
std::vector<ParticleId> System::particles() const { return implementation_->model.particles.ids(); }
std::vector<CosmeticBondId> System::cosmetic_bonds() const { return implementation_->model.cosmetic_bonds.ids(); }
std::vector<BondId> System::bonds() const { return implementation_->model.bonds.ids(); }

std::vector<std::vector<BodyId>> System::articulates() const {
  const model::Model& m = implementation_->model;
  std::vector<std::vector<BodyId>> all;
  m.articulates.for_each([&](std::uint32_t slot, const model::Articulate&) {
    m.for_each_body_of(slot, [&, &bodies = all.emplace_back()](std::uint32_t b) { bodies.push_back(m.bodies.id(b)); });
  });
  return all;
}

std::vector<ParticleId> System::particles(BodyId body) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_particle_of(implementation_->require(body), [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}

std::uint32_t System::articulate(BodyId id) const {
  return implementation_->model.bodies[implementation_->require(id)].articulate;
}
BodyKind System::kind(BodyId id) const { return implementation_->model.bodies[implementation_->require(id)].kind; }
double System::damping(BodyId id) const { return implementation_->model.bodies[implementation_->require(id)].damping; }
double System::mass(BodyId id) const { return implementation_->model.body_mass(implementation_->require(id)); }
Vec3 System::center_of_mass(BodyId id) const {
  return implementation_->model.center_of_mass(implementation_->require(id));
}
Quaternion System::orientation(BodyId id) const {
  const std::uint32_t body = implementation_->require(id);
  implementation_->refresh_orientations();
  return implementation_->model.bodies[body].orientation;
}

BodyId System::body(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return m.bodies.id(m.particles[implementation_->require(id)].body);
}
std::vector<ParticleId> System::ring(ParticleId id) const {
  const model::Model& m = implementation_->model;
  std::vector<ParticleId> ids;
  m.for_each_in_ring(m.particles[implementation_->require(id)].ring,
                     [&](std::uint32_t p) { ids.push_back(m.particles.id(p)); });
  return ids;
}
Vec3 System::position(ParticleId id) const { return implementation_->model.position(implementation_->require(id)); }
Vec3 System::velocity(ParticleId id) const { return implementation_->model.velocity(implementation_->require(id)); }
double System::mass(ParticleId id) const {
  const model::Particle& p = implementation_->model.particles[implementation_->require(id)];
  return p.inactive ? p.mass / model::inactive_share : p.mass;
}
bool System::is_nailed(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return m.rings[m.particles[implementation_->require(id)].ring].nailed;
}
Vec3 System::nail_force(ParticleId id) const {
  const model::Model& m = implementation_->model;
  return -m.nails[m.particles[implementation_->require(id)].ring].multiplier;
}

std::pair<ParticleId, ParticleId> System::ends(BondId id) const {
  const model::Model& m = implementation_->model;
  const model::Bond& b = m.bonds[implementation_->require(id)];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}
std::pair<ParticleId, ParticleId> System::ends(CosmeticBondId id) const {
  const model::Model& m = implementation_->model;
  if (!contains(id)) throw StaleIdError("cosmetic bond " + std::to_string(id.slot) + " is gone");
  const model::CosmeticBond& b = m.cosmetic_bonds[id.slot];
  return {m.particles.id(b.p), m.particles.id(b.q)};
}
bool System::is_active(BondId id) const { return implementation_->model.bonds[implementation_->require(id)].active; }

void System::read_positions(std::span<double> out) const {
  const model::Model& m = implementation_->model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_positions needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& x = m.rings[p.ring].position;
    *write++ = x.x, *write++ = x.y, *write++ = x.z;
  });
}
void System::read_velocities(std::span<double> out) const {
  const model::Model& m = implementation_->model;
  if (out.size() != 3 * std::size_t{m.particles.size()})
    throw std::invalid_argument("read_velocities needs room for 3 numbers a particle");
  double* write = out.data();
  m.particles.for_each([&](std::uint32_t, const model::Particle& p) {
    const Vec3& v = m.rings[p.ring].velocity;
    *write++ = v.x, *write++ = v.y, *write++ = v.z;
  });
}

PoseSnapshot System::poses() const {
  implementation_->refresh_orientations();
  const model::Model& m = implementation_->model;
  PoseSnapshot snapshot;
  snapshot.step = m.step, snapshot.time = m.time, snapshot.structure_version = m.structure_version;
  const ingredient::Energies energy = ingredient::calc_energies(m);
  snapshot.kinetic = static_cast<float>(energy.kinetic);
  snapshot.potential = static_cast<float>(energy.potential + implementation_->held_energy());
  snapshot.gap = static_cast<float>(ingredient::worst_gap(m));
  const auto put = [](float (&out)[3], const Vec3& v) {
    out[0] = static_cast<float>(v.x), out[1] = static_cast<float>(v.y), out[2] = static_cast<float>(v.z);
  };
  snapshot.bodies.reserve(m.bodies.size());
  m.bodies.for_each([&](std::uint32_t slot, const model::Body& b) {
    if (b.kind == BodyKind::inactive || b.count == 0) return;
    if (m.is_spark(b.first)) {
      const ParticleAttributes look = attributes(m.particles.id(b.first));
      SparkPose& spark = snapshot.sparks.emplace_back();
      put(spark.position, m.position(b.first));
      spark.radius = static_cast<float>(look.radius);
      spark.set = m.attributes[m.particles[b.first].attributes].emitter;
      for (int i = 0; i < 3; ++i)
        spark.color = spark.color << 8 | static_cast<std::uint32_t>(std::clamp(look.color[i], 0.0f, 1.0f) * 255 + 0.5f);
      return;
    }
    BodyPose& pose = snapshot.bodies.emplace_back();
    pose.body = slot;
    put(pose.position, m.center_of_mass(slot));
    const Quaternion& q = b.orientation;
    const double values[4] = {q.x, q.y, q.z, q.w};
    for (int i = 0; i < 4; ++i) pose.orientation[i] = static_cast<float>(values[i]);
  });
  m.grips.for_each([&](std::uint32_t, const model::Grip& g) {
    HoldPose& hold = snapshot.holds.emplace_back();
    hold.client = g.client, hold.hold = g.hold, hold.body = g.body;
    put(hold.point, ingredient::Grips::point(m, g));
    put(hold.target, g.target);
    hold.force = static_cast<float>(norm(g.force));
  });
  return snapshot;
}

// --- save, restore, replay --------------------------------------------------------------------------------------------

Snapshot System::snapshot() const { return implementation_->snapshot(); }

Snapshot System::Implementation::snapshot() {
  std::vector<std::byte> content;
  Writer content_writer(content);
  ingredient::archive(model, content_writer);
  // A restored system builds its islands from what is saved; so does this one, or replays would differ in the last bits.
  islands.renew();
  scripts_saved_below = next_script;
  Snapshot snapshot;
  Writer writer(snapshot.bytes);
  std::uint64_t magic = snapshot_magic, check = check_sum(content);
  writer.value(magic), writer.value(check), writer.vector(content);
  return snapshot;
}

void System::Implementation::restore(const Snapshot& snapshot) {
  Reader reader(snapshot.bytes);
  std::uint64_t magic = 0;
  reader.value(magic);
  if (magic != snapshot_magic)
    throw std::invalid_argument("restore: these bytes are no snapshot of this version of Iota");
  std::uint64_t check = 0;
  std::vector<std::byte> content;
  reader.value(check), reader.vector(content);
  if (!reader.ok() || !reader.at_end() || check != check_sum(content))
    throw std::invalid_argument("restore: the snapshot is cut short or damaged");
  Reader content_reader(content);
  model::Model restored;
  ingredient::archive(restored, content_reader);
  if (!content_reader.ok() || !content_reader.at_end())
    throw std::invalid_argument("restore: the snapshot is of another build of Iota");
  restored.surface_functions = std::move(model.surface_functions);
  if (model.scene.is_on()) restored.scene.watch();
  model = std::move(restored);
  model.make_geometries();
  islands.forget();
  held_forces.forget();
  particle_sets.forget();
  held_energy_is_known = false;
  oriented_step = ~0ull;
}

void System::restore(const Snapshot& snapshot) {
  if (implementation_->stepping) throw std::logic_error("restore: not while the system steps");
  if (implementation_->recording) throw std::logic_error("restore: stop the recording first");
  implementation_->restore(snapshot);
  implementation_->forget_edits();
}

void System::start_recording() {
  implementation_->forget_edits();  // a replay would not have them
  implementation_->recording = Recording{snapshot(), {}, {}};
}

Recording System::stop_recording() {
  if (!implementation_->recording) throw std::logic_error("stop_recording: nothing is being recorded");
  Recording recording = std::move(*implementation_->recording);
  implementation_->recording.reset();
  return recording;
}

std::optional<std::uint64_t> System::replay(const Recording& recording) {
  restore(recording.start);
  Reader reader(recording.commands);
  std::size_t steps = 0;
  std::optional<std::uint64_t> differs;
  while (reader.ok() && !reader.at_end() && !differs) {
    std::uint8_t index = 0;
    reader.value(index);
    bool known = false;
    with_command_type(index, [&]<class C>(C command) {
      known = true;
      reader.value(command);
      if (!reader.ok()) return;
      implementation_->model.has_edits |= !std::is_same_v<C, step::Step>;
      implementation_->held_energy_is_known = false;
      (void)implementation_->apply(command);
      if constexpr (std::is_same_v<C, step::Step>)
        if (steps >= recording.hashes.size() || state_hash() != recording.hashes[steps++])
          differs = implementation_->model.step;
    });
    if (!known || !reader.ok()) throw std::invalid_argument("replay: the recording is cut short or damaged");
  }
  return differs;
}

}  // namespace iota
