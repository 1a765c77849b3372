# SPDX-License-Identifier: BSD-3-Clause
# Compiles for the browser with the parts of Debian's emscripten: the C library and libc++ of its sysroot, Clang called
# directly, as em++ would take a second to start for every file, and em++ for the link alone.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_C_COMPILER clang-14)
set(CMAKE_CXX_COMPILER clang++-14)
set(CMAKE_AR llvm-ar-14 CACHE FILEPATH "")
set(CMAKE_RANLIB llvm-ranlib-14 CACHE FILEPATH "")
set(CMAKE_C_COMPILER_TARGET wasm32-unknown-emscripten)
set(CMAKE_CXX_COMPILER_TARGET wasm32-unknown-emscripten)
set(CMAKE_SYSROOT /usr/share/emscripten/cache/sysroot)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE NEVER)
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
# What em++ 3.1.6 tells its Clang.  Vectors of two numbers as those of SSE2: sums are then in the order in which the program
# of x86-64 adds.
set(flags "-DEMSCRIPTEN -D__EMSCRIPTEN_major__=3 -D__EMSCRIPTEN_minor__=1 -D__EMSCRIPTEN_tiny__=6 -fvisibility=default")
string(APPEND flags " -mllvm -combiner-global-alias-analysis=false -mllvm -enable-emscripten-sjlj -mllvm -disable-lsr")
string(APPEND flags " -fno-threadsafe-statics -Dunix -D__unix -D__unix__ -Xclang -iwithsysroot/include/compat -I${CMAKE_CURRENT_LIST_DIR}/include")
string(APPEND flags " -msimd128 -D__SSE__ -D__SSE2__")
set(CMAKE_C_FLAGS_INIT "${flags}")
# Precompiled headers that ccache keeps are right as long as what they hold is, whenever it was copied.
string(APPEND flags " -Xclang -fno-pch-timestamp")
set(CMAKE_CXX_FLAGS_INIT "${flags} -D_LIBCPP_ABI_VERSION=2 -fwasm-exceptions -include ${CMAKE_CURRENT_LIST_DIR}/newer_library.hpp")
set(CMAKE_CXX_LINK_EXECUTABLE "${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs em++ -fwasm-exceptions <LINK_FLAGS> <OBJECTS> -o <TARGET> <LINK_LIBRARIES>")
