// SPDX-License-Identifier: Apache-2.0
// From snapshots to poses frames: quantization once per snapshot, then per client only moved bodies.
//
// A position takes 3 x 16 bits within a box around the bodies, a rotation 2 + 3 x 10 bits ("smallest three"): 12 bytes
// a body with its slot. A body far from all others (a falling piece) would enlarge the box and so all errors; it is
// sent separately with a float position, 20 bytes, and so is one that is too small for the steps of the box. Errors:
// position at most half of box edge / 65535 per axis, and 1/400 of the size of its body, in a world with many
// small ones 1/50; rotation at most 5 mrad.
#pragma once

#include <iota/pose_snapshot.h>
#include <iota_protocol.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace iota::net {

/// The packed rotation of a quaternion (x y z w), normalized first; nothing if it is not finite or about zero.
std::optional<std::uint32_t> pack_rotation(const float (&orientation)[4]);

/// The unit quaternion (x y z w) of a packed rotation.
std::array<float, 4> unpack_rotation(std::uint32_t packed);

/// Position of `body` in the box of `poses`, world, m.
std::array<float, 3> unpack_position(const protocol::Poses& poses, const protocol::PoseBody& body);

/// Keeps the box and turns snapshots into frames that list every body.
class PoseQuantizer {
 public:
  /// How large the body in a slot is drawn, m; 0: not known.
  void set_size(std::uint32_t slot, float size);
  /// Bodies and holds that are not finite are left out. No allocation once the sizes have settled.
  void update(const PoseSnapshot& snapshot);

  /// The latest frame, a keyframe.
  const protocol::Poses& poses() const { return poses_; }
  /// Rises with each change of the box, which changes the meaning of all numbers.
  std::uint32_t box_version() const { return box_version_; }

 private:
  struct Bounds {
    std::array<double, 3> min, max;
    double longest_edge() const;
    Bounds with(const float (&position)[3]) const;
    bool contains(const float (&position)[3]) const;
  };
  void fit_box(std::span<const BodyPose> bodies);
  Bounds bulk_of(std::span<const BodyPose> bodies);
  /// The longest edge of a box whose steps are small enough for half of the bodies, m.
  double calc_usual_limit(std::span<const BodyPose> bodies);
  void set_box(const Bounds& bulk);
  /// Whether a step of the box is more than a share of a body's size.
  bool is_too_small(const BodyPose& body, double share) const;
  float size_of(std::uint32_t slot) const { return slot < sizes_.size() ? sizes_[slot] : 0; }
  void add_body(const BodyPose& body);

  protocol::Poses poses_;
  std::optional<Bounds> box_;
  std::uint32_t box_version_ = 0;
  double widest_ = 0;         ///< longest edge of all bulks so far, m
  double share_ = 0;          ///< of a body's size, that a step of the box may be
  double limit_ = 0;          ///< longest edge that the bodies in the box may span, m
  std::vector<float> sizes_;  ///< by slot, m
  std::vector<float> sorted_;
};

/// The state last sent to a client, to send only differences.
class PoseDelta {
 public:
  /// Replaces `out` by the next frame for this client. A keyframe on request, at first, and after a change of box.
  /// generations: of the bodies in the slots, as sent to the client: another body's pose does not count.
  void encode(const PoseQuantizer& latest, std::span<const std::uint32_t> generations, bool wants_keyframe,
              std::vector<std::uint8_t>& out);
  bool last_was_keyframe() const { return frame_.keyframe; }

 private:
  struct Near {
    protocol::PoseBody pose;
    std::uint32_t generation = 0;
    bool is_there = false;
  };
  struct Far {
    protocol::PoseFarBody pose;
    std::uint32_t generation = 0;
  };
  bool note_near(const protocol::PoseBody& body, std::uint32_t generation);
  bool note_far(const protocol::PoseFarBody& body, std::uint32_t generation);

  protocol::Poses frame_;
  std::vector<Near> near_;  ///< by slot
  std::unordered_map<std::uint32_t, Far> far_;
  std::optional<std::uint32_t> box_version_;
};

}  // namespace iota::net
