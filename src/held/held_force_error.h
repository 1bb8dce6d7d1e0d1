// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/model.h"
#include "math/mat3.h"

#include <cstdint>
#include <vector>

namespace iota::held {

/// The error of mode accurate by forces that are held over a step, which its sub-steps do not see. A force with the second
/// derivative f'' has a mean that differs by h^2 f''/24 from that in the middle of the step; f'' is found from the last three
/// steps. In a second such an acceleration moves a point by half of it, and its motion carries that on: the figure of eight of
/// three bodies was 1.4 times as far off, so the estimate is twice that. And a mean force leaves a point that has the right
/// velocity h^3 f'/12m from its place in each step: of a particle that fell with a drag of 0.05/s this was 40 times the rest.
class HeldForceError {
 public:
  void forget() { known_ = 0; }
  /// Before held forces are added to the pushes, and after: the estimate, in lengths of the links (of 1 m for single
  /// particles) per second of simulated time. 0 in other modes, and until three steps of one length are known.
  void begin(const model::Model&);
  double estimate(const model::Model&, double h);

 private:
  struct Held {
    Vec3 force;  ///< N
    Mat3 rate;   ///< of the part that is linear in the velocity, N s/m
  };
  // By slot of the ring.
  std::vector<Vec3> applied_, change_before_;  // N
  std::vector<Held> now_, last_;
  int known_ = 0;  // steps
  double h_ = 0;
  std::uint64_t structure_ = 0;
};

}  // namespace iota::held
