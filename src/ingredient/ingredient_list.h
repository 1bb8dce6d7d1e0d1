// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/affine_rows.h"
#include "ingredient/angle_springs.h"
#include "ingredient/bonds.h"
#include "ingredient/closings.h"
#include "ingredient/contacts.h"
#include "ingredient/cosmetic_bonds.h"
#include "ingredient/emitters.h"
#include "ingredient/fields.h"
#include "ingredient/grips.h"
#include "ingredient/ignored_contacts.h"
#include "ingredient/joints.h"
#include "ingredient/laws.h"
#include "ingredient/masses.h"
#include "ingredient/nails.h"
#include "ingredient/names.h"
#include "ingredient/oriented_particles.h"
#include "ingredient/pairs.h"
#include "ingredient/pushes.h"
#include "ingredient/rigid_rows.h"
#include "ingredient/rod_spins.h"
#include "ingredient/strides.h"

#include <tuple>
#include <type_traits>

namespace iota::ingredient {

/// The list of ingredients; every stage is a fold over it. The rows and forces of an island are in this order.
using Ingredients = std::tuple<  //
    Masses,                      //
    Pushes,                      //
    RigidRows,                   //
    AffineRows,                  //
    OrientedParticles,           //
    RodSpins,                    //
    Closings,                    //
    Nails,                       //
    Laws,                        //
    Bonds,                       //
    Joints,                      //
    Fields,                      //
    Pairs,                       //
    Emitters,                    //
    Grips,                       //
    Names,                       //
    CosmeticBonds,               //
    AngleSprings,                //
    Contacts,                    //
    IgnoredContacts,             //
    Strides>;

/// The ingredient with a command among its own; void if there is none.
template <class C, class List = Ingredients>
struct OwnerOfCommand {
  using type = void;
};
template <class C, class First, class... Others>
struct OwnerOfCommand<C, std::tuple<First, Others...>> {
  template <class... Own>
  static constexpr bool is_among(std::tuple<Own...>*) {
    return (std::is_same_v<C, Own> || ...);
  }
  using type = typename std::conditional_t<is_among(static_cast<typename First::Commands*>(nullptr)),
                                           std::type_identity<First>, OwnerOfCommand<C, std::tuple<Others...>>>::type;
};
template <class C>
using OwnerOf = typename OwnerOfCommand<C>::type;
template <class C>
inline constexpr bool is_own_command = !std::is_void_v<OwnerOf<C>>;

template <class List>
struct TypesOf;
template <class... I>
struct TypesOf<std::tuple<I...>> {
  static_assert((ModelIngredient<I> && ...) && (IslandIngredient<I> && ...));
  template <class Visit>
  static void for_each(Visit visit) {
    (visit.template operator()<I>(), ...);
  }
};

/// Calls visit.operator()<I>() for each ingredient of a list, in order.
template <class List, class Visit>
void for_each_type(Visit visit) {
  TypesOf<List>::for_each(visit);
}

template <class List>
void add_energies(const Scope& scope, Energies& sum) {
  for_each_type<List>([&]<class I>() { I::add_energy(scope, sum); });
}
template <class List>
void add_momenta(const Scope& scope, Momenta& sum) {
  for_each_type<List>([&]<class I>() { I::add_momentum(scope, sum); });
}
template <class List>
void add_loads(const LastStep& step, std::uint32_t body, LoadReader& reader) {
  for_each_type<List>([&]<class I>() { I::add_loads(step, body, reader); });
}
template <class List>
void end_step(Model& model, double h) {
  for_each_type<List>([&]<class I>() { I::end_step(model, h); });
}
template <class List>
void tell(Model& model, Outcome& outcome) {
  for_each_type<List>([&]<class I>() { I::tell(model, outcome); });
}

}  // namespace iota::ingredient
