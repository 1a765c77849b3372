// SPDX-License-Identifier: BSD-3-Clause
#include "report/picture.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "io/output_file.hpp"
#include "report/staged_folder.hpp"

namespace report {

PictureFile::PictureFile(std::filesystem::path path, const std::vector<std::string>& inputs)
    : path_(std::move(path)), inputs_(inputs) {
  if (path_.extension() != ".svg" && path_.extension() != ".png")
    throw std::invalid_argument("'" + path_.string() + "' must end in .svg or .png");
  const auto found = find_gnuplot();
  if (!found) throw std::invalid_argument(gnuplot_missing());
  gnuplot_ = *found;
  const io::OutputFile writable(path_.string(), inputs_);
}

void PictureFile::write(Figure figure) const {
  figure.name = "picture";
  const auto parent = path_.parent_path();
  const StagedFolder folder(parent.empty() ? std::filesystem::path(".") : parent);
  folder.write(figure.name + ".gp", gnuplot_script(figure));
  const std::string trouble = draw(gnuplot_, folder.path(), {figure.name});
  if (!trouble.empty()) throw std::runtime_error(trouble);
  std::ostringstream content;
  content << std::ifstream(folder.path() / (figure.name + path_.extension().string()), std::ios::binary).rdbuf();
  io::OutputFile(path_.string(), inputs_).write(content.str());
}

}  // namespace report
