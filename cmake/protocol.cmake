# SPDX-License-Identifier: Apache-2.0
# iota_protocol: the message structs, encoders and decoders, generated from protocol/.

find_package(Python 3.10 REQUIRED COMPONENTS Interpreter)

set(iota_generated_dir "${CMAKE_CURRENT_BINARY_DIR}/generated")
set(iota_protocol_header "${iota_generated_dir}/iota_protocol.h")
set(iota_protocol_generator "${CMAKE_CURRENT_SOURCE_DIR}/tools/generate_protocol.py")

file(GLOB_RECURSE iota_protocol_inputs CONFIGURE_DEPENDS
  "${CMAKE_CURRENT_SOURCE_DIR}/protocol/*.json" "${CMAKE_CURRENT_SOURCE_DIR}/tools/protocol/*.*")
list(FILTER iota_protocol_inputs EXCLUDE REGEX "/(golden|__pycache__)/")

add_custom_command(
  OUTPUT "${iota_protocol_header}"
  COMMAND "${Python_EXECUTABLE}" "${iota_protocol_generator}" --cpp "${iota_protocol_header}"
  DEPENDS "${iota_protocol_generator}" ${iota_protocol_inputs}
  COMMENT "Generating iota_protocol.h"
  VERBATIM)
# The values of the golden bytes, for tests.
set(iota_protocol_vectors "${iota_generated_dir}/iota_protocol_vectors.h")
add_custom_command(
  OUTPUT "${iota_protocol_vectors}"
  COMMAND "${Python_EXECUTABLE}" "${iota_protocol_generator}" --cpp-vectors "${iota_protocol_vectors}"
  DEPENDS "${iota_protocol_generator}" ${iota_protocol_inputs} "${CMAKE_CURRENT_SOURCE_DIR}/protocol/golden/vectors.json"
  COMMENT "Generating iota_protocol_vectors.h"
  VERBATIM)
add_custom_target(iota_protocol_vectors DEPENDS "${iota_protocol_vectors}")

# The Python module beside the extension: see cmake/python.cmake.
set(iota_protocol_module "${CMAKE_CURRENT_BINARY_DIR}/python/iota/_protocol.py")
add_custom_command(
  OUTPUT "${iota_protocol_module}"
  COMMAND "${Python_EXECUTABLE}" "${iota_protocol_generator}" --python "${iota_protocol_module}"
  DEPENDS "${iota_protocol_generator}" ${iota_protocol_inputs}
  COMMENT "Generating _protocol.py"
  VERBATIM)
add_custom_target(iota_protocol_python DEPENDS "${iota_protocol_module}")

if(TARGET iota_protocol) # comes with a built server
  return()
endif()

add_custom_target(iota_protocol_files DEPENDS "${iota_protocol_header}")

add_library(iota_protocol INTERFACE)
add_dependencies(iota_protocol iota_protocol_files)
target_include_directories(iota_protocol INTERFACE "${iota_generated_dir}")
