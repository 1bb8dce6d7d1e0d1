// SPDX-License-Identifier: Apache-2.0
#include "edit/nails.h"

#include "edit/settle.h"
#include "math/checks.h"
#include "model/nailed.h"

#include <iota/reports.h>

namespace iota::edit {

namespace {

/// how: what `Ring::nailed` becomes; a nail stays one.
void hold(Editor& e, std::uint32_t particle, const Vec3& position, std::uint16_t how) {
  model::Model& model = e.model;
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
    if (how != model::carried && ring.nailed == model::carried) ring.nailed = how, model.mark_ring(slot);
    return;
  }
  const bool moved = ring.position != position;
  bool gentle = !moved && ring.velocity == Vec3{};  // it is already at rest there
  model.for_each_in_ring(slot, [&](std::uint32_t p) { gentle = gentle && model.follows_basis(p); });
  RestructureReport report;
  Restructuring change(e, {{model.particles[particle].body}},
                       gentle ? Restructuring::Kind::gentle : Restructuring::Kind::moving, report);
  ring.nailed = how, ring.position = position, ring.velocity = {};
  model.nails.make(slot) = {position, position, {}};
  model.mark_ring(slot);
  report.changed = true;
  change.finish({moved, true});
}

}  // namespace

void apply(Editor& e, const Nail& c) {
  const std::uint32_t particle = e.require(c.particle);
  hold(e, particle, c.in_place ? e.model.position(particle) : c.position, model::by_nail);
}

void carry(Editor& e, ParticleId particle, const Vec3& position) {
  hold(e, e.require(particle), position, model::carried);
}

void stop_carrying(Editor& e, std::uint32_t body) {
  model::Model& model = e.model;
  model.for_each_particle_of(body, [&](std::uint32_t p) {
    const std::uint32_t slot = model.particles[p].ring;
    model::Ring& ring = model.rings[slot];
    if (ring.nailed != model::carried) return;
    bool moves = false;  // with another scripted body
    model.for_each_in_ring(slot, [&](std::uint32_t q) {
      moves = moves || model.bodies[model.particles[q].body].kind == BodyKind::scripted;
    });
    if (moves) return;
    ring.nailed = 0;
    model.nails.at(slot).multiplier = {};
    model.mark_ring(slot);
  });
}

void apply(Editor& e, const Release& c) {
  model::Model& model = e.model;
  const std::uint32_t particle = e.require(c.particle);
  const std::uint32_t ring = model.particles[particle].ring;
  if (model.rings[ring].nailed != model::by_nail) return;
  model.rings[ring].nailed = 0;
  model.scene.note(ViewEvent::Kind::break_, model.rings[ring].position);
  model.nails.at(ring).multiplier = {};
  model.mark_ring(ring);
  e.structure_changed();
}

}  // namespace iota::edit
