// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/attributes.h>
#include <iota/vec3.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstdint>
#include <optional>

namespace iota::bindings {

namespace nb = nanobind;

/// Any object passed as a vector. Converted by `to_vec3` instead of nanobind, so that the error names the argument and
/// its value.
struct VectorArgument {
  nb::handle value;
};

/// A `Vec3`, or any sequence or array of 2 or 3 numbers (default z: 0). False for anything else.
bool try_vec3(nb::handle value, Vec3& out);

/// As `try_vec3`; TypeError if it is not a vector, ValueError if it is not finite. The text contains `name`.
Vec3 to_vec3(VectorArgument argument, const char* name);

/// A unit quaternion from any 4 numbers x y z w that are not zero, or from an axis and an angle in degrees: ('z', 30) or
/// ((1, 1, 0), 30). TypeError or ValueError for other values.
Quaternion to_quaternion(nb::handle value, const char* name);

/// Red, green, blue and opacity, each from 0 to 1, of anything that `iota.colors.rgba` takes; its errors.
Color to_color(nb::handle value);
/// The same as 0xRRGGBB; None: none. ValueError for a color that is seen through.
std::optional<std::uint32_t> to_opaque_color(nb::handle value);

/// `value` in short, for error texts.
std::string describe(nb::handle value);
std::string describe(const Vec3& value);

double finite(double value, const char* name);
double finite_positive(double value, const char* name, const char* unit);
double finite_not_negative(double value, const char* name, const char* unit);

}  // namespace iota::bindings

namespace nanobind::detail {

template <>
struct type_caster<iota::bindings::VectorArgument> {
  NB_TYPE_CASTER(iota::bindings::VectorArgument,
                 const_name("Vec3 | collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.float64]"))
  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    value.value = source;
    return !source.is_none();
  }
  static handle from_cpp(const iota::bindings::VectorArgument& source, rv_policy, cleanup_list*) noexcept {
    return source.value.inc_ref();
  }
};

}  // namespace nanobind::detail
