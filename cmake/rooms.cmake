# A room is one folder under src/ and one static library of all its .cpp files. ROOMS names the floors below that it may use (and re-exports
# them); LIBRARIES are implementation details of its .cpp files.
set(ARMWRIGHT_ROOMS "" CACHE INTERNAL "")

function(armwright_compile_settings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wnon-virtual-dtor -Woverloaded-virtual)
  # GCC 12 warns of overlapping copies that cannot happen in std::string concatenation (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(ARMWRIGHT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  # No fused multiply-add behind our back: the same source gives the same bits whatever the target's instruction set.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
endfunction()

# A compiler's time is mostly spent on reading the same headers and making the same templates for every file. With this option up to 24
# files of a target are compiled as one: much faster from the beginning (docs/architecture.md), slower after a change. Names in unnamed namespaces
# must then differ within a room.
option(ARMWRIGHT_UNITY_BUILD "Compile several files at once: builds faster from the beginning, slower after a change" OFF)
function(armwright_join_files target)
  if(ARMWRIGHT_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE BATCH UNITY_BUILD_BATCH_SIZE 24)
    # To GCC a file that is included is a header, in which a class must not hold what is local to another file.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
  endif()
endfunction()

function(armwright_room name)
  cmake_parse_arguments(ROOM "" "" "ROOMS;LIBRARIES;PUBLIC_LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_module/") # a file of its own, which the program loads on demand
  add_library(armwright_${name} STATIC ${sources})
  add_library(armwright::${name} ALIAS armwright_${name})
  set_target_properties(armwright_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(armwright_${name} PUBLIC cxx_std_20)
  target_include_directories(
    armwright_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/armwright>)
  foreach(below IN LISTS ROOM_ROOMS)
    target_link_libraries(armwright_${name} PUBLIC armwright_${below})
  endforeach()
  target_link_libraries(armwright_${name} PUBLIC ${ROOM_PUBLIC_LIBRARIES} PRIVATE ${ROOM_LIBRARIES})
  armwright_compile_settings(armwright_${name})
  armwright_join_files(armwright_${name})
  set(ARMWRIGHT_ROOMS "${ARMWRIGHT_ROOMS};${name}" CACHE INTERNAL "")
endfunction()

# What a plugin is built against: two headers and nothing else.
add_library(armwright_plugin INTERFACE)
add_library(armwright::plugin ALIAS armwright_plugin)
set_target_properties(armwright_plugin PROPERTIES EXPORT_NAME plugin)
target_include_directories(armwright_plugin INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
