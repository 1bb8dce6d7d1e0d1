// SPDX-License-Identifier: Apache-2.0
#include "vector_argument.h"

#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

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
    const std::string text = std::string(name) + " must be 2 or 3 numbers, not " + describe(argument.value);
    throw nb::type_error(text.c_str());
  }
  if (!is_finite(vector)) raise_value(std::string(name) + " must be finite, not " + describe(vector));
  return vector;
}

Quaternion to_quaternion(nb::handle value, const char* name) {
  double v[4] = {};
  nb::object items = PySequence_Check(value.ptr()) ? nb::steal(PySequence_Fast(value.ptr(), "")) : nb::object();
  bool good = items.is_valid() && PySequence_Fast_GET_SIZE(items.ptr()) == 4;
  if (!items.is_valid()) PyErr_Clear();
  for (Py_ssize_t i = 0; good && i < 4; ++i) good = try_number(PySequence_Fast_GET_ITEM(items.ptr(), i), v[i]);
  if (!good) {
    const std::string text = std::string(name) + " must be 4 numbers x y z w, not " + describe(value);
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

Color to_color(nb::handle value, const char* name) {
  Color color{1, 1, 1, 1};
  try {
    const auto numbers = nb::cast<std::vector<double>>(value);
    if (numbers.size() == 3 || numbers.size() == 4) {
      bool good = true;
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        good = good && numbers[i] >= 0 && numbers[i] <= 1;
        color[i] = static_cast<float>(numbers[i]);
      }
      if (good) return color;
    }
  } catch (const nb::cast_error&) {
  }
  throw nb::value_error((std::string(name) + " must be 3 or 4 numbers from 0 to 1, not " + describe(value)).c_str());
}

}  // namespace iota::bindings
