// SPDX-License-Identifier: Apache-2.0
// How much a test tries that samples (random scenes, edits, damaged bytes); tests/python/amount.py is the same in Python.
#pragma once

#include <cstdlib>

namespace iota {

/// `all` where IOTA_TEST_ALL is set, as by `make test-all`; else a tenth of it, with the same seeds from the first on.
template <class Count>
Count sampled(Count all) {
  return std::getenv("IOTA_TEST_ALL") ? all : all / 10;
}

}  // namespace iota
