// SPDX-License-Identifier: Apache-2.0
#include "system_object.h"

#include "bond_view.h"

#include <algorithm>
#include <cmath>

namespace iota::bindings {

namespace {

/// Imported when needed: the generator of the stub file imports this module without its package.
nb::object error_class(const char* name) { return nb::module_::import_("iota.errors").attr(name); }

[[noreturn]] void raise_object(const nb::object& error) {
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  throw nb::python_error();
}

/// Ctrl-C and other signals, which are not errors of the function in which they arrive.
bool is_signal(const nb::object& raised) { return !PyObject_IsInstance(raised.ptr(), PyExc_Exception); }

std::string describe_exception(const nb::object& raised) {
  return std::string(nb::type_name(raised.type()).c_str()) + ": " + nb::str(raised).c_str();
}

/// The engine's text for a stale id; `touch` is any call that checks it.
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
  const auto survivor = view_of(handle.system->engine, handle.id).survivor_of(handle.id);
  raise_stale_as(text, survivor ? nb::cast(sibling(handle, *survivor)) : nb::object(nb::none()));
}

}  // namespace

void raise_stale_as(const std::string& text, const nb::object& survivor) {
  raise_object(error_class("StaleIdError")(text, survivor));
}

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
  raise_stale_with_survivor(handle, engine_text([&] { (void)handle.system->engine.bodies().mass(handle.id); },
                                                name_of(handle.id) + " is gone"));
}

void raise_stale(const ParticleHandle& handle) {
  raise_stale_with_survivor(handle, engine_text([&] { (void)handle.system->engine.particles().position(handle.id); },
                                                name_of(handle.id) + " is gone"));
}

void raise_stale(const BondHandle& handle) {
  raise_stale_as(
      engine_text([&] { (void)handle.system->engine.bonds().is_active(handle.id); }, name_of(handle.id) + " is gone"),
      nb::none());
}

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

SystemObject* to_system(nb::handle system) {
  SystemObject* object = nullptr;
  if (!nb::try_cast(system, object) || !object)
    throw nb::type_error(("system must be a System, not " + describe(system)).c_str());
  return object;
}

void SystemObject::raise_mid_step() {
  raise_runtime(
      "the function of a surface or a solver is called in the middle of a step, on any thread: it cannot use the system. "
      "Give it what it needs beforehand, or act in a bond's function or between the steps");
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
    raise_runtime(
        std::string(what) +
        " is not possible in a function that is called during a step. There, everything may be read, and only "
        "destroy, combine, separate, nail, release, kind, active and a joint's length, limits, motor, friction and "
        "spring may be asked for; they are made right after the step");
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

double SystemObject::call_surface(const std::shared_ptr<ScriptFunction>& function, const Vec3& r) {
  const MidStep mid_step;
  double phi = 0;
  bool is_done = false;
  for (int attempt = 0; attempt < 2 && !is_done; ++attempt)  // a second time if a signal arrived in it
    guard(function, BondId{}, [&] {
      const nb::object result = function->function(r.x, r.y, r.z);
      if (!nb::try_cast<double>(result, phi) || !std::isfinite(phi)) {
        const std::string text = "a surface must be a finite number (m), not " + describe(result);
        throw nb::value_error(text.c_str());
      }
      is_done = true;
    });
  if (!is_done) throw std::runtime_error("it was interrupted");
  return phi;
}

StepReport SystemObject::step(double dt, int count) {
  prepare_step(dt, count);
  StepReport report;
  {
    const nb::gil_scoped_release unlocked;
    report = advance(dt, count);
  }
  finish_step(report);
  return report;
}

void SystemObject::prepare_step(double dt, int count) {
  (void)use_between_steps("step");
  finite_positive(dt, "dt", "s");
  if (count < 1) throw nb::value_error(("count must be at least 1, not " + std::to_string(count)).c_str());
  std::erase_if(failures, [](const ForceFailure& failure) { return !failure.source->constraint; });
}

StepReport SystemObject::advance(double dt, int count) {
  StepReport report = engine.step(dt);
  const auto has_failed = [&] {
    return !failures.empty() || !report.switched_off.empty() || !report.switched_off_constraints.empty();
  };
  for (int i = 1; i < count && !has_failed(); ++i) add_step(report, engine.step(dt));
  return report;
}

void SystemObject::finish_step(StepReport& report) {
  stops = report.stops;
  contacts = report.contacts;
  step_edits = report.edits;
  broken = report.broken;
  // Functions that the engine has dropped: ours is the only remaining reference.
  std::erase_if(functions, [](const auto& function) { return function.use_count() == 1; });
  if (nb::object raised = take_solver_failure(); raised.is_valid()) {
    if (is_signal(raised)) raise_object(raised);
    for (std::string& warning : report.warnings)
      if (warning.starts_with("the solver ")) warning += "; it raised " + describe_exception(raised);
  }
  if (!failures.empty() || !report.switched_off.empty() || !report.switched_off_constraints.empty())
    tell_failures(report);
}

void SystemObject::raise_first_failure() {
  const nb::object exception = failures.back().exception;
  failures.clear();
  raise_object(exception);
}

void SystemObject::tell_failures(const StepReport& report) {
  std::vector<ForceFailure> all;
  all.swap(failures);
  for (const ForceFailure& failure : all)
    if (is_signal(failure.exception)) raise_object(failure.exception);
  BondId bond;
  ConstraintId constraint;
  std::string text;
  std::size_t count = all.size();
  if (!all.empty()) {
    const ForceFailure& first = all.front();
    bond = first.bond, constraint = first.source->constraint;
    if (const auto* own = bond ? static_cast<const BondFunction*>(first.source.get()) : nullptr)
      text = name_of(bond) + " between " + name_of(own->p) + " and " + name_of(own->q);
    else
      text = constraint ? name_of(constraint) : first.source->what;
    text += std::string(" was switched off: its function raised ") + describe_exception(first.exception);
  } else {
    if (report.switched_off.empty())
      constraint = report.switched_off_constraints.front();
    else
      bond = report.switched_off.front();
    const std::string name = bond ? name_of(bond) : name_of(constraint);
    for (const std::string& warning : report.warnings)
      if (text.empty() && warning.starts_with(name)) text = warning;
    count = report.switched_off.size() + report.switched_off_constraints.size();
  }
  if (count > 1) text += " (and " + std::to_string(count - 1) + " more in this step)";
  if (warn_of_forces) {
    if (PyErr_WarnEx(error_class("ForceWarning").ptr(), text.c_str(), 1) != 0) throw nb::python_error();
    return;
  }
  nb::object error;
  if (bond)
    error = error_class("BondError")(text, nb::cast(report), BondHandle{nb::find(this), this, bond});
  else if (constraint)
    error = error_class("ConstraintError")(text, nb::cast(report), ConstraintHandle{nb::find(this), this, constraint});
  else
    error = error_class("ForceError")(text, nb::cast(report));
  if (!all.empty()) PyException_SetCause(error.ptr(), nb::object(all.front().exception).release().ptr());
  raise_object(error);
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
