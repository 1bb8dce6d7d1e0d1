// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <system_error>

namespace iota::bindings {

namespace {

static_assert(std::endian::native == std::endian::little, "recordings are written in the machine's own byte order");

constexpr std::string_view file_mark = "IOTAREC1";

std::uint64_t fnv1a(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3u;
  return hash;
}

void append_number(std::string& out, std::uint64_t number) {
  out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::uint64_t number_at(std::string_view bytes, std::size_t offset) {
  std::uint64_t number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

/// Mark, three counts (bytes, bytes, hashes), their contents, FNV-1a of all before it.
std::string encode(const Recording& recording) {
  std::string out(file_mark);
  append_number(out, recording.start.bytes.size());
  append_number(out, recording.commands.size());
  append_number(out, recording.hashes.size());
  out.append(reinterpret_cast<const char*>(recording.start.bytes.data()), recording.start.bytes.size());
  out.append(reinterpret_cast<const char*>(recording.commands.data()), recording.commands.size());
  out.append(reinterpret_cast<const char*>(recording.hashes.data()), recording.hashes.size() * 8);
  append_number(out, fnv1a(out));
  return out;
}

[[noreturn]] void raise_broken(const std::string& source, const char* why) {
  const std::string text = source + " is no recording: " + why;
  throw nb::value_error(text.c_str());
}

Recording decode(std::string_view bytes, const std::string& source) {
  constexpr std::size_t head = 8 + 3 * 8, tail = 8;
  if (bytes.size() < head + tail || bytes.substr(0, 8) != file_mark) raise_broken(source, "it does not start as one");
  const std::uint64_t start = number_at(bytes, 8), commands = number_at(bytes, 16), hashes = number_at(bytes, 24);
  const std::uint64_t room = bytes.size() - head - tail;
  if (start > room || commands > room - start || hashes > (room - start - commands) / 8 ||
      start + commands + hashes * 8 != room)
    raise_broken(source, "its length is wrong, it may have been cut short");
  if (number_at(bytes, bytes.size() - tail) != fnv1a(bytes.substr(0, bytes.size() - tail)))
    raise_broken(source, "its checksum is wrong");
  const auto* data = reinterpret_cast<const std::byte*>(bytes.data()) + head;
  Recording recording;
  recording.start.bytes.assign(data, data + start);
  recording.commands.assign(data + start, data + start + commands);
  recording.hashes.resize(hashes);
  if (hashes) std::memcpy(recording.hashes.data(), data + start + commands, hashes * 8);
  return recording;
}

[[noreturn]] void raise_os_error(const std::filesystem::path& path) {
  PyErr_SetFromErrnoWithFilename(PyExc_OSError, path.c_str());
  throw nb::python_error();
}

std::filesystem::path to_path(nb::handle path) {
  nb::object text = nb::steal(PyOS_FSPath(path.ptr()));
  if (!text.is_valid()) throw nb::python_error();
  return nb::cast<std::string>(text);
}

/// Written beside the target and moved there: a reader sees the old file or the new one, never a part.
void save(const Recording& recording, nb::handle target) {
  const std::filesystem::path path = to_path(target);
  const std::filesystem::path part =
      path.string().append(".").append(std::to_string(std::random_device{}())).append(".part");
  const std::string bytes = encode(recording);
  std::FILE* file = std::fopen(part.c_str(), "wb");
  if (!file) raise_os_error(path);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed || std::rename(part.c_str(), path.c_str()) != 0) {
    const int error = errno;
    std::remove(part.c_str());
    errno = error;
    raise_os_error(path);
  }
}

Recording load(nb::handle source) {
  const std::filesystem::path path = to_path(source);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) raise_os_error(path);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  return decode(bytes, path.string());
}

nb::bytes as_bytes(const std::vector<std::byte>& bytes) { return nb::bytes(bytes.data(), bytes.size()); }

constexpr const char* doc =
    "A snapshot and all that happened since. `System.replay` repeats it and compares the state after every step.\n\n"
    "    system.start_recording()\n"
    "    ...\n"
    "    recording = system.stop_recording()\n"
    "    recording.save('run.iota')\n"
    "    assert system.replay(iota.Recording.load('run.iota')) is None";

}  // namespace

void bind_recording(nb::module_& module) {
  nb::class_<Recording>(module, "Recording", doc)
      .def_prop_ro(
          "start", [](const Recording& r) { return as_bytes(r.start.bytes); }, "The snapshot it starts from.")
      .def_prop_ro(
          "steps", [](const Recording& r) { return r.hashes.size(); }, "Number of steps.")
      .def_ro("hashes", &Recording::hashes, "`System.state_hash()` after each step.")
      .def("save", &save, "path"_a, nb::sig("def save(self, path: str | os.PathLike[str]) -> None"),
           "Writes it to a file, whole or not at all. Raises OSError.")
      .def_static("load", &load, "path"_a, nb::sig("def load(path: str | os.PathLike[str]) -> Recording"),
                  "Reads what `save` wrote. Raises OSError, or ValueError for a file that is no whole recording.")
      .def(
          "to_bytes",
          [](const Recording& r) {
            const std::string bytes = encode(r);
            return nb::bytes(bytes.data(), bytes.size());
          },
          "The contents of its file.")
      .def_static(
          "from_bytes", [](const nb::bytes& bytes) { return decode({bytes.c_str(), bytes.size()}, "this"); }, "data"_a)
      .def(
          "__eq__",
          [](const Recording& a, nb::handle other) {
            const Recording* b = nullptr;
            return nb::try_cast<const Recording*>(other, b) && b && encode(a) == encode(*b);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", [](const Recording& r) {
        return "<Recording: " + std::to_string(r.hashes.size()) + " steps, " +
               std::to_string(r.start.bytes.size() + r.commands.size()) + " bytes>";
      });
}

}  // namespace iota::bindings
