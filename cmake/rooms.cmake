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

function(armwright_room name)
  cmake_parse_arguments(ROOM "" "" "ROOMS;LIBRARIES;PUBLIC_LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*/*.cpp)
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
  set(ARMWRIGHT_ROOMS "${ARMWRIGHT_ROOMS};${name}" CACHE INTERNAL "")
endfunction()

# What a plugin is built against: two headers and nothing else.
add_library(armwright_plugin INTERFACE)
add_library(armwright::plugin ALIAS armwright_plugin)
set_target_properties(armwright_plugin PROPERTIES EXPORT_NAME plugin)
target_include_directories(armwright_plugin INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                      $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
