# SPDX-License-Identifier: BSD-3-Clause
# fracfit_library(<name> <sources>...): a library target frac_<name> with alias fracfit::<name>, C++20, public headers under
# include/, our warnings kept private, installed with component <name>.
function(fracfit_library name)
  set(target fracfit_${name})
  add_library(${target} ${ARGN})
  add_library(fracfit::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  fracfit_warnings(${target})
endfunction()

function(fracfit_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms on `"literal" + std::string` (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
endfunction()
