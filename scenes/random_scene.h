// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scenes/script.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// Random scenes and checks that all of them must pass: random graphs, loops, nails, springs, grips and edits every
/// frame, masses over six decades.
namespace iota::scenes {

enum class DeedKind : std::uint8_t {
  make_body,       // of one to five particles
  make_solid,      // a box, sphere, cylinder ... with two attachments, the first combined with particle a
  make_link,       // a two-point body hinged to particle a
  bridge,          // a two-point body from particle a to particle b
  combine,         // particles a and b
  combine_slowly,  // over a time
  combine_bodies,
  cut,  // particle a leaves, or parts from, another one of its ring
  separate,
  nail,
  move_nail,
  release,
  spring,
  drag,
  law,  // changes to another predefined law
  destroy_bond,
  joint,     // of any kind between the bodies of a and b, or between a's and the world
  distance,  // a rod or a rope between a and b
  surface,   // a stays on, inside or outside a sphere, a plane or a box
  path,      // a slides along a curve
  switch_constraint,
  destroy_constraint,
  grip,
  move_grip,
  let_go,
  push,
  set_velocity,
  set_mass,
  set_kind,
  destroy_particle,
  destroy_body,
  set_mode,
  step,
};

/// One thing done to a scene, as plain numbers. `a` and `b` are taken modulo how many particles there are, and further
/// numbers come from `seed`: so any part of a script is a valid script.
struct Deed {
  DeedKind kind = DeedKind::step;
  std::uint32_t a = 0, b = 0;
  std::uint64_t seed = 0;
};

/// The start of a scene: the shape of the graph of its bodies.
enum class Graph : std::uint8_t { soup, chain, ring, tree, star, net, count };

struct RandomSceneOptions {
  int bodies = 14;  ///< at the start, at most
  int frames = 30;  ///< steps
  int edits = 2;    ///< a frame, at most
};

std::vector<Deed> random_script(std::uint64_t seed, const RandomSceneOptions& options = {});

/// Plays a script on a new system. Returns the error, in a sentence, after the first deed that shows it: numbers that
/// are not finite, an invalid structure, a gap of a step reported as solved, a gain of energy, a refused edit that
/// changed something.
std::optional<std::string> play(const std::vector<Deed>& script, Tally& tally);

/// Whether two errors are of the same kind.
std::function<bool(const std::vector<Deed>&)> same_complaint_as(const std::vector<Deed>& script);
/// The shortest script found, by leaving out, that still fails.
std::vector<Deed> shrink(std::vector<Deed> script, const std::function<bool(const std::vector<Deed>&)>& fails);

/// The calls of a script, line by line, which can be played without this file: see WatchedSystem.
std::string tell(const std::vector<Deed>& script);

}  // namespace iota::scenes
