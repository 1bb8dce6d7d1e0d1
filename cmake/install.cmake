# SPDX-License-Identifier: Apache-2.0
# What `cmake --install BUILD --component engine` writes, so that another project can say find_package(iota).

include(CMakePackageConfigHelpers)

set(iota_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/iota")

install(TARGETS iota_engine EXPORT iotaTargets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT engine
  INCLUDES DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(DIRECTORY include/iota DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT engine FILES_MATCHING PATTERN "*.h")
install(EXPORT iotaTargets NAMESPACE iota:: DESTINATION "${iota_package_dir}" COMPONENT engine)

configure_package_config_file(cmake/iotaConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/iotaConfig.cmake"
  INSTALL_DESTINATION "${iota_package_dir}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/iotaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/iotaConfig.cmake" "${CMAKE_CURRENT_BINARY_DIR}/iotaConfigVersion.cmake"
  DESTINATION "${iota_package_dir}" COMPONENT engine)
