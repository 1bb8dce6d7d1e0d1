// SPDX-License-Identifier: Apache-2.0
#include "edit/angle_springs.h"

#include "math/checks.h"

#include <numbers>

namespace iota::edit {

namespace {

constexpr double least_rest = 0.01;  // rad: the energy is a function of the chord's middle, which hardly changes near 0

void take_options(ingredient::AngleSpring& spring, const AngleSpringOptions& options) {
  require_not_negative("stiffness", options.stiffness);
  require_not_negative("damping", options.damping);
  if (!(options.rest >= least_rest && options.rest <= std::numbers::pi))
    throw std::invalid_argument(
        text("the rest angle of an angle spring must be between 0.01 and pi (straight), got ", options.rest));
  spring.stiffness = options.stiffness, spring.damping = options.damping, spring.rest = options.rest;
}

}  // namespace

AngleSpringId apply(Editor& e, const CreateAngleSpring& c) {
  model::Model& model = e.model;
  ingredient::AngleSpring spring;
  spring.particles = {e.require(c.p), e.require(c.middle), e.require(c.q)};
  const Vec3 middle = model.position(c.middle.slot);
  spring.lengths = {norm(model.position(c.p.slot) - middle), norm(model.position(c.q.slot) - middle)};
  if (!(spring.lengths[0] > 0 && spring.lengths[1] > 0) || c.p == c.q)
    throw std::invalid_argument(
        text("an angle spring needs three particles, the middle one away from the others, got particles ", c.p.slot,
             ", ", c.middle.slot, " and ", c.q.slot));
  AngleSpringOptions options = c.options;
  if (std::isnan(options.rest)) options.rest = ingredient::AngleSprings::angle(model, spring);
  take_options(spring, options);
  e.structure_changed();
  return model.angle_springs.id(ingredient::AngleSprings::add(model, spring));
}

void apply(Editor& e, const SetAngleSpring& c) {
  ingredient::AngleSpring& spring = e.model.angle_springs[e.require(c.spring)];
  AngleSpringOptions options = c.options;
  if (std::isnan(options.rest)) options.rest = ingredient::AngleSprings::angle(e.model, spring);
  take_options(spring, options);
  const model::Particle& middle = e.model.particles[spring.at(1)];
  e.model.wake(e.model.bodies[middle.body].articulate);
}

void apply(Editor& e, const Destroy<AngleSpringId>& c) {
  ingredient::AngleSprings::remove(e.model, e.require(c.id));
  e.structure_changed();
}

}  // namespace iota::edit
