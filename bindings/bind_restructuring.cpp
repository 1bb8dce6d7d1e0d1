// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "names.h"
#include "restructure_result.h"

namespace iota::bindings {

namespace {

constexpr const char* combine_particles_doc =
    "Joins it with particle q. Thesis, Tables 4.1 and 4.2.\n\n"
    "Same particle: nothing. Same body: this one absorbs q. Hinged: the hinge becomes rigid, and its body absorbs\n"
    "q's. Unrelated: a hinge; particles that are apart meet at once (over=0) or within `over` seconds. Momentum is\n"
    "kept; exceptions are reported.\n\n"
    "keep: 'both': both are moved to a place between them, weighted by mass. 'first': this one stays at its place,\n"
    "and q is moved here with everything hinged to it, as one rigid body; so none of it may be nailed, static or\n"
    "hinged to this particle already, and `over` must be 0.\n\n"
    "Raises ValueError for particles of two systems, a bad `over` or `keep`, StaleIdError for handles of destroyed\n"
    "objects.\n\n"
    "    p.combine(q)";

constexpr const char* combine_bodies_doc =
    "Makes the two one rigid body without moving them; it absorbs `other`. Raises ValueError for bodies of two "
    "systems.";

constexpr const char* separate_doc =
    "Separates it from particle q. Thesis, Table 4.3.\n\n"
    "Same particle: a second one at the same place, half the mass each. Same body: q becomes a one-particle body hinged\n"
    "to this one. Hinged: q leaves the ring. Unrelated: nothing (the report is then false).\n\n"
    "    p.separate(q)";

/// Moves everything hinged to q, as one rigid body, so that q coincides with p.
void bring(System& engine, ParticleId q, ParticleId p) {
  const BodyId body = engine.particles().body(q);
  const Vec3 way = engine.particles().position(p) - engine.particles().position(q);
  if (way == Vec3{}) return;
  const std::uint32_t articulate = engine.bodies().articulate(body);
  const auto refuse = [&](const std::string& why) {
    throw nb::value_error(("combine: " + name_of(q) + " cannot be brought to " + name_of(p) + ": " + why).c_str());
  };
  if (engine.bodies().articulate(engine.particles().body(p)) == articulate) refuse("they are connected already");
  for (const BodyId other : engine.bodies().ids()) {
    if (engine.bodies().articulate(other) != articulate) continue;
    if (const BodyKind kind = engine.bodies().kind(other); kind == BodyKind::static_ || kind == BodyKind::scripted)
      refuse(name_of(other) + " is " + to_word(kind_words, kind));
    for (const ParticleId held : engine.bodies().particles(other))
      if (engine.particles().is_nailed(held)) refuse(name_of(held) + " is nailed");
  }
  engine.bodies().set_pose(body, engine.bodies().center_of_mass(body) + way, engine.bodies().orientation(body));
}

RestructureResult combine_particles(const ParticleHandle& p, const ParticleHandle& q, double over,
                                    const std::string& keep) {
  check_one_system(p, q, "combine");
  finite_not_negative(over, "over", "s");
  const bool keeps_first = keep == "first";
  if (!keeps_first && keep != "both")
    throw nb::value_error(("keep must be 'both' or 'first', not '" + keep + "'").c_str());
  if (keeps_first && over > 0) throw nb::value_error("keep='first' takes no time: over must be 0");
  q.use();
  System& engine = p.use();
  const double distance = norm(engine.particles().position(p.id) - engine.particles().position(q.id));
  if (keeps_first) bring(p.system->use_between_steps("combine with keep='first'"), q.id, p.id);
  RestructureResult result{p.system_object, p.system, engine.edits().combine(p.id, q.id, over)};
  if (keeps_first) result.report.closed_distance = distance;
  return result;
}

RestructureResult combine_bodies(const BodyHandle& a, const BodyHandle& b) {
  check_one_system(a, b, "combine");
  b.use();
  return {a.system_object, a.system, a.use().edits().combine(a.id, b.id)};
}

RestructureResult separate(const ParticleHandle& p, const ParticleHandle& q) {
  check_one_system(p, q, "separate");
  q.use();
  return {p.system_object, p.system, p.use().edits().separate(p.id, q.id)};
}

/// The ends of all cosmetic bonds.
std::vector<std::pair<ParticleHandle, ParticleHandle>> cosmetic_lines(nb::handle_t<SystemObject> self) {
  SystemObject* object = nb::inst_ptr<SystemObject>(self);
  System& engine = object->use();
  std::vector<std::pair<ParticleHandle, ParticleHandle>> out;
  for (const CosmeticBondId bond : engine.cosmetic_bonds().ids()) {
    const auto [p, q] = engine.cosmetic_bonds().ends(bond);
    out.push_back({{nb::borrow(self), object, p}, {nb::borrow(self), object, q}});
  }
  return out;
}

}  // namespace

void bind_restructuring(nb::module_& module) {
  nb::borrow<nb::class_<ParticleHandle>>(module.attr("Particle"))
      .def("combine", &combine_particles, "q"_a, "over"_a = 0.0, nb::kw_only(), "keep"_a = "both",
           nb::sig(
               "def combine(self, q: Particle, over: float = 0.0, *, keep: typing.Literal['both', 'first'] = 'both') "
               "-> RestructureReport"),
           combine_particles_doc)
      .def("separate", &separate, "q"_a, separate_doc);
  nb::borrow<nb::class_<BodyHandle>>(module.attr("Body"))
      .def("combine", &combine_bodies, "other"_a, combine_bodies_doc);

  nb::object system = module.attr("System");
  auto type = nb::borrow<nb::class_<SystemObject>>(system);
  type.def_prop_ro("bodies", all_of<BodyHandle>([](System& engine) { return engine.bodies().ids(); }),
                   "In order of slots, without obstacles.")
      .def_prop_ro("obstacles", all_of<BodyHandle>([](System& engine) { return engine.bodies().obstacles(); }),
                   "In order of slots: see `obstacle`.")
      .def_prop_ro("particles", all_of<ParticleHandle>([](System& engine) { return engine.particles().ids(); }),
                   "In order of slots: the order of the rows of `positions`.")
      .def_prop_ro("bonds", all_of<BondHandle>([](System& engine) { return engine.bonds().ids(); }),
                   "In order of slots.")
      .def_prop_ro("cosmetic_bonds",
                   all_of<CosmeticBondHandle>([](System& engine) { return engine.cosmetic_bonds().ids(); }),
                   "In order of slots.")
      .def_prop_ro("cosmetic_lines", &cosmetic_lines, "The ends of all cosmetic bonds.");
}

}  // namespace iota::bindings
