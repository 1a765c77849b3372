# SPDX-License-Identifier: BSD-3-Clause
# cmake -DINPUT=<file.js> -DOUTPUT=<file.cpp> -P embed_script.cmake: writes the script as a C++ source with
# report::figure_script().
file(READ "${INPUT}" text)
file(WRITE "${OUTPUT}" "#include \"report/figure_data.hpp\"

namespace report {

std::string_view figure_script() {
  return R\"script(${text})script\";
}

}  // namespace report
")
