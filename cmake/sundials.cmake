# SPDX-License-Identifier: Apache-2.0
# KINSOL, a second solver for equations. Linked as static archives, so that nothing that is installed or packed depends
# on SUNDIALS; without them the engine is whole but for the solver "kinsol", and says so when asked for it.

option(IOTA_KINSOL "Use SUNDIALS KINSOL where it is found (tools/fetch_sundials.sh)" ON)
if(NOT IOTA_KINSOL)
  return()
endif()

set(iota_sundials_hint "${CMAKE_CURRENT_SOURCE_DIR}/.venv/sundials")
find_path(IOTA_SUNDIALS_INCLUDE kinsol/kinsol.h HINTS "${iota_sundials_hint}/include")
set(iota_sundials_archives "")
foreach(part kinsol nvecserial sunlinsoldense sunmatrixdense)
  find_library(IOTA_SUNDIALS_${part} "libsundials_${part}.a" HINTS "${iota_sundials_hint}/lib")
  list(APPEND iota_sundials_archives "${IOTA_SUNDIALS_${part}}")
endforeach()
if(NOT IOTA_SUNDIALS_INCLUDE OR iota_sundials_archives MATCHES "NOTFOUND")
  message(STATUS "iota: without SUNDIALS; there will be no solver \"kinsol\"")
  return()
endif()

set_property(SOURCE src/solver/general/kinsol.cpp APPEND PROPERTY COMPILE_DEFINITIONS IOTA_HAVE_KINSOL)
target_include_directories(iota_engine SYSTEM PRIVATE "$<BUILD_INTERFACE:${IOTA_SUNDIALS_INCLUDE}>")
# An installed engine brings the archives with it.
set(iota_sundials_installed "")
foreach(archive ${iota_sundials_archives})
  cmake_path(GET archive FILENAME name)
  list(APPEND iota_sundials_installed "$<INSTALL_INTERFACE:\${_IMPORT_PREFIX}/${CMAKE_INSTALL_LIBDIR}/${name}>")
endforeach()
target_link_libraries(iota_engine PRIVATE "$<BUILD_INTERFACE:${iota_sundials_archives}>" ${iota_sundials_installed})
install(FILES ${iota_sundials_archives} DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT engine)
