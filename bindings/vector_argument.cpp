// SPDX-License-Identifier: Apache-2.0
#include "vector_argument.h"

#include <nanobind/stl/array.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

namespace iota::bindings {

namespace {

bool try_number(PyObject* object, double& out) {
  if (PyFloat_Check(object)) {
    out = PyFloat_AS_DOUBLE(object);
    return true;
  }
  if (PyUnicode_Check(object) || PyBytes_Check(object)) return false;
  out = PyFloat_AsDouble(object);
  if (out != -1.0 || !PyErr_Occurred()) return true;
  PyErr_Clear();
  return false;
}

[[noreturn]] void raise_value(const std::string& text) { throw nb::value_error(text.c_str()); }

std::string number_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

}  // namespace

bool try_vec3(nb::handle value, Vec3& out) {
  Vec3* vector = nullptr;
  if (nb::try_cast<Vec3*>(value, vector) && vector) {
    out = *vector;
    return true;
  }
  PyObject* object = value.ptr();
  // A set is refused, as it has no order.
  if (PyUnicode_Check(object) || PyBytes_Check(object) || !PySequence_Check(object)) return false;
  nb::object items = nb::steal(PySequence_Fast(object, ""));
  if (!items.is_valid()) {
    PyErr_Clear();
    return false;
  }
  const Py_ssize_t size = PySequence_Fast_GET_SIZE(items.ptr());
  if (size != 2 && size != 3) return false;
  out = {};
  return try_number(PySequence_Fast_GET_ITEM(items.ptr(), 0), out.x) &&
         try_number(PySequence_Fast_GET_ITEM(items.ptr(), 1), out.y) &&
         (size == 2 || try_number(PySequence_Fast_GET_ITEM(items.ptr(), 2), out.z));
}

Vec3 to_vec3(VectorArgument argument, const char* name) {
  Vec3 vector;
  if (!try_vec3(argument.value, vector)) {
    const std::string example = std::string(name) == "gravity" ? ", as in (0, -9.81, 0)" : "";
    const std::string text =
        std::string(name) + " must be 2 or 3 numbers" + example + ", not " + describe(argument.value);
    throw nb::type_error(text.c_str());
  }
  if (!is_finite(vector)) raise_value(std::string(name) + " must be finite, not " + describe(vector));
  return vector;
}

namespace {

/// The items of a sequence of this many; null for any other object.
nb::object items_of(nb::handle value, Py_ssize_t count) {
  if (!PySequence_Check(value.ptr()) || PyUnicode_Check(value.ptr())) return {};
  nb::object items = nb::steal(PySequence_Fast(value.ptr(), ""));
  if (!items.is_valid()) PyErr_Clear();
  return items.is_valid() && PySequence_Fast_GET_SIZE(items.ptr()) == count ? items : nb::object();
}

/// An axis of the world by its letter, or a direction.
bool try_axis(nb::handle value, Vec3& axis) {
  if (!PyUnicode_Check(value.ptr())) return try_vec3(value, axis);
  const std::string letter = nb::cast<std::string>(value);
  axis = {letter == "x" ? 1.0 : 0.0, letter == "y" ? 1.0 : 0.0, letter == "z" ? 1.0 : 0.0};
  return dot(axis, axis) > 0;
}

bool try_rotation(nb::handle value, double (&q)[4]) {
  if (const nb::object items = items_of(value, 4); items.is_valid()) {
    for (Py_ssize_t i = 0; i < 4; ++i)
      if (!try_number(PySequence_Fast_GET_ITEM(items.ptr(), i), q[i])) return false;
    return true;
  }
  const nb::object items = items_of(value, 2);
  Vec3 axis;
  double degrees = 0;
  if (!items.is_valid() || !try_axis(PySequence_Fast_GET_ITEM(items.ptr(), 0), axis) ||
      !try_number(PySequence_Fast_GET_ITEM(items.ptr(), 1), degrees))
    return false;
  const double length = norm(axis), half = degrees * std::numbers::pi / 360;
  const double sine = length > 0 ? std::sin(half) / length : std::numeric_limits<double>::quiet_NaN();
  q[0] = sine * axis.x, q[1] = sine * axis.y, q[2] = sine * axis.z, q[3] = std::cos(half);
  return true;
}

}  // namespace

Quaternion to_quaternion(nb::handle value, const char* name) {
  double v[4] = {};
  if (!try_rotation(value, v)) {
    const std::string text = std::string(name) +
                             " must be an axis and an angle in degrees, as in ('z', 30) or ((1, 1, 0), 30), or 4 "
                             "numbers x y z w of a quaternion, not " +
                             describe(value);
    throw nb::type_error(text.c_str());
  }
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
  if (!(length > 1e-6) || !std::isfinite(length))
    raise_value(std::string(name) + " must be finite and not zero, not " + describe(value));
  return {v[0] / length, v[1] / length, v[2] / length, v[3] / length};
}

std::string describe(nb::handle value) {
  std::string text = nb::repr(value).c_str();
  if (text.size() > 80) text = text.substr(0, 77) + "...";
  return text;
}

std::string describe(const Vec3& value) {
  char text[96];
  std::snprintf(text, sizeof text, "(%g, %g, %g)", value.x, value.y, value.z);
  return text;
}

double finite(double value, const char* name) {
  if (!std::isfinite(value)) raise_value(std::string(name) + " must be finite, not " + number_text(value));
  return value;
}

double finite_positive(double value, const char* name, const char* unit) {
  if (!(std::isfinite(value) && value > 0))
    raise_value(std::string(name) + " must be finite and above 0 " + unit + ", not " + number_text(value));
  return value;
}

double finite_not_negative(double value, const char* name, const char* unit) {
  if (!(std::isfinite(value) && value >= 0))
    raise_value(std::string(name) + " must be finite and at least 0" + (*unit ? " " : "") + unit + ", not " +
                number_text(value));
  return value;
}

Color to_color(nb::handle value) {
  const auto parts = nb::cast<std::array<float, 4>>(nb::module_::import_("iota.colors").attr("rgba")(value));
  return {parts[0], parts[1], parts[2], parts[3]};
}

std::optional<std::uint32_t> to_opaque_color(nb::handle value) {
  if (value.is_none()) return std::nullopt;
  return nb::cast<std::uint32_t>(nb::module_::import_("iota.colors").attr("opaque_number")(value));
}

}  // namespace iota::bindings
