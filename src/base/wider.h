// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>  // says which C library it is: without it the first source of a batch had no wider loops

// One build for all x86-64 processors: loops are compiled for wider registers too and chosen at load time. Widths do
// not change results, as every lane does the same operations. (Sanitizers start too late for the choice at load time.)
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define IOTA_WIDER __attribute__((target_clones("avx2", "default")))
#else
#define IOTA_WIDER
#endif

#if defined(__GNUC__)
#define IOTA_ALWAYS_INLINE inline __attribute__((always_inline))
#else
#define IOTA_ALWAYS_INLINE inline
#endif
