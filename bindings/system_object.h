// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vector_argument.h"
#include "views.h"

#include <iota/system.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace iota::bindings {

namespace nb = nanobind;

/// A function of the script that the engine calls. The engine's copy holds it by shared_ptr and may drop it while the
/// interpreter lock is released; `SystemObject` holds it too, so that the function is always destroyed with the lock.
struct ScriptFunction {
  nb::object function;
  std::string what;         ///< "law wind", "field current"
  ConstraintId constraint;  ///< of the surface that it defines; else null
  FieldId field;            ///< that it is; else null
};

/// The function of one scripted bond.
struct BondFunction : ScriptFunction {
  BondId bond;
  ParticleId p, q;
};

/// While one exists, its thread may not use any system: the engine is in the middle of an operation of several threads,
/// any of which may call a function.
class MidStep {
 public:
  explicit MidStep(bool is_so = true) : is_so_(is_so) { depth_ += is_so_; }
  ~MidStep() { depth_ -= is_so_; }
  MidStep(const MidStep&) = delete;
  static bool is_now() { return depth_ > 0; }

 private:
  bool is_so_;
  static inline thread_local int depth_ = 0;
};

/// A function that raised, or a signal that arrived in it.
struct ForceFailure {
  std::shared_ptr<ScriptFunction> source;
  BondId bond;  ///< null unless it is a function of one bond
  nb::object exception;
};

/// The state of a Python `System`: the engine's system, its owner thread and the functions of its scripted bonds.
class SystemObject {
 public:
  explicit SystemObject(const SystemOptions& options) : engine(options), owner(std::this_thread::get_id()) {}

  /// The engine's system, for a caller on the owner thread; throws `RuntimeError` on any other.
  System& use() {
    if (MidStep::is_now()) raise_mid_step();
    if (owner != std::this_thread::get_id()) raise_foreign_thread();
    return engine;
  }
  /// The same, for calls that are not allowed in functions called during a step.
  System& use_between_steps(const char* what);

  void adopt();
  StepReport step(double dt, int count);
  /// The parts of `step`: checks, with the interpreter lock; the engine's steps, without it; what follows, with it.
  void prepare_step(double dt, int count);
  StepReport advance(double dt, int count);
  void finish_step(StepReport& report);
  /// phi of a surface of the script, m; throws std::runtime_error unless it is a finite number. Called on any thread.
  double call_surface(const std::shared_ptr<ScriptFunction>& function, const Vec3& r);
  BondLaw make_scripted_law(std::shared_ptr<BondFunction> function, std::string name);
  void keep(std::shared_ptr<ScriptFunction> function) { functions.push_back(std::move(function)); }
  /// Makes a constraint and sets its id in its functions. Exceptions raised by these propagate unchanged.
  template <class Spec>
  ConstraintId create_surface_constraint(const Spec& spec);
  /// Runs `call` for the engine, with the lock held. Saves its exception and throws std::runtime_error, for which the
  /// engine switches off the force, law or surface of the function; a signal that arrives in it is only saved.
  template <class Call>
  void guard(const std::shared_ptr<ScriptFunction>& source, BondId bond, Call call);

  int traverse(visitproc visit, void* argument);
  void clear();

  System engine;
  std::thread::id owner;
  std::vector<std::shared_ptr<ScriptFunction>> functions;
  std::vector<std::shared_ptr<ScriptFunction>> new_surfaces;  ///< of the next constraint
  std::vector<nb::object> code;                               ///< compiled functions of laws
  std::vector<ForceFailure> failures;                         ///< of the present step; of surfaces, since the last one
  bool warn_of_forces = false;                                ///< failed forces give a warning instead of an exception
  std::map<std::string, LawId> written_laws;                  ///< expressions of bonds, by text and parameters
  std::optional<RestructureReport> step_edits;                ///< requested during the last step
  std::vector<Broken> broken;                                 ///< in the last step
  std::vector<StopEvent> stops;                               ///< in the last step
  std::vector<ContactEvent> contacts;                         ///< in the last step

 private:
  [[noreturn]] static void raise_foreign_thread();
  [[noreturn]] static void raise_mid_step();
  [[noreturn]] void raise_first_failure();
  void tell_failures(const StepReport& report);
};

/// A Python handle: a system and an id in it.
template <class IdType>
struct Handle {
  nb::object system_object;  ///< keeps the system alive
  SystemObject* system = nullptr;
  IdType id;

  /// The engine, after checking that the caller is on the owner thread and that the handle is not stale.
  System& use() const;
  bool is_alive() const;
  bool same_as(const Handle& other) const { return system == other.system && id == other.id; }
};

using BodyHandle = Handle<BodyId>;
using ParticleHandle = Handle<ParticleId>;
using BondHandle = Handle<BondId>;
using LawHandle = Handle<LawId>;
using GroupHandle = Handle<GroupId>;
using FieldHandle = Handle<FieldId>;
using PairsHandle = Handle<PairsId>;
using GripHandle = Handle<GripId>;
using EmitterHandle = Handle<EmitterId>;
using ConstraintHandle = Handle<ConstraintId>;
using CosmeticBondHandle = Handle<CosmeticBondId>;

template <KindName kind>
std::string name_of(Id<kind> id) {
  return std::string(kind.text) + " " + std::to_string(id.slot);
}

/// Translates the engine's StaleIdError into Python's.
void register_errors();

/// The exception of a solver of the script in steps since the last call; null if none.
nb::object take_solver_failure();

/// Throws Python's RuntimeError.
[[noreturn]] void raise_runtime(const std::string& text);

/// Throws TypeError for anything but a System.
SystemObject* to_system(nb::handle system);

/// The system of a living object, for a call that is refused during a step.
template <class IdType>
System& between_steps(const Handle<IdType>& self, const char* what) {
  self.use();
  return self.system->use_between_steps(what);
}

/// Another object of the same system.
template <class Other, class IdType>
Handle<IdType> sibling(const Other& handle, IdType id) {
  return {handle.system_object, handle.system, id};
}

/// Throws StaleIdError, which says what became of the object of a handle.
[[noreturn]] void raise_stale_as(const std::string& text, const nb::object& survivor);
template <class IdType>
[[noreturn]] void raise_stale(const Handle<IdType>& handle) {
  raise_stale_as(name_of(handle.id) + " is gone", nb::none());
}
[[noreturn]] void raise_stale(const BodyHandle&);
[[noreturn]] void raise_stale(const ParticleHandle&);
[[noreturn]] void raise_stale(const BondHandle&);
[[noreturn]] void raise_stale(const GripHandle&);
[[noreturn]] void raise_stale(const EmitterHandle&);
[[noreturn]] void raise_stale(const ConstraintHandle&);

template <class Spec>
ConstraintId SystemObject::create_surface_constraint(const Spec& spec) {
  const auto functions_of_it = std::exchange(new_surfaces, {});
  const std::size_t known = failures.size();
  try {
    const ConstraintId constraint = engine.joints().create(spec);
    for (const auto& function : functions_of_it) function->constraint = constraint;
    return constraint;
  } catch (...) {
    if (failures.size() > known) raise_first_failure();
    throw;
  }
}

template <class Call>
void SystemObject::guard(const std::shared_ptr<ScriptFunction>& source, BondId bond, Call call) {
  nb::gil_scoped_acquire lock;
  try {
    call();
    return;
  } catch (nb::python_error& error) {
    const bool is_signal = !error.matches(PyExc_Exception);
    failures.push_back({source, bond, nb::borrow(error.value())});
    // Ctrl-C may arrive here; it is not an error of the function.
    if (is_signal) return;
  } catch (nb::builtin_exception& error) {
    PyObject* type = error.type() == nb::exception_type::type_error ? PyExc_TypeError : PyExc_ValueError;
    failures.push_back({source, bond, nb::borrow(type)(error.what())});
  }
  const nb::object& raised = failures.back().exception;
  throw std::runtime_error(std::string(nb::type_name(raised.type()).c_str()) + ": " + nb::str(raised).c_str());
}

template <class IdType>
bool Handle<IdType>::is_alive() const {
  return system != nullptr && view_of(system->use(), id).contains(id);
}

template <class IdType>
System& Handle<IdType>::use() const {
  if (!system)
    throw nb::value_error("this handle has no system: it comes from a report that was pickled, or was cleared");
  System& engine = system->use();
  if (!view_of(engine, id).contains(id)) raise_stale(*this);
  return engine;
}

template <class HandleType>
std::vector<HandleType> wrap_all(const nb::object& system_object, SystemObject* system, const auto& ids) {
  std::vector<HandleType> handles;
  handles.reserve(ids.size());
  for (const auto id : ids) handles.push_back({system_object, system, id});
  return handles;
}

/// Throws ValueError unless both belong to one system.
template <class HandleType>
void check_one_system(const HandleType& a, const HandleType& b, const char* call) {
  if (a.system == b.system) return;
  const std::string text = std::string(call) + " takes two of one system, but " + name_of(a.id) + " and " +
                           name_of(b.id) + " belong to different systems";
  throw nb::value_error(text.c_str());
}

}  // namespace iota::bindings
