// SPDX-License-Identifier: Apache-2.0
// Describes changes for viewers: the bodies in the scene log, the ingredients attached to them, and destroyed objects.
#include "math/mat3.h"
#include "model/outline.h"
#include "system/core.h"

#include <iota/scene.h>

#include <algorithm>

namespace iota {

namespace {

bool is_drawn(const model::Structure& model, std::uint32_t body) {
  return model.bodies.is_alive(body) && model.is_visible(body);
}

void add_balls(Core& core, const ingredient::SceneView& view, std::uint32_t slot, DrawnBody& drawn) {
  core.model.for_each_particle_of(slot, [&](std::uint32_t p) {
    const ParticleId id = core.model.particles.id(p);
    if (!Particles(core).has_attributes(id)) return;
    const ParticleAttributes look = Particles(core).attributes(id);
    if (look.radius > 0) drawn.balls.push_back({view.point_in(slot, core.model.position(p)), look.radius, look.color});
  });
}

void describe_body(Core& core, const ingredient::SceneView& view, std::uint32_t slot, SceneChanges& changes) {
  const model::Model& model = core.model;
  if (!is_drawn(model, slot)) return changes.bodies.gone.push_back(slot);
  const model::Body& body = model.bodies[slot];
  DrawnBody& drawn = changes.bodies.set.emplace_back();
  drawn.id = model.bodies.id(slot);
  drawn.is_new = model.scene.bodies.is_new(slot);
  drawn.kind = body.kind;
  drawn.particles = body.count;
  drawn.radius = model::radius_of(core.model, slot);
  drawn.color = Bodies(core).color(drawn.id);
  const Quaternion& q = body.orientation;
  for (SolidView& solid : Bodies(core).solids(drawn.id))
    drawn.solids.push_back({std::move(solid.shape), view.point_in(slot, solid.position),
                            multiply({-q.x, -q.y, -q.z, q.w}, solid.orientation)});
  if (body.count == 1) {
    const ParticleId only = model.particles.id(body.first);
    if (Particles(core).has_attributes(only)) drawn.attributes = Particles(core).attributes(only);
  }
  if (body.count > 1) add_balls(core, view, slot, drawn);
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() { I::draw(view, slot, drawn); });
}

SceneChanges describe(Core& core, bool whole) {
  const model::Model& model = core.model;
  const ingredient::SceneView view(model, whole);
  SceneChanges changes;
  changes.is_whole = whole;
  changes.usual_radius = model::usual_radius(core.model);
  if (whole) changes.extent = model::scene_extent(model);
  const auto bodies = [&](const model::ChangedSlots& log) {
    std::vector<std::uint32_t> slots = log.slots();
    if (!whole) return slots;
    slots.clear();
    model.bodies.for_each([&](std::uint32_t slot, const model::Body&) { slots.push_back(slot); });
    return slots;
  };
  for (const std::uint32_t body : bodies(model.scene.bodies)) describe_body(core, view, body, changes);
  for (const std::uint32_t body : bodies(model.scene.memberships))
    if (is_drawn(model, body) && !model.obstacles.has(body))
      changes.memberships.push_back({body, model.bodies[body].articulate});
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() { I::describe(view, changes); });
  return changes;
}

}  // namespace

SceneChanges Viewer::take_scene_changes(bool whole, std::span<const BodyId> also) {
  core_.orientations.refresh(core_.model);
  model::Model& model = core_.model;
  for (const BodyId body : also)
    if (model.bodies.contains(body)) model.scene.bodies.note(body.slot);
  whole = whole || model.scene.is_whole || model.scene.usual_radius != model::usual_radius(model);
  SceneChanges changes = describe(core_, whole);
  changes.events = std::move(model.scene.events);
  model.watch_scene();
  model.scene.usual_radius = changes.usual_radius;
  return changes;
}

void Viewer::stop_watching_scene() { core_.model.stop_watching_scene(); }

}  // namespace iota
