# sutura_add_plugin(NAME SOURCES file... [LINK target...])
#
# A plugin is a module libsutura_NAME.so that exports sutura_plugin_NAME (SUTURA_PLUGIN of
# sutura/plugin.h). It is built with the instruction set and alignment of the library, which the
# target sutura::sutura carries: the handshake at load refuses anything else.
function(sutura_add_plugin name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(NOT name MATCHES "^[a-z0-9_]+$")
    message(FATAL_ERROR "sutura_add_plugin: '${name}' may hold lower case letters, digits and '_' only")
  endif()
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "sutura_add_plugin(${name}): expected SOURCES")
  endif()
  add_library(sutura_${name} MODULE ${ARG_SOURCES})
  target_link_libraries(sutura_${name} PRIVATE sutura::sutura ${ARG_LINK})
  # Results must not depend on contraction of a*b+c.
  target_compile_options(sutura_${name} PRIVATE -ffp-contract=off)
  set_target_properties(sutura_${name} PROPERTIES CXX_VISIBILITY_PRESET hidden)
endfunction()

# sutura_add_plugin_test(NAME SOURCES file... [SCENE file])
#
# A program of GoogleTest for the plugin NAME, run by ctest under this name after `enable_testing()`.
# Its sources are given two texts: PLUGIN_DIR, the folder that the plugin is in, and SCENE.
function(sutura_add_plugin_test name)
  cmake_parse_arguments(ARG "" "SCENE" "SOURCES" ${ARGN})
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "sutura_add_plugin_test(${name}): expected SOURCES")
  endif()
  find_package(GTest REQUIRED)
  add_executable(${name}_test ${ARG_SOURCES})
  target_link_libraries(${name}_test PRIVATE sutura::sutura GTest::gtest_main)
  target_compile_definitions(${name}_test PRIVATE
    PLUGIN_DIR="$<TARGET_FILE_DIR:sutura_${name}>" SCENE="${CMAKE_CURRENT_SOURCE_DIR}/${ARG_SCENE}")
  add_dependencies(${name}_test sutura_${name})
  add_test(NAME ${name} COMMAND ${name}_test)
endfunction()
