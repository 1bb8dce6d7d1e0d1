// SPDX-License-Identifier: Apache-2.0
// The commands of recordings of letter A, of November 2026. Never changes.
#pragma once

#include <string_view>

namespace iota::edit {

inline constexpr std::string_view letter_a_commands = R"(Step f8
SetGravity f8f8f8
SetMode u1
SetSolver [i1]
SetDamping f8
SetRest f8f8
CreateBody u1f8
CreateSolid <f8|f8f8f8f8|f8f8f8|f8f8|f8f8f8|[f8f8f8][u4u4u4]|f8f8f8|f8f8f8|f8f8>f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8[f8f8f8]u1f8
CreateAttachment u4u4f8f8f8
SetRod u4u4f8f8
SetKind u4u4u1
SetBodyDamping u4u4f8
SetPose u4u4f8f8f8f8f8f8f8
SetBodyVelocity u4u4f8f8f8
SetAngularVelocity u4u4f8f8f8
Destroy<body> u4u4
CreateParticle u4u4f8f8f8f8f8f8f8
SetPosition u4u4f8f8f8
SetVelocity u4u4f8f8f8
SetMass u4u4f8
ApplyForce u4u4f8f8f8
SetParticleActive u4u4u1
SetParticleBreakForce u4u4f8
Destroy<particle> u4u4
SetAttributes u4u4f8f8f8f4f4f4f4
SetOrientation u4u4f8f8f8f8
SetSpin u4u4f8f8f8
ApplyTorque u4u4f8f8f8
SetMoment u4u4f8
SetSpinDamping u4u4f8
Align u4u4f8f8f8f8f8
CreateEmitter f8<f8|f8f8f8f8|f8f8f8|f8f8|f8f8f8|[f8f8f8][u4u4u4]|f8f8f8|f8f8f8|f8f8>f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8u4[f8f8f4f4f4f4]u8
SetEmitterActive u4u4u1
SetRate u4u4f8
MoveEmitter u4u4f8f8f8f8f8f8f8
Destroy<emitter> u4u4
CombineParticles u4u4u4u4f8
CombineBodies u4u4u4u4
Separate u4u4u4u4
SeparatePart u4u4u4u4
CreateCosmeticBond u4u4u4u4
Destroy<cosmeticbond> u4u4
Nail u4u4u1f8f8f8
Release u4u4
CreateGrip u4u4f8f8f8f8f8f8u4u4f8f8
MoveGrip u4u4f8f8f8
Destroy<grip> u4u4
CreateJoint u1u4u4u4u4f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8f8
CreateDistance u1u4u4u4u4f8f8f8
CreatePath u4u4u4u4u1[f8f8f8]u1f8f8f8f8f8f8f8f8f8f8f8f8f8f8
CreateSurface u1u4u4u4u4u4u4f8f8f8f8u8u8f8f8f8f8f8f8f8f8f8
CreateSurfacePair u1u4u4u4u4u4u4f8f8f8f8u8u8f8f8f8f8f8f8f8u4u4f8f8f8f8u8u8f8f8f8f8f8f8f8f8f8
SetConstraintActive u4u4u1
SetCoordinate u4u4u1f8f8f8f8f8f8f8f8f8f8f8
SetLength u4u4f8
SetBreakLimits u4u4f8f8
Destroy<constraint> u4u4
CreateLaw u4[i1][i1][[i1]f8]u8
Destroy<law> u4u4
CreateBond u4u4u4u4u4u4u1u8f8f8f8f8f8f8f8f8
SetBondParameter u4u4u4f8
SetBondActive u4u4u1
SetBondBreakForce u4u4f8
Destroy<bond> u4u4
CreateGroup [i1]
SetMember u4u4u4u4u1
Destroy<group> u4u4
CreateField [i1][i1][[i1]f8]u4u4u1u8
SetFieldParameter u4u4u4f8
SetFieldActive u4u4u1
Destroy<field> u4u4
CreatePairs u4u4u4u4u4u4u1f8f8f8f8f8f8f8f8f8
SetPairsParameter u4u4u4f8
SetPairsActive u4u4u1
Destroy<pairwiseforce> u4u4
BeginEdit 
EndEdit 
CancelEdit 
Undo 
Redo 
SetBodyName u4u4[i1]
SetBodyMass u4u4f8
ApplyBodyForce u4u4f8f8f8u1f8f8f8
ApplyBodyTorque u4u4f8f8f8
SetCoordinateValue u4u4u1f8
CreatePoints [f8f8f8][f8f8f8][f8]u1f8
CreateRods [f8f8f8][f8f8f8][f8][f8]u1f8
CreateBonds [u4u4][u4u4]u4u4u1[f8f8f8f8f8f8f8f8]
CombineMany [u4u4][u4u4]
AssignParticles u1[u4u4][f8]
AssignBodies u1[u4u4][f8]
AssignBonds [u4][u4u4][f8]
CreateSpan u4u4u4u4f8f8f8f8f8f8f8f8f8f8f8f8f8
CreateCoupling u1[u4u4u1f8]f8f8f8
CreateTackle [u4u4]f8f8f8
SetCompliance u4u4f8f8f8
SetTolerance f8
SetBudget i4f8f8
SetRadius u4u4f8
SetUsualRadius f8
SetMaterial u4u4u1f8u8f8f8f8f8f8
SetUsualMaterial u1f8u8f8f8f8f8f8
CreateObstacle <f8|f8f8f8f8|f8f8f8|f8f8|f8f8f8|[f8f8f8][u4u4u4]|f8f8f8|f8f8f8|f8f8>f8f8f8f8f8f8f8
TakeSnapshot 
SetColor u4u4u1u4
CreateAngleSpring u4u4u4u4u4u4f8f8f8
SetAngleSpring u4u4f8f8f8
Destroy<anglespring> u4u4
IgnoreContacts u4u4u4u4u4u4u4u4u1
SetStride u4u4u4u1
)";

}  // namespace iota::edit
