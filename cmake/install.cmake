# The files that `cmake --install` installs. The component runtime is the program and its configurations. The component dev is a CMake package
# of the libraries and their headers, so that plugins and other programs can be built with them; it leaves out cli, which is internal to the
# program. package.cmake makes one Debian package per component. Without --component, all components are installed.
include(CMakePackageConfigHelpers)

set(ARMWRIGHT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/armwright)
set(ARMWRIGHT_PACKAGE_ROOMS ${ARMWRIGHT_ROOMS})
list(FILTER ARMWRIGHT_PACKAGE_ROOMS INCLUDE REGEX ".")
list(REMOVE_ITEM ARMWRIGHT_PACKAGE_ROOMS cli)
# The pkg-config modules that the libraries need.
set(ARMWRIGHT_PACKAGE_MODULES ode tomlplusplus tinyxml2 yaml-0.1 liblz4 libzstd)
if(ARMWRIGHT_WITH_PAGE)
  list(APPEND ARMWRIGHT_PACKAGE_MODULES duktape)
endif()
if(ARMWRIGHT_WITH_MPI)
  list(APPEND ARMWRIGHT_PACKAGE_MODULES ompi-c)
endif()

install(TARGETS armwright RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(TARGETS ${ARMWRIGHT_MODULES} LIBRARY DESTINATION ${ARMWRIGHT_MODULE_DIR} COMPONENT runtime)
install(DIRECTORY configs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/armwright/configs COMPONENT runtime)
# Example plugins to read and to build. The program looks for built plugins in lib/armwright/plugins.
install(DIRECTORY plugins/ DESTINATION ${CMAKE_INSTALL_DATADIR}/armwright/plugins COMPONENT runtime USE_SOURCE_PERMISSIONS
        PATTERN "__pycache__" EXCLUDE)
# Examples: problems of users' own, and a program that uses armwright as a library.
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/armwright/examples COMPONENT runtime USE_SOURCE_PERMISSIONS
        PATTERN "__pycache__" EXCLUDE PATTERN "build" EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime OPTIONAL)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY ${ARMWRIGHT_MANUAL_DIR}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime)
install(FILES ${ARMWRIGHT_MANUAL_DIR}/completions/armwright DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT runtime)

foreach(room IN LISTS ARMWRIGHT_PACKAGE_ROOMS)
  install(TARGETS armwright_${room} EXPORT armwrightTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  # Headers include each other by folder ("base/error.hpp"). The targets have the include path for this.
  install(DIRECTORY src/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/armwright COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(EXPORT armwrightTargets NAMESPACE armwright:: DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

# A separate export set, so that a plugin needs none of the libraries that armwright itself needs.
install(TARGETS armwright_plugin EXPORT armwrightPluginTargets)
install(DIRECTORY include/armwright DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(EXPORT armwrightPluginTargets NAMESPACE armwright:: DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

# The shared library for programs of the user's own, which needs no headers or packages of armwright's libraries either. A built program
# needs only the file in the component runtime.
install(TARGETS armwright_shared EXPORT armwrightRunTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime
                                                                    NAMELINK_COMPONENT dev)
install(EXPORT armwrightRunTargets NAMESPACE armwright:: DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

configure_package_config_file(cmake/armwrightConfig.cmake.in ${PROJECT_BINARY_DIR}/armwrightConfig.cmake
                              INSTALL_DESTINATION ${ARMWRIGHT_CMAKE_DIR} PATH_VARS ARMWRIGHT_MODULE_DIR)
# docs/versioning.md says what does not change within a major version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/armwrightConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/armwrightConfig.cmake ${PROJECT_BINARY_DIR}/armwrightConfigVersion.cmake
        DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

include(cmake/package.cmake)
if(ARMWRIGHT_BUILD_TESTS)
  add_subdirectory(tests/package)
endif()
