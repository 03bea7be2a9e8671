# The module libarmwright_pagmo.so: the only file that contains pagmo. The program loads it when an optimizer of pagmo is made, because
# loading pagmo takes more time and memory than everything else at a start (docs/architecture.md).
set(folder ${PROJECT_SOURCE_DIR}/src/optimizers/pagmo_module)
add_library(armwright_pagmo MODULE ${folder}/pagmo_module.cpp)
set_target_properties(armwright_pagmo PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                                 LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/${ARMWRIGHT_MODULE_DIR})
target_compile_features(armwright_pagmo PRIVATE cxx_std_20)
target_include_directories(armwright_pagmo PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(armwright_pagmo PRIVATE Pagmo::pagmo)
armwright_compile_settings(armwright_pagmo)

# The id of the module, which the program requires: of everything that decides whether the two fit together, and what the module computes.
# A change of the two files configures again.
set(parts ${PROJECT_VERSION} ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS} ${Pagmo_VERSION})
string(TOUPPER ${CMAKE_BUILD_TYPE} type)
list(APPEND parts ${CMAKE_CXX_FLAGS_${type}})
foreach(file pagmo_module.hpp pagmo_module.cpp)
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${file})
  file(SHA256 ${folder}/${file} hash)
  list(APPEND parts ${hash})
endforeach()
string(SHA256 id "${parts}")
string(SUBSTRING ${id} 0 16 id)
set_source_files_properties(${folder}/pagmo_module.cpp optimizers/pagmo/pagmo_loader.cpp PROPERTIES COMPILE_DEFINITIONS ARMWRIGHT_PAGMO_ID="${id}")

# Whatever contains the optimizers needs the module beside it.
add_dependencies(armwright_optimizers armwright_pagmo)
