// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "net/presenter.h"
#include "net/server.h"

#include <nanobind/nanobind.h>

#include <memory>
#include <utility>

namespace iota::bindings {

namespace nb = nanobind;

/// The state of a Python `Server`.
class ServerObject {
 public:
  explicit ServerObject(std::unique_ptr<net::Server> server) : server_(std::move(server)) {}

  /// Throws ValueError once it is closed.
  net::Server& use() {
    if (!server_) throw nb::value_error("this server is closed");
    return *server_;
  }
  void close() {
    const nb::gil_scoped_release unlocked;  // it waits a moment for frames in flight
    server_.reset();
  }

 private:
  std::unique_ptr<net::Server> server_;
};

/// The state of a Python `Room`: a world on a server, and the state last sent to its viewers.
struct RoomObject {
  explicit RoomObject(std::unique_ptr<net::Room> opened) : room(std::move(opened)) {}

  /// Throws ValueError once it is closed.
  net::Room& use() {
    if (!room) throw nb::value_error("this world is not on its server any more");
    return *room;
  }

  std::unique_ptr<net::Room> room;
  net::Presenter presenter;
  net::EntityChanges own;      ///< entities of the script, sent with the next poses
  protocol::WorldState state;  ///< last sent to pages
  double usual_radius = 0;     ///< of rods of a simulator of the script, m; 0: not chosen yet
};

/// The state of a Python `RoomRecording`.
struct RoomRecordingObject {
  std::unique_ptr<net::Recording> recording;  ///< null once it has ended
};

}  // namespace iota::bindings
