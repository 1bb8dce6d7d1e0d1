// SPDX-License-Identifier: Apache-2.0
// Sleep of islands: always of a whole island, since its bodies move together.
#include "island/island.h"

#include <algorithm>
#include <utility>

namespace iota::island {

using model::is_free;
using model::Model;

bool Island::is_asleep(const Model& model) const {
  const auto first = std::find_if(nodes_.bodies.begin(), nodes_.bodies.end(),
                                  [&](std::uint32_t b) { return is_free(model.bodies[b].kind); });
  return first != nodes_.bodies.end() && model.bodies[*first].kind == BodyKind::resting;
}

void Island::wake_bodies(Model& model) {
  if (!std::exchange(to_wake_, false)) return;
  for (const std::uint32_t b : nodes_.bodies)
    if (model.bodies[b].kind == BodyKind::resting) model.bodies[b].kind = BodyKind::dynamic;
  articulate(model).slow_time = 0;
}

void Island::update_sleep_timer(Model& model, double h, solver::AdvanceReport& report) {
  if (!(model.rest_after > 0)) return;
  const double limit = model.rest_speed * model.rest_speed;
  const auto is_slow = [&](const Vec3& v) { return dot(v, v) < limit; };
  const bool slow = std::all_of(problem_.velocity.begin(), problem_.velocity.end(), is_slow) &&
                    !any_ingredient([&](const auto& i) { return i.keeps_awake(model, problem_); });
  double& slow_time = articulate(model).slow_time;
  slow_time = slow ? slow_time + h : 0;
  if (slow_time < model.rest_after || slow_time <= h) return;  // what wakes in each step does not sleep in between
  report.lost += problem_.kinetic_energy();
  put_to_rest(model);
}

// Bodies that join in the midst of a step are in no list of those to wake: a sleeper moved on as one, and its outline stayed behind.
void Island::look_whether_still(const Model& model) {
  const auto has = [&](BodyKind kind) {
    return std::ranges::any_of(nodes_.bodies, [&](std::uint32_t b) { return model.bodies[b].kind == kind; });
  };
  to_wake_ = to_wake_ || (has(BodyKind::resting) && has(BodyKind::dynamic));
  is_still_ = idle_ ? !is_driven(model) : is_asleep(model) && !to_wake_;
  book_epoch_ = 0;
}

void Island::put_to_rest(Model& model) {
  for (const std::uint32_t b : nodes_.bodies)
    if (is_free(model.bodies[b].kind)) model.bodies[b].kind = BodyKind::resting;
  for_each_ingredient([&](const auto& i) { i.put_to_rest(model, problem_); });
  nodes_.for_each_ring(model, [&](std::uint32_t ring) { model.stop_ring(ring); });
  to_wake_ = false, is_still_ = true, book_epoch_ = 0;
}

}  // namespace iota::island
