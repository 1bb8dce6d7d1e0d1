// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "typed_argument.h"

#include <nanobind/operators.h>
#include <nanobind/stl/array.h>

#include <array>
#include <cstring>

namespace iota::bindings {

namespace {

/// Arithmetic with vectors; `NotImplemented` for other operands, so that arrays (n, 3) handle them.
template <class Operation>
auto with_vector(Operation operation) {
  return [operation](const Vec3& a, nb::handle other) -> nb::object {
    Vec3 b;
    if (!try_vec3(other, b)) return nb::borrow(Py_NotImplemented);
    return nb::cast(operation(a, b));
  };
}

double component(const Vec3& v, Py_ssize_t index) {
  if (index < 0) index += 3;
  if (index < 0 || index > 2) throw nb::index_error("a Vec3 has the components 0, 1 and 2");
  return index == 0 ? v.x : index == 1 ? v.y : v.z;
}

std::string number(double value) { return nb::repr(nb::float_(value)).c_str(); }

constexpr const char* vector_doc =
    "Three numbers: a place (m), a velocity (m/s), a force (N) ... in the world frame, y up.\n\n"
    "It is immutable; assign a new one: `particle.position += (0, 1, 0)`. Adds to and compares with tuples, lists\n"
    "and arrays of 2 or 3 numbers, and converts to an array with `numpy.asarray(v)`, float64 of shape (3,).";

}  // namespace

Vector3Array make_vector3_array(std::vector<double> numbers) {
  auto* owned = new std::vector<double>(std::move(numbers));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
  return Vector3Array(owned->data(), {owned->size() / 3, 3}, owner);
}

void bind_vector(nb::module_& module) {
  module.def(
      "unit_quaternion",
      [](nb::handle rotation) {
        const Quaternion q = to_quaternion(rotation, "a rotation");
        return std::array{q.x, q.y, q.z, q.w};
      },
      "rotation"_a, nb::sig("def unit_quaternion(rotation: " IOTA_ROTATION ") -> tuple[float, float, float, float]"),
      "x y z w, from these or an axis and an angle in degrees: ('z', 30) or ((1, 1, 0), 30). Raises TypeError, ValueError.");
  nb::class_<Vec3>(module, "Vec3", vector_doc)
      .def(
          "__init__", [](Vec3* self, double x, double y, double z) { new (self) Vec3{x, y, z}; }, "x"_a = 0.0,
          "y"_a = 0.0, "z"_a = 0.0)
      .def_ro("x", &Vec3::x)
      .def_ro("y", &Vec3::y)
      .def_ro("z", &Vec3::z)
      .def("__len__", [](const Vec3&) { return 3; })
      .def("__getitem__", &component, "index"_a)
      .def(
          "__iter__", [](const Vec3& v) { return nb::iter(nb::make_tuple(v.x, v.y, v.z)); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[float]"))
      .def("__add__", with_vector([](const Vec3& a, const Vec3& b) { return a + b; }), nb::is_operator(),
           nb::sig("def __add__(self, other: Vec3 | collections.abc.Sequence[float], /) -> Vec3"))
      .def("__radd__", with_vector([](const Vec3& a, const Vec3& b) { return b + a; }), nb::is_operator(),
           nb::sig("def __radd__(self, other: collections.abc.Sequence[float], /) -> Vec3"))
      .def("__sub__", with_vector([](const Vec3& a, const Vec3& b) { return a - b; }), nb::is_operator(),
           nb::sig("def __sub__(self, other: Vec3 | collections.abc.Sequence[float], /) -> Vec3"))
      .def("__rsub__", with_vector([](const Vec3& a, const Vec3& b) { return b - a; }), nb::is_operator(),
           nb::sig("def __rsub__(self, other: collections.abc.Sequence[float], /) -> Vec3"))
      .def(
          "__mul__", [](const Vec3& a, double s) { return a * s; }, nb::is_operator(), "factor"_a)
      .def(
          "__rmul__", [](const Vec3& a, double s) { return s * a; }, nb::is_operator(), "factor"_a)
      .def(
          "__truediv__",
          [](const Vec3& a, double s) {
            if (s == 0) {
              PyErr_SetString(PyExc_ZeroDivisionError, "a Vec3 was divided by 0");
              throw nb::python_error();
            }
            return a * (1 / s);
          },
          nb::is_operator(), "divisor"_a)
      .def("__neg__", [](const Vec3& a) { return -a; })
      .def("__abs__", [](const Vec3& a) { return norm(a); })
      .def(
          "__eq__",
          [](const Vec3& a, nb::handle other) -> nb::object {
            Vec3 b;
            return try_vec3(other, b) ? nb::bool_(a == b) : nb::borrow(Py_NotImplemented);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const Vec3& a) { return nb::hash(nb::make_tuple(a.x, a.y, a.z)); })
      .def("__repr__",
           [](const Vec3& a) { return "Vec3(" + number(a.x) + ", " + number(a.y) + ", " + number(a.z) + ")"; })
      .def(
          "__array__",
          [](const Vec3& a, nb::object dtype, nb::object) {
            nb::object array = nb::module_::import_("numpy").attr("array");
            return array(nb::make_tuple(a.x, a.y, a.z), dtype.is_none() ? nb::str("float64") : dtype);
          },
          "dtype"_a = nb::none(), "copy"_a = nb::none(),
          nb::sig("def __array__(self, dtype: object = None, copy: object = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"))
      .def(
          "dot", [](const Vec3& a, VectorArgument b) { return dot(a, to_vec3(b, "other")); }, "other"_a,
          "Scalar product.")
      .def(
          "cross", [](const Vec3& a, VectorArgument b) { return cross(a, to_vec3(b, "other")); }, "other"_a,
          "Vector product.")
      .def_prop_ro(
          "length", [](const Vec3& a) { return norm(a); }, "Euclidean length; also `abs(v)`.")
      .def(
          "unit",
          [](const Vec3& a) {
            const double length = norm(a);
            return length > 0 ? a * (1 / length) : Vec3{};
          },
          "The vector of length 1 in the same direction; zero stays zero.")
      .def(
          "__getstate__", [](const Vec3& a) { return nb::make_tuple(a.x, a.y, a.z); },
          nb::sig("def __getstate__(self) -> tuple[float, float, float]"))
      .def(
          "__setstate__",
          [](Vec3& self, nb::tuple state) {
            new (&self) Vec3{nb::cast<double>(state[0]), nb::cast<double>(state[1]), nb::cast<double>(state[2])};
          },
          nb::sig("def __setstate__(self, state: tuple[float, float, float], /) -> None"));
}

}  // namespace iota::bindings
