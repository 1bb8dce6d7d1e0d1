// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iota/system.h>

#include <cstdint>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace iota::scenes {

/// Counts over many plays.
struct Tally {
  std::uint64_t scenes = 0, steps = 0, edits = 0, refused = 0, unconverged = 0, fallbacks = 0;
  /// Largest gain of energy in a step without hands and moved nails, relative to its motion; in a step that fell back
  /// to the robust scheme or to a least violation; and in scenes with joints.
  double made_up = 0, made_up_by_rescues = 0, made_up_with_joints = 0;
  double gap = 0;  ///< worst of the steps that were reported as solved, m
};

/// A system driven by lines of text, each of which is one call, with checks. A line is a verb and its
/// arguments, such as particle 0.1 0.5 0 0 2 0 0 0 body, position, mass, velocity combine 3.1 7.1 0.25
/// particles, seconds
/// Ids are slot.generation. Numbers have 17 digits, so that reading them gives the same bits. So a script needs only
/// this interpreter; if the order of slots changes, it fails instead of testing something else.
class WatchedSystem {
 public:
  explicit WatchedSystem(Tally& tally, std::string* log = nullptr) : tally_(tally), log_(log) {}

  System& system() { return system_; }
  const System& system() const { return system_; }
  const std::vector<GripId>& grips() const { return grips_; }

  /// The result of the latest call.
  BodyId body;
  ParticleId particle;

  /// Makes one call and writes it to the log, as a comment if it is refused. Throws what the system throws.
  template <class... Arguments>
  void call(std::string_view verb, const Arguments&... arguments) {
    std::ostringstream line;
    line.precision(17);
    line << verb;
    (write(line, arguments), ...);
    try {
      perform(line.str());
    } catch (const std::invalid_argument&) {
      if (log_) *log_ += "# refused: " + line.str() + '\n';
      throw;
    }
  }
  void perform(const std::string& line);

  /// Takes a step and checks it: returns the error, in a sentence.
  std::optional<std::string> step(double dt);
  /// Whether the structure is valid and the energy finite.
  std::optional<std::string> check() const;

 private:
  template <KindName kind>
  static void write(std::ostream& out, const Id<kind>& id) {
    out << ' ' << id.slot << '.' << id.generation;
  }
  static void write(std::ostream& out, const Vec3& v) { out << ' ' << v.x << ' ' << v.y << ' ' << v.z; }
  static void write(std::ostream& out, double v) { out << ' ' << v; }
  static void write(std::ostream& out, const char* word) { out << ' ' << word; }
  void forget_dead_grips();

  Tally& tally_;
  std::string* log_;
  System system_;
  std::vector<GripId> grips_;
  bool jointed_ = false;    // has had constraints, which are less exact
  bool disturbed_ = false;  // external forces do work in the next step
};

/// Plays lines on a fresh system; those that begin with # are comments. Returns the error, with the number of the line.
std::optional<std::string> play(std::string_view lines, Tally& tally);

}  // namespace iota::scenes
