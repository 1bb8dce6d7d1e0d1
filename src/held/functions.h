// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/forces.h>

#include <cstdint>
#include <map>

namespace iota::held {

/// The code that bonds, laws and fields call. It is not part of the saved state: the tables of the model name it by keys,
/// and what is restored or replayed finds it here again.
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
