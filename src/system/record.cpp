// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void System::start_recording() { implementation_->door.start_recording(); }

Recording System::stop_recording() { return implementation_->door.stop_recording(); }

std::optional<std::uint64_t> System::replay(const Recording& recording) {
  if (implementation_->door.is_stepping()) throw std::logic_error("replay: not while the system steps");
  if (implementation_->door.is_recording()) throw std::logic_error("replay: stop the recording first");
  return implementation_->door.replay(recording, [&](const edit::Command& command) {
    std::visit([&](const auto& c) { (void)implementation_->execute(c); }, command);
  });
}

}  // namespace iota
