// SPDX-License-Identifier: Apache-2.0
// What the clients of one world share: its entities, settings and newest poses, who is connected, and the two boxes through
// which the stepping thread and the server's thread pass things to each other. Knows messages, not sockets.
#pragma once

#include "net/entity_store.h"
#include "net/out_queue.h"
#include "net/pose_encoder.h"
#include "net/server.h"

#include <iota_protocol.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace iota::net {

/// A client's connection, as the hub sees it.
class ClientLink {
 public:
  virtual void send(const Frame& frame, std::string_view key) = 0;
  /// There are newer entities or poses; fetch them when there is room.
  virtual void world_changed() = 0;
  /// Tell the reason and close.
  virtual void drop(std::string_view reason) = 0;
  /// The world has ended: send what is queued, then close.
  virtual void world_ended() = 0;

 protected:
  ~ClientLink() = default;
};

/// Of a server, over all its worlds.
struct Counters {
  std::atomic<std::uint32_t> clients{0};
  std::atomic<std::uint64_t> bytes_sent{0}, frames_sent{0}, frames_dropped{0}, frames_refused{0}, upgrades_refused{0},
      clients_dropped{0};
};

class Hub {
 public:
  /// `call_frame`: has frame() called on the server's thread, a frame's time from now. Called there only.
  Hub(std::string world, std::size_t max_clients, Counters& counters, std::function<void()> call_frame);
  const std::string& world() const { return world_; }

  // --- from any thread. True: nothing was waiting, so deliver() has to be called on the server's thread.
  /// Changes of entities add up, of poses only the newest counts; both reach clients together.
  [[nodiscard]] bool publish(const PoseSnapshot& snapshot, EntityChanges changes);
  /// A message that is whole: the latest of each type counts, and is given to late joiners.
  template <class Message>
  [[nodiscard]] bool set(const Message& message);
  /// Kept: told to clients that join later too, until it is forgotten or another with the same title takes its place.
  [[nodiscard]] bool notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
                            std::string_view hint, bool is_kept);
  /// The kept notices with this title, or all for an empty one, are not told to those who join later.
  [[nodiscard]] bool forget_notice(std::string_view title);
  [[nodiscard]] bool ask_picture(std::uint32_t client, std::uint32_t number);
  [[nodiscard]] bool effect(std::string_view kind, const Vec3f& position);
  std::vector<InputEvent> take_input();

  // --- on the server's thread
  /// Hands everything that was published on to the clients: edits in order, then the newest poses.
  void deliver();
  /// Welcomes the client on `link` and replays the scene to it; gives its number, or 0 and the reason of a refusal.
  std::pair<std::uint32_t, std::string> join(ClientLink& link, const protocol::Hello& hello);
  void leave(std::uint32_t client);
  /// Tells what waited for a frame's time to pass.
  void frame();
  /// One frame of a welcomed client. What is not understood is answered by a notice.
  void receive(std::uint32_t client, std::span<const std::uint8_t> bytes);
  void refuse_frame(std::uint32_t client, std::string_view reason);
  const PoseQuantizer& poses() const { return poses_; }
  /// Number of the newest poses, 0 before the first.
  std::uint64_t pose_number() const { return pose_number_; }
  EntityStore& entities() { return entities_; }
  /// Closes all connections.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    ClientLink* link = nullptr;
    std::string name;
    protocol::Role role = protocol::Role::actor;
    protocol::Id selected;
    std::set<std::uint32_t> holds;
    Clock::time_point reset_at = Clock::time_point::min();  ///< when it asked for a reset last
    bool is_told_to_wait = false;                           ///< that it asks for resets too often
    std::uint32_t picture = 0;                              ///< number of the one that it was asked for; 0: none
    std::size_t picture_bytes = 0;                          ///< of it that came
  };
  using Edit = std::function<void()>;

  bool post(Edit edit);
  void broadcast(const Frame& frame, std::string_view key = {});
  protocol::Clients all_clients() const;
  /// Tells everyone who is there, with the next frame: many come, go and select at once.
  void tell_clients();
  [[nodiscard]] bool set_latest(std::string key, Frame frame);
  void push_input(InputEvent event);
  void tell(std::uint32_t client, const protocol::Notice& notice);
  /// Tells a client that only watches that it does.
  bool may_act(std::uint32_t client);
  /// Tells a client that resets the world too often that it has to wait.
  bool may_reset(std::uint32_t client);

  void handle(std::uint32_t client, const protocol::Hello& message);
  void handle(std::uint32_t client, const protocol::Select& message);
  void handle(std::uint32_t client, const protocol::GrabStart& message);
  void handle(std::uint32_t client, const protocol::GrabMove& message);
  void handle(std::uint32_t client, const protocol::GrabEnd& message);
  void handle(std::uint32_t client, const protocol::Action& message);
  void handle(std::uint32_t client, const protocol::Control& message);
  void handle(std::uint32_t client, const protocol::Ping& message);
  void handle(std::uint32_t client, const protocol::Change& message);
  void handle(std::uint32_t client, const protocol::Pointer& message);
  void handle(std::uint32_t client, const protocol::Key& message);
  void handle(std::uint32_t client, const protocol::Picture& message);

  const std::string world_;
  const std::size_t max_clients_;
  Counters& counters_;
  const std::function<void()> call_frame_;

  // Between the threads: to the server ...
  std::mutex out_mutex_;
  std::vector<Edit> edits_;
  PoseSnapshot snapshot_;
  std::vector<EntityChanges> changes_;
  std::uint64_t snapshot_number_ = 0;
  bool is_delivery_due_ = false;
  // ... and to the stepping thread.
  std::mutex in_mutex_;
  std::vector<InputEvent> input_;
  std::map<std::uint32_t, std::size_t> input_counts_;  ///< waiting events by client

  // On the server's thread only.
  std::map<std::uint32_t, Client> clients_;
  std::uint32_t next_client_ = 1;
  std::vector<std::pair<std::string, Frame>> latest_;  ///< in the order in which keys were first set
  std::vector<std::pair<std::string, Frame>> kept_notices_;
  bool are_clients_told_ = true;
  EntityStore entities_;
  std::vector<Edit> delivering_;
  std::vector<EntityChanges> delivered_changes_;
  PoseSnapshot delivered_;
  PoseQuantizer poses_;
  std::uint64_t pose_number_ = 0;
};

template <class Message>
bool Hub::set(const Message& message) {
  return set_latest(std::to_string(static_cast<int>(Message::message_type)),
                    std::make_shared<const std::vector<std::uint8_t>>(protocol::encode(message)));
}

}  // namespace iota::net
