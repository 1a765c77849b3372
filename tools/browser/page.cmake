# SPDX-License-Identifier: BSD-3-Clause
# Makes of the program fracfit one page with everything inside, fracfit.html.
# Recursion over formulas and decompositions of Boost's numbers of many digits need more stack than the 5 MB of em++.
target_link_options(fracfit PRIVATE
  -O2 -sSINGLE_FILE=1 -sMODULARIZE=1 -sEXPORT_NAME=fracfit -sENVIRONMENT=web,worker,node -sINVOKE_RUN=0 -sEXIT_RUNTIME=1
  -sALLOW_MEMORY_GROWTH=1 -sINITIAL_MEMORY=64MB -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=16MB -sFORCE_FILESYSTEM=1
  -sEXPORTED_RUNTIME_METHODS=FS,callMain)
add_custom_command(
  OUTPUT ${PROJECT_BINARY_DIR}/fracfit.html
  COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:fracfit> -DPAGE=${PROJECT_SOURCE_DIR}/tools/browser/page.html
          -DOUTPUT=${PROJECT_BINARY_DIR}/fracfit.html -P ${PROJECT_SOURCE_DIR}/tools/browser/embed.cmake
  DEPENDS fracfit ${PROJECT_SOURCE_DIR}/tools/browser/page.html ${PROJECT_SOURCE_DIR}/tools/browser/embed.cmake
  COMMENT "Embedding the program in its page"
  VERBATIM)
add_custom_target(page ALL DEPENDS ${PROJECT_BINARY_DIR}/fracfit.html)
