// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/ids.h>
#include <iota/pose_snapshot.h>
#include <iota/scene.h>
#include <iota/view.h>

#include <cstdint>
#include <span>

namespace iota {

/// Data for viewers.
class Viewer : public View {
 public:
  explicit Viewer(Core& core) : View(core) {}

  PoseSnapshot poses() const;
  /// All changes since the last call; everything at the first call, after a restore, and on request (`whole`).
  /// `also` lists unchanged bodies to be described too. The cost is proportional to the changes. Only one caller at
  /// a time.
  SceneChanges take_scene_changes(bool whole = false, std::span<const BodyId> also = {});
  void stop_watching_scene();  ///< ends the log of changes; the next call returns everything
  /// As System::structure_version, without births and deaths of sparks: changes when a viewer's list of bodies does.
  std::uint32_t scene_version() const;
  /// A body of one free particle of an emitter: viewers draw a dot that users cannot grab.
  bool is_spark(BodyId) const;
};

}  // namespace iota
