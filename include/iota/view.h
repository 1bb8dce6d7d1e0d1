// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace iota {

struct Core;

/// A part of the interface of a `System`, such as `system.bodies()`: it refers to the system and must not outlive it.
class View {
 public:
  View(const View&) = delete;
  View& operator=(const View&) = delete;

 protected:
  explicit View(Core& core) : core_(core) {}
  ~View() = default;

  Core& core_;
};

}  // namespace iota
