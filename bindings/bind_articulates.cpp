// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

namespace iota::bindings {

namespace {

constexpr const char* articulate_doc =
    "A group of bodies connected by hinges, at present: an edit may make it larger or smaller. Two are\n"
    "equal while their bodies are connected.\n\n"
    "    if hook.body.articulate != eye.body.articulate:\n"
    "        hook.combine(eye)";

/// Represented by any of its bodies.
struct ArticulateView {
  BodyHandle body;

  std::uint32_t number() const { return body.use().bodies().articulate(body.id); }
  std::vector<BodyHandle> bodies() const {
    return wrap_all<BodyHandle>(body.system_object, body.system, body.use().bodies().articulate_of(body.id));
  }
  bool contains(const BodyHandle& other) const {
    return other.system == body.system && other.use().bodies().articulate(other.id) == number();
  }
};

BodyHandle& holder_of(ArticulateView& articulate) { return articulate.body; }

std::vector<ArticulateView> all(nb::handle_t<SystemObject> self) {
  std::vector<ArticulateView> out;
  for (const auto& members : nb::inst_ptr<SystemObject>(self)->use().bodies().articulates())
    out.push_back({handle_of(self, members.front())});
  return out;
}

}  // namespace

void bind_articulates(nb::module_& module) {
  nb::class_<ArticulateView> type(module, "Articulate", articulate_doc, nb::type_slots(handle_slots<ArticulateView>));
  type.def_prop_ro("bodies", &ArticulateView::bodies, "In order of slots.")
      .def("__contains__", &ArticulateView::contains, "body"_a)
      .def("__len__", [](const ArticulateView& self) { return self.bodies().size(); })
      .def(
          "__iter__", [](const ArticulateView& self) { return nb::iter(nb::cast(self.bodies())); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[Body]"))
      .def_prop_ro("number", &ArticulateView::number, "Equal for bodies of one articulate; edits change it.")
      .def_prop_rw(
          "active", [](const ArticulateView& self) { return self.body.use().bodies().is_active(self.body.id); },
          [](const ArticulateView& self, bool active) {
            self.body.use().bodies().set_articulate_active(self.body.id, active);
          },
          "False switches all its bodies off; see `Body.active`.")
      .def_prop_rw(
          "stride", [](const ArticulateView& self) { return self.body.use().bodies().stride(self.body.id); },
          [](const ArticulateView& self, int steps) {
            between_steps(self.body, "stride = ...").bodies().set_articulate_stride(self.body.id, steps);
          },
          "Of all its bodies; see `Body.stride`.")
      .def(
          "__eq__",
          [](const ArticulateView& self, nb::handle other) {
            const ArticulateView* theirs = nullptr;
            return nb::try_cast<const ArticulateView*>(other, theirs) && theirs && self.contains(theirs->body);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__",
           [](const ArticulateView&) -> std::size_t {
             throw nb::type_error("an articulate has no hash, as edits change what it is equal to; use its number");
           })
      .def("__repr__", [](const ArticulateView& self) {
        if (!self.body.is_alive()) return stale_repr("Articulate of body", self.body);
        return "<Articulate of " + std::to_string(self.bodies().size()) + " bodies>";
      });

  nb::borrow<nb::class_<BodyHandle>>(module.attr("Body"))
      .def_prop_ro(
          "articulate", [](const BodyHandle& self) { return self.use(), ArticulateView{self}; },
          nb::sig("def articulate(self) -> Articulate"), "The group of bodies connected to it by hinges.");
  nb::borrow<nb::class_<SystemObject>>(module.attr("System"))
      .def_prop_ro("articulates", &all, nb::sig("def articulates(self) -> list[Articulate]"),
                   "The groups of bodies connected by hinges.");
}

}  // namespace iota::bindings
