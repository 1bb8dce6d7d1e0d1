// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "restructure_result.h"

namespace iota::bindings {

namespace {

/// The context manager of `System.edit`.
struct EditScope {
  nb::object system_object;
  SystemObject* system = nullptr;
  bool undoable = true;
  std::optional<RestructureReport> report;
};

constexpr const char* scope_doc =
    "A batch of edits: `with system.edit() as edit: ...`. They have one report and are undone together, or, if they are not\n"
    "undoable, not by themselves: an undo goes to before the last batch that is. If the block raises, the system is restored.\n"
    "A batch within a batch is part of it.";

}  // namespace

void bind_edits(nb::module_& module) {
  nb::class_<EditScope>(module, "Edit", scope_doc, nb::type_slots(handle_slots<EditScope>))
      .def(
          "__enter__",
          [](nb::handle_t<EditScope> self) {
            const EditScope& scope = *nb::inst_ptr<EditScope>(self);
            scope.system->use_between_steps("edit").edits().begin(scope.undoable);
            return nb::borrow(self);
          },
          nb::sig("def __enter__(self) -> Edit"))
      .def(
          "__exit__",
          [](EditScope& self, nb::handle type, nb::handle, nb::handle) {
            System& engine = self.system->use_between_steps("edit");
            if (!engine.edits().is_open()) return;
            if (type.is_none())
              self.report = engine.edits().end();
            else
              engine.edits().cancel();
          },
          "type"_a.none(), "value"_a.none(), "traceback"_a.none(),
          nb::sig("def __exit__(self, type: object, value: object, traceback: object) -> None"))
      .def_prop_ro(
          "report",
          [](const EditScope& self) {
            if (!self.report) raise_runtime("the report of an edit is available after its block");
            return RestructureResult{self.system_object, self.system, *self.report};
          },
          "RestructureReport of all edits in the block, available after it.");

  auto system = nb::borrow<nb::class_<SystemObject>>(module.attr("System"));
  system
      .def(
          "edit",
          [](nb::handle_t<SystemObject> self, bool undoable) {
            return EditScope{nb::borrow(self), nb::inst_ptr<SystemObject>(self), undoable, std::nullopt};
          },
          nb::kw_only(), "undoable"_a = true, nb::sig("def edit(self, *, undoable: bool = True) -> Edit"), scope_doc)
      .def(
          "undo", [](SystemObject& self) { return self.use_between_steps("undo").edits().undo(); },
          "Restores the state before the last batch of edits, time included; handles from then are valid again. A\n"
          "batch saves the whole state before it: at most 64, and 256 MiB, are kept. `restore` and `start_recording`\n"
          "drop them. False if there is none.")
      .def(
          "redo", [](SystemObject& self) { return self.use_between_steps("redo").edits().redo(); },
          "Undoes the last `undo`. False if there is none, or there were edits since.")
      .def_prop_ro(
          "step_edits",
          [](nb::handle_t<SystemObject> self) -> std::optional<RestructureResult> {
            SystemObject* object = nb::inst_ptr<SystemObject>(self);
            object->use();
            if (!object->step_edits) return std::nullopt;
            return RestructureResult{nb::borrow(self), object, *object->step_edits};
          },
          "One report of all edits that were requested during the last step and made right after it; None without any.")
      .def_prop_ro("undo_count", [](SystemObject& self) { return self.use().edits().undo_count(); })
      .def_prop_ro("redo_count", [](SystemObject& self) { return self.use().edits().redo_count(); });
}

}  // namespace iota::bindings
