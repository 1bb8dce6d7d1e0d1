// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "contact/outline.h"

#include <map>
#include <memory>
#include <optional>

namespace iota::contact {

/// A value that is derived from each form when it is first asked for, and kept as long as the form lives.
template <class Value>
class FormCache {
 public:
  /// make(): the value of a form that is new here.
  template <class Make>
  const Value& of(const std::shared_ptr<const Form>& form, Make make) {
    const auto known = entries_.find(form.get());
    if (known != entries_.end() && !known->second.form.expired()) return *known->second.value;
    std::erase_if(entries_, [](const auto& each) { return each.second.form.expired(); });
    Entry& entry = entries_[form.get()];
    entry.form = form;
    return entry.value.emplace(make());
  }

 private:
  struct Entry {
    std::weak_ptr<const Form> form;
    std::optional<Value> value;
  };
  std::map<const Form*, Entry> entries_;
};

}  // namespace iota::contact
