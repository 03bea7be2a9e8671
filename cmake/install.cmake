# What `cmake --install` lays down: the program and its configurations (component runtime), and the rooms below it as a CMake package with
# their headers, so that plugins and other programs can build on them (dev). The cli room is the program's inside and stays out. Packages
# are made of the components (package.cmake); without --component all are installed.
include(CMakePackageConfigHelpers)

set(ARMWRIGHT_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/armwright)
set(ARMWRIGHT_PACKAGE_ROOMS ${ARMWRIGHT_ROOMS})
list(FILTER ARMWRIGHT_PACKAGE_ROOMS INCLUDE REGEX ".")
list(REMOVE_ITEM ARMWRIGHT_PACKAGE_ROOMS cli)
# What their libraries need of pkg-config.
set(ARMWRIGHT_PACKAGE_MODULES ode urdfdom tomlplusplus tinyxml2)
if(ARMWRIGHT_WITH_PAGE)
  list(APPEND ARMWRIGHT_PACKAGE_MODULES duktape cpp-httplib)
endif()
if(ARMWRIGHT_WITH_MPI)
  list(APPEND ARMWRIGHT_PACKAGE_MODULES ompi-c)
endif()

install(TARGETS armwright RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
install(DIRECTORY configs/ DESTINATION ${CMAKE_INSTALL_DATADIR}/armwright/configs COMPONENT runtime)
# Examples to read and to build; the program looks for built plugins in lib/armwright/plugins.
install(DIRECTORY plugins/ DESTINATION ${CMAKE_INSTALL_DATADIR}/armwright/plugins COMPONENT runtime USE_SOURCE_PERMISSIONS
        PATTERN "__pycache__" EXCLUDE)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime OPTIONAL)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(DIRECTORY ${ARMWRIGHT_MANUAL_DIR}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime)
install(FILES ${ARMWRIGHT_MANUAL_DIR}/completions/armwright DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT runtime)

foreach(room IN LISTS ARMWRIGHT_PACKAGE_ROOMS)
  install(TARGETS armwright_${room} EXPORT armwrightTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
  # Headers name each other by room ("base/error.hpp"); the targets carry the folder that makes this work.
  install(DIRECTORY src/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/armwright COMPONENT dev FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(EXPORT armwrightTargets NAMESPACE armwright:: DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

# A set of its own, so that a plugin needs none of the libraries that the rooms need.
install(TARGETS armwright_plugin EXPORT armwrightPluginTargets)
install(DIRECTORY include/armwright DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(EXPORT armwrightPluginTargets NAMESPACE armwright:: DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

configure_package_config_file(cmake/armwrightConfig.cmake.in ${PROJECT_BINARY_DIR}/armwrightConfig.cmake
                              INSTALL_DESTINATION ${ARMWRIGHT_CMAKE_DIR})
# docs/versioning.md says what stays as it is within a major version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/armwrightConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/armwrightConfig.cmake ${PROJECT_BINARY_DIR}/armwrightConfigVersion.cmake
        DESTINATION ${ARMWRIGHT_CMAKE_DIR} COMPONENT dev)

include(cmake/package.cmake)
if(ARMWRIGHT_BUILD_TESTS)
  add_subdirectory(tests/package)
endif()
