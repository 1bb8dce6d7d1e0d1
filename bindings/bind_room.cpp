// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"

#include "binders.h"
#include "names.h"
#include "record_maker.h"
#include "room_object.h"
#include "shape_argument.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace iota::bindings {

namespace {

using Quat4 = std::tuple<double, double, double, double>;
/// name, key, label, help, whether it is on a body, button ("a", "b" or "")
using ActionTuple = std::tuple<std::string, std::string, std::string, std::string, bool, std::string>;

net::Vec3f narrow(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }
protocol::Quat narrow(const Quat4& q) {
  const auto [x, y, z, w] = q;
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), static_cast<float>(w)};
}

protocol::Part make_part(const std::string& kind, const std::vector<float>& sizes, const std::string& style,
                         const std::string& material, std::optional<std::uint32_t> color, const Vec3& offset,
                         const Quat4& rotation, double turn, const std::vector<float>& vertices,
                         const std::vector<std::uint32_t>& triangles) {
  protocol::Part part;
  part.style = style;
  part.shape = {kind, sizes, vertices, triangles};
  part.offset = narrow(offset);
  part.rotation = narrow(rotation);
  part.turn = static_cast<float>(turn);
  part.material = material;
  part.color = color.value_or(protocol::no_color);
  return part;
}

void set_settings(RoomObject& self, const std::string& title, const std::vector<std::string>& styles,
                  const std::string& style, const std::optional<std::pair<Vec3, Vec3>>& camera,
                  std::optional<double> ground, const std::vector<std::string>& modules, std::uint32_t client) {
  const auto& [position, target] = camera.value_or(std::pair<Vec3, Vec3>{});
  self.use().set(protocol::WorldSettings{title, styles, style, camera.has_value(), narrow(position), narrow(target),
                                         ground.has_value(), static_cast<float>(ground.value_or(0)), modules},
                 client);
}

/// The name of a level, the number of things at it, and slots of their bodies.
using LevelTuple = std::tuple<std::string, std::uint32_t, std::vector<std::uint32_t>>;

/// Two digits, so that small fluctuations are not sent to pages.
float two_digits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 0;
  const double step = std::pow(10, std::floor(std::log10(value)) - 1);
  return static_cast<float>(std::round(value / step) * step);
}

void set_room_state(RoomObject& self, bool paused, double speed, double step_ms, double dt,
                    const std::vector<std::pair<std::string, double>>& costs, double budget_ms,
                    const std::vector<LevelTuple>& levels, const std::vector<std::string>& changes) {
  protocol::WorldState state{
      paused, static_cast<float>(speed), two_digits(step_ms), dt, {}, static_cast<float>(budget_ms), {}, changes};
  for (const auto& [part, ms] : costs) state.costs.push_back({part, two_digits(ms)});
  for (const auto& [name, count, bodies] : levels) state.levels.push_back({name, count, bodies});
  if (self.state == state) return;
  self.state = state;
  self.use().set(state);
}

void set_actions(RoomObject& self, const std::vector<ActionTuple>& actions) {
  protocol::Actions message;
  for (const auto& [name, key, label, help, on_body, button] : actions) {
    const auto target = on_body ? protocol::ActionTarget::body : protocol::ActionTarget::world;
    const auto face = button == "a"   ? protocol::ControllerButton::a
                      : button == "b" ? protocol::ControllerButton::b
                                      : protocol::ControllerButton::none;
    message.actions.push_back({name, key, label, help, target, face});
  }
  self.use().set(message);
}

void publish_changes(RoomObject& self, const PoseSnapshot& snapshot, const SceneChanges& changes,
                     const net::Presenter::NameOf& name_of) {
  // Entities that the script attached to bodies are sent after them.
  net::EntityChanges out = self.presenter.present(changes, name_of);
  out.append(std::exchange(self.own, {}));
  self.use().publish(snapshot, std::move(out));
}

void publish(RoomObject& self, SystemObject& system, bool effects) {
  System& engine = system.use();
  const SceneChanges changes =
      engine.viewer().take_scene_changes(self.presenter.needs_all(), self.presenter.assigned());
  publish_changes(self, engine.viewer().poses(), changes, [&](BodyId body) { return engine.bodies().name(body); });
  if (!effects) return;
  for (const ViewEvent& event : changes.events)
    self.use().effect(event.kind == ViewEvent::Kind::join ? "join" : "break", narrow(event.position));
}

// ---------------------------------------------------------------------------------------- a simulator of the script's

/// slot, generation, kind, name, articulate, number of particles, lines from place to place, solids (shape, place,
/// turn): all in the body's frame.
using SimulatedBodyTuple =
    std::tuple<std::uint32_t, std::uint32_t, std::string, std::string, std::uint32_t, std::uint32_t,
               std::vector<std::pair<Vec3, Vec3>>, std::vector<std::tuple<nb::object, Vec3, Quat4>>>;
using HoldTuple = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, Vec3, Vec3, double>;

DrawnLine line_between(const Vec3& from, const Vec3& to) {
  const double length = norm(to - from);
  return {0.5 * (from + to), length > 0 ? shortest_turn({1, 0, 0}, (1 / length) * (to - from)) : Quaternion{}, length};
}

/// usual_radius: chosen by the first bodies.
SceneChanges scene_of(const std::vector<SimulatedBodyTuple>& bodies, double extent, double& usual_radius) {
  SceneChanges changes;
  changes.extent = extent;
  for (const auto& [slot, generation, kind, name, articulate, particles, lines, solids] : bodies) {
    DrawnBody& body = changes.bodies.set.emplace_back();
    body.id = {slot, generation};
    body.is_new = false;
    body.kind = from_word(kind_words, kind, "kind");
    body.particles = particles;
    for (const auto& [from, to] : lines) body.lines.push_back(line_between(from, to));
    for (const auto& [shape, position, turn] : solids) {
      const auto [x, y, z, w] = turn;
      body.solids.push_back({to_shape(shape), position, {x, y, z, w}});
    }
    changes.memberships.push_back({slot, articulate});
  }
  if (usual_radius == 0) {
    std::vector<double> rods;
    for (const DrawnBody& body : changes.bodies.set)
      if (body.particles == 2 && body.lines.size() == 1) rods.push_back(body.lines[0].length);
    usual_radius = usual_radius_of(std::move(rods), extent);
  }
  changes.usual_radius = usual_radius;
  for (DrawnBody& body : changes.bodies.set) body.radius = (body.particles == 1 ? 2 : 1) * usual_radius;
  return changes;
}

/// A changed body, if `bodies` are given.
void publish_simulated(RoomObject& self, std::optional<std::vector<SimulatedBodyTuple>> bodies, nb::handle slots,
                       nb::handle places, const std::vector<HoldTuple>& holds, std::uint64_t step, double time,
                       std::uint32_t structure_version, const Energy& energy, double gap, double extent) {
  const nb::object as_array = nb::module_::import_("numpy").attr("ascontiguousarray");
  const auto which =
      nb::cast<nb::ndarray<const std::uint32_t, nb::c_contig, nb::device::cpu>>(as_array(slots, "uint32"));
  const auto numbers = nb::cast<nb::ndarray<const float, nb::c_contig, nb::device::cpu>>(as_array(places, "float32"));
  const std::size_t count = which.size();
  if (which.ndim() != 1 || numbers.ndim() != 2 || numbers.shape(0) != count || numbers.shape(1) != 7)
    throw nb::value_error("poses() must return slots of shape (n,) and places of shape (n, 7)");
  PoseSnapshot snapshot;
  snapshot.step = step, snapshot.time = time, snapshot.structure_version = structure_version;
  snapshot.kinetic = static_cast<float>(energy.kinetic), snapshot.potential = static_cast<float>(energy.potential);
  snapshot.gap = static_cast<float>(gap);
  snapshot.bodies.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    snapshot.bodies[i].body = which.data()[i];
    std::copy_n(numbers.data() + 7 * i, 3, snapshot.bodies[i].position);
    std::copy_n(numbers.data() + 7 * i + 3, 4, snapshot.bodies[i].orientation);
  }
  for (const auto& [client, hold, body, point, target, force] : holds) {
    HoldPose& pose = snapshot.holds.emplace_back();
    pose.client = client, pose.hold = hold, pose.body = body, pose.force = static_cast<float>(force);
    std::copy_n(narrow(point).data(), 3, pose.point);
    std::copy_n(narrow(target).data(), 3, pose.target);
  }
  if (bodies) {
    std::map<std::uint32_t, std::string> names;
    for (const auto& body : *bodies) names.emplace(std::get<0>(body), std::get<3>(body));
    publish_changes(self, snapshot, scene_of(*bodies, extent, self.usual_radius),
                    [&](BodyId body) { return names[body.slot]; });
  } else {
    self.use().publish(snapshot, std::exchange(self.own, {}));
  }
}

// ---------------------------------------------------------------------------------------------- entities of the script

template <std::size_t... I>
bool is_record(std::uint8_t kind, std::span<const std::uint8_t> bytes, std::index_sequence<I...>) {
  return ((kind == I && protocol::decode_records<std::tuple_element_t<I, protocol::EntityKinds>>(bytes)) || ...);
}

std::uint8_t kind_named(const std::string& name) {
  const std::optional<std::uint8_t> kind = net::entity_kind_of(name);
  if (!kind) throw nb::value_error(("there is no kind of entities named '" + name + "'").c_str());
  return *kind;
}

void set_entity(RoomObject& self, const std::string& kind, std::uint32_t slot, std::uint32_t generation,
                const nb::bytes& fields) {
  std::vector<std::uint8_t> record(8 + fields.size());
  for (int byte = 0; byte < 4; ++byte) {
    record[byte] = static_cast<std::uint8_t>(slot >> (8 * byte));
    record[4 + byte] = static_cast<std::uint8_t>(generation >> (8 * byte));
  }
  std::memcpy(record.data() + 8, fields.data(), fields.size());
  const std::uint8_t number = kind_named(kind);
  if (!is_record(number, record, std::make_index_sequence<net::entity_kind_count>()))
    throw nb::value_error(("these bytes are not a record of the kind '" + kind + "'").c_str());
  self.own.set(number, {slot, generation}, record);
}

// ------------------------------------------------------------------------------------------------------------- input

using NamedIds = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Client and record of each input.
nb::list records_of(const std::vector<net::ClientInput>& inputs) {
  nb::list taken;
  if (inputs.empty()) return taken;
  const RecordMaker maker;
  for (const auto& [client, what] : inputs) {
    taken.append(nb::make_tuple(client, std::visit([&](const auto& message) { return maker.make(message); }, what)));
  }
  return taken;
}

/// The bodies that still exist, each once, in this order.
std::vector<BodyId> existing(RoomObject& self, const NamedIds& named) {
  std::vector<BodyId> ids;
  std::set<std::uint32_t> seen;
  for (const auto& [slot, generation] : named) {
    const std::optional<BodyId> body = self.presenter.body({slot, generation});
    if (body && seen.insert(body->slot).second) ids.push_back(*body);
  }
  return ids;
}

nb::list bodies_of(RoomObject& self, const NamedIds& ids, const nb::object& system) {
  SystemObject* const object = to_system(system);
  nb::list bodies;
  for (const BodyId id : existing(self, ids))
    if (object->use().bodies().contains(id)) bodies.append(nb::cast(BodyHandle{system, object, id}));
  return bodies;
}

/// The same of a simulator: slots.
std::vector<std::uint32_t> slots_of(RoomObject& self, const NamedIds& ids) {
  std::vector<std::uint32_t> slots;
  for (const BodyId id : existing(self, ids)) slots.push_back(id.slot);
  return slots;
}

}  // namespace

void bind_room(nb::module_& module) {
  nb::class_<protocol::Part>(module, "DrawnPart", "A shape at its place on a body, as sent to pages.")
      .def(
          "__init__",
          [](protocol::Part* self, const std::string& kind, const std::vector<float>& sizes, const std::string& style,
             const std::string& material, std::optional<std::uint32_t> color, VectorArgument offset,
             const Quat4& rotation, double turn, const std::vector<float>& vertices,
             const std::vector<std::uint32_t>& triangles) {
            new (self) protocol::Part(make_part(kind, sizes, style, material, color, to_vec3(offset, "offset"),
                                                rotation, turn, vertices, triangles));
          },
          "kind"_a, "sizes"_a, nb::kw_only(), "style"_a = "*", "material"_a = "paint", "color"_a = nb::none(),
          "offset"_a = nb::make_tuple(0, 0, 0), "rotation"_a = Quat4{0, 0, 0, 1}, "turn"_a = 0.0,
          "vertices"_a = std::vector<float>{}, "triangles"_a = std::vector<std::uint32_t>{});

  nb::class_<RoomRecordingObject>(module, "RoomRecording", "Keeps what the viewers of a world are sent.")
      .def(
          "take",
          [](RoomRecordingObject& self) {
            nb::list taken;
            if (!self.recording) return taken;
            for (const net::RecordedMessage& message : self.recording->take())
              taken.append(nb::make_tuple(
                  message.time, nb::bytes(reinterpret_cast<const char*>(message.bytes.data()), message.bytes.size())));
            return taken;
          },
          nb::sig("def take(self) -> list[tuple[float, bytes]]"),
          "The messages since the last call, each with its time from the start of the recording (s). On any thread.")
      .def("end", [](RoomRecordingObject& self) { self.recording.reset(); }, "Keeps no more.");

  nb::class_<RoomObject>(module, "Room", "A world on a server. `World` uses it; scripts rarely need to.")
      .def_prop_ro(
          "world", [](RoomObject& self) { return self.use().world(); }, "Its id.")
      .def(
          "close",
          [](RoomObject& self, nb::object system) {
            self.room.reset();
            SystemObject* object = nullptr;
            if (nb::try_cast(system, object) && object) object->use().viewer().stop_watching_scene();
          },
          "system"_a, "Tells its pages that the world has ended, and stops logging changes of its system.")
      .def("set_settings", &set_settings, nb::kw_only(), "title"_a, "styles"_a, "style"_a, "camera"_a.none(),
           "ground"_a.none(), "modules"_a, "client"_a = 0,
           "client: for this one alone, until the next settings for all (client 0).")
      .def("set_state", &set_room_state, nb::kw_only(), "paused"_a, "speed"_a, "step_ms"_a, "dt"_a, "costs"_a,
           "budget_ms"_a = 0.0, "levels"_a = std::vector<LevelTuple>{}, "changes"_a = std::vector<std::string>{})
      .def("set_actions", &set_actions, "actions"_a,
           "Tuples of name, key, label, help, whether it is on a body, and button.")
      .def(
          "set_visual",
          [](RoomObject& self, const std::string& name, std::vector<protocol::Part> parts) {
            self.presenter.set_visual(name, std::move(parts));
          },
          "name"_a, "parts"_a, "Sets the parts of a visual, with which bodies or ties are drawn.")
      .def(
          "assign",
          [](RoomObject& self, const BodyHandle& body, const std::string& name, bool odd) {
            self.presenter.assign(body.id, name, odd);
          },
          "body"_a, "name"_a, "odd"_a, "Draws a body with a visual.")
      .def(
          "assign_slot",
          [](RoomObject& self, std::uint32_t slot, std::uint32_t generation, const std::string& name, bool odd) {
            self.presenter.assign({slot, generation}, name, odd);
          },
          "slot"_a, "generation"_a, "name"_a, "odd"_a, "The same for a body of a simulator.")
      .def("set_entity", &set_entity, "kind"_a, "slot"_a, "generation"_a, "fields"_a,
           "An entity of the script, as described for its kind in protocol/entities; sent with the next poses. Raises\n"
           "ValueError for bytes that are not such a record.")
      .def(
          "destroy_entity",
          [](RoomObject& self, const std::string& kind, std::uint32_t slot, std::uint32_t generation) {
            self.own.destroy(kind_named(kind), {slot, generation});
          },
          "kind"_a, "slot"_a, "generation"_a, "Destroys an entity.")
      .def(
          "set_listens",
          [](RoomObject& self, bool clicks, bool hovers, bool moves, std::vector<std::string> keys) {
            self.use().set(protocol::Listens{clicks, hovers, moves, std::move(keys)});
          },
          nb::kw_only(), "clicks"_a, "hovers"_a, "moves"_a, "keys"_a, "Enables further input events of pages.")
      .def(
          "ask_picture",
          [](RoomObject& self, std::uint32_t client, std::uint32_t number) { self.use().ask_picture(client, number); },
          "client"_a, "number"_a, "Asks one client for a picture; its parts come as input with this number.")
      .def("publish", &publish, "system"_a, "effects"_a = true,
           "Sends the newest poses of a system, and its changes; effects: with the joins and breaks of its edits.")
      .def("publish_simulated", &publish_simulated, "bodies"_a.none(), "slots"_a, "places"_a, "holds"_a, nb::kw_only(),
           "step"_a, "time"_a, "structure_version"_a, "energy"_a, "gap"_a, "extent"_a,
           "The same for a simulator of the script, see iota.Simulator; bodies: None if none has changed. Raises\n"
           "ValueError for shapes of slots and places other than (n,) and (n, 7).")
      .def_prop_ro(
          "needs_all",
          [](RoomObject& self) { return self.presenter.needs_all() || !self.presenter.assigned().empty(); },
          "Whether a simulator must send its bodies next time even without a change.")
      .def("bodies_of", &bodies_of, "ids"_a, "system"_a,
           nb::sig("def bodies_of(self, ids: collections.abc.Sequence[tuple[int, int]], system: System) -> list[Body]"),
           "The bodies with these ids, slot and generation, that still exist, each once.")
      .def("slots_of", &slots_of, "ids"_a, "The slots of the simulator's bodies with these ids that still exist.")
      .def(
          "take_warnings", [](RoomObject& self) { return self.presenter.take_warnings(); },
          "Notices since the last call about things that could not be drawn exactly.")
      .def(
          "notice",
          [](RoomObject& self, std::uint32_t client, std::uint8_t level, const std::string& title,
             const std::string& text, const std::string& hint, bool keep, const std::string& id, double seconds,
             std::uint8_t place) {
            self.use().notice(client, level, title, text, hint, keep,
                              {id, static_cast<float>(seconds),
                               static_cast<protocol::NoticePlace>(std::min<std::uint8_t>(place, 4))});
          },
          "client"_a, "level"_a, "title"_a, "text"_a, "hint"_a = "", "keep"_a = false, "id"_a = "", "seconds"_a = 0.0,
          "place"_a = 0,
          "A card on one client's page, or on all (client 0). level: a NoticeLevel. keep: pages that open later are shown\n"
          "it too. id: it replaces the card with the same one. seconds: 0 as usual, -1 until it is closed. place: a\n"
          "NoticePlace.")
      .def(
          "forget_notice", [](RoomObject& self, const std::string& title) { self.use().forget_notice(title); },
          "title"_a, "Kept cards with this title, or all for an empty one, are not shown to pages that open later.")
      .def(
          "effect",
          [](RoomObject& self, const std::string& kind, VectorArgument position, double volume) {
            self.use().effect(kind, narrow(to_vec3(position, "position")), static_cast<float>(volume));
          },
          "kind"_a, "position"_a, "volume"_a = 1.0,
          "Flash, sound and haptic pulse: 'break', 'join', 'grab' or 'impact' at a place (m); '#NAME' plays a sound.")
      .def(
          "pulse",
          [](RoomObject& self, std::uint32_t client, const std::string& hand, double strength, double seconds) {
            self.use().pulse(client, {hand, static_cast<float>(strength), static_cast<float>(seconds)});
          },
          "client"_a, "hand"_a, "strength"_a, "seconds"_a,
          "A haptic pulse for one client. hand: 'left', 'right' or '', both. strength: from 0 to 1.")
      .def(
          "record",
          [](RoomObject& self, double pose_time) {
            return new RoomRecordingObject{self.use().record(finite_positive(pose_time, "pose_time", "s"))};
          },
          "pose_time"_a, "Records what viewers are sent. pose_time: between two recorded poses, s.")
      .def(
          "send_away", [](RoomObject& self, std::uint32_t client) { self.use().send_away(client); }, "client"_a,
          "Ends the connection of a client; one on another machine stays away, if it is not a host.")
      .def(
          "take_input", [](RoomObject& self) { return records_of(self.use().take_input()); },
          nb::sig("def take_input(self) -> list[tuple[int, typing.Any]]"),
          "Client and record (iota._protocol.Input) of each input since the last call, in order of arrival.")
      .def(
          "take_pictures", [](RoomObject& self) { return records_of(self.use().take_pictures()); },
          nb::sig("def take_pictures(self) -> list[tuple[int, typing.Any]]"),
          "Only parts of pictures; everything else waits for `take_input`.")
      .def(
          "wait_for_input", [](RoomObject& self, double seconds) { self.use().wait_for_input(seconds); }, "seconds"_a,
          nb::call_guard<nb::gil_scoped_release>(),
          "Returns when there is input, after `wake`, or after some seconds, which Ctrl-C does not cut short.")
      .def("wake", [](RoomObject& self) { self.use().wake(); }, "Ends `wait_for_input`. May be used on any thread.");
}

}  // namespace iota::bindings
