// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/structure.h"

namespace iota::model {

/// The next steps for the caller of a structural edit: to project positions, velocities.
struct Edit {
  bool moved = false;           ///< points that were apart now share a ring: positions must be projected
  bool velocity_dirty = false;  ///< velocities may violate constraints, or mass has moved: they must be projected
};

/// The topology of Tables 4.2 and 4.3: memberships in bodies, rings and articulates, masses, positions and velocities
/// of merged rings. All slots must be alive. Throws std::invalid_argument, before any change, for an impossible edit.
Edit combine_particles(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);
/// Throws if p and q are apart and both are fixed.
void require_can_meet(const Structure&, std::uint32_t p, std::uint32_t q);
Edit combine_bodies(Structure&, std::uint32_t a, std::uint32_t b, RestructureReport&);
Edit separate_particles(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);

/// The parts of a body, in the order of its particles: ids, also of retired bodies.
std::vector<BodyId> parts_of(const Structure&, std::uint32_t body);
/// Makes a part of a body a separate body again; restores hinges that combining had made rigid.
Edit separate_part(Structure&, std::uint32_t body, BodyId part, RestructureReport&);
/// Splits a body if p and q are no longer connected, neither by companions (Structure::visit_companions), nor by a
/// solid, which is one piece. The body keeps the piece with p. Particles connected to neither go with the nearer one.
Edit fall_apart(Structure&, std::uint32_t p, std::uint32_t q, RestructureReport&);

/// Gives new particles of a body weights in its present basis, if that spans their places well: a large body that grows in small
/// parts rarely needs another basis. False, without a change, if the basis must be rebuilt. `before`: its former number
/// of particles.
bool carry_by_basis(Structure&, std::uint32_t body, std::uint32_t before, std::span<const std::uint32_t> particles);
/// The same for a body that has lost particles: false if a basis point is among them.
bool keeps_basis(const Structure&, std::uint32_t body);

/// Destroys a particle and everything that refers to it; also its body if no massive particle remains.
void destroy_particle(Structure&, std::uint32_t particle);
void destroy_body(Structure&, std::uint32_t body);

/// Destroys markers outside of the span of the massive particles, with everything that refers to them, and notes it.
void destroy_stray_markers(Structure&, std::uint32_t body, std::vector<std::string>& notes);

/// Splits the articulate of `bodies` into its connected components.
void split_where_apart(Structure&, std::span<const std::uint32_t> bodies);

}  // namespace iota::model
