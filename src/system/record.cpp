// SPDX-License-Identifier: Apache-2.0
#include "system/core.h"

namespace iota {

void Record::start() { core_.door.start_recording(); }

Recording Record::stop() { return core_.door.stop_recording(); }

std::optional<std::uint64_t> Record::replay(const Recording& recording) {
  if (core_.door.is_stepping()) throw std::logic_error("replay: not while the system steps");
  if (core_.door.is_recording()) throw std::logic_error("replay: stop the recording first");
  return core_.door.replay(recording, [&](Reader& reader) { core_.execute_next(reader); });
}

void Core::execute_next(Reader& reader) {
  edit::read_command(reader, [&](const auto& command) { (void)execute(command); });
}

}  // namespace iota
