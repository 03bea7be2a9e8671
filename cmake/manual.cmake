# What the program itself writes for those who type its commands: manual pages, and bash's completion. Made anew whenever it is linked.
set(ARMWRIGHT_MANUAL_DIR ${PROJECT_BINARY_DIR}/manual CACHE INTERNAL "")
find_program(GZIP_PROGRAM gzip REQUIRED) # man reads pages that are compressed
add_custom_command(
  TARGET armwright POST_BUILD
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:armwright> -DFOLDER=${ARMWRIGHT_MANUAL_DIR} -DGZIP=${GZIP_PROGRAM} -P
          ${PROJECT_SOURCE_DIR}/cmake/write_manual.cmake
  COMMENT "Writing manual pages and completion")
