// SPDX-License-Identifier: Apache-2.0
// The hub without sockets: links that keep what they are sent, in place of connections.
#include "net/hub.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <variant>
#include <vector>

namespace iota::net {
namespace {

class Link : public ClientLink {
 public:
  void send(const Frame& frame, std::string_view) override {
    const auto decoded = protocol::decode_server_message(*frame);
    ASSERT_TRUE(decoded) << decoded.error;
    received.push_back(*decoded.value);
  }
  void world_changed() override { ++changes; }
  void drop(std::string_view reason) override { dropped = reason; }
  void world_ended() override { has_ended = true; }
  std::string address() const override { return machine; }

  template <class Message>
  std::vector<Message> all() const {
    std::vector<Message> found;
    for (const auto& message : received)
      if (const auto* one = std::get_if<Message>(&message)) found.push_back(*one);
    return found;
  }
  std::string last_notice() const {
    const auto notices = all<protocol::Notice>();
    return notices.empty() ? "" : notices.back().title + ": " + notices.back().text;
  }

  std::vector<protocol::ServerMessage> received;
  int changes = 0;
  std::string dropped, machine;
  bool has_ended = false;
};

class HubTest : public testing::Test {
 protected:
  static protocol::Hello hello(const std::string& name = {}, protocol::Role role = protocol::Role::host) {
    return {protocol::protocol_magic, protocol::protocol_version, {}, role, name};
  }
  std::uint32_t join(Link& link, const std::string& name = {}, protocol::Role role = protocol::Role::host) {
    return hub.join(link, hello(name, role)).first;
  }
  template <class Message>
  void receive(std::uint32_t client, const Message& message) {
    hub.receive(client, protocol::encode(message));
  }
  /// The messages that wait for the script, without joins and leaves.
  std::vector<ClientInput> take_gestures() {
    std::vector<ClientInput> inputs = hub.take_input();
    std::erase_if(inputs, [](const ClientInput& input) {
      return std::holds_alternative<protocol::Join>(input.what) || std::holds_alternative<protocol::Leave>(input.what);
    });
    return inputs;
  }

  Counters counters;
  int frames_asked = 0;
  Hub hub{"world", 2, counters, [this] { ++frames_asked; }};
};

TEST_F(HubTest, welcomes_who_joins_and_says_who_is_there) {
  Link link;
  const std::uint32_t client = join(link, "Ada");
  ASSERT_GE(link.received.size(), 2u);
  const auto& welcome = std::get<protocol::Welcome>(link.received[0]);
  EXPECT_EQ(welcome.client, client);
  EXPECT_EQ(welcome.world, "world");
  EXPECT_EQ(link.all<protocol::Clients>().at(0).clients.at(0).name, "Ada");
  EXPECT_EQ(counters.clients, 1u);
  const auto events = hub.take_input();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].client, client);
  EXPECT_EQ(events[0].what, protocol::Input(protocol::Join{"Ada", protocol::Role::host}));
}

TEST_F(HubTest, a_loop_that_waits_for_input_is_woken_by_it_and_by_other_threads) {
  using Clock = std::chrono::steady_clock;
  constexpr double never = 30;  // s
  const auto begin = Clock::now();
  Link link;
  join(link);
  hub.wait_for_input(never);  // it is there
  (void)hub.take_input();
  hub.wake();
  hub.wait_for_input(never);  // it was woken before
  std::jthread other([this] { hub.wake(); });
  hub.wait_for_input(never);
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(20));
  hub.wait_for_input(0.001);
}

TEST_F(HubTest, refuses_a_full_world_and_another_protocol_with_a_reason) {
  Link one, two, three;
  protocol::Hello old = hello();
  old.version = protocol::protocol_version - 1;
  EXPECT_NE(hub.join(one, old).second.find("reload the page"), std::string::npos);
  protocol::Hello other = hello();
  other.magic = 7;
  EXPECT_FALSE(hub.join(one, other).second.empty());
  join(one);
  join(two);
  const auto [client, reason] = hub.join(three, hello());
  EXPECT_EQ(client, 0u);
  EXPECT_EQ(reason, "the world is full: 2 clients are connected");
  EXPECT_TRUE(three.received.empty());
}

TEST_F(HubTest, asks_for_one_delivery_however_much_is_published) {
  EXPECT_TRUE(hub.notice(0, 0, "one", "", "", false));
  EXPECT_FALSE(hub.notice(0, 0, "two", "", "", false));
  EXPECT_FALSE(hub.publish({}, {}));
  Link link;
  join(link);
  hub.deliver();
  EXPECT_EQ(link.all<protocol::Notice>().size(), 2u);
  EXPECT_EQ(link.changes, 1);
  EXPECT_TRUE(hub.publish({}, {})) << "nothing waits any more";
}

TEST_F(HubTest, sends_private_messages_to_one_client_and_public_ones_to_all) {
  Link one, two;
  const std::uint32_t first = join(one);
  join(two);
  (void)hub.notice(first, 1, "for one", "text", "", false);
  (void)hub.effect("break", {1, 2, 3});
  hub.deliver();
  EXPECT_EQ(one.last_notice(), "for one: text");
  EXPECT_EQ(two.last_notice(), "");
  EXPECT_EQ(two.all<protocol::Effect>().at(0).kind, "break");
}

TEST_F(HubTest, sends_a_pulse_to_one_client) {
  Link one, two;
  const std::uint32_t first = join(one);
  join(two);
  (void)hub.pulse(first, {"left", 0.5F, 0.1F});
  (void)hub.pulse(99, {"left", 0.5F, 0.1F});
  hub.deliver();
  EXPECT_EQ(one.all<protocol::Pulse>().at(0).hand, "left");
  EXPECT_TRUE(two.all<protocol::Pulse>().empty());
}

TEST_F(HubTest, sends_settings_to_one_client_and_late_joiners_get_those_of_all) {
  Link first, second, late;
  const std::uint32_t other = join(first), client = join(second);
  (void)hub.set(protocol::WorldSettings{.title = "of all"});
  (void)hub.set(protocol::WorldSettings{.title = "of one"}, client);
  (void)hub.set(protocol::WorldSettings{.title = "of nobody"}, 77U);
  hub.deliver();
  hub.leave(other);  // there is room for two
  join(late);
  EXPECT_EQ(second.all<protocol::WorldSettings>().back().title, "of one");
  for (const Link* link : {&first, &late}) {
    ASSERT_EQ(link->all<protocol::WorldSettings>().size(), 1U);
    EXPECT_EQ(link->all<protocol::WorldSettings>()[0].title, "of all");
  }
}

TEST_F(HubTest, tells_all_where_users_are_once_a_frame) {
  Link one, two;
  const std::uint32_t first = join(one);
  const std::uint32_t second = join(two);
  hub.frame();
  for (const float x : {1.0F, 2.0F, 3.0F}) receive(first, protocol::Presence{{{x, 0, 0}, {0, 0, 0, 1}, 1, {}}});
  receive(second, protocol::Presence{{{7, 0, 0}, {0, 0, 0, 1}, 1, {1, 2, 3}}});
  EXPECT_TRUE(two.all<protocol::People>().empty());
  hub.frame();
  hub.frame();
  const auto told = two.all<protocol::People>();
  ASSERT_EQ(told.size(), 1u);
  ASSERT_EQ(told[0].people.size(), 2u);
  EXPECT_EQ(told[0].people[0].client, first);
  EXPECT_EQ(told[0].people[0].stance.head[0], 3.0F) << "the newest";
  EXPECT_EQ(told[0].people[1].stance.hands.size(), 3u);
  hub.leave(second);
  hub.frame();
  EXPECT_EQ(one.all<protocol::People>().back().people.size(), 1u);
}

TEST_F(HubTest, gives_the_script_the_newest_place_of_a_user) {
  Link link;
  const std::uint32_t client = join(link);
  (void)hub.take_input();
  for (const float x : {1.0F, 2.0F, 3.0F}) receive(client, protocol::Presence{{{x, 0, 0}, {0, 0, 0, 1}, 1, {}}});
  const auto input = hub.take_input();
  ASSERT_EQ(input.size(), 1u);
  EXPECT_EQ(std::get<protocol::Presence>(input[0].what).stance.head[0], 3.0F);
}

TEST_F(HubTest, tells_all_the_new_name_of_a_user) {
  Link one, two;
  const std::uint32_t client = join(one, "Ada");
  join(two);
  receive(client, protocol::Rename{"Grace"});
  hub.frame();
  EXPECT_EQ(two.all<protocol::Clients>().back().clients.at(0).name, "Grace");
  EXPECT_EQ(std::get<protocol::Rename>(hub.take_input().back().what).name, "Grace");
}

TEST_F(HubTest, keeps_one_notice_of_an_id_whatever_its_title) {
  (void)hub.notice(0, 0, "first", "", "", true, {"quiz", 30, protocol::NoticePlace::left});
  (void)hub.notice(0, 0, "second", "", "", true, {"quiz", -1, protocol::NoticePlace::free});
  hub.deliver();
  Link link;
  join(link);
  const auto notices = link.all<protocol::Notice>();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_EQ(notices[0].title, "second");
  EXPECT_EQ(notices[0].id, "quiz");
  EXPECT_EQ(notices[0].seconds, -1.0F);
  (void)hub.forget_notice("quiz");
  hub.deliver();
  Link later;
  join(later);
  EXPECT_TRUE(later.all<protocol::Notice>().empty());
}

TEST_F(HubTest, refuses_a_place_of_a_user_that_is_far_or_not_whole) {
  Link link;
  const std::uint32_t client = join(link);
  receive(client, protocol::Presence{{{3e9F, 0, 0}, {0, 0, 0, 1}, 1, {}}});
  EXPECT_NE(link.last_notice().find("beyond 1e9 m"), std::string::npos);
  receive(client, protocol::Presence{{{0, 0, 0}, {0, 0, 0, 1}, 1, {1, 2}}});
  EXPECT_NE(link.last_notice().find("three coordinates"), std::string::npos);
  hub.frame();
  EXPECT_TRUE(link.all<protocol::People>().empty());
}

TEST_F(HubTest, gives_the_latest_of_each_message_and_kept_notices_to_late_joiners) {
  (void)hub.set(protocol::WorldSettings{.title = "old"});
  (void)hub.set(protocol::WorldSettings{.title = "new"});
  for (int i = 0; i < 9; ++i) (void)hub.notice(0, 1, "kept " + std::to_string(i), "text", "", true);
  (void)hub.notice(0, 1, "kept 8", "again", "", true);
  hub.deliver();
  Link link;
  join(link);
  const auto settings = link.all<protocol::WorldSettings>();
  ASSERT_EQ(settings.size(), 1u);
  EXPECT_EQ(settings[0].title, "new");
  const auto notices = link.all<protocol::Notice>();
  ASSERT_EQ(notices.size(), 8u) << "the oldest is forgotten";
  EXPECT_EQ(notices.front().title, "kept 1");
  EXPECT_EQ(notices.back().text, "again");
  (void)hub.forget_notice("kept 1");
  hub.deliver();
  Link later;
  join(later);
  EXPECT_EQ(later.all<protocol::Notice>().size(), 7u);
}

TEST_F(HubTest, cuts_a_notice_between_characters_and_repairs_invalid_utf8) {
  Link link;
  join(link);
  std::string title;
  for (int i = 0; i < 200; ++i) title += "\xC3\xA9";  // 400 bytes of a letter of two
  (void)hub.notice(0, 9, title, "a\xFFz", "", false);
  hub.deliver();
  const auto notice = link.all<protocol::Notice>().at(0);
  EXPECT_LE(notice.title.size(), 256u);
  EXPECT_EQ(notice.title.substr(notice.title.size() - 5), "\xC3\xA9...");
  EXPECT_EQ(notice.text, "a?z");
}

TEST_F(HubTest, keeps_the_newest_place_of_each_grip) {
  Link link;
  const std::uint32_t client = join(link);
  for (const std::uint32_t hold : {1u, 2u}) receive(client, protocol::GrabStart{.hold = hold});
  for (int i = 1; i <= 5; ++i) {
    for (const std::uint32_t hold : {1u, 2u})
      receive(client, protocol::GrabMove{hold, {static_cast<float>(i), static_cast<float>(hold), 0}});
  }
  receive(client, protocol::GrabEnd{1});
  receive(client, protocol::GrabMove{2, {9, 2, 0}});
  const auto events = take_gestures();
  ASSERT_EQ(events.size(), 6u) << "2 starts, 2 moves, an end, and a move after it";
  EXPECT_EQ(events[2].what, protocol::Input(protocol::GrabMove{1, {5, 1, 0}}));
  EXPECT_EQ(events[3].what, protocol::Input(protocol::GrabMove{2, {5, 2, 0}}));
  EXPECT_EQ(events[4].what, protocol::Input(protocol::GrabEnd{1}));
  EXPECT_EQ(events[5].what, protocol::Input(protocol::GrabMove{2, {9, 2, 0}}));
}

TEST_F(HubTest, keeps_the_newest_place_of_each_pointer_also_among_those_of_grips) {
  Link link;
  const std::uint32_t client = join(link);
  receive(client, protocol::GrabStart{1, {7, 1}, {}, {}});
  const auto move = [](const std::string& name, float x) {
    return protocol::Pointer{
        protocol::PointerKind::move, {}, name, {x, 0, 0}, {}, {0, 0, -1}, {0, 0, 0, 1}, {x}, {}, {}};
  };
  for (float x = 1; x <= 100; ++x) {
    receive(client, move("left", x));
    receive(client, protocol::GrabMove{1, {x, 0, 0}});
    receive(client, move("right", -x));
  }
  const auto events = take_gestures();
  ASSERT_EQ(events.size(), 4u) << "the start, one of the grip and of each pointer";
  EXPECT_EQ(events[1].what, protocol::Input(move("left", 100)));
  EXPECT_EQ(events[2].what, protocol::Input(protocol::GrabMove{1, {100, 0, 0}}));
  EXPECT_EQ(events[3].what, protocol::Input(move("right", -100)));
  protocol::Pointer wrong = move("left", 1);
  wrong.joints = {1, 2};
  receive(client, wrong);
  wrong.joints = {1, 2, 2e9F};
  receive(client, wrong);
  EXPECT_TRUE(take_gestures().empty());
  EXPECT_TRUE(link.dropped.empty());
  EXPECT_NE(link.last_notice().find("beyond 1e9 m"), std::string::npos) << link.last_notice();
}

TEST_F(HubTest, keeps_the_newest_value_of_a_control_until_something_else_is_done) {
  Link link;
  const std::uint32_t client = join(link);
  const protocol::Id slider{1, 1}, other{2, 1};
  for (int i = 0; i < 50; ++i) receive(client, protocol::Change{slider, 1.0 * i, ""});
  receive(client, protocol::Change{other, 7, ""});
  receive(client, protocol::Change{slider, 99, ""});
  std::vector<protocol::Input> taken;
  for (const ClientInput& input : take_gestures()) taken.push_back(input.what);
  EXPECT_EQ(taken, (std::vector<protocol::Input>{protocol::Change{slider, 49, ""}, protocol::Change{other, 7, ""},
                                                 protocol::Change{slider, 99, ""}}));
}

TEST_F(HubTest, refuses_grips_that_do_not_fit_and_the_client_stays) {
  Link link;
  const std::uint32_t client = join(link);
  receive(client, protocol::GrabStart{.hold = 1});
  receive(client, protocol::GrabStart{.hold = 1});
  EXPECT_NE(link.last_notice().find("in use already"), std::string::npos);
  receive(client, protocol::GrabMove{7, {}});
  EXPECT_NE(link.last_notice().find("holds nothing"), std::string::npos);
  receive(client, protocol::GrabMove{1, {2e9F, 0, 0}});
  EXPECT_NE(link.last_notice().find("1e9 m"), std::string::npos);
  for (std::uint32_t hold = 2; hold < 40; ++hold) receive(client, protocol::GrabStart{.hold = hold});
  EXPECT_NE(link.last_notice().find("holds too much"), std::string::npos);
  EXPECT_EQ(take_gestures().size(), 32u);
  EXPECT_EQ(counters.frames_refused, 10u);
  EXPECT_EQ(link.dropped, "");
}

TEST_F(HubTest, answers_bytes_that_are_no_message_with_a_notice) {
  Link link;
  const std::uint32_t client = join(link);
  hub.receive(client, std::vector<std::uint8_t>{});
  hub.receive(client, std::vector<std::uint8_t>{255, 1, 2});
  std::vector<std::uint8_t> cut = protocol::encode(protocol::GrabStart{.hold = 1});
  cut.pop_back();
  hub.receive(client, cut);
  EXPECT_EQ(link.all<protocol::Notice>().size(), 3u);
  EXPECT_TRUE(take_gestures().empty());
}

TEST_F(HubTest, lets_guests_touch_but_not_pause_reset_or_send_away) {
  Link host, guest;
  const std::uint32_t first = join(host), client = join(guest, "", protocol::Role::actor);
  receive(client, protocol::GrabStart{.hold = 1});
  receive(client, protocol::Action{.name = "break"});
  receive(client, protocol::Change{{1, 1}, 0.5, ""});
  EXPECT_EQ(take_gestures().size(), 3u);
  for (int command = 0; command < 5; ++command)
    receive(client, protocol::Control{static_cast<protocol::ControlCommand>(command), 0});
  receive(client, protocol::SendAway{first});
  EXPECT_TRUE(take_gestures().empty());
  EXPECT_EQ(guest.all<protocol::Notice>().size(), 6u);
  EXPECT_NE(guest.last_notice().find("Only the host"), std::string::npos);
  EXPECT_EQ(host.dropped, "");
}

TEST_F(HubTest, lets_a_host_send_others_away_who_stay_away_on_another_machine) {
  Link host, guest;
  const std::uint32_t first = join(host), client = join(guest, "", protocol::Role::actor);
  guest.machine = "192.168.0.7";
  receive(first, protocol::SendAway{first});
  EXPECT_EQ(host.dropped, "") << "not itself";
  receive(first, protocol::SendAway{client});
  EXPECT_EQ(guest.dropped, "the host has sent you away");
  hub.leave(client);
  guest.dropped.clear();
  EXPECT_EQ(join(guest, "", protocol::Role::viewer), 0u);
  EXPECT_EQ(guest.dropped, "the host has sent you away") << "so that its page does not try again";
  EXPECT_NE(join(guest, "", protocol::Role::host), 0u) << "a host by its address may come from there";
}

TEST_F(HubTest, lets_a_viewer_select_and_nothing_else) {
  Link link;
  const std::uint32_t client = join(link, "", protocol::Role::viewer);
  receive(client, protocol::Select{{4, 1}});
  receive(client, protocol::GrabStart{.hold = 1});
  EXPECT_NE(link.last_notice().find("You only watch"), std::string::npos);
  receive(client, protocol::Action{.name = "break", .body = {4, 1}});
  receive(client, protocol::Control{protocol::ControlCommand::reset, 0});
  receive(client, protocol::Change{{1, 1}, 0.5, ""});
  receive(client, protocol::Key{"k", true});
  receive(client, protocol::Pointer{.kind = protocol::PointerKind::click, .name = "mouse"});
  receive(client, protocol::Profile{true});
  receive(client, protocol::SendAway{7});
  const auto events = take_gestures();
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].what, protocol::Input(protocol::Select{{4, 1}}));
}

TEST_F(HubTest, passes_messages_through_as_they_were_sent) {
  Link link;
  const std::uint32_t client = join(link);
  const std::vector<protocol::Input> sent{
      protocol::GrabStart{3, {4, 1}, {1, 2, 3}, {4, 5, 6}},
      protocol::Action{"break", {4, 1}, {{5, 2}}},
      protocol::Change{{1, 1}, 0.5, "text"},
      protocol::Pointer{
          protocol::PointerKind::click, {4, 1}, "mouse", {1, 0, 0}, {}, {0, 0, -1}, {0, 0, 0, 1}, {1}, {}, {1, 2, 3}},
      protocol::Key{"k", true},
      protocol::Profile{true}};
  for (const auto& each : sent)
    std::visit(
        [&](const auto& message) {
          if constexpr (requires { message.message_type; }) receive(client, message);
        },
        each);
  std::vector<protocol::Input> taken;
  for (const ClientInput& input : take_gestures()) taken.push_back(input.what);
  EXPECT_EQ(taken, sent);
}

TEST_F(HubTest, refuses_each_place_that_is_too_far) {
  Link link;
  const std::uint32_t client = join(link);
  const protocol::Vec3 far{0, 2e9F, 0};
  receive(client, protocol::GrabStart{1, {4, 1}, far, {}});
  receive(client, protocol::GrabStart{1, {4, 1}, {}, far});
  receive(client, protocol::Pointer{protocol::PointerKind::click, {}, "mouse", {}, far, {}, {0, 0, 0, 1}, {}, {}, {}});
  receive(client, protocol::Presence{{far, {0, 0, 0, 1}, 1, {}}});
  receive(client, protocol::Presence{{{}, {0, 0, 0, 1}, 1, {0, 0, 2e9F}}});
  EXPECT_EQ(counters.frames_refused, 5u);
  EXPECT_EQ(link.last_notice(), "A message was not understood: presence: a place is beyond 1e9 m");
  EXPECT_TRUE(take_gestures().empty());
}

TEST_F(HubTest, takes_one_single_step_a_round_and_one_reset_a_second_from_all_clients_together) {
  Link link, other;
  const std::uint32_t clients[] = {join(link), join(other)};
  for (int i = 0; i < 100; ++i) {
    for (const std::uint32_t client : clients) {
      receive(client, protocol::Control{protocol::ControlCommand::single_step, 0});
      receive(client, protocol::Control{protocol::ControlCommand::reset, 0});
    }
  }
  EXPECT_EQ(take_gestures().size(), 2u);
  EXPECT_EQ(link.all<protocol::Notice>().size(), 1u) << "told once to wait";
  EXPECT_EQ(other.all<protocol::Notice>().size(), 1u);
}

TEST_F(HubTest, limits_the_bytes_that_wait_for_the_script) {
  Link flood;
  const std::uint32_t client = join(flood);
  const protocol::Action large{.name = "copy", .body = {}, .others = std::vector<protocol::Id>(4000)};
  std::size_t taken = 0;
  for (; taken < 1000 && flood.dropped.empty(); ++taken) receive(client, large);
  EXPECT_LE(taken * 4000 * sizeof(protocol::Id), std::size_t{1100} << 10);
  EXPECT_EQ(flood.dropped, "more input than the script can take");
}

TEST_F(HubTest, has_room_again_when_the_script_has_read_what_waited) {
  Link busy;
  const std::uint32_t client = join(busy);
  const protocol::Action large{.name = "copy", .body = {}, .others = std::vector<protocol::Id>(4000)};
  for (int round = 0; round < 12; ++round) {  // of 0.6 MB: together more than may wait in a world
    for (int i = 0; i < 20; ++i) receive(client, large);
    EXPECT_EQ(take_gestures().size(), 20u) << round;
  }
  EXPECT_EQ(busy.dropped, "");
}

TEST_F(HubTest, limits_the_bytes_of_values_that_replace_older_ones) {
  Link flood;
  const std::uint32_t client = join(flood);
  for (std::uint32_t widget = 0; widget < 4000 && flood.dropped.empty(); ++widget) {
    receive(client, protocol::Change{{widget, 1}, 0, ""});
    receive(client, protocol::Change{{widget, 1}, 0, std::string(4000, 'a')});
  }
  std::size_t bytes = 0;
  for (const ClientInput& input : hub.take_input())
    if (const auto* change = std::get_if<protocol::Change>(&input.what)) bytes += change->text.size();
  EXPECT_LE(bytes, std::size_t{1100} << 10);
}

TEST_F(HubTest, forgets_clients_that_come_fill_the_queue_and_go_while_the_script_hangs) {
  const protocol::Action large{.name = "copy", .body = {}, .others = std::vector<protocol::Id>(4000)};
  for (int time = 0; time < 200; ++time) {
    Link link;
    const std::uint32_t client = join(link);
    while (link.dropped.empty()) receive(client, large);
    hub.leave(client);
  }
  std::size_t bytes = 0;
  for (const ClientInput& input : hub.take_input())
    if (const auto* action = std::get_if<protocol::Action>(&input.what)) bytes += action->others.size() * 8;
  EXPECT_LE(bytes, std::size_t{2} << 20) << "40 MB before";
  Link late;
  const std::uint32_t client = join(late);
  hub.leave(client);
  EXPECT_EQ(hub.take_input().size(), 2u) << "those who come and go in peace are told";
}

TEST_F(HubTest, gives_pictures_before_other_input_which_stays_in_order) {
  Link link;
  const std::uint32_t client = join(link);
  (void)hub.ask_picture(client, 1);
  hub.deliver();
  receive(client, protocol::Key{"a", true});
  receive(client, protocol::Picture{.request = 1, .is_last = false, .data = {1}});
  receive(client, protocol::Key{"b", true});
  receive(client, protocol::Picture{.request = 1, .is_last = true, .data = {2}});
  const auto pictures = hub.take_pictures();
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(std::get<protocol::Picture>(pictures[1].what).data.front(), 2);
  const auto rest = take_gestures();
  ASSERT_EQ(rest.size(), 2u);
  EXPECT_EQ(std::get<protocol::Key>(rest[0].what).key, "a");
}

TEST_F(HubTest, has_room_again_for_each_picture_that_was_taken) {
  Link link;
  const std::uint32_t client = join(link);
  (void)hub.ask_picture(client, 1);
  hub.deliver();
  for (int part = 0; part < 20'000; ++part) {  // together more than may wait
    receive(client, protocol::Picture{.request = 1, .is_last = false, .data = {1}});
    ASSERT_EQ(hub.take_pictures().size(), 1u) << part;
  }
  EXPECT_EQ(link.dropped, "");
}

TEST_F(HubTest, drops_a_client_that_sends_more_than_the_script_takes_and_only_it) {
  Link flood, calm;
  const std::uint32_t client = join(flood), other = join(calm);
  for (int i = 0; i < 5000; ++i) receive(client, protocol::Key{.key = "a", .down = i % 2 == 0});
  EXPECT_EQ(flood.dropped, "more input than the script can take");
  receive(other, protocol::Key{.key = "b", .down = true});
  const auto events = take_gestures();
  EXPECT_EQ(events.size(), 4097u);
  EXPECT_EQ(events.back().client, other);
  EXPECT_EQ(calm.dropped, "");
}

TEST_F(HubTest, takes_a_picture_only_from_whom_it_asked) {
  Link link;
  const std::uint32_t client = join(link);
  receive(client, protocol::Picture{.request = 1, .is_last = true, .data = {1}});
  EXPECT_NE(link.last_notice().find("none was asked for"), std::string::npos);
  (void)hub.ask_picture(client, 1);
  hub.deliver();
  EXPECT_EQ(link.all<protocol::AskPicture>().at(0).request, 1u);
  receive(client, protocol::Picture{.request = 1, .is_last = false, .data = {1}});
  receive(client, protocol::Picture{.request = 1, .is_last = true, .data = {2}});
  receive(client, protocol::Picture{.request = 1, .is_last = true, .data = {3}});
  EXPECT_EQ(take_gestures().size(), 2u) << "it was whole";
}

TEST_F(HubTest, sends_the_list_of_clients_at_most_once_a_frame) {
  Link one, two;
  const std::uint32_t client = join(one);
  join(two);
  for (std::uint32_t slot = 0; slot < 50; ++slot) receive(client, protocol::Select{{slot, 1}});
  EXPECT_EQ(frames_asked, 1);
  const std::size_t before = two.all<protocol::Clients>().size();
  hub.frame();
  hub.frame();
  const auto told = two.all<protocol::Clients>();
  ASSERT_EQ(told.size(), before + 1);
  EXPECT_EQ(told.back().clients.at(0).selected, (protocol::Id{49, 1}));
}

TEST_F(HubTest, says_when_the_world_ends_and_forgets_who_left) {
  Link one, two;
  const std::uint32_t client = join(one);
  join(two);
  hub.leave(client);
  hub.leave(client);
  EXPECT_EQ(counters.clients, 1u);
  hub.end();
  EXPECT_FALSE(one.has_ended);
  EXPECT_TRUE(two.has_ended);
  const auto left = hub.take_input().back();
  EXPECT_EQ(left.client, client);
  EXPECT_TRUE(std::holds_alternative<protocol::Leave>(left.what));
}

}  // namespace
}  // namespace iota::net
