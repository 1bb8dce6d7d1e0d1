// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "pickled.h"
#include "restructure_result.h"

#include <iota/step_times.h>

#include <memory>

namespace iota::bindings {

namespace {

std::string text_of(const char* format, auto... values) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

template <class Pairs>
auto wrap_pairs(const RestructureResult& self, const Pairs& pairs) {
  std::vector<std::pair<nb::object, nb::object>> out;
  for (const auto& pair : pairs)
    out.emplace_back(nb::cast(sibling(self, pair.retired)), nb::cast(sibling(self, pair.survivor)));
  return out;
}

void bind_energy(nb::module_& module) {
  nb::class_<Energy> type(module, "Energy",
                          "Energy balance in J. Each gain and loss is counted where it occurs; `balance` is constant "
                          "up to round-off.");
  def_pickled(type, &Energy::kinetic, &Energy::potential, &Energy::dissipated, &Energy::lost, &Energy::made,
              &Energy::external_work, &Energy::edits);
  type.def(
          "__init__",
          [](Energy* self, double kinetic, double potential, double dissipated, double lost, double made,
             double external_work,
             double edits) { new (self) Energy{kinetic, potential, dissipated, lost, made, external_work, edits}; },
          nb::kw_only(), "kinetic"_a = 0.0, "potential"_a = 0.0, "dissipated"_a = 0.0, "lost"_a = 0.0, "made"_a = 0.0,
          "external_work"_a = 0.0, "edits"_a = 0.0)
      .def_ro("kinetic", &Energy::kinetic)
      .def_ro("potential", &Energy::potential,
              "Of gravity, springs, and all bonds, fields and pairs whose law has an energy.")
      .def_ro("dissipated", &Energy::dissipated,
              "Since the start, work of damping, dashpots, friction, laws and impacts.")
      .def_ro("lost", &Energy::lost, "Since the start, by the integration scheme; may decrease within its tolerance.")
      .def_ro("made", &Energy::made,
              "Since the start, by the integration scheme: a defect, with a warning in the report.")
      .def_ro("external_work", &Energy::external_work,
              "Since the start, by grips, scripted bonds, moved nails and applied forces; also the error of holding a\n"
              "force with an energy, see docs/forces.md.")
      .def_ro("edits", &Energy::edits, "Since the start, gained (+) or lost (-) by edits.")
      .def_prop_ro("total", &Energy::total, "kinetic + potential.")
      .def_prop_ro("balance", &Energy::balance,
                   "kinetic + potential + dissipated + lost - made - external_work - edits: constant.")
      .def("__repr__", [](const Energy& e) {
        return text_of(
            "<Energy: kinetic %.6g J, potential %.6g J, dissipated %.6g J, lost %.6g J, made %.6g J, external work %.6g J, "
            "edits %.6g J>",
            e.kinetic, e.potential, e.dissipated, e.lost, e.made, e.external_work, e.edits);
      });
}

/// The context manager of `StepTimes`.
struct StepTimesScope {
  StepTimes times;
  std::unique_ptr<TimedSteps> timed = {};
};

template <class Member>
auto time_of(Member StepTimes::* part) {
  return [part](const StepTimesScope& self) { return self.times.*part; };
}

void bind_step_times(nb::module_& module) {
  nb::class_<StepTimesScope>(
      module, "StepTimes",
      "Where the time of steps goes, s: of all steps that this thread takes in a with block, of any\n"
      "system. They read the clock several times an iteration. Islands may be solved on several\n"
      "threads: their times are summed.\n\n"
      "    with iota.types.StepTimes() as times:\n"
      "        system.step()\n"
      "    print(times)")
      .def(nb::init<>())
      .def(
          "__enter__",
          [](nb::handle_t<StepTimesScope> self) {
            auto& scope = *nb::inst_ptr<StepTimesScope>(self);
            if (scope.timed) raise_runtime("these StepTimes are in use");
            scope.timed = std::make_unique<TimedSteps>(scope.times);
            return nb::borrow(self);
          },
          nb::sig("def __enter__(self) -> StepTimes"))
      .def(
          "__exit__", [](StepTimesScope& self, nb::handle, nb::handle, nb::handle) { self.timed.reset(); },
          "type"_a.none(), "value"_a.none(), "traceback"_a.none(),
          nb::sig("def __exit__(self, type: object, value: object, traceback: object) -> None"))
      .def_prop_ro("forces", time_of(&StepTimes::forces),
                   "Held forces; forces and constraints in the equations of a step.")
      .def_prop_ro("analyze", time_of(&StepTimes::analyze),
                   "Islands, and the structure of their matrices; only after changes.")
      .def_prop_ro("factor", time_of(&StepTimes::factor),
                   "Assembling and factoring matrices, with the first half of the solution for one right side.")
      .def_prop_ro("solve", time_of(&StepTimes::solve), "The other solutions with these factors.")
      .def_prop_ro("integrate", time_of(&StepTimes::integrate),
                   "All else: loading and storing islands, guesses, energies, edits, the report.")
      .def_prop_ro("total", [](const StepTimesScope& self) { return self.times.total(); })
      .def("__repr__", [](const StepTimesScope& self) {
        const StepTimes& t = self.times;
        return text_of("<StepTimes: forces %.3g s, analyze %.3g s, factor %.3g s, solve %.3g s, integrate %.3g s>",
                       t.forces, t.analyze, t.factor, t.solve, t.integrate);
      });
}

void bind_step_report(nb::module_& module) {
  nb::class_<StepReport> type(module, "StepReport",
                              "Result of one `System.step`. Non-convergence is a result, not an exception. It can be "
                              "pickled.");
  // The part that scripts see; of births and deaths only the number.
  const std::tuple seen{
      &StepReport::step,           &StepReport::time,         &StepReport::dt,        &StepReport::iterations_mean,
      &StepReport::iterations_max, &StepReport::substeps_max, &StepReport::fallbacks, &StepReport::unconverged,
      &StepReport::cut_short,      &StepReport::approximate,  &StepReport::error,     &StepReport::worst_gap,
      &StepReport::energy,         &StepReport::articulates,  &StepReport::resting,   &StepReport::structure_version,
      &StepReport::impact,         &StepReport::warnings};
  type.def(
          "__getstate__",
          [seen](const StepReport& r) { return nb::make_tuple(get_state(r, seen), r.born.size(), r.died.size()); },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [seen](StepReport& self, const nb::tuple& state) {
            auto& report = *new (&self) StepReport{};
            set_state(report, seen, state[0]);
            report.born.resize(nb::cast<std::size_t>(state[1]));
            report.died.resize(nb::cast<std::size_t>(state[2]));
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"))
      .def(
          "__init__",
          [](StepReport* self, std::uint64_t step, double time, double dt, const Energy& energy, double worst_gap,
             std::vector<std::string> warnings) {
            StepReport report;
            report.step = step, report.time = time, report.dt = dt, report.energy = energy;
            report.worst_gap = worst_gap, report.warnings = std::move(warnings);
            new (self) StepReport(std::move(report));
          },
          nb::kw_only(), "step"_a, "time"_a, "dt"_a, "energy"_a = Energy{}, "worst_gap"_a = 0.0,
          "warnings"_a = std::vector<std::string>{}, "For simulators of the script, see iota.Simulator.")
      .def_ro("step", &StepReport::step, "Number of the step just finished, from 1.")
      .def_ro("time", &StepReport::time, "Simulated time at its end, s.")
      .def_ro("dt", &StepReport::dt, "Its length, s.")
      .def_ro("iterations_mean", &StepReport::iterations_mean, "Newton iterations per articulate and (sub-)step.")
      .def_ro("iterations_max", &StepReport::iterations_max)
      .def_ro("substeps_max", &StepReport::substeps_max, "Largest number of sub-steps of an articulate.")
      .def_ro("fallbacks", &StepReport::fallbacks,
              "(Sub-)steps that the robust scheme took in place of the energy-keeping one.")
      .def_ro("unconverged", &StepReport::unconverged, "Articulates left with a least violation instead of a solution.")
      .def_ro("cut_short", &StepReport::cut_short,
              "Islands whose budget ended before their solution: see `System.budget_iterations` and `System.islands`.")
      .def_ro("approximate", &StepReport::approximate,
              "Islands whose contacts were solved one by one, as they are too many: see `System.budget_contacts`.")
      .def_ro(
          "error", &StepReport::error,
          "Of mode 'accurate': the largest estimate of the local error of an island, in mean lengths of its links per\n"
          "second; at most `System.tolerance`. Infinite, that is unknown, if contacts were solved one by one, or sub-steps\n"
          "became too short or fell back.")
      .def_ro("worst_gap", &StepReport::worst_gap, "Largest hinge separation or rigidity error, m.")
      .def_ro("energy", &StepReport::energy)
      .def_ro("articulates", &StepReport::articulates)
      .def_prop_ro(
          "births", [](const StepReport& r) { return r.born.size(); }, "Particles made by emitters.")
      .def_prop_ro(
          "deaths", [](const StepReport& r) { return r.died.size(); }, "Particles whose lifetime ended.")
      .def_ro("resting", &StepReport::resting, "Bodies asleep.")
      .def_ro("impact", &StepReport::impact, "The hardest touch that began; its speed is 0 if none did.")
      .def_ro("structure_version", &StepReport::structure_version)
      .def_ro("warnings", &StepReport::warnings, "Plain sentences.")
      .def("__repr__", [](const StepReport& r) {
        return text_of("<StepReport: step %llu, %.6g s, %d articulates, gap %.3g m, %.3g iterations, energy %.6g J>",
                       static_cast<unsigned long long>(r.step), r.time, static_cast<int>(r.articulates), r.worst_gap,
                       r.iterations_mean, r.energy.total());
      });
}

template <class Member>
auto field(Member RestructureReport::* member) {
  return [member](const RestructureResult& self) { return self.report.*member; };
}

template <KindName kind>
nb::object id_state(Id<kind> id) {
  return nb::make_tuple(id.slot, id.generation);
}
template <class Absorbed>
nb::object id_state(const Absorbed& pair) {
  return nb::make_tuple(id_state(pair.retired), id_state(pair.survivor));
}
template <KindName kind>
void read_id(Id<kind>& id, nb::handle state) {
  id.slot = nb::cast<std::uint32_t>(state[0]), id.generation = nb::cast<std::uint32_t>(state[1]);
}
template <class Absorbed>
void read_id(Absorbed& pair, nb::handle state) {
  read_id(pair.retired, state[0]), read_id(pair.survivor, state[1]);
}

/// Calls visit(list) for each list of ids of a report.
template <class Report, class Visit>
void for_each_list(Report& report, Visit visit) {
  visit(report.created_bodies), visit(report.created_particles), visit(report.destroyed_bodies);
  visit(report.destroyed_particles), visit(report.absorbed_bodies), visit(report.absorbed_particles);
}

/// Copies keep the system; pickles cannot.
void def_state(nb::class_<RestructureResult>& type) {
  using R = RestructureReport;
  const std::tuple seen{&R::queued,
                        &R::changed,
                        &R::structure_version,
                        &R::articulates_before,
                        &R::articulates_after,
                        &R::closed_distance,
                        &R::remaining_gap,
                        &R::energy_change,
                        &R::momentum_change,
                        &R::angular_momentum_change,
                        &R::notes};
  type.def("__copy__", [](const RestructureResult& self) { return self; })
      .def(
          "__deepcopy__", [](const RestructureResult& self, nb::handle) { return self; }, "memo"_a)
      .def(
          "__getstate__",
          [seen](const RestructureResult& self) {
            nb::list lists;
            for_each_list(self.report, [&](const auto& ids) {
              nb::list list;
              for (const auto& id : ids) list.append(id_state(id));
              lists.append(list);
            });
            return nb::make_tuple(get_state(self.report, seen), lists);
          },
          nb::sig("def __getstate__(self) -> tuple[typing.Any, ...]"))
      .def(
          "__setstate__",
          [seen](RestructureResult& self, const nb::tuple& state) {
            auto& result = *new (&self) RestructureResult{};
            set_state(result.report, seen, state[0]);
            std::size_t next = 0;
            for_each_list(result.report, [&](auto& ids) {
              for (nb::handle id : state[1][next++]) read_id(ids.emplace_back(), id);
            });
          },
          nb::sig("def __setstate__(self, state: tuple[typing.Any, ...], /) -> None"));
}

void bind_restructure_report(nb::module_& module) {
  nb::class_<RestructureResult> type(
      module, "RestructureReport",
      "Result of one structural edit. True if it changed something. Pickled it keeps everything except "
      "the system: its handles then have only their slots.",
      nb::type_slots(handle_slots<RestructureResult>));
  def_state(type);
  type.def("__bool__", field(&RestructureReport::changed))
      .def_prop_ro("queued", field(&RestructureReport::queued),
                   "True if it was requested during a step: it is made right after it, and the rest is not known yet.")
      .def_prop_ro("changed", field(&RestructureReport::changed),
                   "False if there was nothing to do, e.g. separating unrelated particles.")
      .def_prop_ro("structure_version", field(&RestructureReport::structure_version))
      .def_prop_ro("created_bodies",
                   [](const RestructureResult& self) {
                     return wrap_all<BodyHandle>(self.system_object, self.system, self.report.created_bodies);
                   })
      .def_prop_ro("created_particles",
                   [](const RestructureResult& self) {
                     return wrap_all<ParticleHandle>(self.system_object, self.system, self.report.created_particles);
                   })
      .def_prop_ro(
          "destroyed_bodies",
          [](const RestructureResult& self) {
            return wrap_all<BodyHandle>(self.system_object, self.system, self.report.destroyed_bodies);
          },
          "Of a batch of edits.")
      .def_prop_ro(
          "destroyed_particles",
          [](const RestructureResult& self) {
            return wrap_all<ParticleHandle>(self.system_object, self.system, self.report.destroyed_particles);
          },
          "Of a batch of edits.")
      .def_prop_ro(
          "absorbed_bodies",
          [](const RestructureResult& self) { return wrap_pairs(self, self.report.absorbed_bodies); },
          nb::sig("def absorbed_bodies(self) -> list[tuple[Body, Body]]"), "Pairs (retired, survivor).")
      .def_prop_ro(
          "absorbed_particles",
          [](const RestructureResult& self) { return wrap_pairs(self, self.report.absorbed_particles); },
          nb::sig("def absorbed_particles(self) -> list[tuple[Particle, Particle]]"), "Pairs (retired, survivor).")
      .def_prop_ro("articulates_before", field(&RestructureReport::articulates_before), "Of the whole system.")
      .def_prop_ro("articulates_after", field(&RestructureReport::articulates_after), "Of the whole system.")
      .def_prop_ro("closed_distance", field(&RestructureReport::closed_distance),
                   "Former distance of the combined particles, m.")
      .def_prop_ro("remaining_gap", field(&RestructureReport::remaining_gap), "Gap that could not be closed, m.")
      .def_prop_ro("energy_change", field(&RestructureReport::energy_change), "J")
      .def_prop_ro("momentum_change", field(&RestructureReport::momentum_change),
                   "kg m/s, not conserved because of nails.")
      .def_prop_ro("angular_momentum_change", field(&RestructureReport::angular_momentum_change),
                   "About the origin, kg m^2/s, not conserved because of nails.")
      .def_prop_ro("notes", field(&RestructureReport::notes), "Plain sentences.")
      .def("__repr__", [](const RestructureResult& self) {
        const RestructureReport& r = self.report;
        if (r.queued) return std::string("<RestructureReport: queued until the end of the step>");
        if (!r.changed) return std::string("<RestructureReport: nothing to do>");
        return text_of("<RestructureReport: %u articulates (before: %u), energy %+.3g J, structure version %u>",
                       r.articulates_after, r.articulates_before, r.energy_change, r.structure_version);
      });
}

void bind_diagnosis(nb::module_& module) {
  nb::class_<Diagnosis> type(
      module, "Diagnosis",
      "Analysis of conflicting and redundant constraints of bodies that are solved together: a\n"
      "singular value decomposition of their Jacobian, scaled so that figures do not depend on units.");
  def_pickled(type, &Diagnosis::unknowns, &Diagnosis::rows, &Diagnosis::rank, &Diagnosis::redundancy,
              &Diagnosis::degrees_of_freedom, &Diagnosis::singular_values, &Diagnosis::condition,
              &Diagnosis::kkt_condition, &Diagnosis::findings);
  type.def_ro("unknowns", &Diagnosis::unknowns, "Coordinates of points.")
      .def_ro("rows", &Diagnosis::rows, "Of active constraints: without open stops and slack ropes.")
      .def_ro("rank", &Diagnosis::rank, "Singular values above 1e-8 of the largest.")
      .def_ro("redundancy", &Diagnosis::redundancy, "rows - rank")
      .def_ro("degrees_of_freedom", &Diagnosis::degrees_of_freedom, "unknowns - rank")
      .def_ro("singular_values", &Diagnosis::singular_values, "Falling.")
      .def_ro("condition", &Diagnosis::condition, "Largest singular value over the smallest one in the rank.")
      .def_ro("kkt_condition", &Diagnosis::kkt_condition, "Of the matrix that a step solves, stiffness left out.")
      .def_ro("findings", &Diagnosis::findings, "Plain sentences that name bodies, particles and constraints.")
      .def("__repr__", [](const Diagnosis& d) {
        return text_of("<Diagnosis: %u degrees of freedom, rank %u of %u rows, condition %.3g>", d.degrees_of_freedom,
                       d.rank, d.rows, d.condition);
      });
}

}  // namespace

void bind_reports(nb::module_& module) {
  bind_diagnosis(module);
  bind_energy(module);
  bind_step_times(module);
  bind_step_report(module);
  bind_restructure_report(module);
}

}  // namespace iota::bindings
