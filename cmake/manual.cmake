# The program writes its own manual pages and its completion for bash. The build makes them again whenever it links the program.
set(ARMWRIGHT_MANUAL_DIR ${PROJECT_BINARY_DIR}/manual CACHE INTERNAL "")
find_program(GZIP_PROGRAM gzip REQUIRED) # manual pages are installed compressed
add_custom_command(
  TARGET armwright POST_BUILD
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:armwright> -DFOLDER=${ARMWRIGHT_MANUAL_DIR} -DGZIP=${GZIP_PROGRAM} -P
          ${PROJECT_SOURCE_DIR}/cmake/write_manual.cmake
  COMMENT "Writing manual pages and completion")
