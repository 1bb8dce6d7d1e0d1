// SPDX-License-Identifier: Apache-2.0
// What every step promises, on calm and on eventful scenes: no exception leaves it, it leaves a whole system with finite
// energies, and a warm one allocates nothing.
#include "scenes/chain.h"
#include "tests/cpp/allocations.h"

#include <iota/solver.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace iota {
namespace {

constexpr double dt = 1.0 / 120;

/// What happens once in every `period` steps of a system.
struct Scene {
  /// Called before each step with its number within the period.
  using Script = std::function<void(int)>;

  const char* name;
  int period;
  std::function<Script(System&)> build;
  /// Whether a step did what the scene is about.
  std::function<bool(const StepReport&)> is_event;
  /// Why a step may allocate in which something happened, or the one after it; null: it may not.
  const char* may_allocate = nullptr;
  std::vector<int> may_at = {};  ///< and in these steps of the period, where something happens that no report tells
  int warm_periods = 3;          ///< until nothing needs more room
};

// The only reasons to allocate. Steps in which nothing happens have none, in any scene.
constexpr const char* report_lists_it = "the report is a value and lists what happened";
constexpr const char* structure_is_analyzed = "a problem whose structure changed is analyzed anew";
constexpr const char* solver_is_foreign = "a solver that is not ours owns its memory";

/// For functions of scripts that fail when told to.
struct Fuse {
  bool is_blown = false;
  void check() const {
    if (is_blown) throw 1;  // not even a std::exception
  }
};

bool has_broken(const StepReport& report) { return !report.broken.empty(); }
bool has_warned(const StepReport& report) { return !report.warnings.empty(); }
bool always(const StepReport&) { return true; }

/// Hangs straight down from a nail.
scenes::Chain hanging_chain(System& system, int links) {
  return scenes::make_chain(system, {.links = links, .direction = {0, -1, 0}});
}

/// A weight of 1 kg on a bond, between a nail and 1 m below it.
struct Weight {
  ParticleId hook, weight;
  explicit Weight(System& system)
      : hook(system.particles().create(system.bodies().create(), {0, 0, 0})),
        weight(system.particles().create(system.bodies().create(), {0, -1, 0})) {
    system.particles().nail(hook);
  }
  void put_back(System& system) const {
    system.particles().set_position(weight, {0, -1, 0});
    system.particles().set_velocity(weight, {});
  }
};

// --- the scenes -------------------------------------------------------------------------------------------------------

Scene::Script build_calm(System& system) {
  system.set_damping(0.1);
  const auto chain = scenes::make_chain(system, {.links = 50, .rods = true});
  const BodyId triangle = system.bodies().create();
  system.particles().create(triangle, {1, 1, 0}), system.particles().create(triangle, {2, 1, 0});
  const ParticleId corner = system.particles().create(triangle, {1, 2, 0});
  system.particles().create(triangle, {1.3, 1.3, 0});
  system.bonds().create(corner, chain.lower.back(), SpringLaw{10, 0.1});
  (void)system.grips().create(chain.links[20], {}, {0, 1, 0});
  const BodyId block = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.position = {3, 0, 0}});
  system.joints().create(
      JointSpec{.a = block, .at = {3, 0.5, 0}, .angle = {-2, 2, 1, 5, 0.5, 3, 0.1, 0.2}, .breaks = {1e9, 1e9}});
  const ParticleId bead = system.particles().create(system.bodies().create(), {2, 2, 2});
  system.joints().create(PathSpec{.particle = bead, .points = {{2, 2, 2}, {3, 2, 2}, {4, 3, 2}}});
  system.joints().create(DistanceSpec{.kind = ConstraintKind::rope, .p = bead, .q = corner, .length = 9});
  system.joints().create(SurfaceSpec{.kind = ConstraintKind::inside, .particle = bead, .surface = {Sphere{9}, {}, {}}});
  for (int i = 0; i < 40; ++i)
    system.particles().create(system.bodies().create(), {-2 + 0.3 * (i % 7), 5 + 0.3 * (i / 7), 0}, 1,
                              {0.1 * (i % 3), 0, 0});
  const auto loose = system.particles().ids();
  for (const bool implicit : {true, false})
    system.bonds().create(loose[loose.size() - 1], loose[loose.size() - 9],
                          SharedLaw{system.laws().create("energy = 3*(r - 1)^4; force = -v"), {}, implicit});
  system.bonds().create(
      loose[loose.size() - 2], loose[loose.size() - 3],
      ScriptedLaw{[](const BondState&) { return Vec3{0, 0.1, 0}; }, "a name that is not a short one"});
  system.fields().create("current");
  system.fields().create("fx = sin(x + t)*m; fy = exp(-y^2)");
  system.pairs().create({system.laws().find("soft_repulsion"), {{"length", 0.5}}, {}}, {.cutoff = 0.5});
  return [](int) {};
}

/// A rod of 1 m that turns by more than a radian even in a 64th of a step: the energy-keeping scheme gives up.
Scene::Script build_whirl(System& system) {
  system.set_mode(IntegrationMode::energy_keeping);  // the other one has nothing to fall back to
  system.set_gravity({});
  const BodyId rod = system.bodies().create();
  const ParticleId left = system.particles().create(rod, {-0.5, 0, 0}),
                   right = system.particles().create(rod, {0.5, 0, 0});
  return [&system, left, right](int step) {
    if (step != 0) return;
    const Vec3 along = system.particles().position(right) - system.particles().position(left);
    const Vec3 across = cross({0, 0, 1}, (1 / norm(along)) * along);
    system.particles().set_velocity(left, -9000 * across), system.particles().set_velocity(right, 9000 * across);
  };
}

Scene::Script build_closing(System& system) {
  system.set_gravity({});
  const ParticleId a = system.particles().create(system.bodies().create(), {0, 0, 0}),
                   b = system.particles().create(system.bodies().create(), {0.5, 0, 0});
  return [&system, a, b](int step) {
    if (step == 0) (void)system.edits().separate(a, b), system.particles().set_velocity(b, {1, 0, 0});
    if (step == 10) (void)system.edits().combine(a, b, 8 * dt);
  };
}

Scene::Script build_emitter(System& system) {
  system.emitters().create({.rate = 120, .velocity = {0, 3, 0}, .velocity_spread = 0.5, .lifetime = 0.25});
  hanging_chain(system, 5);
  return [](int) {};
}

Scene::Script build_sleepers(System& system) {
  system.set_damping(5);
  system.set_rest({.after = 0.1, .speed = 0.05});
  const auto chain = hanging_chain(system, 6);
  return [&system, end = chain.lower.back()](int step) {
    if (step == 0) system.particles().apply_force(end, {20, 0, 0});
  };
}

Scene::Script build_breaking_bond(System& system) {
  const Weight weight(system);
  const BondId bond = system.bonds().create(weight.hook, weight.weight, SpringLaw{.stiffness = 1000});
  system.bonds().set_break_force(bond, 20);
  return [&system, weight, bond](int step) {
    if (step == 0) weight.put_back(system), system.bonds().set_active(bond, true);
    if (step == 10) system.particles().apply_force(weight.weight, {0, -5000, 0});
  };
}

Scene::Script build_breaking_hinge(System& system) {
  system.set_damping(5);
  const auto chain = hanging_chain(system, 4);
  return [&system, chain](int step) {
    if (step == 0) {
      if (system.particles().ring(chain.upper[2]).size() == 1)
        (void)system.edits().combine(chain.lower[1], chain.upper[2]);
      system.particles().set_break_force(chain.upper[2], 50);
    }
    if (step == 10) system.particles().apply_force(chain.lower[3], {0, -100, 0});
  };
}

Scene::Script build_breaking_joint(System& system) {
  const BodyId block = system.bodies().create(Box{{0.2, 0.3, 0.4}}, {.mass = 1});
  const ConstraintId weld = system.joints().create(
      JointSpec{.kind = ConstraintKind::weld, .a = block, .at = {0, 0, 0}, .breaks = {.force = 50}});
  return [&system, block, weld](int step) {
    if (step == 0) {
      system.bodies().set_pose(block, {}, {});
      system.bodies().set_velocity(block, {}), system.bodies().set_angular_velocity(block, {});
      system.joints().set_active(weld, true);
    }
    if (step == 10) system.particles().apply_force(system.bodies().particles(block).front(), {0, -200, 0});
  };
}

Scene::Script build_cut(System& system, int links) {
  system.set_damping(0.5);
  const auto chain = hanging_chain(system, links);
  const auto middle = static_cast<std::size_t>(links / 2);
  return [&system, upper = chain.lower[middle], lower = chain.upper[middle + 1]](int step) {
    if (step == 0) (void)system.edits().separate(upper, lower);
    if (step == 3) (void)system.edits().combine(upper, lower);
  };
}

/// Somebody takes hold of a link of a chain, moves it, and lets go.
Scene::Script build_grab(System& system, int links) {
  system.set_damping(0.5);
  const auto chain = hanging_chain(system, links);
  const BodyId held = chain.links[static_cast<std::size_t>(links / 2)];
  const auto grip = std::make_shared<GripId>();
  return [&system, held, grip](int step) {
    const Vec3 place = system.bodies().center_of_mass(held);
    if (step == 0) *grip = system.grips().create(held, {}, place);
    if (step > 0 && step < 5) system.grips().move(*grip, place + Vec3{0.01, 0, 0});
    if (step == 5) system.grips().destroy(*grip);
  };
}

/// A chain of 0.4 m between two nails 0.6 m apart.
Scene::Script build_conflict(System& system) {
  const auto chain = scenes::make_chain(system, {.links = 4});
  system.particles().nail(chain.lower.back(), {0.6, 0, 0});
  return [](int) {};
}

/// The second nail comes near enough, and goes away again.
Scene::Script build_passing_conflict(System& system) {
  const auto chain = scenes::make_chain(system, {.links = 4});
  return [&system, end = chain.lower.back()](int step) {
    if (step == 0) system.particles().nail(end, {0.6, 0, 0});
    if (step == 15) system.particles().nail(end, {0.3, 0, 0});
  };
}

Scene::Script build_foreign_solver(System& system) {
  scenes::make_chain(system, {.links = 4});
  system.set_solver("newton");
  return [](int) {};
}

struct Idle final : Solver {
  Ending search(NonlinearProblem&, std::span<double>, const SolverOptions&) override { return {0, "it does not try"}; }
};
Scene::Script build_solver_that_finds_nothing(System& system) {
  static const bool registered = (register_solver("idle", [] { return std::make_unique<Idle>(); }), true);
  (void)registered;
  scenes::make_chain(system, {.links = 4});
  system.set_solver("idle");
  return [](int) {};
}

Scene::Script build_bond_that_throws(System& system) {
  const Weight weight(system);
  const auto fuse = std::make_shared<Fuse>();
  const BondId bond = system.bonds().create(weight.hook, weight.weight, ScriptedLaw{[fuse](const BondState&) {
                                              fuse->check();
                                              return Vec3{0, -9.81, 0};
                                            }});
  return [&system, fuse, bond](int step) {
    if (step == 0) fuse->is_blown = false, system.bonds().set_active(bond, true);
    if (step == 5) fuse->is_blown = true;
  };
}

Scene::Script build_law_that_throws(System& system) {
  const Weight weight(system);
  const auto fuse = std::make_shared<Fuse>();
  const LawId law = system.laws().create(BatchFunction{[fuse](const BondBatch& batch) {
    fuse->check();
    std::fill(batch.force, batch.force + 3 * batch.count, 0.0);
  }});
  const BondId bond = system.bonds().create(weight.hook, weight.weight, SharedLaw{law, {}, {}});
  return [&system, fuse, bond](int step) {
    if (step == 0) fuse->is_blown = false, system.bonds().set_active(bond, true);
    if (step == 5) fuse->is_blown = true;
  };
}

Scene::Script build_field_that_throws(System& system) {
  hanging_chain(system, 3);
  const auto fuse = std::make_shared<Fuse>();
  const FieldId field = system.fields().create(FieldFunction{[fuse](const ParticleBatch& batch) {
    fuse->check();
    std::fill(batch.force, batch.force + 3 * batch.count, 0.0);
  }});
  return [&system, fuse, field](int step) {
    if (step == 0) fuse->is_blown = false, system.fields().set_active(field, true);
    if (step == 5) fuse->is_blown = true;
  };
}

/// Compiled code may not throw, but it may divide by zero.
double pole(double, double, double t, const double*) {
  return 1 / (std::fmod(std::round(t / dt), 20) == 12 ? 0.0 : 1.0);
}
Scene::Script build_law_without_a_value(System& system) {
  const Weight weight(system);
  const BondId bond =
      system.bonds().create(weight.hook, weight.weight, SharedLaw{system.laws().create(RadialFunction{pole}), {}, {}});
  return [&system, weight, bond](int step) {
    if (step == 0) weight.put_back(system), system.bonds().set_active(bond, true);
  };
}

Scene::Script build_surface_that_fails(System& system) {
  const auto fuse = std::make_shared<Fuse>();
  const BodyId rod = system.bodies().create();
  const ParticleId low = system.particles().create(rod, {0, 0, 0}), high = system.particles().create(rod, {0, 1, 0});
  const ConstraintId floor = system.joints().create(SurfaceSpec{.kind = ConstraintKind::outside,
                                                                .particle = low,
                                                                .surface = {SurfaceFunction{[fuse](const Vec3& r) {
                                                                              fuse->check();
                                                                              return r.y;
                                                                            }},
                                                                            {},
                                                                            {}}});
  return [&system, fuse, low, high, floor](int step) {
    if (step == 0) {
      fuse->is_blown = false;
      system.particles().set_position(low, {0, 0, 0}), system.particles().set_position(high, {0, 1, 0});
      system.particles().set_velocity(low, {}), system.particles().set_velocity(high, {});
      system.joints().set_active(floor, true);
    }
    if (step == 5) fuse->is_blown = true;
  };
}

/// A force function cuts a chain and joins it again.
Scene::Script build_edits_from_within(System& system) {
  system.set_damping(0.5);
  const auto chain = hanging_chain(system, 6);
  const auto step_now = std::make_shared<int>(0);
  system.bonds().create(chain.upper[0], chain.lower[5],
                        ScriptedLaw{[&system, step_now, p = chain.lower[2], q = chain.upper[3]](const BondState&) {
                          if (*step_now == 5) (void)system.edits().separate(p, q);
                          if (*step_now == 8) (void)system.edits().combine(p, q);
                          return Vec3{};
                        }});
  return [step_now](int step) { *step_now = step; };
}

/// A force function asks for an edit that cannot be made: two static particles cannot meet.
Scene::Script build_edit_that_is_refused(System& system) {
  const Weight weight(system);
  const ParticleId left = system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {5, 0, 0}),
                   right = system.particles().create(system.bodies().create({.kind = BodyKind::static_}), {6, 0, 0});
  const auto step_now = std::make_shared<int>(0);
  system.bonds().create(weight.hook, weight.weight, ScriptedLaw{[&system, step_now, left, right](const BondState&) {
                          if (*step_now == 5) (void)system.edits().combine(left, right);
                          return Vec3{};
                        }});
  return [step_now](int step) { *step_now = step; };
}

/// Falls on a stop of its hinge, is lifted, and falls again.
Scene::Script build_impact(System& system) {
  const BodyId arm = system.bodies().create(Box{{1, 0.1, 0.1}}, {.mass = 1, .position = {0.5, 0, 0}});
  system.joints().create(
      JointSpec{.kind = ConstraintKind::revolute, .a = arm, .at = {0, 0, 0}, .angle = {.lower = -0.1}});
  return [&system, arm](int step) {
    if (step == 0) system.bodies().set_angular_velocity(arm, {0, 0, 1});
  };
}

/// Ropes between neighbors in a row of boxes come and go: islands of seven and of ten boxes that lose boxes at one end and
/// gain others at the other, and a large one that takes them over and sheds them.
Scene::Script build_ties(System& system) {
  system.set_threads(1);  // each thread warms up by itself, and on a busy machine a second one may come late
  system.set_gravity({});
  constexpr int count = 120, period = 12;
  std::vector<ParticleId> knots;
  std::vector<ConstraintId> ropes;
  for (int i = 0; i < count; ++i) {
    const BodyId box =
        system.bodies().create(Box{{1, 1, 1}}, {.position = {2.0 * i, 0, 0}, .attachments = {{0.5, 0.5, 0.5}}});
    knots.push_back(system.bodies().attachments(box)[0]);
    system.bodies().set_angular_velocity(box, {0.3, 0.2 * (i % 5), 1});
    if (i == 0) continue;
    const auto pair = static_cast<std::size_t>(i) - 1;
    ropes.push_back(system.joints().create(DistanceSpec{ConstraintKind::rope, knots[pair], knots[pair + 1], 2.5}));
  }
  return [&system, ropes](int step) {
    for (int pair = 0; pair + 1 < count; ++pair)
      system.joints().set_active(ropes[static_cast<std::size_t>(pair)], (step + pair) % period < 6 + 3 * (pair / 40));
  };
}

const std::vector<Scene>& all_scenes() {
  static const std::vector<Scene> scenes{
      {"calm", 10, build_calm, always},
      {"falls_back", 4, build_whirl, [](const StepReport& r) { return r.fallbacks > 0; }},
      {"closing",
       40,
       build_closing,
       [](const StepReport& r) { return r.articulates == 1; },
       structure_is_analyzed,
       {10}},
      {"ties", 12, build_ties, always, nullptr, {}, 12},
      {"emitter", 60, build_emitter, [](const StepReport& r) { return !r.born.empty() && !r.died.empty(); },
       report_lists_it},
      {"sleep", 400, build_sleepers, [](const StepReport& r) { return r.resting > 0; }},
      {"breaking_bond", 20, build_breaking_bond, has_broken, report_lists_it},
      {"breaking_hinge", 20, build_breaking_hinge, has_broken, report_lists_it},
      {"breaking_joint", 20, build_breaking_joint, has_broken, report_lists_it},
      {"cut", 20, [](System& s) { return build_cut(s, 100); }, [](const StepReport& r) { return r.articulates == 2; }},
      {"cut_in_a_large_island", 8, [](System& s) { return build_cut(s, 5000); },
       [](const StepReport& r) { return r.articulates == 2; }, structure_is_analyzed},
      {"grab", 10, [](System& s) { return build_grab(s, 24); },
       [](const StepReport& r) { return r.energy.external_work != 0; }},
      {"grab_in_a_large_island", 10, [](System& s) { return build_grab(s, 5000); },
       [](const StepReport& r) { return r.energy.external_work != 0; }},
      {"conflict", 10, build_conflict, [](const StepReport& r) { return r.worst_gap > 1e-3; }},
      // In the fifth period the mid-point rule has no solution for the first time.
      {"passing_conflict",
       30,
       build_passing_conflict,
       [](const StepReport& r) { return r.worst_gap > 1e-3; },
       nullptr,
       {},
       6},
      {"foreign_solver", 10, build_foreign_solver, always, solver_is_foreign},
      {"solver_that_finds_nothing", 10, build_solver_that_finds_nothing, has_warned, solver_is_foreign},
      {"bond_that_throws", 20, build_bond_that_throws, has_warned, structure_is_analyzed},
      {"law_that_throws", 20, build_law_that_throws, has_warned, structure_is_analyzed},
      {"field_that_throws", 20, build_field_that_throws, has_warned, report_lists_it},
      {"law_without_a_value", 20, build_law_without_a_value, has_warned, structure_is_analyzed},
      {"surface_that_fails", 20, build_surface_that_fails, has_warned, structure_is_analyzed},
      {"edits_from_within", 20, build_edits_from_within, [](const StepReport& r) { return r.edits.has_value(); },
       structure_is_analyzed},
      {"edit_that_is_refused", 10, build_edit_that_is_refused, has_warned, report_lists_it},
      {"impact", 120, build_impact, [](const StepReport& r) { return r.energy.kinetic < 1e-9; }},
  };
  return scenes;
}

class Step : public testing::TestWithParam<std::tuple<std::size_t, IntegrationMode>> {
 protected:
  const Scene& scene() const { return all_scenes()[std::get<0>(GetParam())]; }
  System system{{.mode = std::get<1>(GetParam())}};
};

TEST_P(Step, throws_nothing_leaves_the_system_whole_and_allocates_nothing_when_warm) {
  const Scene::Script before_step = scene().build(system);
  const Energy start = system.energy();
  const int warm_periods = scene().warm_periods, periods = warm_periods + 3;
  int events = 0, quiet_after_event = 1;
  for (int step = 0; step < periods * scene().period; ++step) {
    SCOPED_TRACE(std::string(scene().name) + ", step " + std::to_string(step));
    const std::uint32_t version = system.structure_version();
    before_step(step % scene().period);
    StepReport report;
    const long before = allocations;
    ASSERT_NO_THROW(report = system.step(dt));
    const long allocated = allocations - before;

    ASSERT_TRUE(std::isfinite(report.energy.total()) && std::isfinite(report.energy.dissipated));
    const auto book = [](const Energy& e) { return e.balance(); };
    ASSERT_NEAR(book(report.energy), book(start), 1e-6 * (1 + report.energy.kinetic + std::abs(report.energy.edits)));
    if (step % scene().period == 0 || step + 1 == periods * scene().period) {
      ASSERT_EQ(system.validate(), std::vector<std::string>{});
    }
    events += scene().is_event(report);

    const bool has_changed =
        report.structure_version != version || !report.warnings.empty() || !report.born.empty() || !report.died.empty();
    quiet_after_event = has_changed ? 0 : quiet_after_event + 1;
    if (step < warm_periods * scene().period) continue;
    const auto& at = scene().may_at;
    const bool is_listed = std::find(at.begin(), at.end(), step % scene().period) != at.end();
    const bool is_foreign = scene().may_allocate == solver_is_foreign;
    const bool may = (scene().may_allocate != nullptr && (quiet_after_event < 2 || is_listed || is_foreign)) ||
                     !report.stops.empty();  // the report lists them
    if (!may) {
      EXPECT_EQ(allocated, 0);
    }
  }
  EXPECT_GT(events, 0) << "the scene does not do what it is there for";
}

INSTANTIATE_TEST_SUITE_P(, Step,
                         testing::Combine(testing::Range<std::size_t>(0, all_scenes().size()),
                                          testing::Values(IntegrationMode::robust, IntegrationMode::energy_keeping)),
                         [](const auto& info) {
                           return std::string(all_scenes()[std::get<0>(info.param)].name) +
                                  (std::get<1>(info.param) == IntegrationMode::robust ? "_robust" : "_energy_keeping");
                         });

}  // namespace
}  // namespace iota
