# Writes the commit, and whether the working tree differs from it, into HEADER. The header is written only if this changes.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                OUTPUT_VARIABLE state OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(state "unknown")
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define ARMWRIGHT_GIT \"@state@\"\n" @ONLY)
