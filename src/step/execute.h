// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "step/implementation.h"

namespace iota {

namespace step {

/// Place of a command in the list, which is how recordings name it.
template <class C, std::size_t I = 0>
constexpr std::uint8_t index_of() {
  if constexpr (std::is_same_v<C, std::variant_alternative_t<I, Command>>)
    return I;
  else
    return index_of<C, I + 1>();
}

}  // namespace step

template <class C>
auto System::Implementation::execute(const C& command) {
  using Result = decltype(apply(command));
  if (stepping) {
    if constexpr (step::is_queueable<C>) {
      queue.push_back(command);
      if constexpr (std::is_same_v<Result, RestructureReport>) {
        RestructureReport report;
        report.queued = true;
        return report;
      } else {
        return;
      }
    } else {
      throw std::logic_error(
          "only structural edits (combine, separate, nail, release, destroy, activate) may be asked for while "
          "the system steps; they are applied right after the step");
    }
  }
  held_energy_is_known = held_energy_is_known && std::is_same_v<C, step::Step>;
  const auto record = [&] {
    if (!recording) return;
    Writer writer(recording->commands);
    std::uint8_t index = step::index_of<C>();
    C copy = command;
    writer.value(index);
    writer.value(copy);
  };
  model.has_edits |= !std::is_same_v<C, step::Step>;
  if constexpr (std::is_void_v<Result>) {
    apply(command);
    record();
  } else {
    Result result = apply(command);
    if constexpr (std::is_same_v<Result, RestructureReport>)
      if (batch) batch->add(result);
    record();
    return result;
  }
}

}  // namespace iota
