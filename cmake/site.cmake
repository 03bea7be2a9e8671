# The site of the documentation, site/index.html of the build tree: README.md, CHANGELOG.md and docs as pages. They open from disk without a
# server and have a search. Making it takes a second, so every build that has Node for the page of `armwright report` makes it.
if(NOT ARMWRIGHT_WITH_PAGE)
  return()
endif()

set(site ${PROJECT_BINARY_DIR}/site)
file(GLOB_RECURSE site_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/*.md ${PROJECT_SOURCE_DIR}/docs/*.png ${PROJECT_SOURCE_DIR}/web/site/*)
add_custom_command(
  OUTPUT ${site}/index.html
  COMMAND ${NODE_PROGRAM} site/build.mjs ${site}
  DEPENDS ${page}/packages ${site_sources} ${PROJECT_SOURCE_DIR}/docs/site.json ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/SECURITY.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  WORKING_DIRECTORY ${web}
  COMMENT "Building the site of the documentation"
  VERBATIM)
add_custom_target(site ALL DEPENDS ${site}/index.html)
# Two targets need the packages, and one rule fetches them. The dependency makes the targets run one after the other.
add_dependencies(site armwright_page)
install(DIRECTORY ${site}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/html COMPONENT runtime OPTIONAL)
