// SPDX-License-Identifier: Apache-2.0
#include "solver/loops.h"

#include "base/disjoint_sets.h"
#include "base/sort_unique.h"
#include "solver/pieces.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace iota::solver {

namespace {

/// Other lengths than those of a tree, or of a body.
bool have_loops(std::uint32_t points, std::uint32_t lengths) {
  return lengths != points - 1 && !(points <= 4 && lengths == points * (points - 1) / 2);
}

/// A joint, by the number of its owner and its slot in that, and a piece that it connects.
using End = std::pair<std::uint64_t, std::uint32_t>;

/// Joints with all pieces that they connect; the world is the last one.
void find_ends_of_joints(const Problem& problem, const Pieces& pieces, std::uint32_t world, std::vector<End>& ends) {
  ends.clear();
  problem.for_each_constraint_pool([&]<class C>(const ConstraintPool<C>& pool) {
    if constexpr (!std::is_same_v<C, DistanceConstraint> && !is_of_contact<C>)
      for (std::size_t i = 0; i < pool.items.size(); ++i) {
        const C& c = pool.items[i];
        const std::uint64_t joint = std::uint64_t{pool.keys[i].owner} << 32 | pool.keys[i].slot;
        for (int k = 0; k < c.node_count(); ++k)
          ends.emplace_back(joint, pieces.of[c.nodes[static_cast<std::size_t>(k)]]);
        if (!c.is_internal()) ends.emplace_back(joint, world);
      }
  });
  sort_unique(ends);
}

/// Kept, so that nothing is allocated when a structure changes a little.
struct Room {
  Pieces pieces;
  RoomForPieces of_pieces;
  std::vector<std::uint32_t> points, lengths;
  std::vector<End> ends;
  DisjointSets connected;
};

}  // namespace

bool has_loops(const Problem& problem) {
  thread_local Room room;
  const std::uint32_t world = find_pieces(problem, Connection::lengths, room.pieces, room.of_pieces);
  room.points.assign(world, 0), room.lengths.assign(world, 0);
  for (const std::uint32_t piece : room.pieces.of) ++room.points[piece];
  for (const DistanceConstraint& c : problem.items_of<DistanceConstraint>()) ++room.lengths[room.pieces.of[c.nodes[0]]];
  for (std::uint32_t piece = 0; piece < world; ++piece)
    if (have_loops(room.points[piece], room.lengths[piece])) return true;

  find_ends_of_joints(problem, room.pieces, world, room.ends);
  room.connected.reset(world + 1);
  for (std::size_t i = 1; i < room.ends.size(); ++i) {
    if (room.ends[i].first != room.ends[i - 1].first) continue;
    const std::uint32_t a = room.connected.root(room.ends[i - 1].second), b = room.connected.root(room.ends[i].second);
    if (a == b) return true;
    room.connected.set_parent(a, b);
  }
  return false;
}

}  // namespace iota::solver
