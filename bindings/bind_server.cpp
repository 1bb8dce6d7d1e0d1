// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

#include "net/server.h"
#include "net/token.h"

#include <nanobind/stl/tuple.h>

#include <system_error>

namespace iota::bindings {

namespace {

using net::InputEvent;
using net::Server;
using net::ServerOptions;
using net::ServerStatistics;

constexpr const char* doc =
    "Serves the page and its WebSocket on one port, on a thread of its own. `World` drives it; a script hardly needs to.\n\n"
    "Raises OSError when the port is taken. dt: s.";

const char* kind_name_of(InputEvent::Kind kind) {
  switch (kind) {
    case InputEvent::Kind::join: return "join";
    case InputEvent::Kind::leave: return "leave";
    case InputEvent::Kind::select: return "select";
    case InputEvent::Kind::grab_start: return "grab_start";
    case InputEvent::Kind::grab_move: return "grab_move";
    case InputEvent::Kind::grab_end: return "grab_end";
    case InputEvent::Kind::action: return "action";
    case InputEvent::Kind::control: return "control";
  }
  return "unknown";
}

Vec3 widen(const net::Vec3f& v) { return {v[0], v[1], v[2]}; }
net::Vec3f narrow(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

[[noreturn]] void raise_os_error(const std::error_code& code, const char* text) {
  nb::object arguments = nb::make_tuple(code.value(), text);
  PyErr_SetObject(PyExc_OSError, arguments.ptr());
  throw nb::python_error();
}

std::string kept_token() {
  try {
    return net::load_or_make_token();
  } catch (const std::system_error& error) {
    raise_os_error(error.code(), error.what());
  } catch (const std::runtime_error& error) {
    raise_os_error(std::make_error_code(std::errc::no_such_file_or_directory), error.what());
  }
}

void make_server(Server* self, const std::string& host, std::uint16_t port, const std::string& page_folder,
                 const std::string& token, const std::string& world, double dt) {
  ServerOptions options;
  options.host = host;
  options.port = port;
  options.page_folder = page_folder;
  options.token = token;
  options.world = world;
  options.dt = finite_positive(dt, "dt", "s");
  try {
    new (self) Server(std::move(options));
  } catch (const std::system_error& error) {
    raise_os_error(error.code(), error.what());
  }
}

void publish(Server& self, SystemObject& system, bool paused, double speed, double step_ms) {
  PoseSnapshot snapshot = system.use().poses();
  snapshot.paused = paused;
  snapshot.speed = static_cast<float>(speed);
  snapshot.step_ms = static_cast<float>(step_ms);
  self.publish(snapshot);
}

/// What a simulator of the script shows: see iota.Simulator.
void publish_poses(
    Server& self, nb::handle slots, nb::handle places,
    const std::vector<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, Vec3, Vec3, double>>& holds,
    std::uint64_t step, double time, std::uint32_t structure_version, const Energy& energy, double gap, bool paused,
    double speed, double step_ms) {
  const nb::object as_array = nb::module_::import_("numpy").attr("ascontiguousarray");
  const auto bodies =
      nb::cast<nb::ndarray<const std::uint32_t, nb::c_contig, nb::device::cpu>>(as_array(slots, "uint32"));
  const auto numbers = nb::cast<nb::ndarray<const float, nb::c_contig, nb::device::cpu>>(as_array(places, "float32"));
  const std::size_t count = bodies.size();
  if (bodies.ndim() != 1 || numbers.ndim() != 2 || numbers.shape(0) != count || numbers.shape(1) != 7)
    throw nb::value_error("poses() must give slots of shape (n,) and places of shape (n, 7)");
  PoseSnapshot snapshot;
  snapshot.step = step, snapshot.time = time, snapshot.structure_version = structure_version, snapshot.paused = paused;
  snapshot.speed = static_cast<float>(speed), snapshot.step_ms = static_cast<float>(step_ms);
  snapshot.kinetic = static_cast<float>(energy.kinetic), snapshot.potential = static_cast<float>(energy.potential);
  snapshot.gap = static_cast<float>(gap);
  snapshot.bodies.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    snapshot.bodies[i].body = bodies.data()[i];
    std::copy_n(numbers.data() + 7 * i, 3, snapshot.bodies[i].position);
    std::copy_n(numbers.data() + 7 * i + 3, 4, snapshot.bodies[i].orientation);
  }
  for (const auto& [client, hold, body, point, target, force] : holds) {
    HoldPose& pose = snapshot.holds.emplace_back();
    pose.client = client, pose.hold = hold, pose.body = body, pose.force = static_cast<float>(force);
    std::copy_n(narrow(point).data(), 3, pose.point);
    std::copy_n(narrow(target).data(), 3, pose.target);
  }
  self.publish(snapshot);
}

void bind_input(nb::module_& module) {
  nb::class_<InputEvent>(module, "InputEvent", "What a user did, or that one came or went.")
      .def_prop_ro(
          "kind", [](const InputEvent& e) { return kind_name_of(e.kind); },
          "join, leave, select, grab_start, grab_move, grab_end, action or control")
      .def_ro("client", &InputEvent::client, "From 1, never used twice.")
      .def_ro("hold", &InputEvent::hold, "The client's own number for this hand.")
      .def_prop_ro(
          "body",
          [](const InputEvent& e) -> std::optional<std::uint32_t> {
            return e.body == net::no_body ? std::nullopt : std::optional(e.body);
          },
          "Slot, not checked against the system.")
      .def_prop_ro(
          "local_point", [](const InputEvent& e) { return widen(e.local_point); }, "Body frame, m.")
      .def_prop_ro(
          "target", [](const InputEvent& e) { return widen(e.target); }, "World frame, m.")
      .def_ro("name", &InputEvent::name, "The client's name, or the action's.")
      .def_ro("command", &InputEvent::command, "0 pause, 1 play, 2 single step, 3 reset, 4 speed")
      .def_ro("value", &InputEvent::value)
      .def("__repr__", [](const InputEvent& e) {
        return std::string("<InputEvent ") + kind_name_of(e.kind) + " of client " + std::to_string(e.client) + ">";
      });
}

void bind_statistics(nb::module_& module) {
  nb::class_<ServerStatistics>(module, "ServerStatistics", "Counts since the server started.")
      .def_ro("clients", &ServerStatistics::clients, "Connected now.")
      .def_ro("bytes_sent", &ServerStatistics::bytes_sent)
      .def_ro("frames_sent", &ServerStatistics::frames_sent)
      .def_ro("frames_dropped", &ServerStatistics::frames_dropped, "Poses that a slow client never got.")
      .def_ro("frames_refused", &ServerStatistics::frames_refused, "Frames that were not understood.")
      .def_ro("upgrades_refused", &ServerStatistics::upgrades_refused, "Wrong Host, Origin or token.")
      .def_ro("clients_dropped", &ServerStatistics::clients_dropped, "Over their queue, or silent.");
}

}  // namespace

void bind_server(nb::module_& module) {
  bind_input(module);
  bind_statistics(module);
  module.def("make_token", &net::make_token, "A new secret for a page's address: 32 hexadecimal digits.");
  module.def("kept_token", &kept_token,
             "The secret kept in the state folder, made when there is none. Raises OSError where that cannot be done.");
  nb::class_<Server>(module, "Server", doc)
      .def("__init__", &make_server, nb::kw_only(), "host"_a = "127.0.0.1", "port"_a = 8080, "page_folder"_a = "",
           "token"_a, "world"_a = "default", "dt"_a = 1.0 / 120)
      .def_prop_ro("port", &Server::port)
      .def_prop_ro("url", &Server::url)
      .def("publish", &publish, "system"_a, "paused"_a, "speed"_a, "step_ms"_a, "The newest poses of a system.")
      .def(
          "publish_poses", &publish_poses, "slots"_a, "places"_a, "holds"_a, nb::kw_only(), "step"_a, "time"_a,
          "structure_version"_a, "energy"_a, "gap"_a, "paused"_a, "speed"_a, "step_ms"_a,
          "The newest poses of a simulator of the script, see iota.Simulator. Raises ValueError for shapes other than\n"
          "(n,) and (n, 7).")
      .def(
          "publish_structure",
          [](Server& self, std::uint32_t structure_version,
             const std::vector<std::pair<std::uint32_t, std::uint32_t>>& body_articulates) {
            std::vector<BodyArticulate> list;
            for (const auto& [body, articulate] : body_articulates) list.push_back({body, articulate});
            self.publish_structure(structure_version, list);
          },
          "structure_version"_a, "body_articulates"_a, "The same of a simulator of the script.")
      .def(
          "publish_structure",
          [](Server& self, SystemObject& system) {
            const auto articulates = system.use().body_articulates();
            self.publish_structure(system.use().scene_version(), articulates);
          },
          "system"_a, "Which articulate each body belongs to.")
      .def(
          "set_scene", [](Server& self, const std::string& key, const std::string& json) { self.set_scene(key, json); },
          "key"_a, "json"_a, "Sets one keyed part of the scene; 'null' removes it.")
      .def(
          "notice",
          [](Server& self, std::uint32_t client, std::uint8_t level, const std::string& title, const std::string& text,
             const std::string& hint) { self.notice(client, level, title, text, hint); },
          "client"_a, "level"_a, "title"_a, "text"_a, "hint"_a = "",
          "A card on one client's page, or on all (client 0). Level 0 info, 1 warning, 2 error.")
      .def(
          "effect",
          [](Server& self, const std::string& kind, VectorArgument position) {
            self.effect(kind, narrow(to_vec3(position, "position")));
          },
          "kind"_a, "position"_a, "Flash, sound and haptic pulse: 'break', 'join' or 'grab' at a place (m).")
      .def("take_input", &Server::take_input, "What happened since the last call, in order of arrival.")
      .def_prop_ro("statistics", &Server::statistics);
}

}  // namespace iota::bindings
