// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/text.h"

#include <iota/vec3.h>

namespace iota {

inline std::string text_of(const Vec3& v) { return text("(", v.x, ", ", v.y, ", ", v.z, ")"); }

}  // namespace iota
