# SPDX-License-Identifier: BSD-3-Clause
# cmake -DOUTPUT=<file.cpp> -P embed_texts.cmake -- <text>...: writes the text files as a C++ source with
# report::prose_texts().
set(entries "")
set(seen_separator FALSE)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE ${last})
  if(seen_separator)
    get_filename_component(name "${CMAKE_ARGV${i}}" NAME_WE)
    file(READ "${CMAKE_ARGV${i}}" text)
    string(APPEND entries "    {\"${name}\", R\"prose(${text})prose\"},\n")
  elseif("${CMAKE_ARGV${i}}" STREQUAL "--")
    set(seen_separator TRUE)
  endif()
endforeach()
file(WRITE "${OUTPUT}" "#include \"report/prose.hpp\"

namespace report {

std::span<const ProseText> prose_texts() {
  static constexpr ProseText texts[] = {
${entries}  };
  return texts;
}

}  // namespace report
")
