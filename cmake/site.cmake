# The documentation's site, site/index.html of the build tree: README.md, CHANGELOG.md and docs as pages that open from disk, with a search and
# without a server. A second's work, so it is part of every build that has Node for the page of `armwright report`.
if(NOT ARMWRIGHT_WITH_PAGE)
  return()
endif()

set(site ${PROJECT_BINARY_DIR}/site)
file(GLOB_RECURSE site_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/*.md ${PROJECT_SOURCE_DIR}/docs/*.png ${PROJECT_SOURCE_DIR}/web/site/*)
add_custom_command(
  OUTPUT ${site}/index.html
  COMMAND ${NODE_PROGRAM} site/build.mjs ${site}
  DEPENDS ${page}/packages ${site_sources} ${PROJECT_SOURCE_DIR}/docs/site.json ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  WORKING_DIRECTORY ${web}
  COMMENT "Building the documentation's site"
  VERBATIM)
add_custom_target(site ALL DEPENDS ${site}/index.html)
# One rule fetches the packages, and two targets want them: one after the other.
add_dependencies(site armwright_page)
install(DIRECTORY ${site}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/html COMPONENT runtime OPTIONAL)
