// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"
#include "contact/touches.h"

#include <vector>

namespace iota::contact {

/// The motion of a rigid outline: its center moves along a straight line, and it turns about this at a constant rate.
struct Motion {
  Vec3 center, velocity, spin;  ///< m, m/s, rad/s
  double reach = 0;             ///< all of the outline is at most so far from its center, m
  double more = 0;              ///< a bound of what else its places may go, m/s
  double at = 0;                ///< when the center and the outline are where they are, s
};

/// Looks ahead along the ways of two outlines.
class ApproachFinder {
 public:
  explicit ApproachFinder(TouchFinder& touches) : touches_(touches) {}

  /// The time until the gap of two outlines is at most `close`, m: 0 if it is now, infinity if not before `latest`, s. By
  /// conservative advancement (B. Mirtich, Impulse-based dynamic simulation, 1996): a little early, never late. A pair whose
  /// approach is too slow to be decided gets the time up to which it is decided.
  double time(const Outline& first, const Motion&, const Outline& second, const Motion&, double close, double latest);
  /// The touches that the last call of `time` found at the time that it returned, relative to the center of the second
  /// outline in `Motion`.
  const std::vector<Touch>& met() const { return found_; }

 private:
  TouchFinder& touches_;
  Outline moved_[2];  // scratch
  std::vector<Touch> found_;
};

}  // namespace iota::contact
