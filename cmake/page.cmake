# The page of `armwright report` and the figures of `armwright plot`. npm builds them from web/, and the program contains them as
# bytes. Without npm, set the option to OFF; the commands that need the page then end with an error that says so.
option(ARMWRIGHT_WITH_PAGE "The page of armwright report, plot and watch (needs Node and npm)" ON)
if(NOT ARMWRIGHT_WITH_PAGE)
  return()
endif()

enable_language(ASM)
find_program(NODE_PROGRAM NAMES node nodejs)
find_program(NPM_PROGRAM npm)
if(NOT NODE_PROGRAM OR NOT NPM_PROGRAM)
  message(FATAL_ERROR "The page needs Node and npm: install the Debian packages nodejs and npm (scripts/setup does), or configure with "
                      "-DARMWRIGHT_WITH_PAGE=OFF")
endif()
execute_process(COMMAND ${NODE_PROGRAM} --version OUTPUT_VARIABLE node_version OUTPUT_STRIP_TRAILING_WHITESPACE)
if(node_version VERSION_LESS "v18")
  message(FATAL_ERROR "${NODE_PROGRAM} is ${node_version}; the page needs Node 18 or newer")
endif()
pkg_check_modules(DUKTAPE REQUIRED IMPORTED_TARGET duktape)

set(web ${PROJECT_SOURCE_DIR}/web)
set(page ${PROJECT_BINARY_DIR}/page)
# The lock file has the hash of every package. No package needs its installation script.
add_custom_command(
  OUTPUT ${page}/packages
  COMMAND ${NPM_PROGRAM} ci --ignore-scripts --no-audit --no-fund --loglevel=error
  COMMAND ${CMAKE_COMMAND} -E touch ${page}/packages
  DEPENDS ${web}/package.json ${web}/package-lock.json
  WORKING_DIRECTORY ${web}
  COMMENT "Fetching the packages of the page (npm ci)"
  VERBATIM)
file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${web}/src/*.ts ${web}/src/*.css)
set(ARMWRIGHT_PAGE_FILES ${page}/page.js ${page}/page.css ${page}/figures.js)
add_custom_command(
  OUTPUT ${ARMWRIGHT_PAGE_FILES}
  COMMAND ${NODE_PROGRAM} build.mjs ${page}
  DEPENDS ${page}/packages ${web}/build.mjs ${page_sources}
  WORKING_DIRECTORY ${web}
  COMMENT "Building the page"
  VERBATIM)

add_custom_target(armwright_page DEPENDS ${ARMWRIGHT_PAGE_FILES})

set(ARMWRIGHT_PAGE_ASSEMBLY ${PROJECT_BINARY_DIR}/generated/page_bytes.S)
set(text "")
foreach(file page.js page.css figures.js)
  string(MAKE_C_IDENTIFIER "armwright_${file}" symbol)
  string(APPEND text "  .global ${symbol}_begin\n  .global ${symbol}_end\n${symbol}_begin:\n  .incbin \"${page}/${file}\"\n${symbol}_end:\n")
endforeach()
file(CONFIGURE OUTPUT ${ARMWRIGHT_PAGE_ASSEMBLY} CONTENT "  .section .rodata\n${text}  .section .note.GNU-stack,\"\",@progbits\n" @ONLY)
