// SPDX-License-Identifier: Apache-2.0
#include "array_argument.h"
#include "binders.h"
#include "names.h"

namespace iota::bindings {

namespace {

PyType_Slot system_slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(+[](PyObject* self, visitproc visit, void* arg) -> int {
       Py_VISIT(Py_TYPE(self));
       return nb::inst_ready(self) ? nb::inst_ptr<SystemObject>(self)->traverse(visit, arg) : 0;
     })},
    {Py_tp_clear, reinterpret_cast<void*>(+[](PyObject* self) -> int {
       if (nb::inst_ready(self)) nb::inst_ptr<SystemObject>(self)->clear();
       return 0;
     })},
    {0, nullptr}};

constexpr const char* system_doc =
    "A world of particles, bodies and bonds that is advanced step by step. SI units, right-handed, y up.\n\n"
    "gravity: m/s^2. mode: from plausible to accurate. 'plausible' and 'robust' (backward Euler; never fails, never\n"
    "gains energy, dissipates), 'energy_keeping' (mid-point discrete gradient; falls back to 'robust' if a step\n"
    "fails, and reports it), 'accurate' (in sub-steps with an error estimate). damping: 1/s, all velocities fall by\n"
    "exp(-damping t). threads: number of threads for a step, 0: one per core; the results are the same bits for any\n"
    "number.\n\n"
    "A system belongs to the thread that made it; while a World runs it, to the World's. Other threads get\n"
    "WrongThreadError.\n\n"
    "    system = iota.System()\n"
    "    ball = system.body().particle((0, 1, 0))\n"
    "    report = system.step(1 / 120)";

/// The rows of an array or nested sequence of shape (n, 3), finite.
std::vector<double> rows(nb::handle values, std::size_t count, const char* name) {
  nb::object array;
  const auto view = view_rows(values, count, name, "particle", array);
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (std::isfinite(view[i])) continue;
    const std::string text = std::string(name) + " must be finite; row " + std::to_string(i / 3) + " is not";
    throw nb::value_error(text.c_str());
  }
  return {view.begin(), view.end()};
}

template <class Read>
nb::object read_rows(System& engine, Read read) {
  std::vector<double> numbers(3 * engine.particles().ids().size());
  (engine.particles().*read)(numbers);
  return nb::cast(make_vector3_array(std::move(numbers)));
}

void assign_rows(System& engine, nb::handle values, const char* name,
                 void (Particles::*assign)(ParticleId, const Vec3&)) {
  const std::vector<ParticleId> particles = engine.particles().ids();
  const std::vector<double> numbers = rows(values, particles.size(), name);
  for (std::size_t i = 0; i < particles.size(); ++i)
    (engine.particles().*assign)(particles[i], Vec3{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
}

/// Keeps the system, for its bodies.
struct IslandView {
  IslandReport report;
  nb::object system_object;
  SystemObject* system;
};

void bind_islands(nb::module_& module) {
  const auto field = [](auto member) { return [member](const IslandView& self) { return self.report.*member; }; };
  using R = IslandReport;
  nb::class_<IslandView>(module, "IslandReport",
                         "Cost and quality of the last step of bodies that were solved together; see `System.islands`.")
      .def_prop_ro(
          "bodies",
          [](const IslandView& self) {
            return wrap_all<BodyHandle>(self.system_object, self.system, self.report.bodies);
          },
          "Those that still exist.")
      .def_prop_ro("points", field(&R::points), "Unknown ones.")
      .def_prop_ro("resting", field(&R::resting), "Asleep: nothing was solved.")
      .def_prop_ro("iterations", field(&R::iterations),
                   "Of Newton's method, each with one linear solve; in mode 'accurate' linear solves.")
      .def_prop_ro("substeps", field(&R::substeps))
      .def_prop_ro("fallbacks", field(&R::fallbacks), "See `StepReport.fallbacks`.")
      .def_prop_ro("converged", field(&R::converged), "False: left with a least violation instead of a solution.")
      .def_prop_ro("cut_short", field(&R::cut_short), "The budget ended before the solution.")
      .def_prop_ro("approximate", field(&R::approximate), "See `StepReport.approximate`.")
      .def_prop_ro("gap", field(&R::gap), "Largest violation of a constraint at the end, m.")
      .def_prop_ro("error", field(&R::error), "See `StepReport.error`.")
      .def_prop_ro("lost", field(&R::lost), "Energy, by the integration scheme, J.")
      .def_prop_ro("made", field(&R::made), "Energy, by the integration scheme, J: a defect.")
      .def("__repr__", [](const IslandView& self) {
        const IslandReport& r = self.report;
        char text[160];
        std::snprintf(text, sizeof text, "<IslandReport: %d bodies, %d iterations, %d sub-steps, gap %.3g m%s%s%s>",
                      static_cast<int>(r.bodies.size()), r.iterations, r.substeps, r.gap,
                      r.converged ? "" : ", not converged", r.cut_short ? ", cut short" : "",
                      r.approximate ? ", approximate" : "");
        return std::string(text);
      });
}

/// Changes one limit of the budget and keeps the others.
template <class Value>
void set_budget(SystemObject& self, const char* what, Value StepBudget::* limit, Value value) {
  System& engine = self.use_between_steps(what);
  StepBudget budget = engine.budget();
  budget.*limit = value;
  engine.set_budget(budget);
}

void bind_settings(nb::class_<SystemObject>& type) {
  type.def_prop_rw(
          "gravity", [](SystemObject& self) { return self.use().gravity(); },
          [](SystemObject& self, VectorArgument v) {
            self.use_between_steps("gravity = ...").set_gravity(to_vec3(v, "gravity"));
          },
          nb::for_setter(nb::arg("value")), "m/s^2")
      .def_prop_rw(
          "mode", [](SystemObject& self) { return ModeWord{to_word(mode_words, self.use().mode())}; },
          [](SystemObject& self, const ModeWord& mode) {
            self.use_between_steps("mode = ...").set_mode(to_mode(mode));
          },
          "'plausible', 'robust', 'energy_keeping' or 'accurate'; can be changed at any time")
      .def_prop_rw(
          "tolerance", [](SystemObject& self) { return self.use().tolerance(); },
          [](SystemObject& self, double value) { self.use_between_steps("tolerance = ...").set_tolerance(value); },
          "Of mode 'accurate', 1e-12 to 1: the estimated local error of positions that the sub-steps of a second may add, in\n"
          "mean lengths of the links (and springs) that are solved together. The motion may amplify it. See\n"
          "`StepReport.error`.")
      .def_prop_rw(
          "budget_iterations", [](SystemObject& self) { return self.use().budget().iterations; },
          [](SystemObject& self, int value) {
            set_budget(self, "budget_iterations = ...", &StepBudget::iterations, value);
          },
          "Most iterations of Newton's method in a step for bodies that are solved together; 0: unlimited. Results are\n"
          "repeatable. If it ends before the solution, the points move on and stay together as well as possible:\n"
          "`StepReport.cut_short` counts that, and `islands` tells where and how wide the gaps are.")
      .def_prop_rw(
          "budget_contacts", [](SystemObject& self) { return self.use().budget().contacts; },
          [](SystemObject& self, double value) {
            set_budget(self, "budget_contacts = ...", &StepBudget::contacts,
                       finite_not_negative(value, "budget_contacts", "multiplications"));
          },
          "Multiplications that a step may take to solve the contacts of bodies that nothing else connects, all together\n"
          "and exactly; 0: unlimited. A heap that would take more is solved approximately, contact by contact, in time\n"
          "that is linear in its size, and so is a machine in a step that takes many times more: `StepReport.approximate`\n"
          "counts that. What a step takes beyond this the next ones have less. Results are repeatable.")
      .def_prop_rw(
          "contacts_share", [](SystemObject& self) { return self.use().budget().contacts_share; },
          [](SystemObject& self, double value) {
            set_budget(self, "contacts_share = ...", &StepBudget::contacts_share, value);
          },
          "The part of `budget_contacts` that steps may take now, above 0 to 1: a world that has to keep its pace lowers it,\n"
          "see `Levels`.")
      .def_prop_rw(
          "budget_seconds", [](SystemObject& self) { return self.use().budget().seconds; },
          [](SystemObject& self, double value) {
            set_budget(self, "budget_seconds = ...", &StepBudget::seconds,
                       finite_not_negative(value, "budget_seconds", "s"));
          },
          "s of real time that a step may search for solutions, 0: unlimited; otherwise as `budget_iterations`. Results\n"
          "depend on the machine.")
      .def_prop_rw(
          "solver", [](SystemObject& self) { return self.use().solver(); },
          [](SystemObject& self, const std::string& name) { self.use_between_steps("solver = ...").set_solver(name); },
          "The solver of the equations of each step: 'direct' (the built-in sparse Newton), 'newton', 'kinsol' or a\n"
          "solver of the script, see iota.solver. All but 'direct' get dense arrays and are far slower. If they find\n"
          "no root, the step is solved directly, with a warning in the report.")
      .def_prop_rw(
          "damping", [](SystemObject& self) { return self.use().damping(); },
          [](SystemObject& self, double value) {
            self.use_between_steps("damping = ...").set_damping(finite_not_negative(value, "damping", "1/s"));
          },
          "1/s: all velocities fall by exp(-damping t).")
      .def_prop_rw(
          "rest_after", [](SystemObject& self) { return self.use().rest().after; },
          [](SystemObject& self, double value) {
            System& engine = self.use_between_steps("rest_after = ...");
            engine.set_rest({finite_not_negative(value, "rest_after", "s"), engine.rest().speed});
          },
          "s, 0 for never: bodies tied by hinges or bonds fall asleep together when none of their particles has been\n"
          "faster than `rest_speed` for that long. They are then 'resting', do not move, and cost nothing. An edit,\n"
          "an assigned velocity, a grip, an applied force (that of a function too), a moving nail or scripted body,\n"
          "another gravity or a bond whose force changes with the time wakes them.")
      .def_prop_rw(
          "rest_speed", [](SystemObject& self) { return self.use().rest().speed; },
          [](SystemObject& self, double value) {
            System& engine = self.use_between_steps("rest_speed = ...");
            engine.set_rest({engine.rest().after, finite_not_negative(value, "rest_speed", "m/s")});
          },
          "m/s, see `rest_after`.")
      .def_prop_rw(
          "usual_radius", [](SystemObject& self) { return self.use().usual_radius(); },
          [](SystemObject& self, double value) {
            self.use_between_steps("usual_radius = ...").set_usual_radius(finite_positive(value, "usual_radius", "m"));
          },
          "m, of the lines of bodies without a radius of their own, see `Body.radius`. Chosen once, at the begin of the\n"
          "first step that finds a body: 0.06 of the median length of rods, without rods 0.02 of the extent of all\n"
          "particles, 0.03 m for a single place. Before that step: as it would be chosen now.")
      .def_prop_rw(
          "threads", [](SystemObject& self) { return self.use().threads(); },
          [](SystemObject& self, int value) { self.use_between_steps("threads = ...").set_threads(value); },
          "Number of threads for a step; assign 0 for one per core. Not part of the state: results are the same bits.");
}

void bind_readings(nb::class_<SystemObject>& type) {
  type.def_prop_ro(
          "time", [](SystemObject& self) { return self.use().time(); }, "Simulated time, s.")
      .def_prop_ro("step_count", [](SystemObject& self) { return self.use().step_count(); })
      .def_prop_ro(
          "scene_version", [](SystemObject& self) { return self.use().viewer().scene_version(); },
          "As structure_version, without births and deaths of sparks: changes when a page's list of bodies does.")
      .def_prop_ro(
          "structure_version", [](SystemObject& self) { return self.use().structure_version(); },
          "Rises with each batch of structural edits.")
      .def_prop_ro("energy", [](SystemObject& self) { return self.use().energy(); })
      .def_prop_ro(
          "momentum", [](SystemObject& self) { return self.use().momentum(); }, "kg m/s")
      .def_prop_ro(
          "angular_momentum", [](SystemObject& self) { return self.use().angular_momentum(); },
          "About the origin, kg m^2/s.")
      .def_prop_ro(
          "worst_gap", [](SystemObject& self) { return self.use().worst_gap(); },
          "Largest hinge separation or rigidity error, m.")
      .def_prop_ro(
          "articulate_count", [](SystemObject& self) { return self.use().bodies().articulate_count(); },
          "Number of groups of bodies connected by hinges.")
      .def_prop_ro(
          "closing_count", [](SystemObject& self) { return self.use().edits().closing_count(); },
          "Pairs of particles that are still closing after `combine(p, q, over)`.")
      .def_prop_rw(
          "positions", [](SystemObject& self) { return read_rows(self.use(), &Particles::read_positions); },
          [](SystemObject& self, nb::handle values) {
            assign_rows(self.use_between_steps("positions = ..."), values, "positions", &Particles::set_position);
          },
          nb::for_getter(nb::sig("def positions(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def positions(self, value: numpy.typing.ArrayLike, /) -> None")),
          "Places of all particles, m: float64, shape (n, 3), in the order of `particles`. A copy; assign to set\n"
          "them. Particles of one ring move together, so the last value is used.")
      .def_prop_rw(
          "velocities", [](SystemObject& self) { return read_rows(self.use(), &Particles::read_velocities); },
          [](SystemObject& self, nb::handle values) {
            assign_rows(self.use_between_steps("velocities = ..."), values, "velocities", &Particles::set_velocity);
          },
          nb::for_getter(nb::sig("def velocities(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def velocities(self, value: numpy.typing.ArrayLike, /) -> None")),
          "As `positions`, in m/s.");
}

void bind_poses(nb::class_<SystemObject>& type) {
  type.def(
      "poses",
      [](SystemObject& self) {
        const PoseSnapshot snapshot = self.use().viewer().poses();
        const std::size_t count = snapshot.bodies.size();
        auto* slots = new std::uint32_t[count];
        auto* places = new float[count * 7];
        for (std::size_t i = 0; i < count; ++i) {
          slots[i] = snapshot.bodies[i].body;
          std::copy_n(snapshot.bodies[i].position, 3, places + 7 * i);
          std::copy_n(snapshot.bodies[i].orientation, 4, places + 7 * i + 3);
        }
        nb::capsule slot_owner(slots, [](void* p) noexcept { delete[] static_cast<std::uint32_t*>(p); });
        nb::capsule place_owner(places, [](void* p) noexcept { delete[] static_cast<float*>(p); });
        return nb::make_tuple(nb::ndarray<nb::numpy, std::uint32_t, nb::ndim<1>>(slots, {count}, slot_owner),
                              nb::ndarray<nb::numpy, float, nb::shape<-1, 7>>(places, {count, 7}, place_owner));
      },
      nb::sig("def poses(self) -> tuple[numpy.typing.NDArray[numpy.uint32], numpy.typing.NDArray[numpy.float32]]"),
      "Drawn pose of each body: slots, uint32 (n,), and float32 (n, 7): center of mass (m) and unit quaternion\n"
      "x y z w. A body whose particles lie on one line has its local +x from its first particle to its last.");
}

void bind_time(nb::class_<SystemObject>& type) {
  type.def(
          "step", [](SystemObject& self, double dt, int count) { return self.step(dt, count); }, "dt"_a = 1.0 / 120,
          "count"_a = 1,
          "Advances by dt seconds, 0 < dt <= 1, `count` times. Never raises for numerical reasons: see the report.\n"
          "The report of several steps has the energy of the last, sums of counts and the largest gap.\n\n"
          "Raises BondError, after the step is done and without the steps after it, for a bond whose function raised\n"
          "or that had no finite force, ForceError for a function of many bonds or particles; failed forces are\n"
          "switched off. See `force_errors`.")
      .def_prop_rw(
          "force_errors", [](SystemObject& self) { return self.use(), self.warn_of_forces ? "warn" : "raise"; },
          [](SystemObject& self, const std::string& value) {
            if (value != "raise" && value != "warn") {
              const std::string text = "force_errors must be 'raise' or 'warn', not '" + value + "'";
              throw nb::value_error(text.c_str());
            }
            self.use(), self.warn_of_forces = value == "warn";
          },
          "'raise' (default): `step` raises for forces that fail. 'warn': it issues a ForceWarning.")
      .def(
          "snapshot",
          [](SystemObject& self) {
            const Snapshot snapshot = self.use_between_steps("snapshot").snapshot();
            return nb::bytes(snapshot.bytes.data(), snapshot.bytes.size());
          },
          "The whole system in bytes, except functions of the script (of bonds, laws, fields, surfaces).")
      .def(
          "restore",
          [](SystemObject& self, const nb::bytes& data) {
            const auto* bytes = reinterpret_cast<const std::byte*>(data.c_str());
            self.use_between_steps("restore").restore(Snapshot{{bytes, bytes + data.size()}});
          },
          "snapshot"_a,
          "Restores a snapshot; handles from then are valid again. Functions of the script stay those of\n"
          "this system. Raises ValueError for bytes that are not a snapshot, or whose tables are inconsistent; the\n"
          "system is then unchanged.")
      .def(
          "state_hash", [](SystemObject& self) { return self.use().state_hash(); },
          "64 bits of the whole state: equal for equal runs.")
      .def(
          "start_recording", [](SystemObject& self) { self.use_between_steps("start_recording").record().start(); },
          "Records all edits and inputs from now on, and the hash after each step.")
      .def(
          "stop_recording", [](SystemObject& self) { return self.use_between_steps("stop_recording").record().stop(); },
          "The Recording since `start_recording`.")
      .def(
          "replay",
          [](SystemObject& self, const Recording& recording) {
            return self.use_between_steps("replay").record().replay(recording);
          },
          "recording"_a,
          "Restores the recording's start and repeats its commands. Returns the number of the first step with another\n"
          "hash, None if all are equal.")
      .def(
          "islands",
          [](nb::handle_t<SystemObject> self) {
            std::vector<IslandView> out;
            SystemObject* const system = nb::inst_ptr<SystemObject>(self);
            for (IslandReport& report : system->use().islands())
              out.push_back({std::move(report), nb::borrow(self), system});
            return out;
          },
          "Cost and quality of the last step of each island (bodies that were solved together; no free particles).\n"
          "Empty before the first step and after `restore`.")
      .def(
          "diagnose",
          [](SystemObject& self, const BodyHandle& body) {
            if (body.system != &self) throw nb::value_error("diagnose: the body belongs to another system");
            body.use();
            return self.use_between_steps("diagnose").diagnose(body.id);
          },
          "body"_a,
          "Singular values, rank, redundancy and degrees of freedom of the constraints of a body and of all bodies\n"
          "solved together with it, at present. Changes nothing; takes seconds for hundreds of rows, ValueError above "
          "600.")
      .def(
          "validate", [](SystemObject& self) { return self.use_between_steps("validate").validate(); },
          "Checks the whole structure; one sentence per inconsistency.")
      .def("adopt", &SystemObject::adopt, "Makes the calling thread the owner. Raises RuntimeError during a step.");
}

}  // namespace

void bind_system(nb::module_& module) {
  bind_islands(module);
  nb::class_<SystemObject> type(module, "System", system_doc, nb::type_slots(system_slots),
                                nb::is_weak_referenceable());
  type.def(
      "__init__",
      [](SystemObject* self, VectorArgument gravity, const ModeWord& mode, double damping, int threads) {
        SystemOptions options;
        options.gravity = to_vec3(gravity, "gravity");
        options.mode = to_mode(mode);
        options.damping = finite_not_negative(damping, "damping", "1/s");
        options.threads = threads;
        new (self) SystemObject(options);
      },
      "gravity"_a = nb::make_tuple(0.0, -9.81, 0.0), "mode"_a = ModeWord{"energy_keeping"}, "damping"_a = 0.0,
      "threads"_a = 0);
  bind_settings(type);
  bind_readings(type);
  bind_poses(type);
  bind_time(type);
  def_fields(type);
  type.def("__repr__", [](SystemObject& self) {
    if (self.owner != std::this_thread::get_id()) return std::string("<System of another thread>");
    return "<System: " + std::to_string(self.engine.bodies().ids().size()) + " bodies in " +
           std::to_string(self.engine.bodies().articulate_count()) + " articulates at " +
           std::to_string(self.engine.time()) + " s>";
  });
}

}  // namespace iota::bindings
