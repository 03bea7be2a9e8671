# Run by ctest. Every step that fails ends the test with the step's name and what it printed.
function(step name)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status STREQUAL "0")
    message(FATAL_ERROR "${name}: failed (${status})\n${output}")
  endif()
  message(STATUS "${name}: done")
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Rooms travel between the processes with commas: a list would fall apart on the command line.
string(REPLACE "," ";" room_list "${ROOMS}")

file(REMOVE_RECURSE ${WORK_DIR})
set(prefix ${WORK_DIR}/moved)
step("install" ${CMAKE_COMMAND} --install ${BUILD_DIR} --config ${CONFIG} --prefix ${WORK_DIR}/first)
# The package must not remember where it was installed first.
file(RENAME ${WORK_DIR}/first ${prefix})

foreach(room IN LISTS room_list)
  file(GLOB_RECURSE headers RELATIVE ${SOURCE_DIR}/src ${SOURCE_DIR}/src/${room}/*.hpp)
  foreach(header IN LISTS headers)
    if(NOT EXISTS ${prefix}/include/armwright/${header})
      message(FATAL_ERROR "include/armwright/${header} was not installed")
    endif()
  endforeach()
endforeach()
file(GLOB_RECURSE configs RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/configs/*)
foreach(config IN LISTS configs)
  if(NOT EXISTS ${prefix}/share/armwright/${config})
    message(FATAL_ERROR "share/armwright/${config} was not installed")
  endif()
endforeach()
file(GLOB_RECURSE package_files ${prefix}/lib*/cmake/armwright/*.cmake)
foreach(package_file IN LISTS package_files)
  file(READ ${package_file} text)
  foreach(folder IN ITEMS ${SOURCE_DIR} ${BUILD_DIR})
    string(FIND "${text}" "${folder}/" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${package_file} names ${folder}, which an installed package must not need")
    endif()
  endforeach()
endforeach()

step("configure the consumer"
     ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK_DIR}/consumer -G ${GENERATOR}
     -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}"
     -D CMAKE_PREFIX_PATH=${prefix} -D ROOMS=${ROOMS} -D EXPECTED_VERSION=${VERSION})
step("build the consumer" ${CMAKE_COMMAND} --build ${WORK_DIR}/consumer --config ${CONFIG})
step("run the consumer" ${WORK_DIR}/consumer/consumer)
if(NOT output MATCHES "unknown optimizer 'gaa'; did you mean 'ga'\\?")
  message(FATAL_ERROR "the consumer printed\n${output}")
endif()

step("configure the plugin"
     ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/plugin -B ${WORK_DIR}/plugin -G ${GENERATOR}
     -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${FLAGS}"
     -D CMAKE_PREFIX_PATH=${prefix} -D EXPECTED_VERSION=${VERSION}
     -D PLUGIN_SOURCE=${SOURCE_DIR}/tests/plugins/good.cpp)
step("build the plugin" ${CMAKE_COMMAND} --build ${WORK_DIR}/plugin --config ${CONFIG})
# Where the program looks for plugins by itself.
file(COPY ${WORK_DIR}/plugin/libmine.so DESTINATION ${prefix}/lib/armwright/plugins)
step("run the plugin" ${prefix}/bin/armwright optimize sphere --optimizer mine --budget 20 --out ${WORK_DIR}/run)

step("run the installed program" ${prefix}/bin/armwright --version)
