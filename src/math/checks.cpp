// SPDX-License-Identifier: Apache-2.0
#include "math/checks.h"

namespace iota {

namespace {

[[noreturn]] void refuse_text(std::string_view name, std::string_view condition, std::string_view value) {
  throw std::invalid_argument(text(name, " must ", condition, ", got ", value));
}

}  // namespace

void refuse(std::string_view name, std::string_view condition, double value) {
  refuse_text(name, condition, text(value));
}

void refuse(std::string_view name, std::string_view condition, const Vec3& value) {
  refuse_text(name, condition, text_of(value));
}

void refuse(std::string_view name, std::string_view condition, const Quaternion& value) {
  refuse_text(name, condition, text("(", value.x, ", ", value.y, ", ", value.z, ", ", value.w, ")"));
}

}  // namespace iota
