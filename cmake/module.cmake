# Modules: libraries that take long to load are linked only by shared libraries of armwright's own, which the program loads on demand
# (src/process/module_loader.hpp). A module is the folder NAME_module of a room. It uses the standard library and its own library, but no
# room. It lies in lib/armwright, in the build tree as in an installation.
set(ARMWRIGHT_MODULE_DIR lib/armwright CACHE INTERNAL "")
set(ARMWRIGHT_MODULES "" CACHE INTERNAL "")

# armwright_module(NAME FOLDER folder ROOM room LIBRARY target VERSION version): whatever contains the room needs the module.
function(armwright_module name)
  cmake_parse_arguments(MODULE "" "FOLDER;ROOM;LIBRARY;VERSION" "" ${ARGN})
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${MODULE_FOLDER}/*)
  add_library(armwright_${name} MODULE ${files})
  set_target_properties(armwright_${name} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                                     LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${ARMWRIGHT_MODULE_DIR})
  target_compile_features(armwright_${name} PRIVATE cxx_std_20)
  target_include_directories(armwright_${name} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(armwright_${name} PRIVATE ${MODULE_LIBRARY})
  # No function of its library becomes visible to others.
  target_link_options(armwright_${name} PRIVATE -Wl,--exclude-libs,ALL)
  armwright_compile_settings(armwright_${name})
  add_dependencies(armwright_${MODULE_ROOM} armwright_${name})

  # The id is a hash of everything that decides whether the module and the program fit together, and what the module computes. A change of
  # its files configures again.
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  set(parts ${PROJECT_VERSION} ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} "${CMAKE_CXX_FLAGS}" "${CMAKE_CXX_FLAGS_${type}}"
            ${MODULE_VERSION})
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(SHA256 ${file} hash)
    list(APPEND parts ${hash})
  endforeach()
  string(SHA256 id "${parts}")
  string(SUBSTRING ${id} 0 16 id)
  target_compile_definitions(armwright_${name} PRIVATE ARMWRIGHT_MODULE_ID="${id}")
  string(TOUPPER ${name} upper)
  set_property(SOURCE process/module_table.cpp APPEND PROPERTY COMPILE_DEFINITIONS ARMWRIGHT_${upper}_ID="${id}")
  set(ARMWRIGHT_MODULES ${ARMWRIGHT_MODULES} armwright_${name} CACHE INTERNAL "")
endfunction()
