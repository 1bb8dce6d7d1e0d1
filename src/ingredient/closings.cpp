// SPDX-License-Identifier: Apache-2.0
#include "ingredient/closings.h"

#include "base/sort_unique.h"
#include "base/text.h"
#include "ingredient/model.h"
#include "ingredient/outcome.h"
#include "ingredient/row_loads.h"
#include "model/restructure.h"

#include <algorithm>
#include <array>

namespace iota::ingredient {

namespace {

/// Shrinks smoothly from 1 to a hundredth. Each step moves positions only: forces that close the distance in a given time
/// overshoot (measured: they add 25 to 120 J where this adds 0.03 J). A distance row has no direction at 0, so a
/// projection closes the last part.
double closing_factor(double elapsed, double duration) {
  const double s = std::clamp(elapsed / duration, 0.0, 1.0);
  return 1 - 0.99 * s * s * (3 - 2 * s);
}

/// With the scale of the start, as in the model's multiplier: forces are known without the time. The solver's row has the
/// scale of the present length. With that of the start, a gap of a few percent of the last lengths counted as met, and the
/// step that closed it made energy.
solver::DistanceConstraint constraint_of(const Closing& closing, std::uint32_t a, std::uint32_t b) {
  return {{a, b}, closing.distance, closing.distance};
}

}  // namespace

void Closings::build(const IslandMap& map, Problem& problem) {
  const Model& model = map.model;
  if (model.closings.size() == 0) return;
  std::vector<std::uint32_t> slots;
  for (const std::uint32_t body : map.bodies)
    model.for_each_particle_of(
        body, [&](std::uint32_t p) { model.closings.for_each_of(p, [&](std::uint32_t c) { slots.push_back(c); }); });
  sort_unique(slots);
  for (const std::uint32_t slot : slots) {
    const Closing& c = model.closings[slot];
    const std::uint32_t a = map.node_of(c.p), b = map.node_of(c.q);
    if (a == none || b == none) continue;  // of an inactive body
    problem.add(constraint_of(c, a, b), {owner, {}, slot});
  }
}

void Closings::load(const Model& model, const IslandNodes&, double h, Problem& problem) {
  if (model.closings.size() == 0) return;
  auto& distances = problem.pool_of<solver::DistanceConstraint>();
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    const Closing& c = model.closings[key.slot];
    const double factor = closing_factor(c.elapsed + h, c.duration);
    distances.items[i].length = distances.items[i].scale = factor * c.distance;
    distances.multipliers[i] = factor * c.multiplier;
    problem.has_new_rows = problem.has_new_rows || (h > 0 && c.elapsed == 0);
  });
}

void Closings::store(Model& model, const IslandNodes&, double, const Problem& problem) const {
  if (model.closings.size() == 0) return;
  const auto& distances = problem.pool_of<solver::DistanceConstraint>();
  for_each_item_of<solver::DistanceConstraint>(owner, problem, [&](std::size_t i, solver::ItemKey key) {
    Closing& c = model.closings[key.slot];
    c.multiplier = distances.multipliers[i] * c.distance / distances.items[i].scale;
  });
}

std::string Closings::name_of_row(const Model& model, solver::ItemKey key) const {
  const Closing& c = model.closings[key.slot];
  return text("the closing of particles ", c.p, " and ", c.q);
}

void Closings::check_links(const Model& model, model::Audit& audit) { audit.check_ends("closing", model.closings); }

void Closings::validate(const Model& model, model::Audit& audit) {
  model.closings.for_each([&](std::uint32_t, const Closing& c) {
    const model::Particle &p = model.particles[c.p], &q = model.particles[c.q];
    audit.join(p.body, q.body);
    audit.use_particle(c.p), audit.use_particle(c.q);
    audit.require(p.ring != q.ring && p.body != q.body, "a closing of particles ", c.p, " and ", c.q,
                  " has nothing to close");
  });
  audit.require_listed("closing", model.closings);
}

void Closings::add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  const Model& model = step.model;
  if (model.closings.size() == 0) return;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    model.closings.for_each_of(p, [&](std::uint32_t slot) {
      const Closing& closing = model.closings[slot];
      for_each_row_force(step, constraint_of(closing, 0, 1), &closing.multiplier, std::array{closing.p, closing.q},
                         [&](std::uint32_t particle, const Vec3& force) {
                           if (particle == p)
                             reader.take({.particle = p, .force = force, .part = model.particles[p].part});
                         });
    });
  });
}

void Closings::end_step(Model& model, double h) {
  model.closings.for_each([&](std::uint32_t, Closing& c) { c.elapsed += h; });
}

void Closings::tell(Model& model, Outcome& outcome) {
  model.closings.for_each([&](std::uint32_t slot, const Closing& c) {
    if (c.elapsed >= c.duration) outcome.met.push_back(model.closings.id(slot));
  });
}

bool Closings::holds(const Model& model, std::uint32_t particle) { return model.closings.ends_at(particle); }

std::uint32_t Closings::add(Model& model, const Closing& closing) {
  for (const std::uint32_t particle : {closing.p, closing.q}) {
    ++model.particles[particle].uses;
    model.mark_rows(model.particles[particle].body);
  }
  return model.closings.create(closing);
}

void Closings::remove(Model& model, std::uint32_t closing) {
  for (const std::uint32_t particle : {model.closings[closing].p, model.closings[closing].q}) {
    --model.particles[particle].uses;
    model.mark_rows(model.particles[particle].body);
  }
  model.closings.destroy(closing);
}

std::uint32_t Closings::between(const Model& model, std::uint32_t p, std::uint32_t q) {
  std::uint32_t found = none;
  if (model.closings.size() == 0) return found;
  model.closings.for_each_of(p, [&](std::uint32_t slot) {
    if (model.closings[slot].p == q || model.closings[slot].q == q) found = slot;
  });
  return found;
}

// The articulate is split immediately, as a cut must not find another cut pending.
void Closings::end(Model& model, std::uint32_t closing) {
  const std::array bodies{model.particles[model.closings[closing].p].body,
                          model.particles[model.closings[closing].q].body};
  remove(model, closing);
  model::split_where_apart(model, bodies);
}

// While they are closing they are already one problem.
void Closings::visit_joined(const Model& model, std::uint32_t particle, Visit visit) {
  model.closings.for_each_of(particle, [&](std::uint32_t slot) {
    const Closing& closing = model.closings[slot];
    visit(model.particles[closing.p == particle ? closing.q : closing.p].body);
  });
}

void Closings::absorb(Model& model, std::uint32_t q, std::uint32_t p) {
  const auto moved = [&](std::uint32_t) {
    --model.particles[q].uses, ++model.particles[p].uses;
    model.mark_particle(p);
  };
  model.closings.redirect(q, p, moved, [&](std::uint32_t slot) { remove(model, slot); });
}

void Closings::drop(Model& model, std::uint32_t particle) {
  model.closings.for_each_of(particle, [&](std::uint32_t slot) { end(model, slot); });
}

bool Closings::call_off(Model& model, std::uint32_t p, std::uint32_t q) {
  const std::uint32_t closing = between(model, p, q);
  if (closing != none) end(model, closing);
  return closing != none;
}

// If the two particles share a ring or a body now, there is nothing left to close.
void Closings::clean_up(Model& model, std::span<const std::uint32_t>, std::vector<std::string>& notes) {
  if (model.closings.size() == 0) return;
  for (std::uint32_t slot = 0; slot < model.closings.slot_count(); ++slot) {
    if (!model.closings.is_alive(slot)) continue;
    const Closing& closing = model.closings[slot];
    const model::Particle &p = model.particles[closing.p], &q = model.particles[closing.q];
    if (p.ring != q.ring && p.body != q.body) continue;
    if (p.ring != q.ring)
      notes.push_back(text("particles ", closing.p, " and ", closing.q,
                           " were on their way to each other, but are of one rigid body now: called off"));
    remove(model, slot);
  }
}

}  // namespace iota::ingredient
