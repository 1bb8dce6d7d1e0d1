// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/model.h"

namespace iota::model {

/// What the caller of a structural edit must do next: project positions, velocities.
struct Edit {
  bool moved = false;   ///< points that were apart now share a ring: positions must be projected
  bool jolted = false;  ///< velocities may violate constraints, or mass has moved: they must be projected
};

/// The topology of Tables 4.2 and 4.3: who belongs to which body, ring and articulate, masses, positions and velocities of
/// merged rings. All slots must be alive. Throws std::invalid_argument, before anything changes, for an impossible edit.
Edit combine_particles(Model&, std::uint32_t p, std::uint32_t q, RestructureReport&);
/// Throws where p and q are apart and something that does not give way holds each of them.
void require_can_meet(const Model&, std::uint32_t p, std::uint32_t q);
Edit combine_bodies(Model&, std::uint32_t a, std::uint32_t b, RestructureReport&);
Edit separate_particles(Model&, std::uint32_t p, std::uint32_t q, RestructureReport&);

/// The bodies that a body was combined from, in the order of its particles: ids, also of retired bodies.
std::vector<BodyId> parts_of(const Model&, std::uint32_t body);
/// Makes one part of a body a body of its own again; hinges that combining had made rigid are back.
Edit separate_part(Model&, std::uint32_t body, BodyId part, RestructureReport&);
/// Removes a cosmetic bond. Where that disconnects its body's cosmetic bonds the body falls into two: one with the bond's
/// first end, which stays the body, and one with the second. Particles that hang on neither end go with the nearer one; a solid is
/// one piece.
Edit break_cosmetic_bond(Model&, std::uint32_t bond, RestructureReport&);

/// Destroys a particle and everything that refers to it; also its body if no massive particle is left.
void destroy_particle(Model&, std::uint32_t particle);
void destroy_body(Model&, std::uint32_t body);

/// Destroys markers that the massive particles no longer carry, with everything that refers to them, and notes it.
void destroy_stray_markers(Model&, std::uint32_t body, std::vector<std::string>& notes);

/// The closing of two particles, in either order; `none` without one.
std::uint32_t closing_between(const Model&, std::uint32_t p, std::uint32_t q);
/// Ends a closing before its particles have met. Its articulate may split.
void call_off(Model&, std::uint32_t closing);
/// Ends closings whose two particles share a ring or a body by now: there is nothing left to close, or nothing that could.
/// Says so in the notes.
void end_settled_closings(Model&, std::vector<std::string>& notes);

/// Splits the articulate of `bodies` wherever they no longer hang together.
void split_where_apart(Model&, std::span<const std::uint32_t> bodies);

}  // namespace iota::model
