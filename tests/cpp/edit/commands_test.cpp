// SPDX-License-Identifier: Apache-2.0
// Commands as bytes: what is written is read back, and damaged recordings are refused without harm.
#include "edit/commands.h"

#include "tests/cpp/edit/hostile.h"

#include <gtest/gtest.h>
#include <iota/system.h>

#include <random>

namespace iota {
namespace {

using Random = std::mt19937_64;

/// Any value that serialize can write.
template <class T>
void fill(T& v, Random& random) {
  if constexpr (std::is_same_v<T, bool>) {
    v = random() % 2 == 1;
  } else if constexpr (std::is_enum_v<T>) {
    v = static_cast<T>(random() % (static_cast<std::size_t>(LastEnumerator<T>::value) + 1));
  } else if constexpr (std::is_floating_point_v<T>) {
    v = std::uniform_real_distribution<T>(-1e3, 1e3)(random);
  } else if constexpr (std::is_arithmetic_v<T>) {
    v = static_cast<T>(random());
  } else if constexpr (detail::is_array<T>) {
    for (auto& item : v) fill(item, random);
  } else if constexpr (detail::is_list<T>) {
    v.resize(random() % 5);
    for (auto& item : v) fill(item, random);
  } else if constexpr (detail::is_variant<T>) {
    detail::emplace(v, random() % std::variant_size_v<T>);
    std::visit([&](auto& item) { fill(item, random); }, v);
  } else {
    for_each_field(v, [&](auto& field) { fill(field, random); });
  }
}

template <class C>
std::vector<std::byte> bytes_of(const C& command) {
  std::vector<std::byte> bytes;
  edit::write(bytes, command);
  return bytes;
}

TEST(Command, comes_back_from_its_bytes) {
  Random random(7);
  std::vector<std::vector<std::byte>> all;
  for (int repeat = 0; repeat < 20; ++repeat) {
    edit::for_each_command_type([&]<class C>() {
      C command{};
      fill(command, random);
      all.push_back(bytes_of(command));
    });
  }
  ASSERT_EQ(all.size(), 20 * std::tuple_size_v<edit::AllCommands>);
  for (const std::vector<std::byte>& bytes : all) {
    Reader reader(bytes);
    std::vector<std::byte> back;
    edit::read_command(reader, [&](const auto& read) { edit::write(back, read); });
    ASSERT_TRUE(reader.ok() && reader.at_end()) << "command " << std::to_integer<int>(bytes.front());
    ASSERT_EQ(back, bytes) << "command " << std::to_integer<int>(bytes.front());
  }
}

TEST(Command, of_unknown_number_or_enumerator_is_not_read) {
  const auto is_read = [](std::vector<std::byte> bytes) {
    Reader reader(bytes);
    bool is_visited = false;
    edit::read_command(reader, [&](const auto&) { is_visited = true; });
    EXPECT_EQ(is_visited, reader.ok());
    return is_visited;
  };
  EXPECT_FALSE(is_read({}));
  std::vector<std::byte> bytes = bytes_of(edit::SetMode{IntegrationMode::robust});
  ASSERT_TRUE(is_read(bytes));
  bytes.back() = std::byte{255};
  EXPECT_FALSE(is_read(bytes));
  bytes = bytes_of(edit::BeginEdit{});
  bytes.front() = std::byte{std::tuple_size_v<edit::AllCommands>};
  EXPECT_FALSE(is_read(bytes));
  // A string that claims to be longer than all that follows.
  bytes = bytes_of(edit::CreateGroup{"a"});
  bytes[7] = std::byte{255};
  EXPECT_FALSE(is_read(bytes));
}

// --- damaged recordings -------------------------------------------------------------------------------------------------

BodyId make_rod(System& system, double x) {
  const BodyId body = system.bodies().create();
  system.particles().create(body, {x, 0, 0});
  system.particles().create(body, {x + 1, 0, 0}, 2);
  return body;
}

BodyId make_tetrahedron(System& system, double x) {
  const BodyId body = make_rod(system, x);
  system.particles().create(body, {x, 1, 0});
  system.particles().create(body, {x, 0, 1});
  return body;
}

void record_bodies(System& system) {
  system.set_gravity({0, -1, 0});
  system.set_mode(IntegrationMode::robust);
  system.set_solver("direct");
  system.set_rest({1, 0.1});
  const BodyId rod = make_rod(system, 0);
  system.bodies().set_rod(rod, 1, 0.1);
  system.bodies().set_angular_velocity(rod, {1, 0, 0});
  const BodyId box = system.bodies().create(Box{}, {.position = {0, 3, 0}, .attachments = {{0, 0, 1}}});
  system.bodies().create(convex_hull(std::array{Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}));
  system.bodies().create_attachment(box, {0, 4, 0});
  system.bodies().set_pose(box, {1, 3, 0}, {0, 0, 1, 1});
  system.bodies().set_velocity(box, {1, 0, 0});
  system.bodies().set_damping(box, 0.1);
  system.bodies().set_kind(rod, BodyKind::static_);
  system.particles().set_position(system.bodies().particles(rod)[0], {-1, 0, 0});
  system.particles().set_mass(system.bodies().particles(rod)[0], 3);
  (void)system.step(0.01);
  system.bodies().set_active(box, false);
  system.set_damping(0.1);
}

void record_forces(System& system) {
  const BodyId a = make_rod(system, 0), b = make_rod(system, 3);
  const ParticleId p = system.bodies().particles(a)[1], q = system.bodies().particles(b)[0];
  const LawId law = system.laws().create("energy = k * r^2", {"square", {{"k", 3}}});
  const BondId bond = system.bonds().create(p, q, SharedLaw{law, {{"k", 2}}, true});
  system.bonds().create(p, system.bodies().particles(b)[1], SpringLaw{});
  system.bonds().set_parameter(bond, "k", 4);
  system.bonds().set_break_force(bond, 1e3);
  const LawId code = system.laws().create([](double r, double, double, const double*) { return -r; });
  system.bonds().create(p, q, SharedLaw{code, {}, {}});
  system.laws().create([](const BondBatch&) {});
  const GroupId group = system.groups().create("some");
  system.groups().add(group, p);
  const FieldId wind = system.fields().create("wind", {.group = group});
  system.fields().create("fx = y; fy = 0; fz = 0");
  system.fields().create([](const ParticleBatch&) {});
  const PairsId pairs =
      system.pairs().create({system.laws().find("soft_repulsion"), {{"length", 2}}, {}}, {.cutoff = 2});
  (void)system.step(0.01);
  system.fields().set_active(wind, false), system.pairs().set_active(pairs, false),
      system.bonds().set_active(bond, false);
  system.fields().set_parameter(wind, system.fields().parameters(wind)[0].name, 2);
  system.groups().remove(group, p), system.pairs().destroy(pairs), system.bonds().destroy(bond),
      system.laws().destroy(law);
  (void)system.step(0.01);
}

void record_constraints(System& system) {
  const BodyId a = make_tetrahedron(system, 0), b = make_tetrahedron(system, 2), c = make_tetrahedron(system, 4);
  const ParticleId p = system.bodies().particles(a)[0], q = system.bodies().particles(b)[0];
  const ConstraintId joint = system.joints().create(
      JointSpec{.kind = ConstraintKind::revolute, .a = a, .b = b, .at = {1.5, 0, 0}, .breaks = {1e6, 1e6}});
  const ConstraintId rope = system.joints().create(DistanceSpec{ConstraintKind::rope, p, q});
  system.joints().create(PathSpec{.particle = p, .points = {{0, 0, 0}, {1, 1, 0}, {2, 0, 0}}});
  system.joints().create(SurfaceSpec{ConstraintKind::outside, p, {}, {Box{}, {0, -2, 0}}});
  system.joints().create(
      SurfacePairSpec{ConstraintKind::apart, c, {}, {Sphere{}, {4, 0, 0}}, {HalfSpace{}, {0, -2, 0}}});
  (void)system.step(0.01);
  system.joints().set_coordinate(joint, JointCoordinate::angle,
                                 {.lower = -1, .upper = 1, .motor_speed = 1, .motor_max = 2});
  system.joints().set_length(rope, 3);
  system.joints().set_active(joint, false), system.joints().set_break_limits(rope, {1, 1}),
      system.particles().set_break_force(p, 1);
  system.joints().set_compliance(rope, {.linear = 1e-3, .time = 0.1});
  (void)system.step(0.01);
  system.joints().destroy(rope);
}

void record_emitters(System& system) {
  const EmitterId emitter =
      system.emitters().create({.rate = 300, .source = Capsule{}, .velocity_spread = 1, .curve = {{0, 1}, {1, 2}}});
  const ParticleId p = system.bodies().particles(make_rod(system, 0))[0];
  system.particles().set_orientation(p, {0, 0, 1, 1});
  system.particles().set_spin(p, {0, 1, 0});
  system.particles().apply_torque(p, {1, 0, 0});
  system.particles().set_moment(p, 2);
  system.particles().set_spin_damping(p, 1);
  system.particles().align(p, {1, 1, 0}, 2, 1);
  system.particles().set_attributes(p, {.lifetime = 0.015, .radius = 0.1});
  (void)system.step(0.01);
  system.emitters().set_rate(emitter, 10);
  (void)system.step(0.01);
  system.emitters().destroy(emitter);
  (void)system.step(0.01);
}

void record_edits(System& system) {
  const BodyId a = make_tetrahedron(system, 0), b = make_rod(system, 1), c = make_rod(system, 2.5);
  const ParticleId p = system.bodies().particles(a)[1], q = system.bodies().particles(b)[0],
                   r = system.bodies().particles(b)[1];
  system.cosmetic_bonds().create(p, system.bodies().particles(a)[0]);
  system.edits().begin();
  system.edits().combine(p, q);
  system.edits().combine(r, system.bodies().particles(c)[0], 0.015);
  system.edits().end();
  system.particles().nail(system.bodies().particles(a)[0], {0, 1, 0});
  const GripId grip = system.grips().create(c, {}, {3, 3, 0});
  (void)system.step(0.01);
  system.grips().move(grip, {3, 4, 0});
  (void)system.step(0.01);
  system.edits().separate(p, q);
  system.edits().combine(a, b);
  system.edits().separate(a, b);
  system.particles().release(system.bodies().particles(a)[0]);
  system.particles().apply_force(p, {1, 0, 0});
  system.particles().set_active(r, false);
  system.edits().undo(), system.edits().redo();
  system.edits().begin(), system.edits().cancel();
  system.grips().destroy(grip), system.particles().destroy(r), system.bodies().destroy(c);
  (void)system.step(0.01);
}

/// One to four bytes that are other ones, missing or too many; or the end is.
void damage(std::vector<std::byte>& bytes, Random& random) {
  for (auto left = 1 + random() % 4; left > 0 && !bytes.empty(); --left) {
    const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(random() % bytes.size());
    switch (random() % 8) {
      case 0: bytes.erase(at); break;
      case 1: bytes.insert(at, std::byte{static_cast<unsigned char>(random())}); break;
      case 2: bytes.resize(random() % bytes.size()); break;
      case 3: *at = std::byte{255}; break;
      case 4: *at = std::byte{static_cast<unsigned char>(random() % 80)}; break;
      default: *at ^= std::byte{1} << (random() % 8); break;
    }
  }
}

class DamagedRecording : public testing::TestWithParam<void (*)(System&)> {};
INSTANTIATE_TEST_SUITE_P(Of, DamagedRecording,
                         testing::Values(record_bodies, record_forces, record_constraints, record_emitters,
                                         record_edits));

TEST_P(DamagedRecording, leaves_a_whole_system) {
  System system({.threads = 1});
  system.record().start();
  GetParam()(system);
  const Recording recording = system.record().stop();
  ASSERT_EQ(system.record().replay(recording), std::nullopt);
  Random random(hostile_seed());
  const int count = hostile_count(4000);
  int refused = 0, done = 0;
  for (int n = 0; n < count; ++n) {
    Recording damaged = recording;
    damage(damaged.commands, random);
    try {
      (void)system.record().replay(damaged);
      ++done;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
    // Also where a damaged number is a stiffness of 1e300 N/m, which is a number like any other to a command.
    ASSERT_EQ(system.validate(), std::vector<std::string>{}) << "damaged recording " << n;
  }
  EXPECT_GT(refused, count / 10);
  EXPECT_GT(done, count / 10);
}

TEST(Replay, of_a_recording_cut_short_changes_nothing) {
  System system;
  system.record().start();
  record_edits(system);
  Recording recording = system.record().stop();
  const std::uint64_t before = system.state_hash();
  recording.commands.pop_back();
  EXPECT_THROW((void)system.record().replay(recording), std::invalid_argument);
  EXPECT_EQ(system.state_hash(), before);
}

TEST(Recording, with_any_bit_of_its_file_flipped_is_refused) {
  System system;
  system.record().start();
  make_rod(system, 0);
  (void)system.step(0.01);
  const Recording recording = system.record().stop();
  std::vector<std::byte> bytes = recording.to_bytes();
  EXPECT_EQ(Recording::from_bytes(bytes), recording);
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    const std::size_t at = random() % bytes.size();
    const std::byte bit = std::byte{1} << (random() % 8);
    bytes[at] ^= bit;
    EXPECT_THROW((void)Recording::from_bytes(bytes), std::invalid_argument) << "byte " << at;
    bytes[at] ^= bit;
  }
  bytes.pop_back();
  EXPECT_THROW((void)Recording::from_bytes(bytes), std::invalid_argument);
}

}  // namespace
}  // namespace iota
