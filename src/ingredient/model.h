// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/ingredient_list.h"
#include "model/structure.h"

#include <iota/kinds.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

namespace iota::ingredient {

/// The name of a type without its namespaces, the same from all compilers that Iota is built with.
template <class T>
constexpr std::string_view type_name() {
  std::string_view text = __PRETTY_FUNCTION__;  // "... [with T = iota::ingredient::Bonds; ...]", clang: "... [T = ...]"
  text.remove_prefix(text.find("T = ") + 4);
  text = text.substr(0, text.find_first_of(";]"));
  return text.substr(text.rfind(':') + 1);
}

/// The tables of one ingredient; a distinct type, since many ingredients have none.
template <class I>
struct OwnTables : I::Tables {};
template <class List>
struct AllTables;
template <class... I>
struct AllTables<std::tuple<I...>> : OwnTables<I>... {};

}  // namespace iota::ingredient

namespace iota::model {

/// Values of `Model::has_edits`: only of bodies that are awake by them, or of any.
inline constexpr std::uint64_t edits_of_awake = 1, edits_of_any = 2;

/// The saved state of a system: the structure, the settings, and the tables of the ingredients, with the names declared
/// there (`model.bonds`). It is outside of `src/model`, which knows no ingredient.
class Model final : public Structure, public ingredient::AllTables<ingredient::Ingredients> {
 public:
  Vec3 gravity{0, -9.81, 0};
  IntegrationMode mode = IntegrationMode::energy_keeping;
  /// Whether forces are those at the end of a step (backward Euler), not in its middle.
  bool steps_to_end_point() const { return mode == IntegrationMode::plausible || mode == IntegrationMode::robust; }
  double tolerance = 1e-4;    ///< of mode accurate, see System::tolerance
  int budget_iterations = 0;  ///< see StepBudget
  double budget_seconds = 0, budget_contacts = 0, contacts_share = 1;
  double damping = 0;
  /// Name of the solver of the equations of steps, ended by zeros; empty: the built-in one.
  std::array<char, 32> solver{};
  double rest_after = 0, rest_speed = 0;  ///< s, m/s; see RestOptions
  double time = 0, last_dt = 0;
  std::uint64_t step = 0;
  double dissipated = 0, lost = 0, made = 0, external_work = 0, edit_energy = 0;  ///< see Energy
  double booked_energy = 0;     ///< kinetic and potential energy when edits were last booked, J
  std::uint64_t has_edits = 0;  ///< since then: 0, edits_of_awake or edits_of_any
  double held_energy = 0;       ///< of held forces, which `energy` does not include, when last booked, J

  /// The acceleration of all masses: gravity, unless an active field replaces it.
  Vec3 acting_gravity() const;

  enum class Ties { all, but_contacts, constraints };
  /// The bodies of one problem: those of the articulates of `bodies` and of all articulates tied to those by
  /// constraints and, unless `ties` excludes them, implicit forces and contacts. In order of discovery.
  std::vector<std::uint32_t> tied_bodies(std::span<const std::uint32_t> bodies, Ties ties = Ties::all) const;
  /// The same, without bodies that only touch.
  std::vector<std::uint32_t> connected_bodies(std::span<const std::uint32_t> bodies) const {
    return tied_bodies(bodies, Ties::but_contacts);
  }
  bool has_ties() const;                            ///< between any articulates
  bool is_tied_to_world(std::uint32_t body) const;  ///< by an active constraint
  /// visit(body): of the bodies tied to a particle's body, except those of its articulate.
  void visit_tied(std::uint32_t particle, Ties ties, Visit visit) const;

  /// Starts the log of changes for viewers, empty at first.
  void watch_scene();
  void stop_watching_scene();

  std::uint64_t hash() const;        ///< of the state; kept by recordings of all versions
  std::uint64_t quick_hash() const;  ///< another one, for journals: in a fifth of the time
  template <class Archive>
  void archive(Archive& ar);
  /// Takes data that are not saved from the model that this one, read from bytes, replaces.
  void take_over(Model& before);

  void absorb_uses(std::uint32_t q, std::uint32_t p) override;
  void drop_uses(std::uint32_t particle) override;
  void forget_particle(std::uint32_t particle) override;
  void forget_body(std::uint32_t body) override;
  void ring_changed(std::uint32_t ring) override;
  void ring_merged(std::uint32_t into, std::uint32_t from, bool replaces) override;
  void inertia_changed(std::uint32_t body) override;
  void acting_changed(std::uint32_t particle) override;
  bool call_off(std::uint32_t p, std::uint32_t q) override;
  bool is_used(std::uint32_t particle) const override;
  bool is_frozen(std::uint32_t body) const override;
  Vec3 inner_momentum(std::uint32_t body) const override;
  void visit_joined(std::uint32_t particle, Visit visit) const override;
  void visit_companions(std::uint32_t particle, Visit visit) const override;
  void visit_lines(std::uint32_t body, VisitLine visit) const override;
  double ball_radius(std::uint32_t particle) const override;
};

template <class Archive>
void Model::archive(Archive& ar) {
  Structure::archive(ar);
  const auto value = [&](std::string_view name, auto& each) { ar.name(name), ar.value(each); };
  value("gravity", gravity), value("mode", mode), value("tolerance", tolerance);
  value("budget_iterations", budget_iterations), value("budget_seconds", budget_seconds);
  value("budget_contacts", budget_contacts), value("contacts_share", contacts_share);
  value("damping", damping), value("solver", solver), value("rest_after", rest_after), value("rest_speed", rest_speed);
  value("time", time), value("last_dt", last_dt), value("step", step);
  value("dissipated", dissipated), value("lost", lost), value("made", made), value("external_work", external_work);
  value("edit_energy", edit_energy), value("booked_energy", booked_energy), value("has_edits", has_edits);
  value("held_energy", held_energy);
  ingredient::for_each_type<ingredient::Ingredients>([&]<class I>() {
    ar.name(ingredient::type_name<I>());
    static_cast<ingredient::OwnTables<I>&>(*this).archive(ar, *this);
  });
}

/// The table of the objects that an id names: each ingredient knows that of its own.
inline const auto& table_of(const Model& model, BodyId) { return model.bodies; }
inline const auto& table_of(const Model& model, ParticleId) { return model.particles; }
inline const auto& table_of(const Model& model, GroupId) { return model.groups; }
template <std::size_t first = 0, class IdType>
const auto& table_of(const Model& model, IdType id) {
  using Own = ingredient::OwnTables<std::tuple_element_t<first, ingredient::Ingredients>>;
  if constexpr (requires(const Own& own) { own.table_of(id); })
    return static_cast<const Own&>(model).table_of(id);
  else
    return table_of<first + 1>(model, id);
}

[[noreturn]] void refuse_null(std::string_view kind);
/// survivor: the slot of the object that absorbed it.
[[noreturn]] void refuse_stale(std::string_view kind, std::uint32_t slot, std::optional<std::uint32_t> survivor);

/// Slot of a living thing. Throws StaleIdError, which says what became of it.
template <KindName kind>
std::uint32_t require(const Model& model, Id<kind> id) {
  if (table_of(model, id).contains(id)) return id.slot;
  if (!id) refuse_null(kind.text);
  std::optional<std::uint32_t> survivor;
  if constexpr (requires { model.survivor_of(id); })
    if (const auto other = model.survivor_of(id)) survivor = other->slot;
  refuse_stale(kind.text, id.slot, survivor);
}

}  // namespace iota::model
