// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>

#include <cstdint>
#include <map>

namespace iota::held {

/// The functions of bonds, laws and fields. They are not part of the saved state: the tables of the model refer to them
/// by keys, which find them again after a restore or in a replay.
struct Functions {
  struct Law {
    RadialFunction radial = nullptr;
    BatchFunction batch;
  };
  std::map<std::uint64_t, ScriptedLaw> of_bonds;
  std::map<std::uint64_t, Law> of_laws;
  std::map<std::uint64_t, FieldFunction> of_fields;
  std::uint64_t next_key = 1;
};

}  // namespace iota::held
