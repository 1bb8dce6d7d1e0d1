// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/kinds.h>
#include <iota/vec3.h>

namespace iota {

/// Articulates tied by bonds and constraints fall asleep together when no particle of them has been faster than `speed`
/// for `after` seconds: they are then `resting`, do not move, and are not solved. An edit, an assigned velocity, a
/// grip, an applied force (that of a scripted bond too), a moving nail or another gravity wakes them.
struct RestOptions {
  double after = 0;     ///< s; 0: never
  double speed = 0.01;  ///< m/s
};

/// A limit of the work of a step, for worlds that must keep their pace. An island whose budget ends before its solution
/// takes the last resort (docs/solver.md): its points move on and stay together as well as possible; the next step closes
/// the gaps. StepReport::cut_short counts such islands, and `islands` names them.
struct StepBudget {
  int iterations = 0;  ///< of Newton's method, of each island: repeatable; 0: unlimited
  double seconds = 0;  ///< of real time, of the whole step: not repeatable; 0: unlimited. Looked at between solves
  /// Multiplications that a step may take to solve the contacts of bodies that nothing else connects all together, and
  /// so exactly; islands share them by their sizes; 0: unlimited. A heap that would take more is solved approximately,
  /// contact by contact, in time that is linear in its size: StepReport::approximate counts such islands. Repeatable.
  double contacts = 3e7;
  double contacts_share = 1;  ///< above 0 to 1, of `contacts`: what a world that has to keep its pace lets steps take
};

struct SystemOptions {
  Vec3 gravity{0, -9.81, 0};  ///< m/s^2
  IntegrationMode mode = IntegrationMode::energy_keeping;
  double damping = 0;  ///< 1/s, all bodies: velocities fall by exp(-damping t)
  int threads = 0;     ///< used by a step, 0: one per core. Results are the same bits for any number
  RestOptions rest;
  double tolerance = 1e-4;  ///< see System::tolerance
  StepBudget budget;
};

}  // namespace iota
