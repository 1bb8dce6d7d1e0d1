// SPDX-License-Identifier: Apache-2.0
#include "soak/edit_twin.h"

#include "ingredient/tables.h"
#include "model/restructure.h"

#include <iota/reports.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace iota::soak {

namespace {

using model::Model;
using model::none;

/// The thesis' Tables 4.2 and 4.3 in their simplest form. Particles are identified by their slots in the model.
struct Twin {
  struct Point {
    std::uint32_t slot;
    int body, ring;
    double mass;
  };
  std::vector<Point> points;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> bonds;
  int next_label = 0;

  Point& at(std::uint32_t slot) {
    return *std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.slot == slot; });
  }
  void forget(std::uint32_t slot) {
    std::erase_if(points, [&](const Point& p) { return p.slot == slot; });
    std::erase_if(bonds, [&](const auto& b) { return b.first == slot || b.second == slot; });
  }
  /// Replaces q by p.
  void absorb(std::uint32_t p, std::uint32_t q) {
    at(p).mass += at(q).mass;
    for (auto& [a, b] : bonds) {
      if (a == q) a = p;
      if (b == q) b = p;
    }
    std::erase_if(bonds, [](const auto& b) { return b.first == b.second; });
    std::erase_if(points, [&](const Point& x) { return x.slot == q; });
  }
  void weld(int a, int b) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> twins;
    for (const Point& mine : points)
      for (const Point& theirs : points)
        if (mine.body == a && theirs.body == b && mine.ring == theirs.ring) twins.push_back({mine.slot, theirs.slot});
    for (Point& p : points)
      if (p.body == b) p.body = a;
    for (const auto& [mine, theirs] : twins) absorb(mine, theirs);
  }
  /// Whether a body other than `except` has a particle in each ring.
  bool clash(int ring_a, int ring_b, int except) const {
    for (const Point& p : points)
      for (const Point& q : points)
        if (p.ring == ring_a && q.ring == ring_b && p.body == q.body && p.body != except) return true;
    return false;
  }
  void merge_rings(int into, int from) {
    for (Point& p : points)
      if (p.ring == from) p.ring = into;
  }
  int ring_count(int ring) const {
    return static_cast<int>(
        std::count_if(points.begin(), points.end(), [&](const Point& p) { return p.ring == ring; }));
  }

  /// False if it is refused.
  bool combine(std::uint32_t p, std::uint32_t q) {
    if (p == q) return true;
    const Point a = at(p), b = at(q);
    if (a.body == b.body) {
      if (clash(a.ring, b.ring, a.body)) return false;
      const bool hinged = ring_count(b.ring) > 1;
      absorb(p, q);
      if (hinged) merge_rings(a.ring, b.ring);
    } else if (a.ring == b.ring) {
      weld(a.body, b.body);
    } else {
      if (clash(a.ring, b.ring, -1)) return false;
      merge_rings(a.ring, b.ring);
    }
    return true;
  }
  /// `created`: the slot of a second particle, if the edit makes one.
  void separate(std::uint32_t p, std::uint32_t q, std::uint32_t created) {
    if (p == q) {
      at(p).mass /= 2;
      points.push_back({created, at(p).body, next_label++, at(p).mass});
    } else if (at(p).body == at(q).body) {
      at(q).body = next_label++;
      at(q).ring = at(p).ring;
    } else if (at(p).ring == at(q).ring) {
      at(q).ring = next_label++;
    }
  }
  /// Labels of connected components, by flooding over rings and bodies until nothing changes.
  std::vector<int> components() const {
    std::vector<int> label(points.size());
    std::iota(label.begin(), label.end(), 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          if ((points[i].body == points[j].body || points[i].ring == points[j].ring) && label[i] != label[j]) {
            label[i] = label[j] = std::min(label[i], label[j]);
            changed = true;
          }
    }
    return label;
  }
};

/// Whether two labelings define the same groups.
class SameGroups {
 public:
  bool add(std::uint32_t mine, int theirs) {
    const auto [a, is_new_a] = forth_.try_emplace(mine, theirs);
    const auto [b, is_new_b] = back_.try_emplace(theirs, mine);
    return a->second == theirs && b->second == mine;
  }

 private:
  std::map<std::uint32_t, int> forth_;
  std::map<int, std::uint32_t> back_;
};

class Pair {
 public:
  Pair(std::uint64_t seed, EditCount& counted) : random_(seed), counted_(counted) {
    for (int i = 0; i < 8; ++i) make_body();
  }

  std::optional<std::string> edit() {
    last_.clear();
    const std::uint32_t before = model_.articulates.size();
    if (!act()) return last_ + ": one refused and the other did not";
    ++counted_.edits;
    counted_.joined += model_.articulates.size()<before, counted_.cut += model_.articulates.size()> before;
    counted_.most_bodies = std::max<std::uint64_t>(counted_.most_bodies, model_.bodies.size());
    if (auto wrong = compare()) return last_ + ": " + *wrong;
    if (counted_.edits % 64 == 0) {
      model_.take_marked(marked_);
      const std::vector<std::string> complaints = ingredient::validate(model_);
      if (!complaints.empty()) return last_ + ": " + complaints.front();
    }
    return std::nullopt;
  }

 private:
  std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(random_() % n); }
  double uniform() { return 2 * 0x1p-53 * static_cast<double>(random_() >> 11) - 1; }
  std::uint32_t any() { return twin_.points[below(twin_.points.size())].slot; }
  void say(const char* what, std::uint32_t p, std::uint32_t q) {
    last_ = std::string(what) + " " + std::to_string(p) + " " + std::to_string(q);
  }

  void make_body() {
    const std::uint32_t body = model_.make_body(BodyKind::dynamic, 0);
    const int label = twin_.next_label++;
    for (std::uint32_t left = 1 + below(4); left > 0; --left) {
      const double mass = 0.5 + below(4);
      const std::uint32_t p = model_.make_particle(body, {uniform(), uniform(), uniform()}, mass, {});
      twin_.points.push_back({p, label, twin_.next_label++, mass});
    }
    model_.rebuild_basis(body);
  }

  /// Makes one edit in both; false if only one of them refuses it.
  bool act() {
    if (twin_.points.size() < 6) make_body();
    const std::uint32_t p = any(), q = any(), lot = below(100);
    RestructureReport report;
    bool refused = false;
    const auto attempt = [&](auto change) {
      try {
        change();
      } catch (const std::invalid_argument&) {
        refused = true;
        ++counted_.refused;
      }
    };
    if (lot < 38) {
      say("combine", p, q);
      attempt([&] { (void)combine_particles(model_, p, q, report); });
      return twin_.combine(p, q) != refused;
    }
    if (lot < 78) {  // more often for particles of one ring or body
      const std::uint32_t other = lot < 68 ? neighbor(p) : q;
      if (p == other && twin_.points.size() > 24) return true;
      say("separate", p, other);
      attempt([&] { (void)separate_particles(model_, p, other, report); });
      twin_.separate(p, other, report.created_particles.empty() ? none : report.created_particles.front().slot);
      return !refused;
    }
    if (lot < 82) {
      const int a = twin_.at(p).body, b = twin_.at(q).body;
      say("weld bodies of", p, q);
      attempt([&] { (void)combine_bodies(model_, model_.particles[p].body, model_.particles[q].body, report); });
      if (a != b) twin_.weld(a, b);
      return !refused;
    }
    if (lot < 88) {
      say("destroy", p, p);
      destroy_particle(model_, p);
      twin_.forget(p);
      return true;
    }
    if (lot < 90) {
      say("destroy body of", p, p);
      const int body = twin_.at(p).body;
      destroy_body(model_, model_.particles[p].body);
      for (std::size_t i = twin_.points.size(); i-- > 0;)
        if (twin_.points[i].body == body) twin_.forget(twin_.points[i].slot);
      return true;
    }
    if (lot < 95) {
      if (p == q || twin_.bonds.size() > 12) return true;
      say("bond", p, q);
      ingredient::Bond bond;
      bond.p = p, bond.q = q;
      (void)ingredient::Bonds::add(model_, bond);
      twin_.bonds.push_back({p, q});
      return true;
    }
    say("make body", 0, 0);
    if (twin_.points.size() < 28) make_body();
    return true;
  }

  /// A particle of the same ring or body, if there is one.
  std::uint32_t neighbor(std::uint32_t p) {
    const Twin::Point own = twin_.at(p);
    const std::size_t n = twin_.points.size(), start = below(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Twin::Point& other = twin_.points[(start + i) % n];
      if (other.slot != p && (other.ring == own.ring || other.body == own.body)) return other.slot;
    }
    return p;
  }

  std::optional<std::string> compare() const {
    if (model_.particles.size() != twin_.points.size()) return "the numbers of particles differ";
    if (model_.bonds.size() != twin_.bonds.size()) return "the numbers of bonds differ";
    SameGroups bodies, rings, articulates;
    const std::vector<int> components = twin_.components();
    for (std::size_t i = 0; i < twin_.points.size(); ++i) {
      const Twin::Point& p = twin_.points[i];
      if (!model_.particles.is_alive(p.slot)) return "particle " + std::to_string(p.slot) + " is gone";
      const model::Particle& mine = model_.particles[p.slot];
      const std::string name = "particle " + std::to_string(p.slot);
      if (std::abs(mine.mass - p.mass) > 1e-12 * p.mass) return name + " has another mass";
      if (!bodies.add(mine.body, p.body)) return name + " is in another body";
      if (!rings.add(mine.ring, p.ring)) return name + " is in another ring";
      if (!articulates.add(model_.bodies[mine.body].articulate, components[i]))
        return name + " is in another articulate";
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> mine, theirs;
    const auto ordered = [](std::uint32_t a, std::uint32_t b) { return std::pair{std::min(a, b), std::max(a, b)}; };
    model_.bonds.for_each([&](std::uint32_t, const ingredient::Bond& b) { mine.push_back(ordered(b.p, b.q)); });
    for (const auto& [a, b] : twin_.bonds) theirs.push_back(ordered(a, b));
    std::sort(mine.begin(), mine.end()), std::sort(theirs.begin(), theirs.end());
    if (mine != theirs) return "the bonds join other particles";
    return std::nullopt;
  }

  std::mt19937_64 random_;
  EditCount& counted_;
  Model model_;
  Twin twin_;
  Model::Marked marked_;
  std::string last_;
};

}  // namespace

std::optional<std::string> compare_edits(std::uint64_t seed, std::uint64_t count, EditCount& counted) {
  constexpr std::uint64_t per_world = 10'000;
  for (std::uint64_t done = 0, world = seed; done < count; done += per_world, ++world) {
    Pair pair(world, counted);
    for (std::uint64_t i = 0; i < std::min(per_world, count - done); ++i)
      if (auto wrong = pair.edit())
        return "seed " + std::to_string(world) + ", edit " + std::to_string(i) + ", " + *wrong;
  }
  return std::nullopt;
}

}  // namespace iota::soak
