# Every library comes from Debian 12. scripts/setup installs them, and docs/dependencies.md says why each is there.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt 9 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(ZLIB REQUIRED)
find_package(SQLite3 REQUIRED)
pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(TINYXML2 REQUIRED IMPORTED_TARGET tinyxml2)
pkg_check_modules(YAML_0.1 REQUIRED IMPORTED_TARGET yaml-0.1)
pkg_check_modules(LIBLZ4 REQUIRED IMPORTED_TARGET liblz4)
pkg_check_modules(LIBZSTD REQUIRED IMPORTED_TARGET libzstd)
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
find_path(BOOST_INCLUDE_DIR boost/math/distributions/fisher_f.hpp REQUIRED) # Boost.Math has headers only

# The optimizer libraries are optional. If one is missing, its optimizers are listed as unavailable, with the reason.
option(ARMWRIGHT_WITH_NLOPT "Optimizers of NLopt (nlopt:*)" ON)
option(ARMWRIGHT_WITH_PAGMO "Optimizers of pagmo (pagmo:*)" ON)
option(ARMWRIGHT_WITH_CERES "Optimizers of Ceres Solver (ceres:*)" ON)
if(ARMWRIGHT_WITH_NLOPT)
  find_library(NLOPT_CXX_LIBRARY nlopt_cxx REQUIRED) # this variant of the library also has AGS
  find_path(NLOPT_INCLUDE_DIR nlopt.h REQUIRED)
endif()
if(ARMWRIGHT_WITH_PAGMO)
  find_package(Pagmo 2.18 REQUIRED)
endif()
if(ARMWRIGHT_WITH_CERES)
  find_package(Ceres 2.1 REQUIRED)
endif()

# A third engine that checks the others, and robots in MJCF. Both are built if the library is there; the build never requires it. (The CMake package of the library
# requires OpenGL, which only its graphics need, so it is not used.)
find_library(MUJOCO_LIBRARY mujoco)
find_path(MUJOCO_INCLUDE_DIR mujoco/mujoco.h)
set(mujoco_found OFF)
if(MUJOCO_LIBRARY AND MUJOCO_INCLUDE_DIR)
  file(STRINGS ${MUJOCO_INCLUDE_DIR}/mujoco/mujoco.h mujoco_version REGEX "^#define mjVERSION_HEADER")
  string(REGEX REPLACE ".* ([0-9])([0-9])([0-9]).*" "\\1.\\2.\\3" mujoco_version "${mujoco_version}")
  if(mujoco_version VERSION_GREATER_EQUAL 2.2 AND mujoco_version VERSION_LESS 2.3)
    set(mujoco_found ON) # 2.3 has other data structures
  endif()
endif()
option(ARMWRIGHT_WITH_MUJOCO "Engine mujoco, which checks the other engines, and robots in MJCF" ${mujoco_found})
if(ARMWRIGHT_WITH_MUJOCO AND NOT mujoco_found)
  message(FATAL_ERROR "ARMWRIGHT_WITH_MUJOCO is ON, but MuJoCo 2.2 was not found; install the Debian package libmujoco-dev or set the "
                      "option to OFF")
endif()

# OpenMPI distributes evaluations over the ranks of an mpirun. It is found by pkg-config, because CMake's own module requires the language C for
# the plain C interface.
pkg_check_modules(OMPI_C IMPORTED_TARGET ompi-c)
option(ARMWRIGHT_WITH_MPI "Distribution of evaluations by mpirun (OpenMPI)" ${OMPI_C_FOUND})
if(ARMWRIGHT_WITH_MPI AND NOT OMPI_C_FOUND)
  message(FATAL_ERROR "ARMWRIGHT_WITH_MPI is ON, but OpenMPI was not found; install the Debian package libopenmpi-dev or set the option to OFF")
endif()

# Assimp reads the meshes of robots, for the replay of the page and for masses from a density. Without it, the page shows plain shapes with a
# note, and meshes give no mass.
find_library(ASSIMP_LIBRARY assimp)
find_path(ASSIMP_INCLUDE_DIR assimp/Importer.hpp)
set(assimp_found OFF)
if(ASSIMP_LIBRARY AND ASSIMP_INCLUDE_DIR)
  set(assimp_found ON)
endif()
option(ARMWRIGHT_WITH_ASSIMP "Meshes of robots, for masses and replays" ${assimp_found})
if(ARMWRIGHT_WITH_ASSIMP AND NOT assimp_found)
  message(FATAL_ERROR "ARMWRIGHT_WITH_ASSIMP is ON, but Assimp was not found; install the Debian package libassimp-dev or set the option to OFF")
endif()

# The Python package is built for Debian's own interpreter, which has Debian's numpy. Another interpreter may come first on the PATH.
set(Python3_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python interpreter for which the package armwright is built")
find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module)
find_package(pybind11 2.10 QUIET CONFIG)
set(python_found OFF)
if(Python3_Development.Module_FOUND AND pybind11_FOUND)
  set(python_found ON)
endif()
option(ARMWRIGHT_WITH_PYTHON "The Python package armwright" ${python_found})
if(ARMWRIGHT_WITH_PYTHON AND NOT python_found)
  message(FATAL_ERROR "ARMWRIGHT_WITH_PYTHON is ON, but the headers of Python or pybind11 were not found for ${Python3_EXECUTABLE}; install the "
                      "Debian packages python3-dev and pybind11-dev or set the option to OFF")
endif()
