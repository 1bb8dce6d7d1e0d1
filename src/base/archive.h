// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace iota {

/// Appends plain values to a byte vector. Writer and Reader have the same members, so one function serves both.
class Writer {
 public:
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&v, sizeof v);
  }
  /// The number of elements, then their bytes.
  template <class T>
  void vector(const std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(static_cast<std::uint64_t>(v.size()));
    append(v.data(), v.size() * sizeof(T));
  }
  void fail() {}
  /// The name of the items that follow; only a schema has names.
  void name(std::string_view) {}

 private:
  void append(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t end = bytes_.size();
    bytes_.resize(end + size);  // not insert(), for which gcc 12 warns of an impossible overflow
    std::memcpy(bytes_.data() + end, data, size);
  }
  std::vector<std::byte>& bytes_;
};

/// Reads the bytes of a Writer. After the first invalid value, `ok()` is false and every value is read as zero.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    take(&v, sizeof v);
  }
  template <class T>
  void vector(std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    v.resize(count(sizeof(T)));
    take(v.data(), v.size() * sizeof(T));
  }
  /// The number of following items of at least `item_size` bytes; a number that is too large for the remaining bytes is
  /// refused before anything is allocated.
  std::size_t count(std::size_t item_size) {
    std::uint64_t count = 0;
    value(count);
    if (count <= remaining() / item_size) return count;
    fail();
    return 0;
  }
  void fail() { ok_ = false; }
  void name(std::string_view) {}
  bool ok() const { return ok_; }
  bool at_end() const { return position_ == bytes_.size(); }
  std::size_t remaining() const { return bytes_.size() - position_; }

 private:
  void take(void* data, std::size_t size) {
    if (size == 0) return;
    if (!ok_ || size > remaining()) {
      ok_ = false;
      std::memset(data, 0, size);
      return;
    }
    std::memcpy(data, bytes_.data() + position_, size);
    position_ += size;
  }
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

/// 64-bit FNV-1a over the object bytes of plain values: equal bits give equal hashes.
class Hasher {
 public:
  void bytes(const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ p[i]) * 1099511628211ull;
  }
  template <class T>
  void value(const T& v) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    bytes(&v, sizeof v);
  }
  std::uint64_t result() const { return state_; }

 private:
  std::uint64_t state_ = 14695981039346656037ull;
};

/// As `Hasher`, but takes a whole value at once and not its bytes, in a fifth of the time. Two runs that differ in one value
/// give different results, since each value permutes the states.
class WordHasher {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    static_assert(sizeof v <= sizeof state_);
    std::uint64_t word = 0;
    std::memcpy(&word, &v, sizeof v);
    state_ = std::rotl(state_ ^ word, 29) * 0x9e3779b97f4a7c15u;
  }
  std::uint64_t result() const { return state_; }

 private:
  std::uint64_t state_ = 14695981039346656037ull;
};

}  // namespace iota
