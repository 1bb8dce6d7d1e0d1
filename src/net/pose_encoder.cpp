// SPDX-License-Identifier: Apache-2.0
#include "net/pose_encoder.h"

#include "net/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace iota::net {
namespace {

constexpr double steps = 65535;
constexpr double half_range = 1 / std::numbers::sqrt2;  // limit of all components except the largest
constexpr double rotation_steps = 1023;

/// Bodies within this extent are quantized in one box, for any initial extent, m.
constexpr double least_limit = 64;

/// A step of the box is at most this share of a body's size, so that the error is not seen even where the body fills the
/// window.
constexpr double finest_share = 1.0 / 200;

/// More bodies would cost a world with many small ones two thirds more bytes. They bear steps of a larger share, as many
/// are looked at from afar.
constexpr std::ptrdiff_t most_exact = 64;
constexpr double largest_share = 1.0 / 25;

/// Above this a float has no useful resolution, and the box would leave its range, m.
bool is_finite(const float (&v)[3]) {
  return std::abs(v[0]) <= farthest && std::abs(v[1]) <= farthest && std::abs(v[2]) <= farthest;  // false for NaN
}
float finite_or_zero(float value) { return std::isfinite(value) ? value : 0.0F; }
protocol::Vec3 to_vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

std::uint16_t quantize(float value, float low, float high) {
  const double edge = static_cast<double>(high) - low;
  const double step = std::round((static_cast<double>(value) - low) / edge * steps);
  return static_cast<std::uint16_t>(std::clamp(step, 0.0, steps));
}

float unquantize(std::uint16_t step, float low, float high) {
  return static_cast<float>(low + step / steps * (static_cast<double>(high) - low));
}

}  // namespace

std::optional<std::uint32_t> pack_rotation(const float (&orientation)[4]) {
  double square = 0;
  std::size_t largest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    square += static_cast<double>(orientation[i]) * orientation[i];
    if (std::abs(orientation[i]) > std::abs(orientation[largest])) largest = i;
  }
  if (!std::isfinite(square) || square < 1e-12) return std::nullopt;
  // q and -q are the same rotation: the largest component is made positive, so its sign is not sent.
  const double scale = (orientation[largest] < 0 ? -1 : 1) / std::sqrt(square);
  auto packed = static_cast<std::uint32_t>(largest);
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double step = std::round((orientation[i] * scale + half_range) / (2 * half_range) * rotation_steps);
    packed = packed << 10 | static_cast<std::uint32_t>(std::clamp(step, 0.0, rotation_steps));
  }
  return packed;
}

std::array<float, 4> unpack_rotation(std::uint32_t packed) {
  std::array<float, 4> out{};
  const std::size_t largest = packed >> 30;
  double rest = 1;
  int shift = 20;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double value = (packed >> shift & 1023U) / rotation_steps * 2 * half_range - half_range;
    out[i] = static_cast<float>(value);
    rest -= value * value;
    shift -= 10;
  }
  out[largest] = static_cast<float>(std::sqrt(std::max(rest, 0.0)));
  return out;
}

std::array<float, 3> unpack_position(const protocol::Poses& poses, const protocol::PoseBody& body) {
  return {unquantize(body.x, poses.box_min[0], poses.box_max[0]),
          unquantize(body.y, poses.box_min[1], poses.box_max[1]),
          unquantize(body.z, poses.box_min[2], poses.box_max[2])};
}

// ----------------------------------------------------------------------------------------------------------- quantizer

double PoseQuantizer::Bounds::longest_edge() const {
  return std::max({max[0] - min[0], max[1] - min[1], max[2] - min[2]});
}

PoseQuantizer::Bounds PoseQuantizer::Bounds::with(const float (&position)[3]) const {
  Bounds out = *this;
  for (std::size_t i = 0; i < 3; ++i) {
    out.min[i] = std::min<double>(out.min[i], position[i]);
    out.max[i] = std::max<double>(out.max[i], position[i]);
  }
  return out;
}

bool PoseQuantizer::Bounds::contains(const float (&position)[3]) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(position[i] >= min[i] && position[i] <= max[i])) return false;  // also for NaN
  }
  return true;
}

/// From the 10th to the 90th of a hundred bodies on each axis: a few distant ones do not count.
PoseQuantizer::Bounds PoseQuantizer::bulk_of(std::span<const BodyPose> bodies) {
  Bounds out{};
  for (std::size_t i = 0; i < 3; ++i) {
    sorted_.clear();
    for (const BodyPose& body : bodies) {
      if (is_finite(body.position)) sorted_.push_back(body.position[i]);
    }
    const auto at = [&](std::size_t rank) {
      std::nth_element(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(rank), sorted_.end());
      return static_cast<double>(sorted_[rank]);
    };
    if (sorted_.empty()) continue;
    out.min[i] = at(sorted_.size() / 10);
    out.max[i] = at(sorted_.size() - 1 - sorted_.size() / 10);
  }
  return out;
}

void PoseQuantizer::set_size(std::uint32_t slot, float size) {
  if (sizes_.size() <= slot) sizes_.resize(slot + std::size_t{1});
  sizes_[slot] = finite_or_zero(size);
}

double PoseQuantizer::calc_usual_limit(std::span<const BodyPose> bodies) {
  sorted_.clear();
  for (const BodyPose& body : bodies)
    if (size_of(body.body) > 0) sorted_.push_back(size_of(body.body));
  if (sorted_.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  return *middle * finest_share * steps;
}

bool PoseQuantizer::is_too_small(const BodyPose& body, double share) const {
  const double size = size_of(body.body);
  return size > 0 && box_->longest_edge() > size * share * steps;
}

void PoseQuantizer::set_box(const Bounds& bulk) {
  // A margin for motion, so that the box is kept; the error stays small relative to the scene. Bodies that come
  // together for a moment change the box by at most a factor.
  widest_ = std::max(widest_, bulk.longest_edge());
  const double margin = std::max(widest_ / 16, bulk.longest_edge() / 2);
  Bounds box = bulk;
  for (std::size_t i = 0; i < 3; ++i) {
    poses_.box_min[i] = static_cast<float>(bulk.min[i] - margin);
    poses_.box_max[i] = static_cast<float>(bulk.max[i] + margin);
    // Far from the origin a float's resolution can be coarser than the margin.
    if (!(poses_.box_max[i] > poses_.box_min[i])) {
      poses_.box_max[i] = std::nextafter(poses_.box_min[i], std::numeric_limits<float>::max());
    }
    box.min[i] = poses_.box_min[i];
    box.max[i] = poses_.box_max[i];
  }
  box_ = box;
  ++box_version_;
}

void PoseQuantizer::fit_box(std::span<const BodyPose> bodies) {
  std::optional<Bounds> inside;
  if (box_) {
    for (const BodyPose& body : bodies) {
      if (!box_->contains(body.position)) continue;
      inside = inside ? inside->with(body.position)
                      : Bounds{{body.position[0], body.position[1], body.position[2]},
                               {body.position[0], body.position[1], body.position[2]}};
    }
  }
  const bool is_new = !inside;
  if (is_new) {
    inside = bulk_of(bodies);
    // Bodies that would make the box too wide for the others are sent as far ones, instead of those.
    limit_ = std::max(2 * inside->longest_edge(),
                      std::min(std::max(least_limit, 4 * inside->longest_edge()), calc_usual_limit(bodies)));
  }
  bool has_grown = false;
  for (const BodyPose& body : bodies) {
    if (!is_finite(body.position) || (!is_new && box_->contains(body.position))) continue;
    const Bounds larger = inside->with(body.position);
    if (larger.longest_edge() > limit_) continue;
    inside = larger;
    has_grown = true;
  }
  const bool is_too_wide = box_ && box_->longest_edge() > std::max(8 * inside->longest_edge(), widest_ / 4);
  if (is_new || has_grown || is_too_wide) set_box(*inside);
}

void PoseQuantizer::add_body(const BodyPose& body) {
  const auto rotation = pack_rotation(body.orientation);
  if (!is_finite(body.position) || !rotation) return;
  // Coincident bodies, or a single one, do not define a size of the scene: they are sent as floats.
  if (body.body > 0xFFFF || widest_ == 0 || is_too_small(body, share_) || !box_->contains(body.position)) {
    poses_.far_bodies.push_back({body.body, to_vec3(body.position), *rotation});
    return;
  }
  poses_.bodies.push_back({static_cast<std::uint16_t>(body.body),
                           quantize(body.position[0], poses_.box_min[0], poses_.box_max[0]),
                           quantize(body.position[1], poses_.box_min[1], poses_.box_max[1]),
                           quantize(body.position[2], poses_.box_min[2], poses_.box_max[2]), *rotation});
}

void PoseQuantizer::update(const PoseSnapshot& snapshot) {
  poses_.step = snapshot.step;
  poses_.time = std::isfinite(snapshot.time) ? snapshot.time : 0;
  poses_.structure_version = snapshot.structure_version;
  poses_.keyframe = true;
  poses_.kinetic = finite_or_zero(snapshot.kinetic);
  poses_.potential = finite_or_zero(snapshot.potential);
  poses_.gap = finite_or_zero(snapshot.gap);
  if (std::any_of(snapshot.bodies.begin(), snapshot.bodies.end(),
                  [](const auto& b) { return is_finite(b.position); })) {
    fit_box(snapshot.bodies);
    const auto count =
        std::ranges::count_if(snapshot.bodies, [&](const BodyPose& body) { return is_too_small(body, finest_share); });
    share_ = count <= most_exact ? finest_share : largest_share;
  }
  poses_.bodies.clear();
  poses_.far_bodies.clear();
  for (const BodyPose& body : snapshot.bodies) add_body(body);
  poses_.sparks.clear();
  for (const SparkPose& spark : snapshot.sparks) {
    if (poses_.sparks.size() == 65536) break;  // the protocol's limit
    if (!is_finite(spark.position) || !std::isfinite(spark.radius)) continue;
    poses_.sparks.push_back({to_vec3(spark.position), spark.radius, spark.color, spark.set});
  }
  poses_.holds.clear();
  for (const HoldPose& hold : snapshot.holds) {
    if (poses_.holds.size() == 4096) break;  // the protocol's limit
    if (!is_finite(hold.point) || !is_finite(hold.target)) continue;
    poses_.holds.push_back(
        {hold.client, hold.hold, hold.body, to_vec3(hold.point), to_vec3(hold.target), finite_or_zero(hold.force)});
  }
}

// --------------------------------------------------------------------------------------------------------------- delta

bool PoseDelta::note_near(const protocol::PoseBody& body, std::uint32_t generation) {
  if (near_.size() <= body.body) near_.resize(body.body + 1U);
  Near& known = near_[body.body];
  if (!far_.empty()) far_.erase(body.body);
  if (known.is_there && known.generation == generation && known.pose == body) return false;
  known = {body, generation, true};
  return true;
}

bool PoseDelta::note_far(const protocol::PoseFarBody& body, std::uint32_t generation) {
  if (body.body < near_.size()) near_[body.body].is_there = false;
  const auto [known, is_new] = far_.try_emplace(body.body, Far{body, generation});
  if (!is_new && known->second.generation == generation && known->second.pose == body) return false;
  known->second = {body, generation};
  return true;
}

void PoseDelta::encode(const PoseQuantizer& latest, std::span<const std::uint32_t> generations, bool wants_keyframe,
                       std::vector<std::uint8_t>& out) {
  const protocol::Poses& all = latest.poses();
  const auto generation = [&](std::uint32_t slot) { return slot < generations.size() ? generations[slot] : 0; };
  const bool is_keyframe = wants_keyframe || box_version_ != latest.box_version();
  box_version_ = latest.box_version();
  if (is_keyframe) {
    near_.assign(near_.size(), Near{});
    far_.clear();
  }
  frame_.step = all.step;
  frame_.time = all.time;
  frame_.structure_version = all.structure_version;
  frame_.keyframe = is_keyframe;
  frame_.kinetic = all.kinetic;
  frame_.potential = all.potential;
  frame_.gap = all.gap;
  frame_.box_min = all.box_min;
  frame_.box_max = all.box_max;
  frame_.sparks = all.sparks;
  frame_.holds = all.holds;
  frame_.bodies.clear();
  frame_.far_bodies.clear();
  for (const auto& body : all.bodies) {
    if (note_near(body, generation(body.body))) frame_.bodies.push_back(body);
  }
  for (const auto& body : all.far_bodies) {
    if (note_far(body, generation(body.body))) frame_.far_bodies.push_back(body);
  }
  out.clear();
  protocol::encode(frame_, out);
}

}  // namespace iota::net
