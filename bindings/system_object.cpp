// SPDX-License-Identifier: Apache-2.0
#include "system_object.h"

#include "bond_view.h"

#include <algorithm>

namespace iota::bindings {

namespace {

/// Looked up when needed: the module must import without its package, for the generator of the stub file.
nb::object error_class(const char* name) { return nb::module_::import_("iota.errors").attr(name); }

[[noreturn]] void raise_object(const nb::object& error) {
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  throw nb::python_error();
}

[[noreturn]] void raise_stale_as(const std::string& text, const nb::object& survivor) {
  raise_object(error_class("StaleIdError")(text, survivor));
}

/// What the engine says of a stale id; `touch` is any call that checks it.
template <class Touch>
std::string engine_text(const Touch& touch, const std::string& otherwise) {
  try {
    touch();
  } catch (const StaleIdError& error) {
    return error.what();
  }
  return otherwise;
}

template <class HandleType>
[[noreturn]] void raise_stale_with_survivor(const HandleType& handle, const std::string& text) {
  const auto survivor = handle.system->engine.survivor_of(handle.id);
  raise_stale_as(text, survivor ? nb::cast(sibling(handle, *survivor)) : nb::object(nb::none()));
}

}  // namespace

void register_errors() {
  nb::register_exception_translator([](const std::exception_ptr& pointer, void*) {
    try {
      std::rethrow_exception(pointer);
    } catch (const StaleIdError& error) {
      nb::object raised = error_class("StaleIdError")(error.what());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(raised.ptr())), raised.ptr());
    }
  });
}

void raise_stale(const BodyHandle& handle) {
  raise_stale_with_survivor(
      handle, engine_text([&] { (void)handle.system->engine.mass(handle.id); }, name_of(handle.id) + " is gone"));
}

void raise_stale(const ParticleHandle& handle) {
  raise_stale_with_survivor(
      handle, engine_text([&] { (void)handle.system->engine.position(handle.id); }, name_of(handle.id) + " is gone"));
}

void raise_stale(const BondHandle& handle) {
  raise_stale_as(
      engine_text([&] { (void)handle.system->engine.is_active(handle.id); }, name_of(handle.id) + " is gone"),
      nb::none());
}

void raise_stale(const LawHandle& handle) { raise_stale_as(name_of(handle.id) + " is gone", nb::none()); }
void raise_stale(const GroupHandle& handle) { raise_stale_as(name_of(handle.id) + " is gone", nb::none()); }
void raise_stale(const FieldHandle& handle) { raise_stale_as(name_of(handle.id) + " is gone", nb::none()); }
void raise_stale(const PairsHandle& handle) { raise_stale_as(name_of(handle.id) + " is gone", nb::none()); }

void raise_stale(const GripHandle& handle) {
  raise_stale_as(name_of(handle.id) + " was let go, or its body is gone", nb::none());
}

void raise_stale(const ConstraintHandle& handle) {
  raise_stale_as(name_of(handle.id) + " is gone: it, or a body or particle that it held, was destroyed or made rigid",
                 nb::none());
}

void raise_stale(const EmitterHandle& handle) { raise_stale_as(name_of(handle.id) + " was destroyed", nb::none()); }

void raise_runtime(const std::string& text) {
  PyErr_SetString(PyExc_RuntimeError, text.c_str());
  throw nb::python_error();
}

void SystemObject::raise_foreign_thread() {
  nb::object error = error_class("WrongThreadError");
  PyErr_SetString(error.ptr(),
                  "a system belongs to one thread: the one that made it, or the one that runs its World. "
                  "Use world.call(function) to run something there, or system.adopt() to take over a system at rest");
  throw nb::python_error();
}

System& SystemObject::use_between_steps(const char* what) {
  System& system = use();
  if (system.is_stepping())
    raise_runtime(std::string(what) +
                  " is not possible in a bond's function, as a step is under way. There, only combine, separate, nail, "
                  "release and destroy are taken, and done right after the step");
  return system;
}

void SystemObject::adopt() {
  if (engine.is_stepping()) raise_runtime("adopt: a step is under way in another thread");
  owner = std::this_thread::get_id();
}

BondLaw SystemObject::make_scripted_law(std::shared_ptr<BondFunction> function, std::string name) {
  ScriptedLaw law;
  law.name = std::move(name);
  law.force = [this, function = std::move(function)](const BondState& state) -> Vec3 {
    Vec3 force;
    guard(function, function->bond, [&] {
      nb::object result = function->function(BondView{nb::find(this), this, function, state});
      if (!try_vec3(result, force)) {
        const std::string text = "the force must be 2 or 3 numbers (N), not " + describe(result);
        throw nb::type_error(text.c_str());
      }
      if (!is_finite(force)) {
        const std::string text = "the force must be finite (N), not " + describe(force);
        throw nb::value_error(text.c_str());
      }
    });
    return force;
  };
  return law;
}

StepReport SystemObject::step(double dt) {
  System& system = use_between_steps("step");
  finite_positive(dt, "dt", "s");
  failures.clear();
  std::vector<std::string> warnings;
  switch_off_failed_surfaces(warnings);
  StepReport report;
  {
    nb::gil_scoped_release unlocked;
    report = system.step(dt);
  }
  step_edits = report.edits;
  broken = report.broken;
  for (const Broken& b : broken) note_edit("break", b.position);
  switch_off_failed_surfaces(warnings);
  report.warnings.insert(report.warnings.begin(), warnings.begin(), warnings.end());
  // Functions that the engine has dropped: ours is the only reference left.
  std::erase_if(functions, [](const auto& function) { return function.use_count() == 1; });
  if (!failures.empty() || !report.switched_off.empty()) tell_failures(report);
  return report;
}

void SystemObject::tell_failures(const StepReport& report) {
  std::vector<ForceFailure> all;
  all.swap(failures);
  for (const ForceFailure& failure : all) {
    if (!PyObject_IsInstance(failure.exception.ptr(), PyExc_Exception)) raise_object(failure.exception);
  }
  BondId bond;
  std::string text;
  if (!all.empty()) {
    const ForceFailure& first = all.front();
    bond = first.bond;
    if (const auto* own = bond ? static_cast<const BondFunction*>(first.source.get()) : nullptr)
      text = name_of(bond) + " between " + name_of(own->p) + " and " + name_of(own->q);
    else
      text = first.source->what;
    text += std::string(" was switched off: its function raised ") + nb::type_name(first.exception.type()).c_str() +
            ": " + nb::str(first.exception).c_str();
    if (all.size() > 1) text += " (and " + std::to_string(all.size() - 1) + " more in this step)";
  } else {
    bond = report.switched_off.front();
    for (const std::string& warning : report.warnings)
      if (text.empty() && warning.starts_with(name_of(bond))) text = warning;
    const std::size_t more = report.switched_off.size() - 1;
    if (more > 0) text += " (and " + std::to_string(more) + " more in this step)";
  }
  if (warn_of_forces) {
    if (PyErr_WarnEx(error_class("ForceWarning").ptr(), text.c_str(), 1) != 0) throw nb::python_error();
    return;
  }
  nb::object error = bond ? error_class("BondError")(text, nb::cast(report), BondHandle{nb::find(this), this, bond})
                          : error_class("ForceError")(text, nb::cast(report));
  if (!all.empty()) PyException_SetCause(error.ptr(), nb::object(all.front().exception).release().ptr());
  raise_object(error);
}

void SystemObject::settle_surfaces(ConstraintId constraint) {
  std::string failure;
  std::erase_if(surfaces,
                [](const auto& surface) { return surface.use_count() == 1; });  // of constraints that were refused
  for (const auto& surface : surfaces) {
    if (surface->constraint) continue;
    surface->constraint = constraint;
    if (surface->failed) failure = surface->failure;
  }
  if (failure.empty()) return;
  engine.destroy(constraint);
  throw nb::value_error(("the function of the surface " + failure).c_str());
}

void SystemObject::switch_off_failed_surfaces(std::vector<std::string>& warnings) {
  std::erase_if(surfaces, [&](const auto& surface) {
    if (surface->constraint && !engine.contains(surface->constraint)) return true;
    if (!surface->failed || !surface->constraint) return surface.use_count() == 1;
    engine.set_active(surface->constraint, false);
    warnings.push_back("constraint " + std::to_string(surface->constraint.slot) +
                       " is switched off: the function of its surface " + surface->failure);
    return true;
  });
}

int SystemObject::traverse(visitproc visit, void* arg) {
  for (const auto& function : functions) Py_VISIT(function->function.ptr());
  for (const auto& object : code) Py_VISIT(object.ptr());
  for (const auto& failure : failures) Py_VISIT(failure.exception.ptr());
  return 0;
}

void SystemObject::clear() {
  for (const auto& function : functions) function->function.reset();
  code.clear();
  failures.clear();
}

}  // namespace iota::bindings
