// SPDX-License-Identifier: Apache-2.0
// Each sentence of `validate`: one table is damaged, and it is said.
#include "ingredient/tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace iota::model {
namespace {

/// The tables of a system, as a snapshot has them: after mark and checksum.
Model model_of(System& system) {
  const Snapshot snapshot = system.snapshot();
  Reader outer(snapshot.bytes);
  std::uint64_t mark = 0, checksum = 0;
  std::vector<std::byte> content;
  outer.value(mark), outer.value(checksum), outer.vector(content);
  Reader reader(content);
  Model model;
  ingredient::archive(model, reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  return model;
}

/// One of everything that a system can hold, and the slots of what the tests damage.
struct Everything {
  std::uint32_t loner, hinged, hinge_partner, inner, corner, rod, corners_body, box;
  std::uint32_t bond, scripted, cosmetic, joint, grip, field, pairs;
  Model model;

  Everything() {
    System system;
    const auto slot = [](auto id) { return id.slot; };
    const ParticleId alone = system.create_particle(system.create_body(), {9, 9, 9});
    loner = slot(alone);

    // A short chain on a nail, of rods, one of which spins.
    std::vector<ParticleId> upper, lower;
    std::vector<BodyId> links;
    for (int i = 0; i < 3; ++i) {
      links.push_back(system.create_body());
      upper.push_back(system.create_particle(links[i], {double(i), 0, 0}));
      lower.push_back(system.create_particle(links[i], {i + 1.0, 0, 0}));
      system.set_rod(links[i], 1, 0.1);
      if (i > 0) (void)system.combine(lower[i - 1], upper[i]);
    }
    system.nail(upper[0]);
    system.set_angular_velocity(links[2], {3, 0, 0});
    system.set_break_force(upper[1], 1e6);
    hinged = slot(upper[1]), hinge_partner = slot(lower[0]), rod = slot(links[2]);

    // A body of four corners and a particle that is not in its basis, with a cosmetic bond and a group.
    const BodyId four = system.create_body();
    std::vector<ParticleId> corners;
    for (const Vec3& x : {Vec3{0, 5, 0}, Vec3{1, 5, 0}, Vec3{0, 6, 0}, Vec3{0, 5, 1}})
      corners.push_back(system.create_particle(four, x));
    const ParticleId middle = system.create_particle(four, {0.3, 5.3, 0});
    inner = slot(middle), corner = slot(corners[0]), corners_body = slot(four);
    cosmetic = slot(system.create_cosmetic_bond(corners[0], corners[1]));
    const GroupId group = system.create_group("corners");
    system.add(group, corners[0]);
    field = slot(system.create_field("fx = m", {.group = group}));
    pairs = slot(system.create_pairs({system.find_law("soft_repulsion"), {{"length", 0.5}}, {}}, {.cutoff = 0.5}));

    // A solid on a joint, in a hand.
    const BodyId solid = system.create_body(Box{{0.2, 0.3, 0.4}}, {.position = {0, 5, 3}});
    (void)system.create_attachment(solid, {0, 5.2, 3});
    joint = slot(
        system.create_constraint(JointSpec{.kind = ConstraintKind::revolute, .a = solid, .b = four, .at = {0, 5, 1}}));
    grip = slot(system.create_grip(solid, {}, {1, 1, 1}));
    box = slot(solid);

    // Bonds of both kinds; two on their way to each other; one rigid body that was two.
    bond = slot(system.create_bond(alone, corners[1], SpringLaw{}));
    (void)system.create_bond(alone, corners[2], SpringLaw{});
    scripted = slot(system.create_bond(alone, lower[2], ScriptedLaw{[](const BondState&) { return Vec3{}; }}));
    const ParticleId left = system.create_particle(system.create_body(), {-5, 0, 0}),
                     right = system.create_particle(system.create_body(), {-6, 0, 0});
    (void)system.combine(left, right, 10);
    const ParticleId one = system.create_particle(system.create_body(), {-9, 0, 0}),
                     two = system.create_particle(system.create_body(), {-9, 0, 0});
    system.create_particle(system.body(two), {-9, 1, 0});
    (void)system.combine(one, two), (void)system.combine(one, two);

    system.create_emitter({.rate = 240});
    (void)system.step(1.0 / 60);
    system.apply_force(alone, {1, 0, 0});
    model = model_of(system);
  }
};

/// A slot of a table beyond its end: nothing lives there.
constexpr std::uint32_t nowhere = 1000;

template <class Table>
std::uint32_t first_alive(const Table& table) {
  std::uint32_t found = none;
  table.for_each([&](std::uint32_t slot, const auto&) { found = std::min(found, slot); });
  return found;
}

struct Damage {
  const char* sentence;
  std::function<void(Everything&)> make;
};

std::uint32_t ring_of(Everything& e, std::uint32_t p) { return e.model.particles[p].ring; }
Body& body_of(Everything& e, std::uint32_t p) { return e.model.bodies[e.model.particles[p].body]; }

const std::vector<Damage> damages{
    // particles
    {"is in no living body or ring", [](Everything& e) { e.model.particles[e.loner].body = nowhere; }},
    {"has mass -1", [](Everything& e) { e.model.particles[e.loner].mass = -1; }},
    {"is in its body's basis, or alone in it", [](Everything& e) { e.model.particles[e.corner].mass = 0; }},
    {"is in a basis and tied to it, or neither", [](Everything& e) { e.model.ties.make(e.corner); }},
    {"has basis weights that sum to 1.5", [](Everything& e) { e.model.ties.at(e.inner).weights[0] += 0.5; }},
    {"uses, has", [](Everything& e) { ++e.model.particles[e.loner].uses; }},
    {"is in a group that is gone", [](Everything& e) { e.model.particles[e.loner].groups |= 1u << 30; }},
    // rings
    {"lists stranger", [](Everything& e) { e.model.particles[e.hinged].ring = ring_of(e, e.loner); }},
    {"counts 2 particles, lists 1", [](Everything& e) { ++e.model.rings[ring_of(e, e.loner)].count; }},
    {"holds two particles of one body",
     [](Everything& e) { e.model.particles[e.hinged].body = e.model.particles[e.hinge_partner].body; }},
    {"is not finite", [](Everything& e) { e.model.rings[ring_of(e, e.loner)].velocity.x = std::nan(""); }},
    {"is nailed nowhere", [](Everything& e) { e.model.rings[ring_of(e, e.loner)].nailed = 1; }},
    // side tables
    {"a tie of 1000, which does not live", [](Everything& e) { e.model.ties.make(nowhere); }},
    {"lists of 1000, which does not live", [](Everything& e) { e.model.references.make(nowhere); }},
    {"a fuse of 1000, which does not live", [](Everything& e) { e.model.fuses.make(nowhere); }},
    {"rows of 1000, which does not live", [](Everything& e) { e.model.more_rows.make(nowhere); }},
    {"a spin of 1000, which does not live", [](Everything& e) { e.model.spins.make(nowhere); }},
    {"a nail of 1000, which does not live", [](Everything& e) { e.model.nails.make(nowhere); }},
    {"a push of 1000, which does not live", [](Everything& e) { e.model.pushes.make(nowhere); }},
    {"spins, but is not a rod", [](Everything& e) { e.model.spins.make(e.corners_body); }},
    {"the spin of", [](Everything& e) { e.model.spins.at(e.rod).momentum = std::nan(""); }},
    // bodies
    {"lists stranger", [](Everything& e) { e.model.particles[e.loner].body = e.corners_body; }},
    {"counts 2 particles, lists 1", [](Everything& e) { ++body_of(e, e.loner).count; }},
    {"is in no living articulate",
     [](Everything& e) {  // one that is gone; the table has room for it
       body_of(e, e.loner).articulate = e.model.articulates.create({}).slot;
       e.model.articulates.destroy(body_of(e, e.loner).articulate);
     }},
    {"rows at rank", [](Everything& e) { ++body_of(e, e.corner).row_count; }},
    {"has a wrong table of them", [](Everything& e) { e.model.more_rows.erase(e.corners_body); }},
    {"has a wrong basis point 0", [](Everything& e) { body_of(e, e.corner).basis[0] = e.loner; }},
    {"is not of body", [](Everything& e) { e.model.solids[first_alive(e.model.solids)].body = e.corners_body; }},
    {"stands on stranger", [](Everything& e) { e.model.solids[first_alive(e.model.solids)].points[0] = e.loner; }},
    {"inertia pair",
     [](Everything& e) { e.model.inertia_pairs[e.model.bodies[e.rod].first_inertia].body = e.corners_body; }},
    {"bodies list 0 solids of 1", [](Everything& e) { e.model.bodies[e.box].first_solid = none; }},
    // articulates
    {"hang together but are in articulates",
     [](Everything& e) { body_of(e, e.hinged).articulate = body_of(e, e.loner).articulate; }},
    {"lists stranger", [](Everything& e) { body_of(e, e.loner).articulate = body_of(e, e.corner).articulate; }},
    {"counts 2 bodies, lists 1", [](Everything& e) { ++e.model.articulates[body_of(e, e.loner).articulate].count; }},
    {"holds 2 separate pieces",
     [](Everything& e) { e.model.join_articulates(body_of(e, e.loner).articulate, body_of(e, e.corner).articulate); }},
    // what joins two particles
    {"has nothing to close",
     [](Everything& e) {
       Closing& closing = e.model.closings[first_alive(e.model.closings)];
       closing.q = closing.p;
     }},
    {"bond", [](Everything& e) { e.model.bonds[e.bond].q = e.model.bonds[e.bond].p; }},
    {"cosmetic bond",
     [](Everything& e) { e.model.cosmetic_bonds[e.cosmetic].q = e.model.cosmetic_bonds[e.cosmetic].p; }},
    {"which does not end there", [](Everything& e) { e.model.references.at(e.corner).first_bond = 2 * e.bond; }},
    {"ends of 3 bonds", [](Everything& e) { e.model.references.at(e.loner).first_bond = none; }},
    {"ends of 1 closings",
     [](Everything& e) {
       e.model.references.at(e.model.closings[first_alive(e.model.closings)].p).first_closing = none;
     }},
    {"ends of 1 cosmetic bonds", [](Everything& e) { e.model.references.at(e.corner).first_cosmetic_bond = none; }},
    {"is implicit without a derivative", [](Everything& e) { e.model.bonds[e.scripted].implicit = 1; }},
    {"has a parameter that is not finite",
     [](Everything& e) { e.model.bonds[e.bond].parameters[0] = std::numeric_limits<double>::infinity(); }},
    // constraints
    {"holds a stranger at place", [](Everything& e) { e.model.constraints[e.joint].particles[a_axis] = e.loner; }},
    {"joins a body to itself",
     [](Everything& e) {
       auto& places = e.model.constraints[e.joint].particles;
       places[b_origin] = places[a_origin];
     }},
    {"lists constraint",
     [](Everything& e) {
       e.model.references.make(e.loner).first_constraint = place_count * e.joint + static_cast<std::uint32_t>(a_origin);
     }},
    {"places of constraints",
     [](Everything& e) {
       const std::uint32_t origin = e.model.constraints[e.joint].particles[a_origin];
       e.model.references.at(origin).first_constraint = none;
     }},
    // laws, fields, pairwise forces
    {"has no living law", [](Everything& e) { e.model.bonds[e.bond].law = nowhere; }},
    {"law", [](Everything& e) { ++e.model.laws[spring_law].uses; }},
    {"field", [](Everything& e) { e.model.fields[e.field].group = 30; }},
    {"pairwise force", [](Everything& e) { e.model.pairs[e.pairs].group = 30; }},
    {"has cut-off -1", [](Everything& e) { e.model.pairs[e.pairs].cutoff = -1; }},
    // the rest
    {"are of no living particle",
     [](Everything& e) { e.model.attributes[first_alive(e.model.attributes)].particle = e.loner; }},
    {"are of no emitter", [](Everything& e) { e.model.attributes[first_alive(e.model.attributes)].emitter = nowhere; }},
    {"particles, has", [](Everything& e) { ++e.model.emitters[first_alive(e.model.emitters)].alive; }},
    {"twin", [](Everything& e) { e.model.twins[first_alive(e.model.twins)].mass = -1; }},
    {"holds no living body", [](Everything& e) { e.model.grips[e.grip].body = nowhere; }},
    {"hangs on a stranger", [](Everything& e) { e.model.grips[e.grip].points[0] = e.loner; }},
};

TEST(Validate, finds_nothing_wrong_with_a_system_that_holds_one_of_everything) {
  const Everything e;
  EXPECT_EQ(ingredient::validate(e.model), std::vector<std::string>{});
  EXPECT_GT(e.model.twins.size(), 0u);
  EXPECT_GT(e.model.attributes.size(), 0u);
  EXPECT_GT(e.model.closings.size(), 0u);
  EXPECT_GT(e.model.spins.size(), 0u);
  EXPECT_GT(e.model.pushes.size(), 0u);
}

TEST(Validate, says_what_is_wrong_with_any_damaged_table) {
  const Everything whole;
  for (const Damage& damage : damages) {
    Everything e = whole;
    damage.make(e);
    const std::vector<std::string> complaints = ingredient::validate(e.model);
    const auto says_it = [&](const std::string& text) { return text.find(damage.sentence) != std::string::npos; };
    EXPECT_TRUE(std::any_of(complaints.begin(), complaints.end(), says_it))
        << "not said: " << damage.sentence << "; said instead: " << (complaints.empty() ? "" : complaints.front());
  }
}

}  // namespace
}  // namespace iota::model
