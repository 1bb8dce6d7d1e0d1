// SPDX-License-Identifier: Apache-2.0
namespace detail {

/// Whether `text` is well-formed UTF-8 (no overlong forms, no surrogates).
inline bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int more = lead >= 0xC2 && lead <= 0xDF   ? 1
                     : lead >= 0xE0 && lead <= 0xEF ? 2
                     : lead >= 0xF0 && lead <= 0xF4 ? 3
                                                    : 0;
    if (more == 0 || text.size() - i < static_cast<std::size_t>(more)) return false;
    for (int k = 0; k < more; ++k) {
      const auto next = static_cast<unsigned char>(text[i++]);
      unsigned char low = 0x80;
      unsigned char high = 0xBF;
      if (k == 0 && lead == 0xE0) low = 0xA0;
      if (k == 0 && lead == 0xED) high = 0x9F;
      if (k == 0 && lead == 0xF0) low = 0x90;
      if (k == 0 && lead == 0xF4) high = 0x8F;
      if (next < low || next > high) return false;
    }
  }
  return true;
}

class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_(out) {}

  template <class UInt>
  void integer(UInt value) {
    const std::size_t at = out_.size();
    out_.resize(at + sizeof(UInt));
    for (std::size_t i = 0; i < sizeof(UInt); ++i) {
      out_[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }
  void real(float value, const char* field) {
    check_finite(value, field);
    integer(std::bit_cast<std::uint32_t>(value));
  }
  void real(double value, const char* field) {
    check_finite(value, field);
    integer(std::bit_cast<std::uint64_t>(value));
  }
  template <std::size_t N>
  void reals(const std::array<float, N>& value, const char* field) {
    for (const float component : value) real(component, field);
  }
  void count(std::size_t count, std::size_t limit, const char* field) {
    if (count > limit) {
      throw std::length_error(std::string(field) + ": " + std::to_string(count) +
                              " is above the limit of " + std::to_string(limit));
    }
    integer(static_cast<std::uint32_t>(count));
  }
  void text(std::string_view value, std::size_t limit, const char* field) {
    count(value.size(), limit, field);
    if (!is_utf8(value)) throw std::invalid_argument(std::string(field) + ": is not UTF-8");
    out_.insert(out_.end(), value.begin(), value.end());
  }
  void bytes(std::span<const std::uint8_t> value, std::size_t limit, const char* field) {
    count(value.size(), limit, field);
    out_.insert(out_.end(), value.begin(), value.end());
  }

 private:
  static void check_finite(double value, const char* field) {
    if (!std::isfinite(value)) {
      throw std::invalid_argument(std::string(field) + ": is not a finite number");
    }
  }
  std::vector<std::uint8_t>& out_;
};

/// Reads fields in order; after the first failure all further reads do nothing.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class UInt>
  void integer(UInt& value, const char* field) {
    if (!has(sizeof(UInt), field)) return;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(UInt); ++i) {
      bits |= static_cast<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
    }
    at_ += sizeof(UInt);
    value = static_cast<UInt>(bits);
  }
  void boolean(bool& value, const char* field) {
    std::uint8_t byte = 0;
    integer(byte, field);
    if (byte > 1) fail(field, "is neither 0 nor 1");
    value = byte == 1;
  }
  template <class E>
  void enumerator(E& value, unsigned count, const char* field) {
    std::uint8_t byte = 0;
    integer(byte, field);
    if (byte >= count) {
      fail(field, "has no meaning for the value " + std::to_string(byte));
    } else {
      value = static_cast<E>(byte);
    }
  }
  void real(float& value, const char* field) {
    std::uint32_t bits = 0;
    integer(bits, field);
    value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) fail(field, "is not a finite number");
  }
  void real(double& value, const char* field) {
    std::uint64_t bits = 0;
    integer(bits, field);
    value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) fail(field, "is not a finite number");
  }
  template <std::size_t N>
  void reals(std::array<float, N>& value, const char* field) {
    for (float& component : value) real(component, field);
  }
  /// Checked against the bytes left before anything is allocated for it.
  std::size_t count(std::size_t limit, std::size_t smallest_item, const char* field) {
    std::uint32_t count = 0;
    integer(count, field);
    if (!ok()) return 0;
    if (count > limit) {
      fail(field, "has " + std::to_string(count) + " entries, at most " + std::to_string(limit) +
                      " are allowed");
    } else if (count > left() / smallest_item) {
      fail(field, "ends early");
    }
    return ok() ? count : 0;
  }
  void text(std::string& value, std::size_t limit, const char* field) {
    const std::size_t size = count(limit, 1, field);
    if (!ok()) return;
    value.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                 bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + size));
    at_ += size;
    if (!is_utf8(value)) fail(field, "is not UTF-8");
  }
  void bytes(std::vector<std::uint8_t>& value, std::size_t limit, const char* field) {
    const std::size_t size = count(limit, 1, field);
    if (!ok()) return;
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
    value.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
    at_ += size;
  }
  void fail(const char* field, std::string_view what) {
    if (error_.empty()) error_.append(field).append(" ").append(what);
  }
  bool ok() const { return error_.empty(); }
  std::size_t left() const { return bytes_.size() - at_; }
  const std::string& error() const { return error_; }

 private:
  bool has(std::size_t size, const char* field) {
    if (ok() && left() < size) fail(field, "ends early");
    return ok();
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  std::string error_;
};

inline void write(Writer& out, const Id& value) {
  out.integer(value.slot);
  out.integer(value.generation);
}

inline void read(Reader& in, Id& value, const char* field) {
  in.integer(value.slot, field);
  in.integer(value.generation, field);
}
