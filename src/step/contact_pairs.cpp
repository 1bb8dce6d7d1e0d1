// SPDX-License-Identifier: Apache-2.0
#include "step/contact_pairs.h"

#include "model/outline.h"

#include <algorithm>

namespace iota::step {

bool is_particle(const model::Body& body, const contact::Outlines& outlines, std::uint32_t slot) {
  return body.count == 1 && outlines.described(slot).solids.empty();
}

bool may_touch(const model::Model& model, const contact::Outlines& outlines, std::uint32_t slot) {
  return model.bodies[slot].kind != BodyKind::inactive && outlines.reach(slot) >= 0 && model.material(slot);
}

namespace {

/// Whether a place, and those to which a joint lets it go, are within an obstacle or on its surface. A lift of which the guide leaves
/// the ground falls on it, and so does what moves in an upright plane.
bool is_held_at(const contact::Outline& obstacle, const ingredient::Joints::HeldPlace& held, double slack,
                double reach) {
  constexpr double way = 0.1, aside = 1e-3;  // of the reach
  const double apart = contact::near(obstacle, held.place).distance;
  // Each plane through an obstacle leaves it somewhere, while a piston or a bead has a guide through it.
  if (apart > slack || (held.freedom > 1 && apart < -slack)) return false;
  for (std::size_t i = 0; i < held.freedom; ++i)
    for (const double side : {way, -way}) {
      const Vec3 place = held.place + side * reach * held.ways[i];
      if (contact::near(obstacle, place).distance > std::max(apart, 0.0) + aside * reach) return false;
    }
  return true;
}

/// Whether a nail or a joint of the world holds a body, or what welds hold at it, within something static: a chain on its beam, a wheel
/// on the axle that a stand carries.
bool is_held_within(model::Model& model, contact::Outlines& outlines, JoinedBodies& joined, std::uint32_t body,
                    std::uint32_t obstacle) {
  constexpr double of_reach = 1e-3;  // a place on the surface counts
  const bool has_joints = ingredient::Joints::ties_any(model);
  bool any = false;
  const auto look_at = [&](std::uint32_t member) {
    const double reach = std::max(outlines.reach(member), 0.0);  // 0: it has no outline
    const double slack = std::max(model::radius_of(model, member), of_reach * reach);
    model.for_each_particle_of(member, [&](std::uint32_t p) {
      const auto note = [&](const ingredient::Joints::HeldPlace& held) {
        // A guide beside a body may run on into the ground below it.
        const bool is_on_body = held.freedom == 0 || reach == 0 ||
                                contact::near(outlines.placed(member), model.position(p)).distance <= slack;
        any = any || (is_on_body && is_held_at(outlines.placed(obstacle), held, slack, reach));
      };
      if (!any && model.rings[model.particles[p].ring].nailed) note({.place = model.position(p)});
      if (!any && has_joints) ingredient::Joints::visit_held_places(model, p, note);
    });
  };
  if (!joined.has_welds(model))
    look_at(body);
  else
    for (const std::uint32_t member : joined.welded_to(model, body)) look_at(member);
  return any;
}

/// Two particles do not touch, unless both have materials of their own.
bool are_plain(const model::Model& model, std::uint32_t a, std::uint32_t b) {
  return !model.materials.has(a) || !model.materials.has(b);
}

}  // namespace

bool is_sensor(const model::Model& model, const BodyPair& pair) {
  return model.material(pair.first)->touches == Touches::sensor ||
         model.material(pair.second)->touches == Touches::sensor;
}

bool touch_each_other(model::Model& model, contact::Outlines& outlines, JoinedBodies& joined, const BodyPair& pair) {
  const auto [first, second] = pair;
  const auto touches = [&](std::uint32_t body) { return model.material(body)->touches; };
  if (is_sensor(model, pair)) {
    if (touches(first) == touches(second)) return false;
  } else if (model.bodies[second].kind != BodyKind::static_) {
    if (touches(first) != Touches::all || touches(second) != Touches::all) return false;
    const auto is_ball = [&](std::uint32_t body) { return is_particle(model.bodies[body], outlines, body); };
    if (is_ball(first) && is_ball(second) && are_plain(model, first, second)) return false;
    if (!model::is_free(model.bodies[first].kind) && !model::is_free(model.bodies[second].kind)) return false;
  }
  if (ingredient::IgnoredContacts::include(model, first, second) || JoinedBodies::are_joined(model, first, second))
    return false;
  // A sensor feels what welds and joints let overlap: it may be welded to the frame of a door.
  if (!is_sensor(model, pair) && joined.are_joined_by_welds(model, first, second)) return false;
  return model.bodies[second].kind != BodyKind::static_ || !is_held_within(model, outlines, joined, first, second);
}

}  // namespace iota::step
