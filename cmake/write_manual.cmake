# The build runs this script. It writes every manual page, compressed, into FOLDER/man1, and the completion for bash into FOLDER/completions.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE error)
  if(NOT status STREQUAL "0")
    message(FATAL_ERROR "${ARGN}: failed (${status})\n${output}${error}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER}) # a command may have been removed
file(MAKE_DIRECTORY ${FOLDER}/completions)
run(${PROGRAM} manual --format man --out ${FOLDER}/man1)
file(GLOB pages ${FOLDER}/man1/*.1)
run(${GZIP} -9 --no-name ${pages})
run(${PROGRAM} completion bash)
file(WRITE ${FOLDER}/completions/armwright "${output}")
