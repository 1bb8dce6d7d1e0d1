// SPDX-License-Identifier: Apache-2.0
// The generated protocol against golden bytes that an independent encoder made (protocol/make_golden.py), and their
// values in iota_protocol_vectors.h.
#include "net/golden.h"
#include "tests/cpp/amount.h"

#include <gtest/gtest.h>
#include <iota_protocol_vectors.h>

#include <chrono>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <variant>

namespace iota::protocol {
namespace {

using test::golden;

template <class Variant>
std::vector<std::uint8_t> encode_any(const Variant& message) {
  return std::visit([](const auto& m) { return encode(m); }, message);
}

TEST(Protocol, golden_bytes_are_decoded_to_their_values_and_encoded_back) {
  for (const auto& [name, message] : client_vectors) {
    const auto decoded = decode_client_message(golden(name));
    ASSERT_TRUE(decoded) << name << ": " << decoded.error;
    EXPECT_TRUE(*decoded.value == message) << name;
    EXPECT_EQ(encode_any(message), golden(name)) << name;
  }
  for (const auto& [name, message] : server_vectors) {
    const auto decoded = decode_server_message(golden(name));
    ASSERT_TRUE(decoded) << name << ": " << decoded.error;
    EXPECT_TRUE(*decoded.value == message) << name;
    EXPECT_EQ(encode_any(message), golden(name)) << name;
  }
}

template <class Entity>
void expect_golden_record(const Entity& entity) {
  const std::vector<std::uint8_t> bytes = golden("entity_" + std::string(Entity::kind_name));
  std::vector<std::uint8_t> twice;
  append_record(entity, twice);
  EXPECT_EQ(twice, bytes) << Entity::kind_name;
  append_record(entity, twice);
  const auto decoded = decode_records<Entity>(twice);
  ASSERT_TRUE(decoded) << decoded.error;
  EXPECT_EQ(*decoded.value, (std::vector<Entity>{entity, entity})) << Entity::kind_name;
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_FALSE(decode_records<Entity>(std::span(bytes).first(size))) << Entity::kind_name << " cut to " << size;
}

TEST(Protocol, golden_records_of_entities_are_decoded_to_their_values_and_encoded_back) {
  std::apply([](const auto&... entity) { (expect_golden_record(entity), ...); }, entity_vectors);
}

TEST(Protocol, a_record_that_cannot_be_written_leaves_the_others_as_they_are) {
  std::vector<std::uint8_t> records{1, 2, 3};
  EXPECT_THROW(append_record(VisualEntity{{}, std::string(129, 'x'), {}}, records), std::length_error);
  EXPECT_EQ(records, (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST(Protocol, every_golden_file_is_used_and_every_message_has_one) {
  std::set<std::size_t> client_kinds;
  std::set<std::size_t> server_kinds;
  for (const auto& [name, message] : client_vectors) client_kinds.insert(message.index());
  for (const auto& [name, message] : server_vectors) server_kinds.insert(message.index());
  EXPECT_EQ(client_kinds.size(), std::variant_size_v<ClientMessage>);
  EXPECT_EQ(server_kinds.size(), std::variant_size_v<ServerMessage>);
  std::size_t good = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::golden_folder())) {
    if (entry.path().extension() == ".hex" && entry.path().stem().string().rfind("bad_", 0) != 0) ++good;
  }
  EXPECT_EQ(good, client_vectors.size() + server_vectors.size() + std::tuple_size_v<EntityKinds>);
}

TEST(Protocol, bad_golden_bytes_are_refused_with_their_reason) {
  const std::map<std::string, std::string> client_reasons{
      {"bad_empty", "the frame is empty"},
      {"bad_type", "has the type 63"},
      {"bad_direction", "has the type 64"},
      {"bad_short_select", "select.body ends early"},
      {"bad_long_select", "the frame has 1 bytes too many"},
      {"bad_nan", "grab_move.target is not a finite number"},
      {"bad_infinity", "control.value is not a finite number"},
      {"bad_nan_double", "ping.client_time is not a finite number"},
      {"bad_command", "control.command has no meaning for the value 5"},
      {"bad_string_length", "action.name ends early"},
      {"bad_string_huge", "action.name has 4294967295 entries"},
      {"bad_string_limit", "action.name has 129 entries"},
      {"bad_utf8", "action.name is not UTF-8"},
      {"bad_surrogate", "action.name is not UTF-8"},
  };
  const std::map<std::string, std::string> server_reasons{
      {"bad_count", "entities_destroyed.ids ends early"},
      {"bad_count_huge", "entities_destroyed.ids has 4294967295"},
      {"bad_bool", "poses.keyframe is neither 0 nor 1"},
      {"bad_poses_short", "poses.holds ends early"},
  };
  for (const auto& [name, reason] : client_reasons) {
    const auto decoded = decode_client_message(golden(name));
    EXPECT_FALSE(decoded) << name;
    EXPECT_NE(decoded.error.find(reason), std::string::npos) << name << ": " << decoded.error;
  }
  for (const auto& [name, reason] : server_reasons) {
    const auto decoded = decode_server_message(golden(name));
    EXPECT_FALSE(decoded) << name;
    EXPECT_NE(decoded.error.find(reason), std::string::npos) << name << ": " << decoded.error;
  }
}

TEST(Protocol, frames_that_are_cut_or_too_long_are_refused) {
  for (const auto& [name, message] : server_vectors) {
    auto bytes = golden(name);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(decode_server_message(std::span(bytes).first(size))) << name << " cut to " << size;
    }
    bytes.push_back(0);
    EXPECT_FALSE(decode_server_message(bytes)) << name;
  }
}

TEST(Protocol, encoding_refuses_messages_that_a_decoder_would_refuse) {
  EXPECT_THROW(encode(Action{std::string(129, 'x'), {}, {}}), std::length_error);
  EXPECT_THROW(encode(Action{"\xff", {}, {}}), std::invalid_argument);
  EXPECT_THROW(encode(Effect{"break", {0, std::numeric_limits<float>::quiet_NaN(), 0}}), std::invalid_argument);
  EXPECT_THROW(encode(Ping{std::numeric_limits<double>::infinity()}), std::invalid_argument);
  std::vector<std::uint8_t> out{1, 2, 3};
  EXPECT_THROW(encode(Effect{std::string(33, 'x'), {}}, out), std::length_error);
  EXPECT_EQ(out, (std::vector<std::uint8_t>{1, 2, 3}));
}

/// What is decoded has to encode back to the very bytes: no two frames mean the same, nothing is passed over.
template <class Decode>
void expect_error_or_same(const std::vector<std::uint8_t>& bytes, Decode decode, std::size_t& valid) {
  const auto decoded = decode(bytes);
  if (!decoded) {
    ASSERT_FALSE(decoded.error.empty());
    return;
  }
  ++valid;
  ASSERT_EQ(encode_any(*decoded.value), bytes);
}

TEST(Protocol, damaged_frames_give_an_error_or_a_valid_message) {
  std::mt19937 random(20240101);
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const auto& entry : std::filesystem::directory_iterator(test::golden_folder())) {
    if (entry.path().extension() == ".hex") seeds.push_back(test::read_hex(entry.path()));
  }
  ASSERT_GT(seeds.size(), 30U);
  std::size_t valid = 0;
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const int rounds = sampled(200000);
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint8_t> bytes;
    if (round % 4 == 0) {  // noise behind a type that exists
      bytes.resize(1 + below(100));
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
      bytes[0] = static_cast<std::uint8_t>(random() % 2 == 0 ? 1 + below(8) : 64 + below(14));
    } else {
      bytes = seeds[below(seeds.size())];
      for (std::size_t n = below(4); n > 0 && !bytes.empty(); --n) {
        auto& byte = bytes[below(bytes.size())];
        byte =
            random() % 2 == 0 ? static_cast<std::uint8_t>(random()) : static_cast<std::uint8_t>(byte ^ 1U << below(8));
      }
      if (round % 4 == 2) bytes.resize(below(bytes.size() + 1));
      if (round % 4 == 3) bytes.insert(bytes.end(), below(8), 0xFF);
    }
    expect_error_or_same(bytes, decode_client_message, valid);
    expect_error_or_same(bytes, decode_server_message, valid);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(valid, static_cast<std::size_t>(rounds) / 200);
}

}  // namespace
}  // namespace iota::protocol
