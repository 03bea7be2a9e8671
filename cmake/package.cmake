# The Debian packages, which cpack makes from the installed components: armwright (runtime), armwright-dev (dev) and, if it is built,
# python3-armwright (python). package_finish.cmake adds the other things that Debian requires. scripts/packages makes and checks the packages.
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

# The description of each package has its own first line, so there is no common summary. cpack uses this text as a sign for that.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON) # of libarmwright, for packages of programs that use it
set(this_version "= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")

# The dependencies on libraries follow from the program itself. The other programs that it calls (mpirun, a compiler for plugins) are optional.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME armwright)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "armwright-dev, bash-completion, openmpi-bin, python3-scipy")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION
    "tunes robot arms by simulation
armwright tunes the controllers, effort limits, links and motors of a
robot arm (URDF) with interchangeable gradient-free optimizers. It
simulates the arm in a physics engine and judges every winner on test
cases that were not used for training. It compares optimizers with
statistics, resumes after any interruption, distributes work over
clusters, shows results on a page with the motion of the arm, and writes
the gains of the winner for ROS 2.")

# The packages that find_package(armwright) needs, because the libraries are static.
set(dev_packages libeigen3-dev libfmt-dev nlohmann-json3-dev libssl-dev zlib1g-dev libsqlite3-dev pkg-config libode-dev
                 libtomlplusplus-dev libtinyxml2-dev libyaml-dev liblz4-dev libzstd-dev)
foreach(option_and_packages IN ITEMS "NLOPT:libnlopt-cxx-dev" "PAGE:duktape-dev"
                                     "MPI:libopenmpi-dev" "MUJOCO:libmujoco-dev" "ASSIMP:libassimp-dev")
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
The headers for optimizers in C and C++ that armwright loads as plugins,
and the libraries of armwright with their headers and a CMake package:
find_package(armwright).")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-armwright)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "armwright (${this_version}), python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-scipy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/python/postinst
                                              ${PROJECT_SOURCE_DIR}/cmake/debian/python/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "tunes robot arms by simulation - Python
Problems, runs and comparisons of armwright for Python 3.11, with NumPy
arrays, and optimizers written in Python.")

# The Debian changelog has only the version and its date. The changes are in the changelog of the project.
execute_process(COMMAND date --utc --rfc-email "--date=${ARMWRIGHT_RELEASE_DATE}" OUTPUT_VARIABLE release_day OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/debian/changelog @ONLY CONTENT
     "armwright (@PROJECT_VERSION@-@CPACK_DEBIAN_PACKAGE_RELEASE@) unstable; urgency=medium

  * Version @PROJECT_VERSION@; changelog.gz lists the changes.

 -- @CPACK_PACKAGE_CONTACT@  @release_day@
")
configure_file(cmake/debian/copyright.in ${PROJECT_BINARY_DIR}/debian/copyright @ONLY)
# The software of other authors that the program contains: the npm packages that are part of the page (not those that only build it), and
# Ceres, which Debian's CMake package links statically.
set(ARMWRIGHT_PAGE_PACKAGES "")
if(ARMWRIGHT_WITH_PAGE)
  set(ARMWRIGHT_PAGE_PACKAGES core-js echarts three tslib zrender minisearch) # minisearch is in the search of the documentation
endif()
set(ARMWRIGHT_CERES_LICENSE "")
if(ARMWRIGHT_WITH_CERES)
  set(ARMWRIGHT_CERES_LICENSE /usr/share/doc/libceres-dev/copyright)
endif()
configure_file(cmake/package_finish.cmake.in ${PROJECT_BINARY_DIR}/package_finish.cmake @ONLY)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_BINARY_DIR}/package_finish.cmake)
include(CPack)

# The target builds only what the packages contain: neither tests nor benchmarks.
set(packed armwright armwright_shared)
foreach(target IN ITEMS _armwright site) # only the targets that this build has
  if(TARGET ${target})
    list(APPEND packed ${target})
  endif()
endforeach()
add_custom_target(packages COMMAND ${CMAKE_CPACK_COMMAND} -B ${PROJECT_BINARY_DIR}/packages DEPENDS ${packed} USES_TERMINAL
                  COMMENT "Making the Debian packages")
