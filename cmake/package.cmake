# The Debian packages, made by cpack of what is installed: armwright (component runtime), armwright-dev (dev) and, where it is built,
# python3-armwright (python). package_finish.cmake does what Debian asks for beyond that. scripts/packages makes and checks them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME armwright)
set(CPACK_PACKAGE_VENDOR "armwright developers")
set(CPACK_PACKAGE_CONTACT "armwright developers <noreply@armwright.example>")
set(CPACK_COMPONENTS_ALL runtime dev)
if(ARMWRIGHT_WITH_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

# Each package's description begins with a line of its own, so there is none for all; to cpack that is this text.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(this_version "= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# Libraries follow from the program itself. What it calls beyond that (mpirun, a compiler for plugins) nothing needs.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME armwright)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "armwright-dev, bash-completion, openmpi-bin, python3-scipy")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
    "tunes robot arms by simulation
armwright lets interchangeable gradient-free optimizers loose on the
controllers, effort limits, links and motors of a robot arm (URDF),
simulated in a physics engine, and judges every winner on test cases that
no optimizer has seen. It compares optimizers with statistics, resumes
after any interruption, spreads work over clusters, shows results on a
page with the arm's motion, and writes the winner's gains for ROS 2.")

# What find_package(armwright) links. The libraries are static.
set(dev_packages libeigen3-dev libfmt-dev nlohmann-json3-dev libssl-dev zlib1g-dev libsqlite3-dev pkg-config libode-dev liburdfdom-dev
                 liburdfdom-headers-dev libconsole-bridge-dev libtomlplusplus-dev libtinyxml2-dev)
foreach(option_and_packages IN ITEMS "PAGMO:libpagmo-dev" "CERES:libceres-dev" "NLOPT:libnlopt-cxx-dev" "PAGE:duktape-dev"
                                     "PAGE:libcpp-httplib-dev" "MPI:libopenmpi-dev" "MUJOCO:libmujoco-dev" "ASSIMP:libassimp-dev")
  string(REGEX MATCH "(.*):(.*)" unused ${option_and_packages})
  if(ARMWRIGHT_WITH_${CMAKE_MATCH_1})
    list(APPEND dev_packages ${CMAKE_MATCH_2})
  endif()
endforeach()
list(JOIN dev_packages ", " dev_depends)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME armwright-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "armwright (${this_version}), ${dev_depends}")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake, g++")
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "tunes robot arms by simulation - for optimizers and programs of your own
The headers against which optimizers in C and C++ are built that armwright
loads as plugins, and armwright's own libraries with their headers and a
CMake package: find_package(armwright).")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-armwright)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "armwright (${this_version}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-scipy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/python/postinst
                                              ${PROJECT_SOURCE_DIR}/cmake/debian/python/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "tunes robot arms by simulation - Python
Problems, runs and comparisons of armwright from Python 3.11, with arrays
of NumPy, and optimizers written in Python.")

# Debian's own changelog names the version and its day; what has changed stands in the project's.
execute_process(COMMAND date --utc --rfc-email "--date=${ARMWRIGHT_RELEASE_DATE}" OUTPUT_VARIABLE release_day OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/changelog @ONLY CONTENT
     "armwright (@PROJECT_VERSION@-@CPACK_DEBIAN_PACKAGE_RELEASE@) unstable; urgency=medium

  * Version @PROJECT_VERSION@; changelog.gz says what has changed.

 -- @CPACK_PACKAGE_CONTACT@  @release_day@
")
configure_file(cmake/debian/copyright.in ${PROJECT_BINARY_DIR}/debian/copyright @ONLY)
# What the program carries of others: of npm's packages those that the page is made of, and not only built with; and Ceres, which Debian's
# CMake package of it links statically.
set(ARMWRIGHT_PAGE_PACKAGES "")
if(ARMWRIGHT_WITH_PAGE)
  set(ARMWRIGHT_PAGE_PACKAGES core-js echarts three tslib zrender minisearch) # the last in the documentation's search
endif()
set(ARMWRIGHT_CERES_LICENSE "")
if(ARMWRIGHT_WITH_CERES)
  set(ARMWRIGHT_CERES_LICENSE /usr/share/doc/libceres-dev/copyright)
endif()
configure_file(cmake/package_finish.cmake.in ${PROJECT_BINARY_DIR}/package_finish.cmake @ONLY)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/package_finish.cmake)
include(CPack)

# Only what is packed is built for it: neither tests nor benchmarks.
set(packed armwright)
foreach(target IN ITEMS _armwright site) # what this build leaves out is left out
  if(TARGET ${target})
    list(APPEND packed ${target})
  endif()
endforeach()
add_custom_target(packages COMMAND ${CMAKE_CPACK_COMMAND} -B ${PROJECT_BINARY_DIR}/packages DEPENDS ${packed} USES_TERMINAL
                  COMMENT "Making the Debian packages")
