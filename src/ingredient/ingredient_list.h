// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ingredient/closings.h"
#include "ingredient/grips.h"
#include "ingredient/implicit_bonds.h"
#include "ingredient/joints.h"
#include "ingredient/masses.h"
#include "ingredient/nails.h"
#include "ingredient/pushes.h"
#include "ingredient/rigid_rows.h"
#include "ingredient/rod_spins.h"
#include "ingredient/ties.h"

#include <tuple>

namespace iota::ingredient {

/// The one list of ingredients; every stage is a fold over it. The rows and forces of an island are in this order.
using Ingredients = std::tuple<  //
    Masses,                      //
    Pushes,                      //
    RigidRows,                   //
    Ties,                        //
    RodSpins,                    //
    Closings,                    //
    Nails,                       //
    Joints,                      //
    ImplicitBonds,               //
    Grips>;

template <class... I>
consteval bool are_ingredients(std::type_identity<std::tuple<I...>>) {
  static_assert((IslandIngredient<I> && ...));
  return true;
}
static_assert(are_ingredients(std::type_identity<Ingredients>{}));

}  // namespace iota::ingredient
