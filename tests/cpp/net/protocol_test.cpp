// SPDX-License-Identifier: Apache-2.0
// The generated protocol against golden bytes that an independent encoder made (protocol/make_golden.py).
#include "net/golden.h"

#include <gtest/gtest.h>
#include <iota_protocol.h>

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

const Stance stance{{0.5F, 1.5F, 2}, {0.5F, 0.5F, 0.5F, 0.5F}, 0.25F, {1, 2, 3}};

/// The values of protocol/golden/vectors.json, by name.
const std::map<std::string, ClientMessage>& client_vectors() {
  static const std::map<std::string, ClientMessage> vectors{
      {"hello", Hello{protocol_magic, 3, "default", Role::viewer, "Ada \u00fc\u4e16\U0001F517"}},
      {"hello_empty", Hello{protocol_magic, 3, "", Role::actor, ""}},
      {"select", Select{{70000, 3}}},
      {"select_none", Select{}},
      {"grab_start", GrabStart{7, {12, 1}, {0.5F, -0.25F, 0.0F}, {1.5F, -2.0F, 1024.125F}}},
      {"grab_move", GrabMove{7, {-0.125F, 3.0F, 0.0625F}}},
      {"grab_end", GrabEnd{4000000000}},
      {"action", Action{"break", {5, 2}, {{6, 1}, {70000, 3}}}},
      {"control_pause", Control{ControlCommand::pause, 0}},
      {"control_speed", Control{ControlCommand::speed, 0.25F}},
      {"ping", Ping{1234.5678}},
      {"change", Change{{3, 1}, 9.81, "Ada"}},
      {"pointer", Pointer{PointerKind::hover, {12, 1}, "mouse", {0.5F, 1, 2}, {0, 1.5F, 4}, {0, 0, -1}}},
      {"key", Key{"ArrowUp", true}},
      {"picture", Picture{7, true, {'P', 'N', 'G'}}},
      {"presence", Presence{stance}},
      {"profile", Profile{true}},
  };
  return vectors;
}

const std::map<std::string, ServerMessage>& server_vectors() {
  static const std::map<std::string, ServerMessage> vectors{
      {"welcome", Welcome{3, "default", 3}},
      {"refused", Refused{"no such world"}},
      {"poses", Poses{0x0001000200030004,
                      16.0625,
                      9,
                      true,
                      2.5F,
                      -7.25F,
                      0.0009765625F,
                      {-1, -2, -4},
                      {1, 2, 4},
                      {{0, 0, 65535, 32768, 0xDFF7FDFF}, {65535, 1, 2, 3, 0}},
                      {{70000, {0, -4096.5F, 8}, 0xC0000001}},
                      {{{0.25F, 0.5F, -0.75F}, 0.0625F, 0xFF8000, 4}},
                      {{2, 7, 12, {0.5F, 1, 1.5F}, {0.5F, 1.25F, 1.5F}, 12.5F}}}},
      {"poses_nothing_moved", Poses{5, 0.5, 1, false, 0, 0, 0, {}, {}, {}, {}, {}, {}}},
      {"notice", Notice{NoticeLevel::error, "chain.py", "ZeroDivisionError", ""}},
      {"effect", Effect{"break", {0, 1.5F, -0.5F}}},
      {"pong", Pong{1234.5678, 600}},
      {"clients", Clients{{{1, "Ada", {4, 1}, Role::actor}, {2, "", {}, Role::viewer}}}},
      {"entities_set", EntitiesSet{"body", {1, 2, 3, 4, 5}}},
      {"entities_destroyed", EntitiesDestroyed{"tie", {{7, 1}, {70000, 9}}}},
      {"world_settings",
       WorldSettings{"K\u00e4tte", {"rope", "chain"}, "rope", true, {2.5F, 1.5F, 3.5F}, {0, 1.25F, 0}, true, -0.5F}},
      {"world_state", WorldState{true, 0.5F, 0.375F, 1.0 / 120, {{"forces", 0.25F}}}},
      {"actions", Actions{{{"push", "p", "push it", "", ActionTarget::body, ControllerButton::b}}}},
      {"listens", Listens{true, false, {"k", " "}}},
      {"ask_picture", AskPicture{7}},
      {"people", People{{{2, stance}}}},
      {"pulse", Pulse{"left", 0.5F, 0.125F}},
  };
  return vectors;
}

constexpr Id entity_id{70000, 3};
const Anchor on_body{12, {0.5F, 0, -0.25F}}, in_world{no_body, {0, 2, 0}};
const Part torus{"*",     {"torus", {0.5F, 0.125F}, {}, {}}, {0, 0.25F, 0}, {0.5F, 0.5F, 0.5F, 0.5F}, 1.5F, "brass",
                 no_color};
const Part mesh{"chain", {"mesh", {}, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2}}, {}, {0, 0, 0, 1}, 0, "paint", 0xFF8000};

/// A record of each kind, as in vectors.json.
const std::tuple<StyleEntity, BodyEntity, MembershipEntity, TieEntity, JointEntity, NailEntity, ParticleSetEntity,
                 StaticShapeEntity, LabelEntity, LineEntity, ArrowEntity, AxesEntity, TraceEntity, PointCloudEntity,
                 MarkerEntity, WidgetEntity, PlotEntity, SurfaceEntity, PaintEntity, ShapeSetEntity, StrutEntity,
                 FrameEntity, TubeEntity, ViewpointEntity, StageEntity, TextureEntity, LightEntity>
    entity_vectors{{entity_id, "link", {torus, mesh}},
                   {entity_id, BodyKind::scripted, 9, true, 0.125F},
                   {entity_id, 40000},
                   {entity_id, TieKind::rope, 3, 0.75F, on_body, in_world},
                   {entity_id, "revolute", on_body, in_world, {0, 0, 1}},
                   {entity_id, on_body},
                   {entity_id, true, 1000},
                   {entity_id, torus},
                   {entity_id, on_body, in_world, {0, 0.5F, 0}, "K\u00e4tte", 0.125F, 0xFF8000},
                   {entity_id, {12, no_body}, {0, 1, 2, 3, 4, 5}, 0.25F, true, no_color},
                   {entity_id, on_body, in_world, {1, 0, -0.5F}, 0, 0xFF8000},
                   {entity_id, on_body, {0.5F, 0.5F, 0.5F, 0.5F}, 0.75F},
                   {entity_id, on_body, 2.5F, 1000, 0, no_color},
                   {entity_id, in_world, {0, 1, 2, 3, 4, 5}, {0.5F}, {0xFF8000, 0x80FF}},
                   {entity_id, 12, torus},
                   {entity_id, WidgetKind::slider, "gravity", "", "m/s\u00b2", 9.81, 0, 20, 0.5, "", {"one"}, true, 3},
                   {entity_id, "energy", "J", 10, {"kinetic", "potential"}, {1, 2}, {0.5F, 1}, {1, 2, 3, 4}},
                   {entity_id,
                    in_world,
                    {12, no_body, first_frame + 1},
                    {0, 0, 0, 1, 0, 0, 0, 1, 0},
                    {0, 1, 2},
                    {0, 0, 1, 0, 0, 1},
                    "paint#0a1b",
                    0x40FF8000},
                   {entity_id, {12, 13}, {0xFF8000}},
                   {entity_id, on_body, torus, {0, 1, 2}, {0.5F, 0.5F, 0.5F, 0.5F}, {2}, {0x80FF}},
                   {entity_id, on_body, in_world, torus, 0.75F},
                   {entity_id, on_body, {0.5F, 0.5F, 0.5F, 0.5F}},
                   {entity_id, {}, {0, 1, 2, 3, 4, 5}, 0.25F, true, "rope", no_color},
                   {entity_id, "driver", on_body, in_world},
                   {entity_id, 0x0B1020, 0x203040, no_color, 0.5F},
                   {entity_id, "0a1b", {0x89, 'P', 'N'}, 2, 0.5F},
                   {entity_id, LightKind::spot, on_body, in_world, 0xFF8000, 2, 0.5F, 0.25F, true}};

template <class Variant>
std::vector<std::uint8_t> encode_any(const Variant& message) {
  return std::visit([](const auto& m) { return encode(m); }, message);
}

TEST(Protocol, golden_bytes_are_decoded_to_their_values_and_encoded_back) {
  for (const auto& [name, message] : client_vectors()) {
    const auto decoded = decode_client_message(golden(name));
    ASSERT_TRUE(decoded) << name << ": " << decoded.error;
    EXPECT_TRUE(*decoded.value == message) << name;
    EXPECT_EQ(encode_any(message), golden(name)) << name;
  }
  for (const auto& [name, message] : server_vectors()) {
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
  static_assert(std::is_same_v<std::remove_const_t<decltype(entity_vectors)>, EntityKinds>, "a record of each kind");
  std::apply([](const auto&... entity) { (expect_golden_record(entity), ...); }, entity_vectors);
}

TEST(Protocol, a_record_that_cannot_be_written_leaves_the_others_as_they_are) {
  std::vector<std::uint8_t> records{1, 2, 3};
  EXPECT_THROW(append_record(StyleEntity{{}, std::string(129, 'x'), {}}, records), std::length_error);
  EXPECT_EQ(records, (std::vector<std::uint8_t>{1, 2, 3}));
}

TEST(Protocol, every_golden_file_is_used_and_every_message_has_one) {
  std::set<std::size_t> client_kinds;
  std::set<std::size_t> server_kinds;
  for (const auto& [name, message] : client_vectors()) client_kinds.insert(message.index());
  for (const auto& [name, message] : server_vectors()) server_kinds.insert(message.index());
  EXPECT_EQ(client_kinds.size(), std::variant_size_v<ClientMessage>);
  EXPECT_EQ(server_kinds.size(), std::variant_size_v<ServerMessage>);
  std::size_t good = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::golden_folder())) {
    if (entry.path().extension() == ".hex" && entry.path().stem().string().rfind("bad_", 0) != 0) ++good;
  }
  EXPECT_EQ(good, client_vectors().size() + server_vectors().size() + std::tuple_size_v<EntityKinds>);
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
  for (const auto& [name, message] : server_vectors()) {
    auto bytes = golden(name);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_FALSE(decode_server_message(std::span(bytes).first(size))) << name << " cut to " << size;
    }
    bytes.push_back(0);
    EXPECT_FALSE(decode_server_message(bytes)) << name;
  }
}

TEST(Protocol, encoding_refuses_what_a_decoder_would_refuse) {
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

TEST(Protocol, two_hundred_thousand_damaged_frames_give_an_error_or_a_valid_message) {
  std::mt19937 random(20240101);
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const auto& entry : std::filesystem::directory_iterator(test::golden_folder())) {
    if (entry.path().extension() == ".hex") seeds.push_back(test::read_hex(entry.path()));
  }
  ASSERT_GT(seeds.size(), 30U);
  std::size_t valid = 0;
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  for (int round = 0; round < 200000; ++round) {
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
  EXPECT_GT(valid, 1000U);
}

}  // namespace
}  // namespace iota::protocol
