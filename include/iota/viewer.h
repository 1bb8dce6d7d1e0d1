// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/pose_snapshot.h>
#include <iota/scene.h>
#include <iota/view.h>

#include <cstdint>
#include <span>

namespace iota {

/// What viewers draw.
class Viewer : public View {
 public:
  explicit Viewer(Core& core) : View(core) {}

  PoseSnapshot poses() const;
  /// What a viewer has to be told: all that changed since the last call, at first and after a restore everything, and on
  /// request (`whole`); `also` names bodies to be described though they have not changed. Costs what has changed. One caller
  /// at a time.
  SceneChanges take_scene_changes(bool whole = false, std::span<const BodyId> also = {});
  void stop_watching_scene();  ///< nothing is noted any more for the next call, which will be given everything
  /// As System::structure_version, but births and deaths of sparks do not count: what a viewer's list of bodies depends on.
  std::uint32_t scene_version() const;
  /// A body of one particle that an emitter bore and that nothing ties: viewers see a dot that they cannot hold.
  bool is_spark(BodyId) const;
};

}  // namespace iota
