// SPDX-License-Identifier: Apache-2.0
// Each sentence of `validate`: one table is damaged, and it is said.
#include "tests/cpp/ingredient/everything.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace iota::model {
namespace {

using ingredient::Closing;
using ingredient::place_count;
using ingredient::spring_law;
using enum ingredient::Place;

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
    {"is in a basis and has weights in it, or neither", [](Everything& e) { e.model.affine.make(e.corner); }},
    {"has basis weights that sum to 1.5", [](Everything& e) { e.model.affine.at(e.inner).weights[0] += 0.5; }},
    {"uses, has", [](Everything& e) { ++e.model.particles[e.loner].uses; }},
    {"is in a group that is gone", [](Everything& e) { e.model.particles[e.loner].groups |= 1u << 30; }},
    // rings
    {"lists stranger", [](Everything& e) { e.model.particles[e.hinged].ring = ring_of(e, e.loner); }},
    {"counts 2 particles, lists 1", [](Everything& e) { ++e.model.rings[ring_of(e, e.loner)].count; }},
    {"holds two particles of one body",
     [](Everything& e) { e.model.particles[e.hinged].body = e.model.particles[e.hinge_partner].body; }},
    {"is not finite", [](Everything& e) { e.model.rings[ring_of(e, e.loner)].velocity.x = std::nan(""); }},
    {"is nailed nowhere", [](Everything& e) { e.model.rings[ring_of(e, e.loner)].nailed = 1; }},
    // outlines
    {"has a radius", [](Everything& e) { e.model.radii.make(nowhere) = 1; }},
    {"has a color", [](Everything& e) { e.model.colors.make(nowhere) = 1; }},
    {"has color 16777216", [](Everything& e) { e.model.colors.make(e.corners_body) = 0x1000000; }},
    {"has radius -1", [](Everything& e) { e.model.radii.make(e.corners_body) = -1; }},
    {"the usual radius is -1", [](Everything& e) { e.model.usual_radius = -1; }},
    // side tables
    {"the weights of 1000, which does not live", [](Everything& e) { e.model.affine.make(nowhere); }},
    {"lists of 1000, which does not live", [](Everything& e) { e.model.bonds.heads.make(nowhere); }},
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
    {"solid 0 is in no list", [](Everything& e) { e.model.bodies[e.box].first_solid = none; }},
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
    {"angle spring",
     [](Everything& e) {
       auto& ends = e.model.angle_springs[e.angle_spring].particles;
       ends[2] = ends[0];
     }},
    {"a number out of its range", [](Everything& e) { e.model.angle_springs[e.angle_spring].rest = 4; }},
    {"ends of 1 angle springs", [](Everything& e) { e.model.angle_springs.heads.at(e.loner).first = none; }},
    {"a list of bonds begins at", [](Everything& e) { e.model.bonds.heads.make(e.corner).first = 2 * e.bond; }},
    {"which does not end there",
     [](Everything& e) { e.model.bonds.heads.make(e.corner).first = e.model.bonds.heads.at(e.loner).first; }},
    {"a list of places of constraints has",
     [](Everything& e) { e.model.constraints[e.joint].next[a_origin] = place_count * e.joint + a_origin; }},
    {"ends with", [](Everything& e) { body_of(e, e.corner).last = e.corner; }},
    {"inertia pair 2 is in no list", [](Everything& e) { e.model.bodies[e.rod].first_inertia = none; }},
    {"is not basis point 1 of its body", [](Everything& e) { e.model.particles[e.corner].basis_index = 1; }},
    {"has the attributes of another",
     [](Everything& e) { e.model.particles[e.loner].attributes = first_alive(e.model.attributes); }},
    {"ends of 3 bonds", [](Everything& e) { e.model.bonds.heads.at(e.loner).first = none; }},
    {"ends of 1 closings",
     [](Everything& e) { e.model.closings.heads.at(e.model.closings[first_alive(e.model.closings)].p).first = none; }},
    {"ends of 1 cosmetic bonds", [](Everything& e) { e.model.cosmetic_bonds.heads.at(e.corner).first = none; }},
    {"is implicit without a derivative", [](Everything& e) { e.model.bonds[e.scripted].implicit = 1; }},
    {"has a parameter that is not finite",
     [](Everything& e) { e.model.bonds[e.bond].parameters[0] = std::numeric_limits<double>::infinity(); }},
    // constraints
    {"a list of terms without an end", [](Everything& e) { e.model.coupled_terms[0].next = 0; }},
    {"couples nothing", [](Everything& e) { e.model.constraints[e.joint].first_term = 0; }},
    {"is not listed", [](Everything& e) { e.model.constraints[e.joint].coupled = model::none; }},
    {"refers to no coordinate", [](Everything& e) { e.model.coupled_terms[0].coordinate = JointCoordinate::slide; }},
    {"holds a stranger at place", [](Everything& e) { e.model.constraints[e.joint].particles[a_axis] = e.loner; }},
    {"joins a body to itself",
     [](Everything& e) {
       auto& places = e.model.constraints[e.joint].particles;
       places[b_origin] = places[a_origin];
     }},
    {"lists constraint",
     [](Everything& e) {
       e.model.places.make(e.loner).first = place_count * e.joint + static_cast<std::uint32_t>(a_origin);
     }},
    {"places of constraints",
     [](Everything& e) {
       const std::uint32_t origin = e.model.constraints[e.joint].particles[a_origin];
       e.model.places.at(origin).first = none;
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
    {"is gone, or in two lists", [](Everything& e) { e.model.twins[first_alive(e.model.twins)].next = nowhere; }},
    {"is a stranger", [](Everything& e) { e.model.twins[first_alive(e.model.twins)].particle = e.loner; }},
    {"is in no list",
     [](Everything& e) { e.model.first_twin.erase(e.model.twins[first_alive(e.model.twins)].particle); }},
    {"holds no living body", [](Everything& e) { e.model.grips[e.grip].body = nowhere; }},
    {"refers to a particle of another body", [](Everything& e) { e.model.grips[e.grip].points[0] = e.loner; }},
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

TEST(Validate, names_the_error_of_any_damaged_table) {
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
