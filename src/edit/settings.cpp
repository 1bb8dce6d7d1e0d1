// SPDX-License-Identifier: Apache-2.0
#include "edit/settings.h"

#include "edit/law_checks.h"
#include "math/checks.h"

#include <iota/solver.h>

#include <utility>

namespace iota::edit {

void apply(Editor& e, const SetGravity& c) {
  model::Model& model = e.model;
  require_finite("gravity", c.value);
  model.gravity = c.value;
  model.wake_all();
}

void apply(Editor& e, const SetMode& c) { e.model.mode = c.mode; }

void apply(Editor& e, const SetTolerance& c) {
  if (!(c.value >= 1e-12 && c.value <= 1))
    throw std::invalid_argument(text("tolerance must be between 1e-12 and 1 link lengths per second, got ", c.value));
  e.model.tolerance = c.value;
}

void apply(Editor& e, const SetBudget& c) {
  if (c.budget.iterations < 0)
    throw std::invalid_argument(text("budget.iterations must be zero or more, got ", c.budget.iterations));
  require_not_negative("budget.seconds", c.budget.seconds);
  require_not_negative("budget.contacts", c.budget.contacts);
  if (!(c.budget.contacts_share > 0 && c.budget.contacts_share <= 1))
    throw std::invalid_argument(text("budget.contacts_share must be above 0 to 1, got ", c.budget.contacts_share));
  e.model.budget_iterations = c.budget.iterations, e.model.budget_seconds = c.budget.seconds;
  e.model.budget_contacts = c.budget.contacts, e.model.contacts_share = c.budget.contacts_share;
}

void apply(Editor& e, const SetSolver& c) {
  if (c.name.empty() || c.name.size() > max_solver_name)
    throw std::invalid_argument(
        text("set_solver: a name has 1 to ", max_solver_name, " characters, not \"", c.name, "\""));
  std::array<char, 32> name{};
  if (c.name != "direct") put_text(name, c.name, "the name of a solver");
  try {
    if (name[0] != 0) (void)make_solver(c.name);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(text(error.what(), "; or \"direct\", the system's own"));
  }
  e.model.solver = name;
}

void apply(Editor& e, const SetDamping& c) {
  require_not_negative("damping", c.per_second);
  e.model.damping = c.per_second;
}

void apply(Editor& e, const SetUsualRadius& c) {
  require_size("usual_radius", c.value);
  model::Model& model = e.model;
  const double before = std::exchange(model.usual_radius, c.value);
  const bool has_any_material = model.has_usual_material || !model.materials.is_empty();
  if (c.value != before && has_any_material) model.wake_all();
}

void apply(Editor& e, const SetUsualMaterial& c) {
  require_material(c.value);
  model::Model& model = e.model;
  const bool is_same = model.has_usual_material == c.touches && model.usual_material == c.value;
  model.usual_material = c.value, model.has_usual_material = c.touches;
  if (!is_same) model.wake_all();
}

void apply(Editor& e, const SetRest& c) {
  model::Model& model = e.model;
  require_not_negative("rest.after", c.options.after);
  require_not_negative("rest.speed", c.options.speed);
  model.rest_after = c.options.after, model.rest_speed = c.options.speed;
}

}  // namespace iota::edit
