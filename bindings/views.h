// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

/// The view of a system that an id belongs to, for code that is written once for several kinds of ids.
namespace iota::bindings {

inline Bodies view_of(System& system, BodyId) { return system.bodies(); }
inline Particles view_of(System& system, ParticleId) { return system.particles(); }
inline Bonds view_of(System& system, BondId) { return system.bonds(); }
inline CosmeticBonds view_of(System& system, CosmeticBondId) { return system.cosmetic_bonds(); }
inline AngleSprings view_of(System& system, AngleSpringId) { return system.angle_springs(); }
inline Joints view_of(System& system, ConstraintId) { return system.joints(); }
inline Laws view_of(System& system, LawId) { return system.laws(); }
inline Fields view_of(System& system, FieldId) { return system.fields(); }
inline Pairs view_of(System& system, PairsId) { return system.pairs(); }
inline Groups view_of(System& system, GroupId) { return system.groups(); }
inline Grips view_of(System& system, GripId) { return system.grips(); }
inline Emitters view_of(System& system, EmitterId) { return system.emitters(); }

}  // namespace iota::bindings
