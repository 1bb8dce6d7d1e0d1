// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/mat3.h"

namespace iota::shape {

/// phi and its derivatives at a point, in the shape's frame.
struct Level {
  double value = 0;  ///< m
  Vec3 gradient;
  Mat3 hessian;
};

}  // namespace iota::shape
