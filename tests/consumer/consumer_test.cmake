# SPDX-License-Identifier: BSD-3-Clause
# Installs the components that consumer NAME needs from the build tree BUILD_DIR into WORK_DIR/stage, then configures,
# builds and runs the project SOURCE_DIR/NAME against it and checks what it prints.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "status ${status} of: ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_output pattern)
  if(NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "no match for ${pattern} in:\n${output}")
  endif()
endfunction()

function(expect_absent path)
  if(EXISTS "${path}")
    message(FATAL_ERROR "${path} must not be part of this install")
  endif()
endfunction()

set(stage ${WORK_DIR}/stage)
set(project_build ${WORK_DIR}/build)
file(REMOVE_RECURSE ${WORK_DIR})

run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${stage} --component core)
set(options -DCMAKE_PREFIX_PATH=${stage} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE})
if(NAME STREQUAL "core")
  # The core must configure where neither is installed.
  list(APPEND options -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DCMAKE_DISABLE_FIND_PACKAGE_NLopt=ON
       -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON -DCMAKE_DISABLE_FIND_PACKAGE_Boost=ON)
  expect_absent(${stage}/include/frac/identification)
  expect_absent(${stage}/include/backlash/jump_law.hpp)
else()
  run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${stage} --component fitting)
endif()
if(SANITIZE)
  list(APPEND options -DCMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -S ${SOURCE_DIR}/${NAME} -B ${project_build} -G ${GENERATOR} ${options})
run(${CMAKE_COMMAND} --build ${project_build})
# Where pkg-config is, its files name the place of this installation.
find_program(pkg_config NAMES pkg-config pkgconf)
if(pkg_config)
  file(GLOB_RECURSE pc_files ${stage}/*.pc)
  list(GET pc_files 0 pc_file)
  get_filename_component(pc_folder ${pc_file} DIRECTORY)
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_folder} ${pkg_config} --variable=prefix fracfit-core)
  expect_output("^${stage}\n$")
  run(${CMAKE_COMMAND} -E env PKG_CONFIG_PATH=${pc_folder} ${pkg_config} --cflags --libs fracfit-core)
  expect_output("-I${stage}/include")
endif()

# Runs an example and leaves what it prints in `output`.
function(run_example example)
  run(${project_build}/${example})
  set(output "${output}" PARENT_SCOPE)
endfunction()

if(NAME STREQUAL "core")
  run_example(plant_in_a_loop)
  # The integral brings mass 2 to the set-point within a centimetre; mass 1 then lies at a wall, 20 mm behind.
  expect_output("\n10,[-.0-9]+,0\\.98[0-9]+,1\\.00[0-9]+,[0-9]+\n")

  run_example(respond)
  # Fifty-digit values of the furnace; its pole is that of an independent root finder.
  expect_output("stable, poles at -0\\.108 \\+- 1\\.2i")
  expect_output("\n1,0\\.423976252450\n5,0\\.585082992743\n20,0\\.991079096205\n30,1\\.014164778111\n")

  run_example(realise)
  expect_output("stable\\. Tolerance 0\\.001 is met")
  expect_output("pole -0\\.1084168029 \\+- 1\\.1969922447i")
  expect_output("omega 0\\.1 rad/s: relative error below")
  expect_output("omega 10 rad/s: relative error below")

  run_example(pid)
  # sqrt(t)/Gamma(3/2) to the 1e-3 that the order is good to on its band.
  expect_output("\n1,1\\.13,1\\.13\n10,3\\.57,3\\.57\n100,11\\.2[789],11\\.28\n")

  run_example(describing_function_sweep)
  # -(1/omega^2 + Y)/2 with the relative motion Y = 0.1665678150044 - 0.2689779281709i of data/reference/df_orbits.csv.
  expect_output("\n1\\.490712 -0\\.308283908 0\\.134488964\n")
  expect_output("rigid -0\\.125000\n")

  run_example(orbits)
  # Ten digits of a Newton iteration on the impact map, written apart from this library.
  expect_output("period-doubling at omega [0-9.]+ rad/s, F/\\(m2 clearance omega\\^2\\) = 0\\.50424447\n")

  execute_process(COMMAND ldd ${project_build}/plant_in_a_loop RESULT_VARIABLE status OUTPUT_VARIABLE libraries)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "ldd cannot read ${project_build}/plant_in_a_loop")
  endif()
  if(NOT libraries MATCHES "libc\\.")
    message(FATAL_ERROR "ldd lists no C library:\n${libraries}")
  endif()
  if(libraries MATCHES "ceres|glog|nlopt|gflags|cholmod")
    message(FATAL_ERROR "the core consumer links more than the core:\n${libraries}")
  endif()
else()
  run_example(fit)
  file(READ ${SOURCE_DIR}/fitting/fit.cpp program)
  string(REPLACE "// SPDX-License-Identifier: BSD-3-Clause\n" "" program "${program}")
  file(READ ${SOURCE_DIR}/../../README.md readme)
  string(FIND "${readme}" "```cpp\n${program}```" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "README.md does not show ${SOURCE_DIR}/fitting/fit.cpp as it is")
  endif()
  # The parameters the data were made with.
  expect_output("K = 2\n")
  expect_output("T = 0\\.5\n")
  expect_output("a = 0\\.7\n")
  run_example(identify)
  # The structure and the orders the data were made with, within what the noise leaves.
  expect_output("verdict supported\n")
  expect_output("  a = 1\\.(59|6|60[0-9]*), 95 %")
  expect_output("  b = 0\\.(6[89][0-9]*|7|7[0-2][0-9]*), 95 %")
endif()
