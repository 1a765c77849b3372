# SPDX-License-Identifier: BSD-3-Clause
# Makes of the program fracfit one page with everything inside, fracfit.html.
target_sources(fracfit PRIVATE ${PROJECT_SOURCE_DIR}/tools/browser/memory_file.cpp)
# 10^10 rows, the most of a stream, are more than a size of 32 bits counts, and more than a page holds.
target_compile_options(fracfit PRIVATE -Wno-constant-conversion)
# Recursion over formulas and decompositions of Boost's numbers of many digits need more stack than the 5 MB of em++.
target_link_options(fracfit PRIVATE
  -O1 -sMODULARIZE=1 -sEXPORT_NAME=fracfit -sENVIRONMENT=web,worker -sINVOKE_RUN=0 -sEXIT_RUNTIME=1
  -sALLOW_MEMORY_GROWTH=1 -sINITIAL_MEMORY=64MB -sMAXIMUM_MEMORY=2GB -sTOTAL_STACK=16MB -sFORCE_FILESYSTEM=1
  -sEXPORTED_RUNTIME_METHODS=FS,callMain)
set_target_properties(fracfit PROPERTIES SUFFIX .js)
set(page ${PROJECT_BINARY_DIR}/fracfit.html)
set(program $<TARGET_FILE_DIR:fracfit>/fracfit)
add_custom_command(
  OUTPUT ${page}
  COMMAND sh -c "gzip -9 -n -c '${program}.wasm' | base64 -w 0 >'${program}.txt'"
  COMMAND ${CMAKE_COMMAND} -DOUTPUT=${page} -DPAGE=${CMAKE_CURRENT_LIST_DIR}/page.html -DSCRIPT=${program}.js
          -DPROGRAM=${program}.txt -DEXAMPLE=${PROJECT_SOURCE_DIR}/data/examples/cell.csv
          -P ${CMAKE_CURRENT_LIST_DIR}/embed.cmake
  DEPENDS fracfit ${CMAKE_CURRENT_LIST_DIR}/page.html ${CMAKE_CURRENT_LIST_DIR}/embed.cmake
  COMMENT "Putting the program into its page"
  VERBATIM)
add_custom_target(page DEPENDS ${page})
