# SPDX-License-Identifier: Apache-2.0
# How every target of ours is compiled.

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON) # the static libraries end up in a shared Python module
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

find_program(IOTA_CCACHE ccache)
if(IOTA_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${IOTA_CCACHE}")
endif()

# A source of ours reads 8 000 to 10 000 lines of headers, which took two thirds of the compiler's time: eight sources of a
# target share one reading. Names in anonymous namespaces must therefore differ within a folder. The preset `strict`
# compiles each source alone, so that none relies on the includes of another.
option(IOTA_UNITY "Compile eight sources at a time" ON)

# For any x86-64, gcc clears arrays of 100 bytes and more by an instruction that takes 15 ns to begin with: lists of vectors are
# cleared some twenty times in the step of a pendulum. A loop takes 3 ns for 144 bytes, and as long from 700 on. Copies by
# loops are slower than those of the library.
include(CheckCXXCompilerFlag)
set(IOTA_CLEAR_BY_LOOPS -mmemset-strategy=vector_loop:512:noalign,libcall:-1:noalign)
check_cxx_compiler_flag(${IOTA_CLEAR_BY_LOOPS} IOTA_CAN_CLEAR_BY_LOOPS)

# iota_compile(TARGET [-O2]): language level, warnings, reproducible arithmetic, sanitizers, and the level of a release,
# CMake's -O3 unless given: it takes 5 to 20 % off a step, 40 % off a law, and adds half to the time of a compilation.
function(iota_compile target)
  target_compile_options(${target} PRIVATE "$<$<CONFIG:Release>:${ARGN}>")
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic
    # Leaving the rest of an options struct to its defaults is how this interface is meant to be called.
    -Wno-missing-field-initializers
    # A fused multiply-add rounds once where a product and a sum round twice. Whether the compiler fuses depends on
    # optimization level and on what it inlines, so replays and hashes would differ between builds.
    -ffp-contract=off
    # Nothing here reads errno; without this a square root is a call instead of one instruction. Results are the same.
    -fno-math-errno
    # Nothing here traps, and nothing replaces a function of ours at run time: comparisons need no branches, and exported functions
    # are inlined within a file. 2 % fewer instructions of a step, and the same bits.
    -fno-trapping-math -fno-semantic-interposition
    # Without it the place of a function within a cache line changes with any line of code elsewhere: an edit of a chain
    # took 294 or 334 ns by luck.
    -falign-functions=64)
  if(IOTA_CAN_CLEAR_BY_LOOPS)
    target_compile_options(${target} PRIVATE ${IOTA_CLEAR_BY_LOOPS})
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${IOTA_UNITY} UNITY_BUILD_BATCH_SIZE 8)
  # No -march=native: a release must run on another machine than the one that built it.
  if(IOTA_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(IOTA_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${IOTA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${IOTA_SANITIZE})
  endif()
  if(IOTA_COVERAGE)
    target_compile_options(${target} PRIVATE --coverage)
    target_link_options(${target} PUBLIC --coverage)
  endif()
endfunction()
