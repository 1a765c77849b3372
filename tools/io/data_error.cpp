#include "io/data_error.hpp"

namespace io {
namespace {

std::string place(const std::string& file, std::size_t line, std::size_t column) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  if (line > 0 && column > 0) text += ":" + std::to_string(column);
  return text + ": ";
}

}  // namespace

DataError::DataError(const std::string& file, std::size_t line, std::size_t column, const std::string& message)
    : std::runtime_error(place(file, line, column) + message), file_(file), line_(line), column_(column) {}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    result += byte < 0x20 || byte == 0x7f ? '?' : c;
  }
  return result + (text.size() > longest ? "...'" : "'");
}

}  // namespace io
