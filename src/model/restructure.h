// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

namespace iota::model {

/// What the caller of a structural edit must do next: project positions, velocities.
struct Edit {
  bool moved = false;           ///< points that were apart now share a ring: positions must be projected
  bool velocity_dirty = false;  ///< velocities may violate constraints, or mass has moved: they must be projected
};

/// The topology of Tables 4.2 and 4.3: who belongs to which body, ring and articulate, masses, positions and velocities of
/// merged rings. All slots must be alive. Throws std::invalid_argument, before anything changes, for an impossible edit.
Edit combine_particles(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);
/// Throws where p and q are apart and something that does not give way holds each of them.
void require_can_meet(const Structure&, std::uint32_t p, std::uint32_t q);
Edit combine_bodies(Structure&, std::uint32_t a, std::uint32_t b, RestructureReport&);
Edit separate_particles(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);

/// The bodies that a body was combined from, in the order of its particles: ids, also of retired bodies.
std::vector<BodyId> parts_of(const Structure&, std::uint32_t body);
/// Makes one part of a body a body of its own again; hinges that combining had made rigid are back.
Edit separate_part(Structure&, std::uint32_t body, BodyId part, RestructureReport&);
/// Splits a body where p and q hang together by nothing any more: neither by companions (Structure::visit_companions), nor
/// by a solid, which is one piece. The body keeps the piece with p. Particles that hang on neither go with the nearer one.
Edit fall_apart(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);

/// Hangs particles that a body has got on the basis that it has, where that spans their places well: a large body that
/// grows bit by bit needs another basis once in a while only. False where it must be rebuilt; nothing has changed then.
/// `before`: how many particles it had.
bool carry_by_basis(Structure&, std::uint32_t body, std::uint32_t before, std::span<const std::uint32_t> particles);
/// The same for a body that has lost particles: false where a basis point is among them.
bool keeps_basis(const Structure&, std::uint32_t body);

/// Destroys a particle and everything that refers to it; also its body if no massive particle is left.
void destroy_particle(Structure&, std::uint32_t particle);
void destroy_body(Structure&, std::uint32_t body);

/// Destroys markers that the massive particles no longer carry, with everything that refers to them, and notes it.
void destroy_stray_markers(Structure&, std::uint32_t body, std::vector<std::string>& notes);

/// Splits the articulate of `bodies` wherever they no longer hang together.
void split_where_apart(Structure&, std::span<const std::uint32_t> bodies);

}  // namespace iota::model
