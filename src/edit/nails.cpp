// SPDX-License-Identifier: Apache-2.0
#include "edit/nails.h"

#include "edit/checks.h"
#include "edit/settle.h"

namespace iota::edit {

void apply(Editor& e, const Nail& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  const Vec3 position = c.in_place ? model.position(particle) : c.position;
  require_finite("position", position);
  const std::uint32_t slot = model.particles[particle].ring;
  model::Ring& ring = model.rings[slot];
  model.for_each_in_ring(slot, [&](std::uint32_t p) {
    if (model.bodies[model.particles[p].body].kind == BodyKind::static_ && position != ring.position)
      throw std::invalid_argument(text("nail: static body ", model.particles[p].body, " holds particle ", particle,
                                       "; make it dynamic or scripted to move it"));
  });
  if (ring.nailed) {
    model.nails.at(slot).position = position;  // moves there during the next step
    return;
  }
  const bool moved = ring.position != position;
  bool gentle = !moved && ring.velocity == Vec3{};  // it is at rest there already
  model.for_each_in_ring(slot, [&](std::uint32_t p) { gentle = gentle && model.follows_basis(p); });
  RestructureReport report;
  Restructuring change(e, {{model.particles[particle].body}},
                       gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  ring.nailed = 1, ring.position = position, ring.velocity = {};
  model.nails.make(slot) = {position, position, {}};
  model.touch_ring(slot);
  report.changed = true;
  change.finish({moved, true});
}

void apply(Editor& e, const Release& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  const std::uint32_t ring = model.particles[particle].ring;
  if (!model.rings[ring].nailed) return;
  model.rings[ring].nailed = 0;
  model.scene.note(ViewEvent::Kind::break_, model.rings[ring].position);
  model.nails.at(ring).multiplier = {};
  model.touch_ring(ring);
  e.structure_changed();
}

}  // namespace iota::edit
