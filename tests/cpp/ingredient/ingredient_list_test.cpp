// SPDX-License-Identifier: Apache-2.0
// A new ingredient takes part in every fold as soon as it is in the list.
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "ingredient/quantities.h"
#include "model/restructure.h"

#include <gtest/gtest.h>

namespace iota::ingredient {
namespace {

constexpr std::uint32_t blown_body = 0;
const Vec3 blow{0.5, 0, 0.25};

/// Pushes all particles of one body alike.
struct Wind : NoAnswers {
  static void add_energy(const Scope& scope, Energies& sum) {
    scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
      if (p.body == blown_body) sum.potential -= dot(blow, scope.model.rings[p.ring].position);
    });
  }
  static void add_momentum(const Scope& scope, Momenta& sum) {
    scope.for_each_particle([&](std::uint32_t, const model::Particle& p) {
      if (p.body == blown_body) sum.linear += blow;
    });
  }
  static void add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
    if (body == blown_body)
      step.model.for_each_particle_of(body, [&](std::uint32_t p) {
        reader.take({.particle = p, .force = blow, .part = step.model.particles[p].part});
      });
  }
  static void end_step(Model& model, double h) { model.external_work += h; }
  static void tell(Model&, Outcome& outcome) { outcome.warnings.push_back("it blows"); }
};

using WithWind = decltype(std::tuple_cat(Ingredients{}, std::tuple<Wind>{}));

/// Two rods that share a ring at the origin, at rest.
struct TwoRods {
  model::Model model;
  std::uint32_t left, right, left_end, right_end;

  TwoRods() {
    model.gravity = {};
    left = model.make_body(BodyKind::dynamic, 0), right = model.make_body(BodyKind::dynamic, 0);
    (void)model.make_particle(left, {-1, 0, 0}, 1, {});
    left_end = model.make_particle(left, {}, 1, {});
    right_end = model.make_particle(right, {}, 1, {});
    (void)model.make_particle(right, {1, 0, 0}, 1, {});
    for (const std::uint32_t body : {left, right}) model.rebuild_basis(body);
    RestructureReport report;
    (void)model::combine_particles(model, left_end, right_end, report);
  }
};

TEST(IngredientList, a_further_ingredient_ends_its_step_and_is_asked_what_it_led_to) {
  TwoRods rods;
  end_step<WithWind>(rods.model, 0.25);
  EXPECT_EQ(rods.model.external_work, 0.25);
  Outcome outcome;
  tell<WithWind>(rods.model, outcome);
  EXPECT_EQ(outcome.warnings, std::vector<std::string>{"it blows"});
}

TEST(IngredientList, a_further_ingredient_counts_in_energies_and_momenta) {
  const TwoRods rods;
  Energies energies;
  Momenta momenta;
  add_energies<WithWind>(Scope(rods.model), energies);
  add_momenta<WithWind>(Scope(rods.model), momenta);
  EXPECT_EQ(energies.total(), calc_energies(rods.model).total() + 0.5);  // of the particle at x = -1
  EXPECT_EQ(momenta.linear, calc_momenta(rods.model).linear + 2 * blow);

  Energies of_the_other_body;
  add_energies<WithWind>(Scope(rods.model, rods.right), of_the_other_body);
  EXPECT_EQ(of_the_other_body.total(), 0);
}

TEST(IngredientList, a_further_ingredient_counts_in_loads) {
  const TwoRods rods;
  const ReadLoads read = add_loads<WithWind>;
  EXPECT_EQ(calc_hinge_force(rods.model, rods.left_end), Vec3{});
  // Nothing moves, so the hinge shares what blows at it between the two bodies.
  EXPECT_EQ(calc_hinge_force(rods.model, rods.left_end, read), -0.5 * blow);
  EXPECT_EQ(calc_hinge_force(rods.model, rods.right_end, read), 0.5 * blow);
  EXPECT_EQ(calc_outside_load(rods.model, rods.left, {}, read).force, 1.5 * blow);
  EXPECT_EQ(calc_net_load(rods.model, rods.left, {}, read).force, Vec3{});
}

}  // namespace
}  // namespace iota::ingredient
