# Run by ctest: what a user's own optimizers, problems and programs need, from an installed package alone. The templates' own test.sh builds each,
# has check-plugin or check-problem look at it and runs it; the examples in C and C++ likewise. Every step that fails ends the test with its name
# and what it printed.
function(step name)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK_DIR} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status STREQUAL "0")
    message(FATAL_ERROR "${name}: failed (${status})\n${output}")
  endif()
  message(STATUS "${name}: done")
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
set(prefix ${WORK_DIR}/installed)
set(program ${prefix}/bin/armwright)
# As a newcomer has it: compiler, generator and places in the environment, no flag on any command line.
set(env ${CMAKE_COMMAND} -E env CMAKE_PREFIX_PATH=${prefix} ARMWRIGHT=${program} CMAKE_GENERATOR=${GENERATOR} CC=${C_COMPILER}
        CXX=${CXX_COMPILER} "CFLAGS=${C_FLAGS} -Wall -Wextra -Wpedantic -Werror" "CXXFLAGS=${CXX_FLAGS} -Wall -Wextra -Wpedantic -Werror")
step("install" ${CMAKE_COMMAND} --install ${BUILD_DIR} --config ${CONFIG} --prefix ${prefix})

foreach(kind IN ITEMS plugin problem)
  foreach(language IN ITEMS c++ c)
    string(REPLACE "c++" "cpp" name ${kind}_${language})
    step("begin ${name}" ${program} new-${kind} --language ${language} ${name})
    step("test.sh of ${name}" ${env} ./${name}/test.sh)
    if(NOT output MATCHES "It keeps every promise")
      message(FATAL_ERROR "test.sh of ${name} printed\n${output}")
    endif()
  endforeach()
endforeach()
# A process is started for each of check-plugin's hundreds of runs, which would take most of this test's time: it is run only.
step("begin mine_python" ${program} new-plugin --language python mine_python)
step("run mine_python" ${program} optimize rosenbrock --optimizer "exec:python3 mine_python/mine_python.py" --budget 300)

foreach(example IN ITEMS evolution_strategy hooke_jeeves)
  step("configure ${example}" ${env} ${CMAKE_COMMAND} -S ${prefix}/share/armwright/plugins/${example} -B ${example})
  step("build ${example}" ${CMAKE_COMMAND} --build ${example})
  step("check ${example}" ${program} check-plugin ./${example}/lib${example}.so)
  step("run ${example}" ${program} optimize rosenbrock --optimizer ./${example}/lib${example}.so --budget 300)
endforeach()

# A program that uses armwright as a library, and its problem as a library for armwright: they are built, run, killed and resumed, and the
# program `armwright` reads the folders.
set(example own_program)
step("configure ${example}" ${env} ${CMAKE_COMMAND} -S ${prefix}/share/armwright/examples/${example} -B ${example})
step("build ${example}" ${CMAKE_COMMAND} --build ${example})
step("resume ${example}" /usr/bin/python3 ${CMAKE_CURRENT_LIST_DIR}/resume_test.py ./${example}/${example}
     ./${example}/libspeed_control.so ${program} ${WORK_DIR})
step("show its run" ${program} show killed-program-ga)
step("check its run" ${program} doctor killed-program-ga)
step("report its run" ${program} report killed-program-ga --out page.html)
execute_process(COMMAND ${program} optimize host:speed-control WORKING_DIRECTORY ${WORK_DIR} RESULT_VARIABLE status ERROR_VARIABLE output)
if(NOT status EQUAL 2 OR NOT output MATCHES "only that program can continue it")
  message(FATAL_ERROR "armwright ran the problem of another program (${status})\n${output}")
endif()
# The headers are C99, too.
file(WRITE ${WORK_DIR}/run_in_c.c "#include <armwright/plugin.h>\n#include <armwright/run.h>\nint main(void) { return armwright_version()[0] == 0; }\n")
step("compile C" ${C_COMPILER} -std=c99 -Wall -Wextra -Wpedantic -Werror -I${prefix}/include run_in_c.c -o run_in_c -L${prefix}/lib -larmwright
     -Wl,-rpath,${prefix}/lib)
step("run C" ./run_in_c)

# The system's Python, for which Debian has SciPy; another may come first on the PATH.
execute_process(COMMAND /usr/bin/python3 -c "import scipy.optimize" RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
if(status STREQUAL "0")
  step("run scipy_de" ${program} optimize rosenbrock --budget 300
       --optimizer "exec:/usr/bin/python3 ${prefix}/share/armwright/plugins/scipy_de/scipy_de.py")
else()
  message(STATUS "scipy_de is left out: /usr/bin/python3 has no SciPy")
endif()
