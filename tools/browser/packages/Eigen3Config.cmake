# SPDX-License-Identifier: BSD-3-Clause
if(NOT TARGET Eigen3::Eigen)
  add_library(Eigen3::Eigen INTERFACE IMPORTED)
  target_include_directories(Eigen3::Eigen INTERFACE ${FRACFIT_BROWSER_HEADERS})
endif()
set(Eigen3_VERSION 3.4.0)
set(EIGEN3_INCLUDE_DIRS ${FRACFIT_BROWSER_HEADERS})
set(EIGEN3_VERSION_STRING 3.4.0)
