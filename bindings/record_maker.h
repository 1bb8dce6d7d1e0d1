// SPDX-License-Identifier: Apache-2.0
// Makes the records of iota._protocol from what a client has sent.
#pragma once

#include <iota/vec3.h>

#include <iota_protocol.h>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstdint>
#include <tuple>
#include <type_traits>
#include <vector>

namespace iota::bindings {

namespace nb = nanobind;

class RecordMaker {
 public:
  template <class Value>
  nb::object make(const Value& value) const {
    if constexpr (std::is_enum_v<Value>) {
      return module_.attr(protocol::record_name<Value>)(static_cast<int>(value));
    } else if constexpr (std::is_same_v<Value, protocol::Vec3>) {
      return nb::cast(Vec3{value[0], value[1], value[2]});
    } else if constexpr (std::is_same_v<Value, protocol::Quat>) {
      return nb::make_tuple(value[0], value[1], value[2], value[3]);
    } else if constexpr (requires { value.fields(); }) {
      return std::apply(
          [this](const auto&... fields) { return module_.attr(protocol::record_name<Value>)(make(fields)...); },
          value.fields());
    } else {
      return nb::cast(value);
    }
  }

  nb::object make(const std::vector<std::uint8_t>& bytes) const {
    return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  /// A tuple.
  template <class Item>
  nb::object make(const std::vector<Item>& items) const {
    nb::list made;
    for (const Item& item : items) made.append(make(item));
    return nb::tuple(made);
  }

 private:
  nb::module_ module_ = nb::module_::import_("iota._protocol");
};

}  // namespace iota::bindings
