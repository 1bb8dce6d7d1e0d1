// SPDX-License-Identifier: Apache-2.0
#include "binders.h"
#include "room_object.h"

#include "net/certificate.h"
#include "net/token.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <system_error>

namespace iota::bindings {

namespace {

using net::Server;
using net::ServerOptions;
using net::ServerStatistics;

constexpr const char* server_doc =
    "Serves the page and its WebSocket on one port, on a thread of its own, for one world or several.\n\n"
    "A World makes one for itself; use `World.serve(server=...)` for worlds that share one. page_folder: the\n"
    "built page. token: of the host; every page needs it, or one of the others: guest_token for users who may touch,\n"
    "viewer_token for those who may only watch, host_tokens for hosts. hello_time: s, from the upgrade of a connection to its first frame.\n"
    "certificate, key: in PEM; with them other machines use https on the same port. listener: a socket that listens\n"
    "already, which is taken over; -1: none. public_origin: of a proxy that serves this page to others, such as\n"
    "https://worlds.example.org.\n"
    "Raises OSError if the port is in use.";

[[noreturn]] void raise_os_error(const std::error_code& code, const char* text) {
  nb::object arguments = nb::make_tuple(code.value(), text);
  PyErr_SetObject(PyExc_OSError, arguments.ptr());
  throw nb::python_error();
}

std::string token_of_state_folder(std::string (*get)(const std::filesystem::path&)) {
  try {
    return get(net::state_folder());
  } catch (const std::system_error& error) {
    raise_os_error(error.code(), error.what());
  } catch (const std::runtime_error& error) {
    raise_os_error(std::make_error_code(std::errc::no_such_file_or_directory), error.what());
  }
}

std::pair<std::string, std::string> kept_certificate(const std::vector<std::string>& hosts) {
  try {
    const net::Certificate kept = net::load_or_make_certificate(hosts, net::state_folder());
    return {kept.chain, kept.key};
  } catch (const std::system_error& error) {
    raise_os_error(error.code(), error.what());
  }
}

std::unique_ptr<Server> make_server(const std::string& host, std::uint16_t port, const std::string& page_folder,
                                    const std::string& token, const std::string& guest_token,
                                    const std::string& viewer_token, const std::vector<std::string>& host_tokens,
                                    double hello_time, const std::string& certificate, const std::string& key,
                                    int listener, const std::string& public_origin, const std::string& gateway) {
  ServerOptions options;
  options.listener = listener;
  options.public_origin = public_origin;
  options.gateway = gateway;
  options.certificate = {certificate, key};
  options.host = host;
  options.port = port;
  options.page_folder = page_folder;
  options.token = token;
  if (!guest_token.empty()) options.other_tokens.emplace_back(guest_token, protocol::Role::actor);
  if (!viewer_token.empty()) options.other_tokens.emplace_back(viewer_token, protocol::Role::viewer);
  for (const std::string& other : host_tokens) options.other_tokens.emplace_back(other, protocol::Role::host);
  options.hello_time = finite_positive(hello_time, "hello_time", "s");
  try {
    return std::make_unique<Server>(std::move(options));
  } catch (const std::system_error& error) {
    raise_os_error(error.code(), error.what());
  }
}

void bind_statistics(nb::module_& module) {
  nb::class_<ServerStatistics>(module, "ServerStatistics", "Counts since the server started.")
      .def_ro("clients", &ServerStatistics::clients, "Connected now.")
      .def_ro("bytes_sent", &ServerStatistics::bytes_sent)
      .def_ro("frames_sent", &ServerStatistics::frames_sent)
      .def_ro("frames_dropped", &ServerStatistics::frames_dropped, "Poses that were not sent to slow clients.")
      .def_ro("frames_refused", &ServerStatistics::frames_refused, "Frames that could not be decoded.")
      .def_ro("upgrades_refused", &ServerStatistics::upgrades_refused, "Wrong Host, Origin or token.")
      .def_ro("clients_dropped", &ServerStatistics::clients_dropped, "For a full queue, or silence.");
}

}  // namespace

void bind_request(nb::module_& module) {
  nb::class_<net::Request>(module, "Request",
                           "A request of HTTP that waits for an answer, see `Server.serve_requests`.")
      .def_ro("path", &net::Request::path)
      .def_ro("query", &net::Request::query, "With its escapes.")
      .def_ro("is_post", &net::Request::is_post, "It asks for a change.")
      .def_prop_ro(
          "role",
          [](const net::Request& self) {
            constexpr std::array names{"guest", "viewer", "host"};  // in the order of protocol::Role
            return self.role ? names.at(static_cast<std::size_t>(*self.role)) : "";
          },
          "Of its token: host, guest or viewer; empty only for an open path.");
}

void bind_server(nb::module_& module) {
  bind_statistics(module);
  bind_request(module);
  module.def("make_token", &net::make_token, "A new secret for a page's address: 32 hexadecimal digits.");
  module.def(
      "kept_token", [] { return token_of_state_folder(&net::load_or_make_token); },
      "The secret kept in the state folder, made if there is none. Raises OSError if that fails.");
  module.def(
      "renew_token", [] { return token_of_state_folder(&net::renew_token); },
      "Replaces the kept secret: servers that start from now on refuse pages with the old one.\n"
      "Raises OSError if it cannot be written.");
  module.def(
      "kept_certificate", &kept_certificate, "hosts"_a,
      "The server's own certificate for host names and addresses, and its key, both in PEM. Kept in the state folder;\n"
      "replaced if it is not for one of them or expires soon. Raises OSError if it cannot be written.");
  module.def("fingerprint", &net::fingerprint, "certificate"_a,
             "SHA-256 of a certificate in PEM, as browsers show it. Raises ValueError for other texts.");
  nb::class_<ServerObject>(module, "Server", server_doc)
      .def(
          "__init__",
          [](ServerObject* self, const std::string& host, std::uint16_t port, const std::string& page_folder,
             const std::string& token, const std::string& guest_token, const std::string& viewer_token,
             const std::vector<std::string>& host_tokens, double hello_time, const std::string& certificate,
             const std::string& key, int listener, const std::string& public_origin, const std::string& gateway) {
            new (self) ServerObject{make_server(host, port, page_folder, token, guest_token, viewer_token, host_tokens,
                                                hello_time, certificate, key, listener, public_origin, gateway)};
          },
          nb::kw_only(), "host"_a = "127.0.0.1", "port"_a = 8080, "page_folder"_a = "", "token"_a, "guest_token"_a = "",
          "viewer_token"_a = "", "host_tokens"_a = std::vector<std::string>(), "hello_time"_a = 10.0,
          "certificate"_a = "", "key"_a = "", "listener"_a = -1, "public_origin"_a = "", "gateway"_a = "")
      .def(
          "open", [](ServerObject& self, const std::string& world) { return new RoomObject(self.use().open(world)); },
          "world"_a,
          "A world that pages choose by its id; a page without an id gets the first. Raises ValueError for an id\n"
          "that is empty, longer than 128 bytes, or in use.")
      .def("close", &ServerObject::close, "Tells all pages that the server stops, and stops it.")
      .def_prop_ro("port", [](ServerObject& self) { return self.use().port(); })
      .def_prop_ro(
          "url", [](ServerObject& self) { return self.use().url(); }, "Address of the first world's page.")
      .def(
          "url_of", [](ServerObject& self, const std::string& world) { return self.use().url(world); }, "world"_a,
          "Address of a world's page.")
      .def(
          "url_at",
          [](ServerObject& self, const std::string& host, const std::string& world) {
            return self.use().url_at(host, world);
          },
          "host"_a, "world"_a = "",
          "Address for other machines, for which this one is `host`. Without a world: the first one's.")
      .def(
          "relay",
          [](ServerObject& self, const std::string& world, std::uint16_t port, const std::vector<std::string>& tokens) {
            if (tokens.size() != 3 && port != 0) throw nb::value_error("a world has a token for each of three roles");
            std::array<std::string, 3> each;
            std::ranges::copy_n(tokens.begin(), static_cast<std::ptrdiff_t>(std::min<std::size_t>(tokens.size(), 3)),
                                each.begin());
            self.use().relay(world, port, each);
          },
          "world"_a, "port"_a = 0, "tokens"_a = std::vector<std::string>(),
          "A world that another process of this machine serves at a port, with its tokens for actors, viewers and\n"
          "hosts: its clients are passed on. Port 0: they wait until it is known.")
      .def(
          "end_relay", [](ServerObject& self, const std::string& world) { self.use().end_relay(world); }, "world"_a,
          "Clients that wait for it are let go.")
      .def(
          "visitors", [](ServerObject& self, const std::string& world) { return self.use().visitors(world); },
          "world"_a, "Clients that are passed on to such a world, or wait for it.")
      .def(
          "serve_requests",
          [](ServerObject& self, std::vector<std::string> paths, bool is_open) {
            self.use().serve_requests(std::move(paths), is_open);
          },
          "paths"_a, "is_open"_a = false,
          "Requests of HTTP for these paths wait for `take_requests` from now on, up to 5 s, if they have a token.\n"
          "is_open: also without one, and from pages of any origin.")
      .def(
          "take_requests", [](ServerObject& self) { return self.use().take_requests(); },
          "The requests since the last call. Each waits for its `answer`.")
      .def(
          "answer",
          [](ServerObject& self, const net::Request& request, const nb::bytes& body, const std::string& type,
             unsigned status) {
            self.use().answer(request.number, {status, type, std::string(body.c_str(), body.size())});
          },
          "request"_a, "body"_a, "type"_a = "text/plain; charset=utf-8", "status"_a = 200,
          "Answers a request. type: a Content-Type. Too late, it has no effect.")
      .def_prop_ro("statistics", [](ServerObject& self) { return self.use().statistics(); });
}

}  // namespace iota::bindings
