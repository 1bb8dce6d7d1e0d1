// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "system_object.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <string_view>

namespace iota::bindings {

using namespace nb::literals;

/// A float64 array (n, 3), C order, that owns its numbers.
using Vector3Array = nb::ndarray<nb::numpy, double, nb::shape<-1, 3>, nb::c_contig>;

Vector3Array make_vector3_array(std::vector<double> numbers);

void def_fields(nb::class_<SystemObject>&);  ///< the functions of System

// --- handles --------------------------------------------------------------------------------------------------------

/// A handle of an object in a system.
template <class IdType>
Handle<IdType> handle_of(nb::handle_t<SystemObject> system, IdType id) {
  return {nb::borrow(system), nb::inst_ptr<SystemObject>(system), id};
}

/// The system of an object: by default a member.
template <class HandleType>
HandleType& holder_of(HandleType& handle) {
  return handle;
}

/// A scripted function may refer to handles and the system, and the system holds the function: the garbage collector
/// has to see these references to free such a cycle.
template <class HandleType>
inline PyType_Slot handle_slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(+[](PyObject* self, visitproc visit, void* arg) -> int {
       Py_VISIT(Py_TYPE(self));
       if (nb::inst_ready(self)) Py_VISIT(holder_of(*nb::inst_ptr<HandleType>(self)).system_object.ptr());
       return 0;
     })},
    {Py_tp_clear, reinterpret_cast<void*>(+[](PyObject* self) -> int {
       auto& handle = holder_of(*nb::inst_ptr<HandleType>(self));
       handle.system = nullptr;
       handle.system_object.reset();
       return 0;
     })},
    {0, nullptr}};

/// Equality by system and id, hash, `system`, `slot`.
template <class HandleType>
void def_identity(nb::class_<HandleType>& type) {
  type.def(
          "__eq__",
          [](const HandleType& self, nb::handle other) -> nb::object {
            const HandleType* handle = nullptr;
            if (!nb::try_cast<const HandleType*>(other, handle) || !handle) return nb::borrow(Py_NotImplemented);
            return nb::bool_(self.same_as(*handle));
          },
          nb::sig("def __eq__(self, other: object, /) -> bool"), nb::is_operator())
      .def("__hash__",
           [](const HandleType& self) {
             const std::uint64_t id = (std::uint64_t(self.id.generation) << 32 | self.id.slot) * 0x9E3779B97F4A7C15u;
             return Py_hash_t((id ^ reinterpret_cast<std::uintptr_t>(self.system)) >> 1);
           })
      .def_prop_ro(
          "system", [](const HandleType& self) { return self.system_object; }, nb::sig("def system(self) -> System"),
          "The system that owns it.")
      .def_prop_ro(
          "slot", [](const HandleType& self) { return self.id.slot; },
          "Its number, as error texts and the page show it. Reused after it is destroyed; handles are not.");
}

/// A property of System: the handles of all ids that `read(engine)` lists.
template <class HandleType, class Read>
auto all_of(Read read) {
  return [read](nb::handle_t<SystemObject> self) {
    SystemObject* object = nb::inst_ptr<SystemObject>(self);
    return wrap_all<HandleType>(nb::borrow(self), object, read(object->use()));
  };
}

/// As `sibling`, or None.
template <class Other, class IdType>
nb::object sibling_or_none(const Other& handle, const std::optional<IdType>& id) {
  return id ? nb::cast(sibling(handle, *id)) : nb::object(nb::none());
}

/// `alive` and `survivor`, for kinds that can be absorbed.
template <class HandleType>
void def_survival(nb::class_<HandleType>& type, const char* survivor_signature) {
  type.def_prop_ro(
          "alive", [](const HandleType& self) { return self.is_alive(); },
          "False once it was destroyed or absorbed. Never raises for a stale handle.")
      .def_prop_ro(
          "survivor",
          [](const HandleType& self) -> nb::object {
            return sibling_or_none(self, view_of(self.system->use(), self.id).survivor_of(self.id));
          },
          nb::sig(survivor_signature), "Itself if alive, the object that absorbed it, or None if it was destroyed.");
}

template <class HandleType>
std::string stale_repr(const char* type, const HandleType& self) {
  return std::string("<") + type + " " + std::to_string(self.id.slot) + ", gone>";
}

}  // namespace iota::bindings
