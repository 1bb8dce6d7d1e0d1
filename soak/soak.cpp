// SPDX-License-Identifier: Apache-2.0
// iota_soak scenes [COUNT [FIRST_SEED]]: thousands of random scenes. On a failure: the seed, and the shortest script
// found. iota_soak heaps [COUNT [FIRST_SEED]]: random heaps of bodies that touch, with edits. iota_soak promises [COUNT [FIRST_SEED]]: the promises of motion on random scenes. iota_soak edits [COUNT [SEED]]: millions of random edits of the structure, compared with a brute-force twin.
#include "scenes/promises.h"
#include "scenes/random_heap.h"
#include "scenes/random_scene.h"
#include "soak/edit_twin.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

int play_scenes(std::uint64_t count, std::uint64_t first) {
  using namespace iota::scenes;
  Tally tally;
  int failures = 0;
  for (std::uint64_t seed = first; seed < first + count && failures < 10; ++seed) {
    const std::vector<Deed> script = random_script(seed);
    if (const auto wrong = play(script, tally)) {
      ++failures;
      std::printf("seed %llu, %s\n", static_cast<unsigned long long>(seed), wrong->c_str());
      const std::vector<Deed> least = shrink(script, same_complaint_as(script));
      Tally ignored;
      std::printf("%s%s\n", tell(least).c_str(), play(least, ignored).value_or("").c_str());
    }
    if ((seed - first + 1) % 1000 == 0)
      std::fprintf(stderr, "%llu scenes\n", static_cast<unsigned long long>(seed - first + 1));
  }
  std::printf("%llu scenes, %llu steps, %llu edits (%llu refused): %d failed\n",
              static_cast<unsigned long long>(tally.scenes), static_cast<unsigned long long>(tally.steps),
              static_cast<unsigned long long>(tally.edits), static_cast<unsigned long long>(tally.refused), failures);
  std::printf("steps reported as not converged: %llu, handed to the robust scheme: %llu\n",
              static_cast<unsigned long long>(tally.unconverged), static_cast<unsigned long long>(tally.fallbacks));
  std::printf("worst gap of a solved step: %.2e m\n", tally.gap);
  std::printf(
      "most energy made up, of the motion: %.2e by a solved step, %.2e by one that had to fall back, %.2e with joints\n",
      tally.made_up, tally.made_up_by_rescues, tally.made_up_with_joints);
  return failures == 0 ? 0 : 1;
}

int keep_promises(std::uint64_t count, std::uint64_t first) {
  using namespace iota::scenes;
  int broken = 0;
  for (int p = 0; p < static_cast<int>(Promise::count); ++p) {
    int failures = 0;
    const auto promise = static_cast<Promise>(p);
    for (std::uint64_t seed = first; seed < first + count; ++seed)
      if (const auto wrong = break_promise(promise, seed)) {
        if (++failures <= 5)
          std::printf("%s, seed %llu: %s\n", name_of(promise), static_cast<unsigned long long>(seed), wrong->c_str());
      }
    std::printf("%s: %llu scenes, %d broken\n", name_of(promise), static_cast<unsigned long long>(count), failures);
    broken += failures;
  }
  return broken == 0 ? 0 : 1;
}

int play_heaps(std::uint64_t count, std::uint64_t first) {
  iota::scenes::HeapTally tally;
  int failures = 0;
  for (std::uint64_t seed = first; seed < first + count && failures < 10; ++seed) {
    if (const auto wrong = iota::scenes::play_heap(seed, tally)) {
      ++failures;
      std::printf("seed %llu, %s\n", static_cast<unsigned long long>(seed), wrong->c_str());
    }
    if ((seed - first + 1) % 100 == 0)
      std::fprintf(stderr, "%llu heaps\n", static_cast<unsigned long long>(seed - first + 1));
  }
  std::printf("%llu heaps, %llu steps, %llu edits (%llu refused), islands not solved %llu, solved contact by contact %llu: %d failed\n",
              static_cast<unsigned long long>(tally.heaps), static_cast<unsigned long long>(tally.steps),
              static_cast<unsigned long long>(tally.edits), static_cast<unsigned long long>(tally.refused),
              static_cast<unsigned long long>(tally.unsolved), static_cast<unsigned long long>(tally.approximate), failures);
  std::printf("most kinetic energy from nothing in a step, of all: %.2g solved, %.2g contact by contact, %.2g not solved\n",
              tally.gained, tally.gained_in_sweeps, tally.gained_unsolved);
  return failures == 0 ? 0 : 1;
}

int make_edits(std::uint64_t count, std::uint64_t seed) {
  iota::soak::EditCount counted;
  constexpr std::uint64_t portion = 1'000'000;
  for (std::uint64_t done = 0; done < count; done += portion) {
    const auto wrong = iota::soak::compare_edits(seed + done, std::min(portion, count - done), counted);
    if (wrong) std::printf("%s\n", wrong->c_str());
    if (wrong) return 1;
    std::fprintf(stderr, "%llu edits\n", static_cast<unsigned long long>(counted.edits));
  }
  std::printf("%llu edits agree with the twin: %llu joined articulates, %llu cut them, %llu were refused\n",
              static_cast<unsigned long long>(counted.edits), static_cast<unsigned long long>(counted.joined),
              static_cast<unsigned long long>(counted.cut), static_cast<unsigned long long>(counted.refused));
  return 0;
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  const auto number = [&](int at, std::uint64_t otherwise) {
    return count > at ? std::strtoull(words[at], nullptr, 10) : otherwise;
  };
  if (what == "scenes") return play_scenes(number(2, 10'000), number(3, 1));
  if (what == "heaps") return play_heaps(number(2, 10'000), number(3, 1));
  if (what == "edits") return make_edits(number(2, 10'000'000), number(3, 1));
  if (what == "promises") return keep_promises(number(2, 10'000), number(3, 1));
  std::fprintf(stderr, "usage: iota_soak scenes|heaps|promises|edits [COUNT [FIRST_SEED]]\n");
  return 2;
}
