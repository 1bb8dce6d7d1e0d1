# SPDX-License-Identifier: Apache-2.0
# _core: the nanobind module, and its typed stub; _protocol: the protocol's numbers.
#
# Both land in BUILD/python/iota. `make build` links them beside the Python sources, so that python/iota is the whole
# package; a wheel gets them by the install rules at the end.

# A wheel can take an extension that is built and tested already (see wheel() in tools/build.py).
set(IOTA_PREBUILT "" CACHE PATH "Folder with a built _core module and its stub, to be packed instead of compiled")

if(SKBUILD)
  set(iota_page "${CMAKE_CURRENT_SOURCE_DIR}/web/dist")
  if(NOT EXISTS "${iota_page}/index.html")
    message(FATAL_ERROR "A wheel holds the built page, and ${iota_page}/index.html is not there. Try: make wheel")
  endif()
  install(DIRECTORY "${iota_page}/" DESTINATION iota/page COMPONENT python)
endif()

if(SKBUILD AND IOTA_PREBUILT)
  install(DIRECTORY "${IOTA_PREBUILT}/" DESTINATION iota COMPONENT python
          FILES_MATCHING PATTERN "_core.*" PATTERN "_protocol.py" PATTERN "libtbb.so*")
  add_custom_target(everyday)
  return()
endif()

find_package(Python 3.10 REQUIRED COMPONENTS Interpreter Development.Module OPTIONAL_COMPONENTS Development.SABIModule)

# nanobind is a PyPI package: it tells where its CMake files are.
if(NOT nanobind_ROOT)
  execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir
                  OUTPUT_VARIABLE nanobind_ROOT OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
find_package(nanobind CONFIG REQUIRED)

file(GLOB_RECURSE iota_binding_sources CONFIGURE_DEPENDS bindings/*.cpp)
# The functions that bindings/module.cpp calls. The types that others name or add functions to come first.
set(iota_binders vector shapes reports recording system body particle laws bonds fields grip constraints)
list(TRANSFORM iota_binders REPLACE ".+" "BIND(\\0)" OUTPUT_VARIABLE iota_first_binders)
set(iota_other_binders ${iota_binding_sources})
list(FILTER iota_other_binders INCLUDE REGEX "/bind_[a-z_]+\\.cpp$")
list(TRANSFORM iota_other_binders REPLACE ".+/bind_([a-z_]+)\\.cpp" "\\1")
list(REMOVE_ITEM iota_other_binders ${iota_binders})
list(TRANSFORM iota_other_binders REPLACE ".+" "BIND(\\0)")
list(JOIN iota_first_binders " " iota_first_binders)
list(JOIN iota_other_binders " " iota_other_binders)
file(CONFIGURE OUTPUT bindings/binders_of_folder.h CONTENT "#pragma once
#define IOTA_FIRST_BINDERS(BIND) @iota_first_binders@
#define IOTA_OTHER_BINDERS(BIND) @iota_other_binders@
" @ONLY)
# NOMINSIZE: nanobind would compile our sources for size; the calls that cross arrays are worth the speed.
nanobind_add_module(_core NB_STATIC NOMINSIZE NB_SUPPRESS_WARNINGS ${iota_binding_sources})
iota_compile(_core -O2)
set_target_properties(_core PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/python/iota")
target_compile_definitions(_core PRIVATE IOTA_VERSION="${PROJECT_VERSION}")
target_include_directories(_core PRIVATE bindings src ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/bindings)
target_link_libraries(_core PRIVATE iota_engine iota_net)
add_dependencies(_core iota_protocol_python)
# Only the module's entry point is seen from outside: nothing of Boost or of ours can clash with another extension.
target_link_options(_core PRIVATE "$<$<PLATFORM_ID:Linux>:-Wl,--exclude-libs,ALL>")

# oneTBB goes along: a wheel works where it is not installed. (Apache-2.0, see LICENSES/oneTBB.txt.)
if(IOTA_THREADS)
  add_custom_command(TARGET _core POST_BUILD
    COMMAND "${CMAKE_COMMAND}" -E copy_if_different "$<TARGET_FILE:TBB::tbb>"
            "$<TARGET_FILE_DIR:_core>/$<TARGET_SONAME_FILE_NAME:TBB::tbb>")
  set_target_properties(_core PROPERTIES BUILD_RPATH_USE_ORIGIN ON BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
endif()

set(iota_stub "${CMAKE_CURRENT_BINARY_DIR}/python/iota/_core.pyi")
set(iota_stub_patterns "${CMAKE_CURRENT_SOURCE_DIR}/bindings/stub_patterns.txt")
if(NOT EXISTS "${iota_stub_patterns}")
  set(iota_stub_patterns "")
endif()
nanobind_add_stub(iota_stub
  MODULE _core
  OUTPUT "${iota_stub}"
  PYTHON_PATH "$<TARGET_FILE_DIR:_core>"
  PATTERN_FILE ${iota_stub_patterns}
  DEPENDS _core)

add_custom_target(everyday DEPENDS _core iota_stub)

if(SKBUILD)
  install(TARGETS _core LIBRARY DESTINATION iota COMPONENT python)
  install(FILES "${iota_stub}" "${iota_protocol_module}" DESTINATION iota COMPONENT python)
  if(IOTA_THREADS)
    install(FILES "$<TARGET_FILE_DIR:_core>/$<TARGET_SONAME_FILE_NAME:TBB::tbb>" DESTINATION iota COMPONENT python)
  endif()
endif()
