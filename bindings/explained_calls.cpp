// SPDX-License-Identifier: Apache-2.0
#include "explained_calls.h"

#include <nanobind/stl/string.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace iota::bindings {

namespace nb = nanobind;

namespace {

/// The name of a function in scripts: "Body.particle", "Body.mass = ..." for the setter of a property.
std::unordered_map<PyObject*, std::string>& names() {
  static std::unordered_map<PyObject*, std::string> map;
  return map;
}

nb::object sentence_writer(const char* function) { return nb::module_::import_("iota.arguments").attr(function); }

// --- calls --------------------------------------------------------------------------------------------------------------

/// Replaces nanobind's text by a sentence; other errors do not change.
void explain(PyObject* function, PyObject* const* arguments, std::size_t count, PyObject* keywords) {
  nb::python_error error;  // takes the error
  const std::string text = nb::str(error.value()).c_str();
  const auto found = names().find(function);
  if (text.find("incompatible function arguments") == std::string::npos || found == names().end()) {
    error.restore();
    return;
  }
  try {
    // The instance of a constructor call is not initialized yet and must not be read.
    const bool makes = found->second.find(".__init__") != std::string::npos;
    nb::list given;
    for (std::size_t i = 0; i < count; ++i) given.append(i == 0 && makes ? nb::none() : nb::borrow(arguments[i]));
    nb::dict named;
    if (keywords)
      for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(keywords); ++i)
        named[nb::handle(PyTuple_GET_ITEM(keywords, i))] = nb::borrow(arguments[count + static_cast<std::size_t>(i)]);
    const nb::object sentence =
        sentence_writer("explain_call")(found->second, nb::borrow(function).attr("__nb_signature__"), given, named);
    PyErr_SetObject(PyExc_TypeError, sentence.ptr());
  } catch (nb::python_error&) {
    error.restore();
  }
}

/// The functions by which nanobind calls its functions: one of a few, by number and kinds of arguments.
constexpr std::size_t most_callers = 16;
std::array<vectorcallfunc, most_callers> callers{};

template <std::size_t which>
PyObject* call_explained(PyObject* function, PyObject* const* arguments, std::size_t count, PyObject* keywords) {
  PyObject* const result = callers[which](function, arguments, count, keywords);
  if (!result && PyErr_ExceptionMatches(PyExc_TypeError)) {
    constexpr std::size_t without_flags = SIZE_MAX >> 2;  // nanobind has one of its own
    explain(function, arguments, count & without_flags, keywords);
  }
  return result;
}

template <std::size_t... which>
constexpr std::array<vectorcallfunc, most_callers> explained_callers(std::index_sequence<which...>) {
  return {&call_explained<which>...};
}
constexpr auto explained = explained_callers(std::make_index_sequence<most_callers>{});

void explain_function(nb::handle function, const std::string& name) {
  if (!function.is_valid() || !nb::hasattr(function, "__nb_signature__") || names().count(function.ptr())) return;
  names()[function.ptr()] = name;
  // The type has the offset of an instance's vectorcall function (PEP 590).
  auto& caller = *reinterpret_cast<vectorcallfunc*>(reinterpret_cast<char*>(function.ptr()) +
                                                    Py_TYPE(function.ptr())->tp_vectorcall_offset);
  for (std::size_t i = 0; i < most_callers; ++i) {
    if (!callers[i]) callers[i] = caller;
    if (callers[i] != caller) continue;
    caller = explained[i];
    return;
  }
  throw std::logic_error("nanobind has a way to call functions that explain_calls does not know");
}

// --- types --------------------------------------------------------------------------------------------------------------

PyObject* refuse_making(PyObject* type, PyObject* const*, std::size_t, PyObject*) {
  try {
    const nb::object sentence = sentence_writer("explain_making")(nb::borrow(type));
    PyErr_SetObject(PyExc_TypeError, sentence.ptr());
  } catch (nb::python_error& error) {
    error.restore();
  }
  return nullptr;
}

int assign_explained(PyObject* self, PyObject* name, PyObject* value) {
  const int result = PyObject_GenericSetAttr(self, name, value);
  if (result == 0 || !PyErr_ExceptionMatches(PyExc_AttributeError)) return result;
  nb::python_error error;
  try {
    const nb::object sentence =
        sentence_writer("explain_assignment")(nb::borrow(reinterpret_cast<PyObject*>(Py_TYPE(self))), nb::borrow(name));
    if (sentence.is_none())
      error.restore();  // raised by a setter
    else
      PyErr_SetObject(PyExc_AttributeError, sentence.ptr());
  } catch (nb::python_error&) {
    error.restore();
  }
  return result;
}

void explain_type(nb::handle type) {
  const std::string name = nb::cast<std::string>(type.attr("__name__"));
  bool can_be_made = false;
  const auto members =
      nb::borrow<nb::dict>(nb::borrow(reinterpret_cast<PyObject*>(&PyDict_Type))(type.attr("__dict__")));
  for (const auto& [key, member] : members) {
    const std::string of = name + "." + nb::cast<std::string>(key);
    if (Py_TYPE(member.ptr()) == &PyProperty_Type) {
      explain_function(member.attr("fget"), of);
      explain_function(member.attr("fset"), of + " = ...");
    } else if (nb::hasattr(member, "__nb_signature__")) {
      can_be_made = can_be_made || of == name + ".__init__";
      explain_function(member, of);
    }
  }
  auto* const object = reinterpret_cast<PyTypeObject*>(type.ptr());
  if (!can_be_made) object->tp_vectorcall = &refuse_making;
  object->tp_setattro = &assign_explained;
  PyType_Modified(object);
}

}  // namespace

void explain_calls(nb::module_& module) {
  for (const auto& [key, member] : nb::borrow<nb::dict>(module.attr("__dict__"))) {
    if (PyType_Check(member.ptr()))
      explain_type(member);
    else
      explain_function(member, nb::cast<std::string>(nb::str(key)));
  }
}

}  // namespace iota::bindings
