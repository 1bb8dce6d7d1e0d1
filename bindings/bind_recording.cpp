// SPDX-License-Identifier: Apache-2.0
#include "binders.h"

#include "base/replace_file.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace iota::bindings {

namespace {

[[noreturn]] void raise_os_error(const std::filesystem::path& path) {
  PyErr_SetFromErrnoWithFilename(PyExc_OSError, path.c_str());
  throw nb::python_error();
}

std::filesystem::path to_path(nb::handle path) {
  nb::object text = nb::steal(PyOS_FSPath(path.ptr()));
  if (!text.is_valid()) throw nb::python_error();
  return nb::cast<std::string>(text);
}

constexpr const char* ending = ".replay";  // .iota is for what pages show

void save(const Recording& recording, nb::handle target) {
  const std::filesystem::path path = to_path(target);
  if (path.extension() != ending)
    throw std::invalid_argument("a recording of a system must end in " + std::string(ending) + ", not '" +
                                path.filename().string() + "'");
  try {
    replace_file(path, recording.to_bytes(), Readers::all);
  } catch (const std::system_error& error) {
    errno = error.code().value();
    raise_os_error(path);
  }
}

Recording load(nb::handle source) {
  const std::filesystem::path path = to_path(source);
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) raise_os_error(path);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  try {
    return Recording::from_bytes(std::as_bytes(std::span(bytes)));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path.string() + ": " + error.what());
  }
}

nb::bytes as_bytes(const std::vector<std::byte>& bytes) { return nb::bytes(bytes.data(), bytes.size()); }

constexpr const char* recording_doc =
    "A snapshot and all later commands. `System.replay` repeats it and compares the state after every step.\n\n"
    "    system.start_recording()\n"
    "    ...\n"
    "    recording = system.stop_recording()\n"
    "    recording.save('run.replay')\n"
    "    assert system.replay(iota.Recording.load('run.replay')) is None";

}  // namespace

void bind_recording(nb::module_& module) {
  nb::class_<Recording>(module, "Recording", recording_doc)
      .def_prop_ro(
          "start", [](const Recording& r) { return as_bytes(r.start.bytes); }, "The snapshot it starts from.")
      .def_prop_ro(
          "steps", [](const Recording& r) { return r.hashes.size(); }, "Number of steps.")
      .def_ro("hashes", &Recording::hashes, "`System.state_hash()` after each step.")
      .def(
          "save", &save, "path"_a, nb::sig("def save(self, path: str | os.PathLike[str]) -> None"),
          "Writes it to a file that ends in .replay, completely or not at all. Raises OSError, or ValueError for another\n"
          "ending.")
      .def_static("load", &load, "path"_a, nb::sig("def load(path: str | os.PathLike[str]) -> Recording"),
                  "Reads a file made by `save`. Raises OSError, or ValueError for a file that is not a complete "
                  "recording.")
      .def(
          "to_bytes", [](const Recording& r) { return as_bytes(r.to_bytes()); }, "The contents of its file.")
      .def_static(
          "from_bytes",
          [](const nb::bytes& bytes) {
            return Recording::from_bytes({static_cast<const std::byte*>(bytes.data()), bytes.size()});
          },
          "data"_a)
      .def(
          "__eq__",
          [](const Recording& a, nb::handle other) {
            const Recording* b = nullptr;
            return nb::try_cast<const Recording*>(other, b) && b && a == *b;
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__repr__", [](const Recording& r) {
        return "<Recording: " + std::to_string(r.hashes.size()) + " steps, " +
               std::to_string(r.start.bytes.size() + r.commands.size()) + " bytes>";
      });
}

}  // namespace iota::bindings
