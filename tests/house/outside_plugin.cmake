# Builds plugins/hello_law and hello_staple as a stranger would: from a copy, against an installed package. Run by ctest as
#   cmake -DBUILD=... -DSOURCE=... -DWORK=... -DGENERATOR=... -P outside_plugin.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    string(REPLACE ";" " " line "${ARGN}")
    message(FATAL_ERROR "${line}\n${out}\nexit code ${code}")
  endif()
  set(last_output "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(COPY ${SOURCE}/plugins/hello_law ${SOURCE}/plugins/hello_staple DESTINATION ${WORK})

if(NOT EXISTS ${WORK}/prefix/share/doc/sutura/LICENSE)
  message(FATAL_ERROR "the installed tree has no LICENSE")
endif()

# The package must do without the tree it was built from: its files may not name it.
file(GLOB_RECURSE package_files ${WORK}/prefix/*.cmake ${WORK}/prefix/*.h)
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  string(FIND "${text}" "${SOURCE}" at)
  if(NOT at EQUAL -1)
    message(FATAL_ERROR "${file} names the source tree")
  endif()
endforeach()

# Every public header stands by itself: the precompiled headers of our own build would hide a missing include.
file(GLOB_RECURSE headers RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*.h)
foreach(header IN LISTS headers)
  string(MAKE_C_IDENTIFIER ${header} name)
  file(WRITE ${WORK}/headers/${name}.cpp "#include \"${header}\"\n")
endforeach()
file(WRITE ${WORK}/headers/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)
project(headers LANGUAGES CXX)
find_package(sutura CONFIG REQUIRED)
file(GLOB sources *.cpp)
add_library(headers OBJECT \${sources})
target_compile_options(headers PRIVATE -fsyntax-only)
target_link_libraries(headers PRIVATE sutura::sutura)
")
run(${CMAKE_COMMAND} -S ${WORK}/headers -B ${WORK}/build/headers -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build/headers)

foreach(plugin hello_law hello_staple)
  run(${CMAKE_COMMAND} -S ${WORK}/${plugin} -B ${WORK}/build/${plugin} -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
      -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS=${FLAGS}")
  run(${CMAKE_COMMAND} --build ${WORK}/build/${plugin})
  run(${CMAKE_CTEST_COMMAND} --test-dir ${WORK}/build/${plugin} --output-on-failure)
endforeach()

# A host of one's own, as docs/extend/embed.md lists it.
run(${CMAKE_COMMAND} -S ${SOURCE}/tests/host -B ${WORK}/host -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_BUILD_TYPE=RelWithDebInfo "-DCMAKE_CXX_FLAGS=${FLAGS}")
run(${CMAKE_COMMAND} --build ${WORK}/host)
run(${WORK}/host/my_simulator ${SOURCE}/scenes/components/Grasper.xml)
if(NOT last_output MATCHES "the jaws pull with [0-9.]+ mN")
  message(FATAL_ERROR "the host says\n${last_output}")
endif()

# A host in C, as docs/embed/c.md lists it: compiled by its pkg-config file alone, to the bits of the command.
file(GLOB_RECURSE pc ${WORK}/prefix/*/sutura.pc)
cmake_path(GET pc PARENT_PATH pc_folder)
run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_folder} sh -c
    "cc -std=c99 -Wall -Wextra -Wpedantic -Werror ${FLAGS} ${SOURCE}/tests/hosts/stitch.c -o ${WORK}/stitch \
     $(pkg-config --cflags --libs sutura) -Wl,-rpath,$(pkg-config --variable=libdir sutura)")
run(${WORK}/stitch ${SOURCE}/scenes/suture/prick.xml 20 /grasper.force ${WORK}/host_files)
message(STATUS "${last_output}")
run(${WORK}/prefix/bin/sutura run ${SOURCE}/scenes/suture/prick.xml --steps 20 --checkpoint-every 0.2 --output ${WORK}/command_files)
run(${CMAKE_COMMAND} -E compare_files ${WORK}/host_files/host.sutura ${WORK}/command_files/checkpoint.sutura)
run(${CMAKE_COMMAND} -E compare_files ${WORK}/host_files/probe.csv ${WORK}/command_files/probe.csv)

# The command finds the plugins of the package by itself and the stranger's by the variable.
foreach(scene hello_law/band.xml hello_staple/staple.xml)
  run(${CMAKE_COMMAND} -E env SUTURA_PLUGIN_PATH=${WORK}/build/hello_law:${WORK}/build/hello_staple
      ${WORK}/prefix/bin/sutura run ${WORK}/${scene} --output ${WORK}/out)
  message(STATUS "${last_output}")
endforeach()
if(NOT EXISTS ${WORK}/out/staple.pvd)
  message(FATAL_ERROR "the staple has not drawn itself")
endif()
