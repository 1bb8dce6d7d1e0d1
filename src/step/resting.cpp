// SPDX-License-Identifier: Apache-2.0
// Islands that fall asleep and wake: whole ones, since what hangs together moves together.
#include "step/island.h"

#include <algorithm>
#include <utility>

namespace iota::step {

using model::is_free;
using model::Model;
using model::Ring;

bool Island::is_pushed(const Model& model) const {
  const auto has_force = [&](std::uint32_t ring) { return model.pushes[ring].force != Vec3{}; };
  return std::any_of(rings_.begin(), rings_.end(), has_force) ||
         std::any_of(slaves_.begin(), slaves_.end(),
                     [&](std::uint32_t p) { return has_force(model.particles[p].ring); });
}

bool Island::rests(const Model& model) const {
  const auto first =
      std::find_if(bodies_.begin(), bodies_.end(), [&](std::uint32_t b) { return is_free(model.bodies[b].kind); });
  return first != bodies_.end() && model.bodies[*first].kind == BodyKind::resting;
}

bool Island::stays_at_rest(Model& model) {
  const bool disturbed = std::exchange(disturbed_, false);
  const bool sleeps = rests(model);
  if ((!disturbed && !sleeps) || bodies_.empty()) return false;
  if (!disturbed && !nails_move(model) && !is_pushed(model)) return true;
  for (const std::uint32_t b : bodies_)
    if (model.bodies[b].kind == BodyKind::resting) model.bodies[b].kind = BodyKind::dynamic;
  slow_time(model) = 0;
  return false;
}

double& Island::slow_time(Model& model) const {
  return model.articulates[model.bodies[bodies_.front()].articulate].slow_time;
}

void Island::tire(Model& model, double h, solver::AdvanceReport& report) const {
  if (!(model.rest_after > 0) || idle_) return;
  const double limit = model.rest_speed * model.rest_speed;
  bool slow = grips_.empty() && spinning_.empty();
  for (std::size_t i = 0; i < rings_.size() && slow; ++i)
    slow = dot(problem_.velocity[i], problem_.velocity[i]) < limit &&
           (problem_.force.empty() || problem_.force[i] == Vec3{});
  slow_time(model) = slow ? slow_time(model) + h : 0;
  if (slow_time(model) < model.rest_after) return;
  report.dissipated += problem_.kinetic_energy();
  put_to_rest(model);
}

void Island::put_to_rest(Model& model) const {
  for (const std::uint32_t b : bodies_)
    if (is_free(model.bodies[b].kind)) model.bodies[b].kind = BodyKind::resting;
  for (const std::uint32_t b : spinning_) model.spins.at(b).momentum = 0;
  const auto stop = [&](Ring& r) { r.velocity = r.acceleration = {}; };
  for (const std::uint32_t ring : rings_) stop(model.rings[ring]);
  for (const std::uint32_t p : slaves_) stop(model.rings[model.particles[p].ring]);
}

}  // namespace iota::step
