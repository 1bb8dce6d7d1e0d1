// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstddef>

namespace iota::bindings {

namespace nb = nanobind;

/// A type as Python writes it.
template <std::size_t size>
struct TypeText {
  char characters[size];
  consteval TypeText(const char (&text)[size]) { std::copy_n(text, size, characters); }
};

/// Any object; the stub file declares its type as `text`. Converted by our code instead of nanobind, so that the error
/// names the argument and its value.
template <TypeText text>
struct TypedArgument {
  nb::handle value;

  operator nb::object() const { return nb::borrow(value); }  // NOLINT(google-explicit-constructor)
};

using SpringArgument = TypedArgument<"float | collections.abc.Sequence[float]">;
using ServoArgument = TypedArgument<"tuple[float, float] | tuple[float, float, float]">;
using PlaceArgument = TypedArgument<"Vec3 | collections.abc.Sequence[float]">;
/// See `to_quaternion` and `to_color`.
#define IOTA_ROTATION "collections.abc.Sequence[float] | tuple[str | Vec3 | collections.abc.Sequence[float], float]"
#define IOTA_COLOR "str | int | collections.abc.Sequence[float]"
using QuaternionArgument = TypedArgument<IOTA_ROTATION>;
using ColorArgument = TypedArgument<IOTA_COLOR " | None">;
using PathArgument = TypedArgument<
    "collections.abc.Iterable[Vec3 | collections.abc.Sequence[float]] | "
    "collections.abc.Callable[[float], Vec3 | collections.abc.Sequence[float]]">;
using SurfaceArgument = TypedArgument<"Shape | collections.abc.Callable[[float, float, float], float]">;
using CoordinateArgument = TypedArgument<"JointCoordinate | Constraint">;
using TermsArgument = TypedArgument<"collections.abc.Iterable[tuple[JointCoordinate | Constraint, float]]">;
/// Limits, motor, friction and spring of a coordinate.
using DriveArgument = TypedArgument<"collections.abc.Mapping[str, typing.Any]">;

}  // namespace iota::bindings

namespace nanobind::detail {

template <iota::bindings::TypeText text>
struct type_caster<iota::bindings::TypedArgument<text>> {
  NB_TYPE_CASTER(iota::bindings::TypedArgument<text>, const_name(text.characters))
  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    value.value = source;
    return true;
  }
  static handle from_cpp(const iota::bindings::TypedArgument<text>& source, rv_policy, cleanup_list*) noexcept {
    return source.value.inc_ref();
  }
};

}  // namespace nanobind::detail
