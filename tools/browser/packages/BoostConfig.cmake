# SPDX-License-Identifier: BSD-3-Clause
# Headers alone: those beside them belong to the C library of this machine.
foreach(each headers iostreams filesystem)
  if(NOT TARGET Boost::${each})
    add_library(Boost::${each} INTERFACE IMPORTED)
    target_include_directories(Boost::${each} INTERFACE ${FRACFIT_BROWSER_HEADERS})
  endif()
endforeach()
