// SPDX-License-Identifier: Apache-2.0
#include "net/hub.h"

#include "net/fit_text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

namespace iota::net {
namespace {

/// A client with more queued events sends faster than any script can read (moves count as one). While a script hangs,
/// clients come, fill the queue and go: so there is a limit in bytes for one, and for a world, which leaves each of 64
/// clients its part. Without it 43 connections that reconnected took 5.6 GB in 16 s.
constexpr std::size_t max_waiting_input = 4096;
constexpr std::size_t max_waiting_bytes = 1 << 20;
constexpr std::size_t max_waiting_bytes_of_world = 4 << 20;
constexpr std::size_t least_waiting_bytes = 64 << 10;
constexpr std::size_t forgetful_bytes = 1 << 20;  ///< of a world: above, clients that nobody knows are forgotten
constexpr std::size_t max_holds = 32;
constexpr std::string_view sent_away = "the host has sent you away";
constexpr std::string_view clients_key = "clients";
constexpr std::string_view people_key = "people";
constexpr std::size_t max_picture_bytes = 64 << 20;
constexpr std::size_t max_kept_notices = 8;
// A world has one reset a second, and at length one in five, so that it gets somewhere in between.
constexpr double reset_pause = 1, reset_every = 5, most_resets = 10;

/// Coordinates of one place or several.
bool is_near(std::span<const float> places) {
  return std::ranges::all_of(places, [](float x) { return std::abs(x) <= farthest; });
}

/// Whether a place in a message is out of reach: one in it, or in a struct in it.
template <class Value>
bool is_far(const Value& value) {
  if constexpr (std::is_same_v<Value, protocol::Vec3>) {
    return !is_near(value);
  } else if constexpr (requires { value.fields(); }) {
    return std::apply([](const auto&... fields) { return (is_far(fields) || ...); }, value.fields());
  } else if constexpr (requires { value.begin()->fields(); }) {
    return std::ranges::any_of(value, [](const auto& item) { return is_far(item); });
  } else {
    return false;
  }
}

template <class Message>
bool is_a(const ClientInput& input) {
  return std::holds_alternative<Message>(input.what);
}

/// Whether the input moves a grip or a pointer. Of several such inputs only the newest counts.
bool is_move(const ClientInput& input) {
  const auto* pointer = std::get_if<protocol::Pointer>(&input.what);
  return is_a<protocol::GrabMove>(input) || (pointer && pointer->kind == protocol::PointerKind::move);
}

/// Whether two moves are of the same grip or pointer.
bool move_the_same(const ClientInput& a, const ClientInput& b) {
  if (a.client != b.client || a.what.index() != b.what.index()) return false;
  if (const auto* grip = std::get_if<protocol::GrabMove>(&a.what))
    return grip->hold == std::get<protocol::GrabMove>(b.what).hold;
  return std::get<protocol::Pointer>(a.what).name == std::get<protocol::Pointer>(b.what).name;
}

/// Whether two inputs change the same control of the script.
bool change_the_same(const ClientInput& a, const ClientInput& b) {
  const auto *one = std::get_if<protocol::Change>(&a.what), *other = std::get_if<protocol::Change>(&b.what);
  return one && other && a.client == b.client && one->widget == other->widget;
}

/// Bytes of what a value refers to: texts and arrays.
template <class Value>
std::size_t own_bytes(const Value& value) {
  if constexpr (requires { value.fields(); }) {
    return std::apply([](const auto&... fields) { return (std::size_t{0} + ... + own_bytes(fields)); }, value.fields());
  } else if constexpr (requires { value.capacity(); }) {
    return value.size() * sizeof(*value.data());
  } else {
    return 0;
  }
}

/// Pictures are limited by themselves: only those count that the script has asked for.
std::size_t size_of(const ClientInput& input) {
  if (is_a<protocol::Picture>(input)) return sizeof(ClientInput);
  return sizeof(ClientInput) + std::visit([](const auto& message) { return own_bytes(message); }, input.what);
}

/// Whether the same request waits since the script last read its input: at most one single step a round, whoever wants
/// it. Only the newest speed of a client counts, unless there was another request in between.
bool has_waiting_twin(std::vector<ClientInput>& waiting, const ClientInput& input) {
  const auto* request = std::get_if<protocol::Control>(&input.what);
  if (!request) return false;
  for (auto i = waiting.rbegin(); i != waiting.rend(); ++i) {
    auto* known = std::get_if<protocol::Control>(&i->what);
    const bool is_step = request->command == protocol::ControlCommand::single_step;
    if (!known || (i->client != input.client && !is_step)) continue;
    if (known->command == request->command) {
      known->value = request->value;
      return true;
    }
    if (!is_step) return false;
  }
  return false;
}

protocol::Notice make_notice(std::uint8_t level, std::string_view title, std::string_view text, std::string_view hint,
                             const NoticeOptions& options = {}) {
  return {static_cast<protocol::NoticeLevel>(std::min<std::uint8_t>(level, 2)),
          fit_text(title, 256),
          fit_text(text, 8192),
          fit_text(hint, 1024),
          fit_text(options.id, 64),
          options.seconds,
          options.place};
}

}  // namespace

Hub::Hub(std::string world, std::size_t max_clients, Counters& counters, std::function<void()> call_frame)
    : world_(std::move(world)),
      max_clients_(std::min<std::size_t>(max_clients, 1024)),
      counters_(counters),
      call_frame_(std::move(call_frame)) {}

// ----------------------------------------------------------------------------------------------------- from any thread

bool Hub::publish(const PoseSnapshot& snapshot, EntityChanges changes) {
  const std::lock_guard lock(out_mutex_);
  snapshot_ = snapshot;  // reuses its vectors: no allocation once they are large enough
  if (!changes.empty()) changes_.push_back(std::move(changes));
  ++snapshot_number_;
  return !std::exchange(is_delivery_due_, true);
}

bool Hub::post(Edit edit) {
  const std::lock_guard lock(out_mutex_);
  edits_.push_back(std::move(edit));
  return !std::exchange(is_delivery_due_, true);
}

bool Hub::set_latest(std::string key, Frame frame, std::uint32_t client) {
  return post([this, key = std::move(key), frame = std::move(frame), client] {
    if (client != 0) {
      if (const auto found = clients_.find(client); found != clients_.end()) found->second.link->send(frame, key);
      return;
    }
    const auto known = std::ranges::find(latest_, key, [](const auto& part) { return part.first; });
    if (known == latest_.end())
      latest_.emplace_back(key, frame);
    else
      known->second = frame;
    broadcast(frame, key);
  });
}

bool Hub::notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
                 std::string_view hint, bool is_kept, const NoticeOptions& options) {
  const std::string_view key = options.id.empty() ? title : std::string_view(options.id);
  return post([this, client, frame = make_frame(make_notice(level, title, text, hint, options)),
               kept_as = is_kept ? std::string(key) : std::string()] {
    if (!kept_as.empty()) {
      std::erase_if(kept_notices_, [&](const auto& kept) { return kept.first == kept_as; });
      if (kept_notices_.size() == max_kept_notices) kept_notices_.erase(kept_notices_.begin());
      kept_notices_.emplace_back(kept_as, frame);
    }
    if (client == 0) return broadcast(frame);
    if (const auto found = clients_.find(client); found != clients_.end()) found->second.link->send(frame, {});
  });
}

bool Hub::forget_notice(std::string_view title) {
  return post([this, title = std::string(title)] {
    std::erase_if(kept_notices_, [&](const auto& kept) { return title.empty() || kept.first == title; });
  });
}

bool Hub::ask_picture(std::uint32_t client, std::uint32_t number) {
  return post([this, client, number, frame = make_frame(protocol::AskPicture{number})] {
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    found->second.picture = number;
    found->second.picture_bytes = 0;
    found->second.link->send(frame, {});
  });
}

bool Hub::effect(std::string_view kind, const Vec3f& position, float volume) {
  return post([this, frame = make_frame(protocol::Effect{std::string(kind), position, volume})] { broadcast(frame); });
}

bool Hub::pulse(std::uint32_t client, const protocol::Pulse& pulse) {
  return post([this, client, frame = make_frame(pulse)] {
    if (const auto found = clients_.find(client); found != clients_.end()) found->second.link->send(frame, {});
  });
}

bool Hub::send_away(std::uint32_t client) {
  return post([this, client] { send_away_now(client); });
}

std::vector<ClientInput> Hub::take_input() {
  const std::lock_guard lock(in_mutex_);
  waiting_.clear();
  waiting_bytes_ = 0;
  return std::exchange(input_, {});
}

std::vector<ClientInput> Hub::take_pictures() {
  const std::lock_guard lock(in_mutex_);
  const auto first = std::ranges::stable_partition(input_, std::not_fn(is_a<protocol::Picture>)).begin();
  std::vector<ClientInput> taken;
  std::move(first, input_.end(), std::back_inserter(taken));
  input_.erase(first, input_.end());
  for (const ClientInput& picture : taken) {
    Waiting& waiting = waiting_[picture.client];
    --waiting.count;
    waiting.bytes -= size_of(picture);
    waiting_bytes_ -= size_of(picture);
  }
  return taken;
}

void Hub::wait_for_input(double seconds) {
  std::unique_lock lock(in_mutex_);
  has_input_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return is_woken_ || !input_.empty(); });
  is_woken_ = false;
}

void Hub::wake() {
  const std::lock_guard lock(in_mutex_);
  is_woken_ = true;
  has_input_.notify_all();
}

// -------------------------------------------------------------------------------------------- on the server's thread

void Hub::deliver() {
  delivering_.clear();
  bool has_newer_poses = false;
  {
    const std::lock_guard lock(out_mutex_);
    is_delivery_due_ = false;
    std::swap(edits_, delivering_);
    std::swap(changes_, delivered_changes_);
    has_newer_poses = snapshot_number_ != pose_number_;
    if (has_newer_poses) std::swap(snapshot_, delivered_);
    pose_number_ = snapshot_number_;
  }
  for (const Edit& edit : delivering_) edit();
  delivering_.clear();
  for (const EntityChanges& changes : delivered_changes_) {
    entities_.apply(changes);
    for (const auto& [slot, size] : changes.sizes()) poses_.set_size(slot, size);
  }
  delivered_changes_.clear();
  if (!has_newer_poses) return;
  poses_.update(delivered_);
  for (auto& [number, client] : clients_) client.link->world_changed();
  for (const auto& link : watchers_) link->world_changed();
}

void Hub::end() {
  const auto clients = clients_;  // closing may remove some
  for (const auto& [number, client] : clients)
    if (clients_.contains(number)) client.link->world_ended();
}

std::pair<std::uint32_t, std::string> Hub::join(ClientLink& link, const protocol::Hello& hello) {
  if (hello.magic != protocol::protocol_magic) return {0, "this is not Iota's protocol"};
  if (hello.version != protocol::protocol_version) {
    return {0, "the page speaks protocol version " + std::to_string(hello.version) + ", the server version " +
                   std::to_string(protocol::protocol_version) + ": reload the page"};
  }
  if (clients_.size() >= max_clients_) {
    return {0, "the world is full: " + std::to_string(max_clients_) + " clients are connected"};
  }
  if (hello.role != protocol::Role::host && sent_away_.contains(link.address())) {
    link.refuse(sent_away);
    return {0, std::string(sent_away)};
  }
  const std::uint32_t number = next_client_++;
  clients_[number] = {.link = &link, .name = hello.name, .role = hello.role, .selected = {}, .holds = {}};
  ++counters_.clients;
  greet(link, number);
  tell_clients();
  push_input({number, protocol::Join{hello.name, hello.role}});
  return {number, {}};
}

void Hub::leave(std::uint32_t client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  if (found->second.stance) tell_people();
  clients_.erase(found);
  --counters_.clients;
  tell_clients();
  if (!try_forget(client)) push_input({client, protocol::Leave{}});
}

void Hub::watch(std::shared_ptr<ClientLink> link) {
  greet(*link, 0);
  if (pose_number_ != 0) link->world_changed();
  watchers_.push_back(std::move(link));
}

void Hub::unwatch(const ClientLink& link) {
  std::erase_if(watchers_, [&](const auto& watcher) { return watcher.get() == &link; });
}

void Hub::greet(ClientLink& link, std::uint32_t client) const {
  link.send(make_frame(protocol::Welcome{protocol::protocol_version, world_, client}), {});
  for (const auto& [key, frame] : latest_) link.send(frame, key);
  link.send(make_frame(all_clients()), clients_key);
  for (const auto& [title, frame] : kept_notices_) link.send(frame, {});
}

void Hub::receive(std::uint32_t client, std::span<const std::uint8_t> bytes) {
  auto decoded = protocol::decode_client_message(bytes);
  if (!decoded) return refuse_frame(client, decoded.error);
  std::visit([&](auto& message) { handle(client, std::move(message)); }, *decoded.value);
}

void Hub::refuse_frame(std::uint32_t client, std::string_view reason) {
  ++counters_.frames_refused;
  tell(client, make_notice(2, "A message was not understood", reason, "Reload the page."));
}

void Hub::tell(std::uint32_t client, const protocol::Notice& notice) {
  const auto found = clients_.find(client);
  if (found != clients_.end()) found->second.link->send(make_frame(notice), {});
}

bool Hub::may_send(std::uint32_t client, protocol::Viewers viewers) {
  if (viewers == protocol::Viewers::allowed || clients_.at(client).role != protocol::Role::viewer) return true;
  if (viewers == protocol::Viewers::told)
    tell(client, make_notice(0, "You only watch", "This page came as a viewer of the world.", "Open it as an actor."));
  return false;
}

bool Hub::may_reset(std::uint32_t client) {
  Client& self = clients_.at(client);
  const auto now = Clock::now();
  const bool is_first = reset_at_ == Clock::time_point::min();
  const double passed = is_first ? 0 : std::chrono::duration<double>(now - reset_at_).count();
  const double left = is_first ? most_resets : std::min(most_resets, resets_left_ + passed / reset_every);
  if (is_first || (passed >= reset_pause && left >= 1)) {
    reset_at_ = now;
    resets_left_ = left - 1;
    self.is_told_to_wait = false;
    return true;
  }
  if (!std::exchange(self.is_told_to_wait, true))
    tell(client, make_notice(0, "Reset a moment ago", "A world can be reset once a second, ten times in a row.", {}));
  return false;
}

void Hub::broadcast(const Frame& frame, std::string_view key) {
  for (auto& [number, client] : clients_) client.link->send(frame, key);
  for (const auto& link : watchers_) link->send(frame, key);
}

protocol::Clients Hub::all_clients() const {
  protocol::Clients message;
  for (const auto& [number, client] : clients_)
    message.clients.push_back({number, client.name, client.selected, client.role});
  return message;
}

void Hub::tell_clients() {
  if (std::exchange(are_clients_told_, false)) call_frame_();
}

void Hub::tell_people() {
  if (std::exchange(are_people_told_, false)) call_frame_();
}

protocol::People Hub::all_people() const {
  protocol::People message;
  for (const auto& [number, client] : clients_)
    if (client.stance) message.people.push_back({number, *client.stance});
  return message;
}

void Hub::frame() {
  if (!std::exchange(are_clients_told_, true)) broadcast(make_frame(all_clients()), clients_key);
  if (!std::exchange(are_people_told_, true)) broadcast(make_frame(all_people()), people_key);
}

void Hub::push_input(ClientInput input) {
  const std::uint32_t client = input.client;
  if (try_push(std::move(input))) return has_input_.notify_all();
  if (const auto found = clients_.find(client); found != clients_.end()) {
    found->second.link->drop("more input than the script can take");
  }
}

bool Hub::try_push(ClientInput input) {
  const std::lock_guard lock(in_mutex_);
  if (is_move(input)) {
    // Moves of different grips and pointers may be reordered.
    for (auto i = input_.rbegin(); i != input_.rend() && is_move(*i); ++i)
      if (move_the_same(*i, input)) return replace(*i, std::move(input)), true;
  }
  // Only the newest place of a user counts.
  if (is_a<protocol::Presence>(input)) {
    for (auto& other : input_)
      if (other.client == input.client && is_a<protocol::Presence>(other))
        return replace(other, std::move(input)), true;
  }
  // Only the newest value of a control counts, unless there was another input in between.
  if (!input_.empty() && change_the_same(input_.back(), input)) return replace(input_.back(), std::move(input)), true;
  if (has_waiting_twin(input_, input)) return true;
  const std::size_t bytes = size_of(input);
  Waiting& own = waiting_[input.client];
  const bool is_own = is_a<protocol::Join>(input) || is_a<protocol::Leave>(input);
  const bool is_too_much =
      own.count >= max_waiting_input || own.bytes + bytes > max_waiting_bytes ||
      (waiting_bytes_ + bytes > max_waiting_bytes_of_world && own.bytes + bytes > least_waiting_bytes);
  if (!is_own && is_too_much) return false;
  own.count += is_own ? 0 : 1;
  own.bytes += bytes;
  waiting_bytes_ += bytes;
  input_.push_back(std::move(input));
  return true;
}

void Hub::replace(ClientInput& older, ClientInput input) {
  const std::size_t more = size_of(input) - size_of(older);  // modulo 2^64
  waiting_[input.client].bytes += more;
  waiting_bytes_ += more;
  older = std::move(input);
}

bool Hub::try_forget(std::uint32_t client) {
  const std::lock_guard lock(in_mutex_);
  const auto is_its = [&](const ClientInput& input) { return input.client == client; };
  if (waiting_bytes_ < forgetful_bytes ||
      std::ranges::none_of(input_, [&](const auto& input) { return is_its(input) && is_a<protocol::Join>(input); }))
    return false;
  std::erase_if(input_, is_its);
  if (const auto waiting = waiting_.extract(client)) waiting_bytes_ -= waiting.mapped().bytes;
  return true;
}

// --------------------------------------------------------------------------------------------------------- messages

template <class Message>
void Hub::handle(std::uint32_t client, Message message) {
  if (!may_send(client, Message::viewers)) return;
  if (is_far(message)) return refuse_frame(client, std::string(Message::message_name) + ": a place is beyond 1e9 m");
  if constexpr (Message::is_for_script) {
    if (accept(client, message)) push_input({client, std::move(message)});
  } else {
    answer(client, message);
  }
}

bool Hub::refuse(std::uint32_t client, std::string_view reason) {
  refuse_frame(client, reason);
  return false;
}

bool Hub::accept(std::uint32_t client, const protocol::Select& message) {
  Client& self = clients_.at(client);
  if (self.selected == message.body) return false;
  self.selected = message.body;
  tell_clients();
  return true;
}

bool Hub::accept(std::uint32_t client, const protocol::GrabStart& message) {
  Client& self = clients_.at(client);
  if (self.holds.contains(message.hold)) return refuse(client, "grab_start.hold is in use already");
  if (self.holds.size() == max_holds) return refuse(client, "grab_start: this client holds too much already");
  self.holds.insert(message.hold);
  return true;
}

bool Hub::accept(std::uint32_t client, const protocol::GrabMove& message) {
  return clients_.at(client).holds.contains(message.hold) || refuse(client, "grab_move.hold holds nothing");
}

bool Hub::accept(std::uint32_t client, const protocol::GrabEnd& message) {
  return clients_.at(client).holds.erase(message.hold) > 0 || refuse(client, "grab_end.hold holds nothing");
}

bool Hub::accept(std::uint32_t client, const protocol::Control& message) {
  return is_host(client) && (message.command != protocol::ControlCommand::reset || may_reset(client));
}

bool Hub::accept(std::uint32_t client, const protocol::Pointer& message) {
  if (!is_near(message.joints)) return refuse(client, "pointer.joints: a place is beyond 1e9 m");
  return message.joints.size() % 3 == 0 || refuse(client, "pointer.joints: a joint has three coordinates");
}

bool Hub::accept(std::uint32_t client, const protocol::Picture& message) {
  Client& self = clients_.at(client);
  if (self.picture == 0 || message.request != self.picture) return refuse(client, "picture: none was asked for");
  self.picture_bytes += message.data.size();
  const bool is_too_large = self.picture_bytes > max_picture_bytes;
  if (message.is_last || is_too_large) self.picture = 0;
  return !is_too_large || refuse(client, "picture: it is above 64 MiB");
}

bool Hub::accept(std::uint32_t client, const protocol::Presence& message) {
  const protocol::Stance& stance = message.stance;
  if (!is_near(stance.hands)) return refuse(client, "presence: a place is beyond 1e9 m");
  if (stance.hands.size() % 3 != 0) return refuse(client, "presence: a hand has three coordinates");
  clients_.at(client).stance = stance;
  tell_people();
  return true;
}

bool Hub::accept(std::uint32_t client, const protocol::Rename& message) {
  clients_.at(client).name = message.name;
  tell_clients();
  return true;
}

void Hub::answer(std::uint32_t client, const protocol::Hello&) { refuse_frame(client, "hello was said before"); }

void Hub::answer(std::uint32_t client, const protocol::Ping& message) {
  clients_.at(client).link->send(make_frame(protocol::Pong{message.client_time, poses_.poses().step}), {});
}

void Hub::answer(std::uint32_t client, const protocol::SendAway& message) {
  if (is_host(client) && message.client != client) send_away_now(message.client);
}

void Hub::send_away_now(std::uint32_t client) {
  const auto found = clients_.find(client);
  if (found == clients_.end()) return;
  ClientLink& link = *found->second.link;
  if (const std::string address = link.address(); !address.empty() && found->second.role != protocol::Role::host)
    sent_away_.insert(address);
  link.refuse(sent_away);
}

bool Hub::is_host(std::uint32_t client) {
  if (clients_.at(client).role == protocol::Role::host) return true;
  tell(client, make_notice(0, "Only the host does that", "Pause, steps, resets and the speed are for all at once.",
                           "Ask who gave you the address."));
  return false;
}

}  // namespace iota::net
