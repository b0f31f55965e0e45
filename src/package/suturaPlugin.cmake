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
