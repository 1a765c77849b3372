# SPDX-License-Identifier: BSD-3-Clause
# fracfit_library(<name> [OPTIMISED <level>] <sources>...): a library target frac_<name> with alias fracfit::<name>, C++20,
# public headers under include/, our warnings kept private, installed with component <name>.  A release is compiled with
# -O<level>: 2 unless told otherwise, as 3 takes a tenth longer to compile and gains something in identification alone.
function(fracfit_library name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "OPTIMISED" "")
  if(NOT ARG_OPTIMISED)
    set(ARG_OPTIMISED 2)
  endif()
  set(target fracfit_${name})
  add_library(${target} ${ARG_UNPARSED_ARGUMENTS})
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O${ARG_OPTIMISED}>)
  add_library(fracfit::${name} ALIAS ${target})
  # Interfaces may change with each minor version before 1.0.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
                                             SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                                             DEFINE_SYMBOL "")  # objects of shared and static libraries are the same
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "SHARED_LIBRARY")
    set(names ${PROJECT_SOURCE_DIR}/tools/cmake/exported_names.map)
    target_link_options(${target} PRIVATE -Wl,--version-script=${names})
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${names})
  endif()
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  fracfit_precompiled(${target} ${ARG_OPTIMISED})
  fracfit_warnings(${target})
endfunction()

# fracfit_precompiled(<target> [<level>]): parses the standard headers that most files include once, and for a library
# compiled with -O2 or -O3 Eigen's core with them: for all targets of one level together, since GCC 14 takes no headers that
# were parsed at another, and for each program, which the compiler takes for position-independent in another way.  A file
# still includes what it uses.  Files with compile options of their own stay out of it.
function(fracfit_precompiled target)
  set(headers <algorithm> <array> <cmath> <complex> <cstddef> <cstdint> <cstdio> <functional> <limits> <map> <memory>
      <numbers> <numeric> <optional> <span> <stdexcept> <string> <string_view> <utility> <vector>)
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "EXECUTABLE")
    target_precompile_headers(${target} PRIVATE ${headers})
    return()
  endif()
  set(level "${ARGV1}")
  set(parsed fracfit_headers${level})
  if(NOT TARGET ${parsed})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers${level}.cpp CONTENT "")
    add_library(${parsed} OBJECT ${PROJECT_BINARY_DIR}/headers${level}.cpp)
    target_compile_features(${parsed} PRIVATE cxx_std_20)
    if(level GREATER 1)
      list(APPEND headers <Eigen/Core>)
      target_link_libraries(${parsed} PRIVATE Eigen3::Eigen)
    endif()
    if(level)
      target_compile_options(${parsed} PRIVATE $<$<CONFIG:Release>:-O${level}>)
    endif()
    fracfit_warnings(${parsed})
    target_precompile_headers(${parsed} PRIVATE ${headers})
  endif()
  target_precompile_headers(${target} REUSE_FROM ${parsed})
endfunction()

# Compiles files of one room as one source where CMAKE_UNITY_BUILD is on, as in a folder that tools/setup makes: their
# headers are parsed and their templates instantiated once.  Small groups, so that a change in one of them costs seconds;
# files with hot loops, with options of their own or with names that another one uses differently stay out.
function(fracfit_together group)
  set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${group})
endfunction()

function(fracfit_warnings target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
  if(NOT CMAKE_UNITY_BUILD)
    # A local name of one file may be that of a constant in another one of its group.
    target_compile_options(${target} PRIVATE -Wshadow)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms on `"literal" + std::string` (GCC bug 105651), of all three kinds once headers are precompiled.
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
  elseif(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # GCC leaves it out of -Wconversion.
    target_compile_options(${target} PRIVATE -Wno-sign-conversion)
  endif()
endfunction()

# fracfit_text_of(<variable> <folder> <files>...): real C files as strings of C++, each named as its file.
function(fracfit_text_of variable folder)
  set(strings "")
  foreach(file ${ARGN})
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/${file})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    file(READ ${path} text)
    string(REGEX REPLACE "\\..*" "" stem ${file})
    string(APPEND strings "const std::string_view ${stem} = R\"c(${text})c\";\n")
  endforeach()
  set(${variable} "${strings}" PARENT_SCOPE)
endfunction()
