# The data of describe_build(). Every build reads the git state, not only every run of CMake.
set(header ${PROJECT_BINARY_DIR}/generated/git_state.hpp)
add_custom_target(
  armwright_git_state
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DHEADER=${header} -P
          ${PROJECT_SOURCE_DIR}/cmake/write_git_state.cmake
  BYPRODUCTS ${header}
  COMMENT "")
add_dependencies(armwright_base armwright_git_state)
set_source_files_properties(${PROJECT_SOURCE_DIR}/src/base/build_info.cpp TARGET_DIRECTORY armwright_base
                            PROPERTIES OBJECT_DEPENDS ${header})

# The versions of all libraries, as CMake found them. A library that is not in the build has an empty version. Libraries without a CMake
# package or a pkg-config module have their version in a header.
file(STRINGS ${BOOST_INCLUDE_DIR}/boost/version.hpp boost_version REGEX "^#define BOOST_LIB_VERSION ")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" boost_version "${boost_version}")
string(REPLACE "_" "." boost_version "${boost_version}")
pkg_check_modules(NLOPT QUIET nlopt)
pkg_check_modules(ASSIMP QUIET assimp)
set(armwright_library_rows "")
function(armwright_library name is_used version)
  if(NOT ${is_used})
    set(version "")
  elseif(NOT version)
    set(version "unknown")
  endif()
  set(armwright_library_rows "${armwright_library_rows}    {\"${name}\", \"${version}\"},\n" PARENT_SCOPE)
endfunction()
armwright_library(assimp ARMWRIGHT_WITH_ASSIMP "${ASSIMP_VERSION}")
armwright_library(boost TRUE "${boost_version}")
armwright_library(ceres ARMWRIGHT_WITH_CERES "${Ceres_VERSION}")
armwright_library(cli11 TRUE "${CLI11_VERSION}")
armwright_library(duktape ARMWRIGHT_WITH_PAGE "${DUKTAPE_VERSION}")
armwright_library(eigen TRUE "${Eigen3_VERSION}")
armwright_library(fmt TRUE "${fmt_VERSION}")
armwright_library(libyaml TRUE "${YAML_0.1_VERSION}")
armwright_library(lz4 TRUE "${LIBLZ4_VERSION}")
armwright_library(mujoco ARMWRIGHT_WITH_MUJOCO "${mujoco_version}")
armwright_library(nlohmann_json TRUE "${nlohmann_json_VERSION}")
armwright_library(nlopt ARMWRIGHT_WITH_NLOPT "${NLOPT_VERSION}")
armwright_library(ode TRUE "${ODE_VERSION}")
armwright_library(openmpi ARMWRIGHT_WITH_MPI "${OMPI_C_VERSION}")
armwright_library(openssl TRUE "${OPENSSL_VERSION}")
armwright_library(pagmo ARMWRIGHT_WITH_PAGMO "${Pagmo_VERSION}")
armwright_library(sqlite TRUE "${SQLite3_VERSION}")
armwright_library(tinyxml2 TRUE "${TINYXML2_VERSION}")
armwright_library(tomlplusplus TRUE "${TOMLPLUSPLUS_VERSION}")
armwright_library(zlib TRUE "${ZLIB_VERSION_STRING}")
armwright_library(zstd TRUE "${LIBZSTD_VERSION}")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/library_versions.hpp CONTENT
     "// Written by cmake/build_info.cmake. An empty version means: not in this build.
inline constexpr struct {
  const char* name;
  const char* version;
} kLibraryVersions[] = {
@armwright_library_rows@};
" @ONLY)

target_include_directories(armwright_base PRIVATE ${PROJECT_BINARY_DIR}/generated)
target_compile_definitions(
  armwright_base
  PRIVATE ARMWRIGHT_VERSION="${PROJECT_VERSION}"
          ARMWRIGHT_RELEASE_DATE="${ARMWRIGHT_RELEASE_DATE}"
          ARMWRIGHT_COMPILER="${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          ARMWRIGHT_BUILD_TYPE="${CMAKE_BUILD_TYPE}")
