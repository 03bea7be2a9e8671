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

# A compiler's time is mostly spent on reading the same headers and making the same templates for every file. With this option up to
# ARMWRIGHT_FILES_PER_BATCH files of a target are compiled as one: much faster from the beginning, slower after a change. Names in unnamed
# namespaces must then differ within a room.
option(ARMWRIGHT_UNITY_BUILD "Compile several files at once: builds faster from the beginning, slower after a change" OFF)
set(ARMWRIGHT_FILES_PER_BATCH 96 CACHE STRING "The most files that ARMWRIGHT_UNITY_BUILD compiles at once")
# armwright_join_files(TARGET [MOST]): joins the files of a target in the fewest batches, all of about the same size. MOST lowers the limit.
function(armwright_join_files target)
  if(ARMWRIGHT_UNITY_BUILD)
    set(most ${ARMWRIGHT_FILES_PER_BATCH})
    if(ARGN AND ARGN LESS most)
      set(most ${ARGN})
    endif()
    get_target_property(sources ${target} SOURCES)
    list(LENGTH sources count)
    math(EXPR batches "(${count} + ${most} - 1) / ${most}")
    math(EXPR size "(${count} + ${batches} - 1) / ${batches}")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE BATCH UNITY_BUILD_BATCH_SIZE ${size})
    # To GCC a file that is included is a header, in which a class must not hold what is local to another file.
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
  endif()
endfunction()

# Most files of these rooms make words, tables and files from numbers, which need not be fast. A compiler needs a quarter less time for them
# with -O1.
function(armwright_optimise_little target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# TEXT names the folders of a room that armwright_optimise_little() is for. They become an object library of their own, because files with
# other options are not joined with others.
function(armwright_room name)
  cmake_parse_arguments(ROOM "" "FILES_PER_BATCH" "ROOMS;LIBRARIES;PUBLIC_LIBRARIES;TEXT" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_module/") # a file of its own, which the program loads on demand
  set(text ${sources})
  list(JOIN ROOM_TEXT "|" folders)
  list(FILTER text INCLUDE REGEX "/${name}/(${folders})/")
  list(FILTER sources EXCLUDE REGEX "/${name}/(${folders})/")
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
  armwright_join_files(armwright_${name} ${ROOM_FILES_PER_BATCH})
  if(text)
    add_library(armwright_${name}_text OBJECT ${text})
    set_target_properties(armwright_${name}_text PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(armwright_${name}_text PRIVATE $<TARGET_PROPERTY:armwright_${name},LINK_LIBRARIES>)
    target_include_directories(armwright_${name}_text PRIVATE ${PROJECT_SOURCE_DIR}/src)
    target_compile_definitions(armwright_${name}_text PRIVATE $<TARGET_PROPERTY:armwright_${name},COMPILE_DEFINITIONS>)
    armwright_compile_settings(armwright_${name}_text)
    armwright_optimise_little(armwright_${name}_text)
    armwright_join_files(armwright_${name}_text)
    target_sources(armwright_${name} PRIVATE $<TARGET_OBJECTS:armwright_${name}_text>)
  endif()
  set(ARMWRIGHT_ROOMS "${ARMWRIGHT_ROOMS};${name}" CACHE INTERNAL "")
endfunction()

# What a plugin is built against: two headers and nothing else.
add_library(armwright_plugin INTERFACE)
add_library(armwright::plugin ALIAS armwright_plugin)
set_target_properties(armwright_plugin PROPERTIES EXPORT_NAME plugin)
target_include_directories(armwright_plugin INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
