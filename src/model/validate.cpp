// SPDX-License-Identifier: Apache-2.0
#include "model/model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

namespace iota::model {

namespace {

class Complaints {
 public:
  template <class... Parts>
  void require(bool condition, const Parts&... parts) {
    if (condition) return;
    std::ostringstream text;
    (text << ... << parts);
    list.push_back(text.str());
  }
  std::vector<std::string> list;
};

}  // namespace

// Independent of how edits keep the structure: everything is counted again from the particles.
std::vector<std::string> Model::validate() const {
  Complaints complaints;
  std::vector<std::uint32_t> in_body(bodies.slot_count(), 0), in_ring(rings.slot_count(), 0),
      in_articulate(articulates.slot_count(), 0), uses(particles.slot_count(), 0);

  particles.for_each([&](std::uint32_t slot, const Particle& p) {
    const bool linked = bodies.is_alive(p.body) && rings.is_alive(p.ring);
    complaints.require(linked, "particle ", slot, " is in no living body or ring");
    complaints.require(p.mass >= 0 && std::isfinite(p.mass), "particle ", slot, " has mass ", p.mass);
    if (!linked) return;
    complaints.require(!p.is_marker() || (p.basis_index < 0 && bodies[p.body].rank > 0), "marker ", slot,
                       " is in its body's basis, or alone in it");
    ++in_body[p.body], ++in_ring[p.ring];
    double weight_sum = 0;
    for (const double w : weights(slot)) weight_sum += w;
    complaints.require((p.basis_index < 0) == ties.has(slot), "particle ", slot,
                       " is in a basis and tied to it, or neither");
    complaints.require(std::abs(weight_sum - 1) < 1e-9, "particle ", slot, " has basis weights that sum to ",
                       weight_sum);
  });

  rings.for_each([&](std::uint32_t slot, const Ring& r) {
    std::uint32_t walked = 0;
    std::vector<std::uint32_t> owners;
    for_each_in_ring(slot, [&](std::uint32_t p) {
      ++walked;
      complaints.require(particles.is_alive(p) && particles[p].ring == slot, "ring ", slot, " lists stranger ", p);
      owners.push_back(particles[p].body);
    });
    complaints.require(walked == r.count && walked == in_ring[slot] && walked > 0, "ring ", slot, " counts ", r.count,
                       " particles, lists ", walked, ", has ", in_ring[slot]);
    std::sort(owners.begin(), owners.end());
    complaints.require(std::adjacent_find(owners.begin(), owners.end()) == owners.end(), "ring ", slot,
                       " holds two particles of one body");
    complaints.require(is_finite(r.position) && is_finite(r.velocity), "ring ", slot, " is not finite");
  });

  const auto require_owners = [&](const char* what, const auto& values, const auto& owners) {
    values.for_each([&](std::uint32_t slot, const auto&) {
      complaints.require(owners.is_alive(slot), what, " of ", slot, ", which does not live");
    });
  };
  require_owners("a tie", ties, particles), require_owners("lists", references, particles);
  require_owners("a fuse", fuses, particles), require_owners("rows", more_rows, bodies);
  require_owners("a spin", spins, bodies);
  spins.for_each([&](std::uint32_t slot, const RodSpin& spin) {
    complaints.require(!bodies.is_alive(slot) || axial_inertia(slot) > 0, "body ", slot, " spins, but is no rod");
    complaints.require(std::isfinite(spin.momentum) && std::isfinite(spin.angle), "the spin of ", slot,
                       " is not finite");
  });
  require_owners("a nail", nails, rings), require_owners("a push", pushes, rings);
  rings.for_each([&](std::uint32_t slot, const Ring& r) {
    complaints.require(!r.nailed || nails.has(slot), "ring ", slot, " is nailed nowhere");
  });

  std::uint32_t listed_solids = 0;
  bodies.for_each([&](std::uint32_t slot, const Body& b) {
    std::uint32_t walked = 0;
    for_each_particle_of(slot, [&](std::uint32_t p) {
      ++walked;
      complaints.require(particles.is_alive(p) && particles[p].body == slot, "body ", slot, " lists stranger ", p);
    });
    complaints.require(walked == b.count && walked == in_body[slot], "body ", slot, " counts ", b.count,
                       " particles, lists ", walked, ", has ", in_body[slot]);
    complaints.require(articulates.is_alive(b.articulate), "body ", slot, " is in no living articulate");
    if (articulates.is_alive(b.articulate)) ++in_articulate[b.articulate];
    complaints.require(b.row_count == b.rank * (b.rank - 1) / 2 || b.count == 0, "body ", slot, " has ",
                       int(b.row_count), " rows at rank ", int(b.rank));
    complaints.require((b.row_count > 1) == more_rows.has(slot), "body ", slot, " with ", int(b.row_count),
                       " rows has a wrong table of them");
    for (int i = 0; i < b.rank; ++i)
      complaints.require(particles.is_alive(b.basis[i]) && particles[b.basis[i]].body == slot &&
                             particles[b.basis[i]].basis_index == i,
                         "body ", slot, " has a wrong basis point ", i);
    for_each_solid_of(slot, [&](std::uint32_t s) {
      ++listed_solids;
      complaints.require(solids.is_alive(s) && solids[s].body == slot, "solid ", s, " is not of body ", slot);
      for (const std::uint32_t p : solids[s].points)
        complaints.require(particles.is_alive(p) && particles[p].body == slot, "solid ", s, " stands on stranger ", p);
    });
    for_each_inertia_of(slot, [&](std::uint32_t i) {
      const InertiaPair& pair = inertia_pairs[i];
      complaints.require(inertia_pairs.is_alive(i) && pair.body == slot && particles[pair.p].body == slot &&
                             particles[pair.q].body == slot,
                         "inertia pair ", i, " is not of body ", slot);
    });
  });

  complaints.require(listed_solids == solids.size(), "bodies list ", listed_solids, " solids of ", solids.size());

  // Articulates are exactly the components of the hinge graph (closings count as hinges).
  std::vector<std::uint32_t> parent(bodies.slot_count());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t b) {
    while (parent[b] != b) b = parent[b] = parent[parent[b]];
    return b;
  };
  rings.for_each([&](std::uint32_t, const Ring& r) {
    if (r.first == none) return;
    for (std::uint32_t p = particles[r.first].next_in_ring; p != none; p = particles[p].next_in_ring)
      parent[root(particles[p].body)] = root(particles[r.first].body);
  });
  closings.for_each([&](std::uint32_t, const Closing& c) {
    parent[root(particles[c.p].body)] = root(particles[c.q].body);
    ++uses[c.p], ++uses[c.q];
    complaints.require(particles[c.p].ring != particles[c.q].ring && particles[c.p].body != particles[c.q].body,
                       "a closing of particles ", c.p, " and ", c.q, " has nothing to close");
  });
  std::vector<std::uint32_t> articulate_of_root(bodies.slot_count(), none), roots_of(articulates.slot_count(), 0);
  bodies.for_each([&](std::uint32_t slot, const Body& b) {
    const std::uint32_t r = root(slot);
    if (articulate_of_root[r] == none) articulate_of_root[r] = b.articulate, ++roots_of[b.articulate];
    complaints.require(articulate_of_root[r] == b.articulate, "bodies ", r, " and ", slot,
                       " hang together but are in articulates ", articulate_of_root[r], " and ", b.articulate);
  });
  articulates.for_each([&](std::uint32_t slot, const Articulate& a) {
    std::uint32_t walked = 0;
    for_each_body_of(slot, [&](std::uint32_t b) {
      ++walked;
      complaints.require(bodies.is_alive(b) && bodies[b].articulate == slot, "articulate ", slot, " lists stranger ",
                         b);
    });
    complaints.require(walked == a.count && walked == in_articulate[slot] && walked > 0, "articulate ", slot,
                       " counts ", a.count, " bodies, lists ", walked, ", has ", in_articulate[slot]);
    complaints.require(roots_of[slot] == 1, "articulate ", slot, " holds ", roots_of[slot], " separate pieces");
  });

  const auto require_ends = [&](const char* what, std::uint32_t slot, std::uint32_t p, std::uint32_t q) {
    complaints.require(particles.is_alive(p) && particles.is_alive(q) && p != q, what, " ", slot, " joins ", p, " and ",
                       q);
  };
  std::vector<std::uint32_t> emitted(emitters.slot_count(), 0);
  attributes.for_each([&](std::uint32_t slot, const Attributes& a) {
    complaints.require(particles.is_alive(a.particle) && particles[a.particle].attributes == slot, "attributes ", slot,
                       " are of no living particle");
    if (a.emitter != none && emitters.is_alive(a.emitter)) ++emitted[a.emitter];
    complaints.require(a.emitter == none || emitters.is_alive(a.emitter), "attributes ", slot, " are of no emitter");
  });
  emitters.for_each([&](std::uint32_t slot, const Emitter& e) {
    complaints.require(e.alive == emitted[slot], "emitter ", slot, " counts ", e.alive, " particles, has ",
                       emitted[slot]);
  });
  twins.for_each([&](std::uint32_t slot, const Twin& t) {
    complaints.require(particles.is_alive(t.particle) && t.mass >= 0, "twin ", slot, " is of no living particle");
  });
  bonds.for_each([&](std::uint32_t slot, const Bond& b) {
    require_ends("bond", slot, b.p, b.q);
    ++uses[b.p], ++uses[b.q];
  });
  cosmetic_bonds.for_each(
      [&](std::uint32_t slot, const CosmeticBond& b) { require_ends("cosmetic bond", slot, b.p, b.q); });
  // Every end is in the list of its particle, and in no other.
  const auto require_listed = [&](const char* what, const auto& items, std::uint32_t References::* first) {
    std::uint32_t listed = 0;
    references.for_each([&](std::uint32_t slot, const References& of) {
      for (std::uint32_t link = of.*first; link != none; link = items[link / 2].next[link % 2]) {
        const bool good = items.is_alive(link / 2) && (link % 2 ? items[link / 2].q : items[link / 2].p) == slot;
        complaints.require(good, "particle ", slot, " lists ", what, " ", link / 2, ", which does not end there");
        if (!good || ++listed > 2 * items.size()) return;
      }
    });
    complaints.require(listed == 2 * items.size(), "the particles list ", listed, " ends of ", items.size(), " ", what,
                       "s");
  };
  require_listed("bond", bonds, &References::first_bond);
  require_listed("closing", closings, &References::first_closing);
  require_listed("cosmetic bond", cosmetic_bonds, &References::first_cosmetic_bond);
  std::uint32_t constraint_ends = 0;
  constraints.for_each([&](std::uint32_t slot, const Constraint& c) {
    for (int place = 0; place < place_count; ++place) {
      const std::uint32_t p = c.particles[place];
      if (p == none) continue;
      complaints.require(particles.is_alive(p) && particles[p].body == body_of_side(*this, c, place >= b_origin),
                         info(c.kind).name, " ", slot, " holds a stranger at place ", place);
      ++constraint_ends;
    }
    complaints.require(body_of_side(*this, c, 0) != body_of_side(*this, c, 1), info(c.kind).name, " ", slot,
                       " joins a body to itself");
  });
  std::uint32_t constraint_ends_listed = 0;
  particles.for_each([&](std::uint32_t slot, const Particle& p) {
    for (std::uint32_t link = references[slot].first_constraint; link != none;
         link = constraints[link / place_count].next[link % place_count]) {
      const bool good = constraints.is_alive(link / place_count) &&
                        constraints[link / place_count].particles[link % place_count] == slot;
      complaints.require(good, "particle ", slot, " lists constraint ", link / place_count, ", which is not there");
      if (!good || ++constraint_ends_listed > constraint_ends) break;
    }
    complaints.require(p.uses == uses[slot], "particle ", slot, " counts ", p.uses, " uses, has ", uses[slot]);
  });
  complaints.require(constraint_ends_listed == constraint_ends, "the particles list ", constraint_ends_listed, " of ",
                     constraint_ends, " places of constraints");
  std::vector<std::uint32_t> law_uses(laws.slot_count(), 0);
  const auto require_law = [&](const char* what, std::uint32_t slot, std::uint32_t law) {
    complaints.require(laws.is_alive(law), what, " ", slot, " has no living law");
    if (laws.is_alive(law)) ++law_uses[law];
  };
  const auto require_group = [&](const char* what, std::uint32_t slot, std::uint32_t group) {
    complaints.require(group == none || groups.is_alive(group), what, " ", slot, " acts on no living group");
  };
  bonds.for_each([&](std::uint32_t slot, const Bond& b) {
    require_law("bond", slot, b.law);
    if (laws.is_alive(b.law))
      complaints.require(!b.implicit || laws[b.law].has_derivative(), "bond ", slot,
                         " is implicit without a derivative");
    for (const double v : b.parameters)
      complaints.require(std::isfinite(v), "bond ", slot, " has a parameter that is not finite");
  });
  pairs.for_each([&](std::uint32_t slot, const Pairs& p) {
    require_law("pairwise force", slot, p.law);
    require_group("pairwise force", slot, p.group);
    complaints.require(p.cutoff > 0 && std::isfinite(p.cutoff), "pairwise force ", slot, " has cut-off ", p.cutoff);
  });
  fields.for_each([&](std::uint32_t slot, const Field& f) { require_group("field", slot, f.group); });
  laws.for_each([&](std::uint32_t slot, const Law& l) {
    complaints.require(l.uses == law_uses[slot], "law ", slot, " counts ", l.uses, " uses, has ", law_uses[slot]);
  });
  std::uint32_t living_groups = 0;
  groups.for_each([&](std::uint32_t slot, const Group&) { living_groups |= 1u << slot; });
  particles.for_each([&](std::uint32_t slot, const Particle& p) {
    complaints.require((p.groups & ~living_groups) == 0, "particle ", slot, " is in a group that is gone");
  });
  grips.for_each([&](std::uint32_t slot, const Grip& g) {
    complaints.require(bodies.is_alive(g.body), "grip ", slot, " holds no living body");
    for (std::uint32_t i = 0; i < g.count; ++i)
      complaints.require(particles.is_alive(g.points[i]) && particles[g.points[i]].body == g.body, "grip ", slot,
                         " hangs on a stranger");
  });
  return complaints.list;
}

}  // namespace iota::model
