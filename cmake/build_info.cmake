# What describe_build() reports. The git state is read at every build, not only when CMake configures.
set(header ${PROJECT_BINARY_DIR}/generated/git_state.hpp)
add_custom_target(
  armwright_git_state
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DHEADER=${header} -P
          ${PROJECT_SOURCE_DIR}/cmake/write_git_state.cmake
  BYPRODUCTS ${header}
  COMMENT "")
add_dependencies(armwright_study armwright_git_state)
set_source_files_properties(${PROJECT_SOURCE_DIR}/src/study/build_info.cpp TARGET_DIRECTORY armwright_study
                            PROPERTIES OBJECT_DEPENDS ${header})
target_include_directories(armwright_study PRIVATE ${PROJECT_BINARY_DIR}/generated)
target_compile_definitions(
  armwright_study
  PRIVATE ARMWRIGHT_VERSION="${PROJECT_VERSION}"
          ARMWRIGHT_COMPILER="${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
          ARMWRIGHT_BUILD_TYPE="${CMAKE_BUILD_TYPE}" ARMWRIGHT_ODE_VERSION="${ODE_VERSION}"
          ARMWRIGHT_URDFDOM_VERSION="${URDFDOM_VERSION}")
