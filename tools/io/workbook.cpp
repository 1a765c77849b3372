// SPDX-License-Identifier: BSD-3-Clause
// A workbook is a zip archive of XML files (ECMA-376): xl/workbook.xml names the sheets, xl/_rels/workbook.xml.rels the
// file of each, xl/sharedStrings.xml the texts that cells share.
#include "io/workbook.hpp"

#ifdef FRACFIT_WORKBOOKS
#include <zip.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "io/number.hpp"
#endif

namespace io {

#ifdef FRACFIT_WORKBOOKS
namespace {

using Xml = boost::property_tree::ptree;
using Archive = std::unique_ptr<zip_t, decltype(&zip_discard)>;

// The limits of Excel.
constexpr std::size_t most_columns = 16'384, most_rows = 1'048'576;
// An archive may claim to unpack to more than there is.
constexpr zip_uint64_t most_bytes = 500'000'000;

Archive opened(std::string_view bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  zip_t* archive = source == nullptr ? nullptr : zip_open_from_source(source, ZIP_RDONLY, &error);
  if (archive == nullptr && source != nullptr) zip_source_free(source);
  zip_error_fini(&error);
  return {archive, &zip_discard};
}

std::optional<Xml> parsed(zip_t* archive, const std::string& name) {
  zip_stat_t about;
  if (zip_stat(archive, name.c_str(), 0, &about) != 0 || (about.valid & ZIP_STAT_SIZE) == 0 || about.size > most_bytes)
    return std::nullopt;
  const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(zip_fopen(archive, name.c_str(), 0), &zip_fclose);
  std::string text(static_cast<std::size_t>(about.size), '\0');
  if (!file || zip_fread(file.get(), text.data(), about.size) != static_cast<zip_int64_t>(about.size))
    return std::nullopt;
  std::istringstream stream(std::move(text));
  Xml xml;
  read_xml(stream, xml);
  return xml;
}

// Names may have the prefix of their namespace, as in x:row.
std::string_view local(std::string_view name) {
  return name.substr(name.find(':') == std::string_view::npos ? 0 : name.find(':') + 1);
}

const Xml* child(const Xml& of, std::string_view name) {
  for (const auto& [key, value] : of)
    if (local(key) == name) return &value;
  return nullptr;
}

std::string attribute(const Xml& of, const char* name) {
  return of.get<std::string>(Xml::path_type(std::string("<xmlattr>/") + name, '/'), "");
}

// A text, in one piece or in runs of different fonts; how it is pronounced (rPh) is no part of it.
std::string text_in(const Xml& of) {
  std::string text;
  for (const auto& [key, value] : of) {
    if (local(key) == "t") text += value.data();
    if (local(key) == "r") text += text_in(value);
  }
  return text;
}

// Column of "AB12" from 0.
std::size_t column_in(const std::string& reference) {
  std::size_t column = 0;
  for (const char c : reference) {
    if (c < 'A' || c > 'Z') break;
    column = 26 * column + static_cast<std::size_t>(c - 'A' + 1);
    if (column > most_columns) throw std::runtime_error("column");
  }
  if (column == 0) throw std::runtime_error("column");
  return column - 1;
}

std::size_t whole(const std::string& text, std::size_t most) {
  const auto number = parse_count(text);
  if (!number || *number > most) throw std::runtime_error("number");
  return static_cast<std::size_t>(*number);
}

std::string field_of(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '\r' || c == '\n')
      quoted += ' ';
    else
      quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + '"';
}

std::string value_of(const Xml& cell, const std::vector<std::string>& shared) {
  const std::string type = attribute(cell, "t");
  const Xml* const inline_text = child(cell, "is");
  if (inline_text != nullptr) return text_in(*inline_text);
  const Xml* const value = child(cell, "v");
  if (value == nullptr) return "";
  if (type != "s") return value->data();
  const std::size_t index = whole(value->data(), shared.size());
  return shared.at(index);
}

std::string text_of(const Xml& rows, const std::vector<std::string>& shared) {
  std::string text;
  std::size_t lines = 0;
  for (const auto& [key, row] : rows) {
    if (local(key) != "row") continue;
    const std::string number = attribute(row, "r");
    const std::size_t line = number.empty() ? lines + 1 : whole(number, most_rows);
    for (; lines + 1 < line; ++lines) text += '\n';
    std::string fields;
    std::size_t column = 0;
    for (const auto& [name, cell] : row) {
      if (local(name) != "c") continue;
      const std::string reference = attribute(cell, "r");
      const std::size_t at = reference.empty() ? column : column_in(reference);
      for (; column < at; ++column) fields += ',';
      fields += field_of(value_of(cell, shared)) + ',';
      ++column;
    }
    // Each field is followed by a comma, the last one as well.
    while (fields.ends_with(',')) fields.pop_back();
    text += fields + '\n';
    ++lines;
  }
  return text;
}

std::string path_of(const Xml& relations, const std::string& id) {
  for (const auto& [key, relation] : relations)
    if (local(key) == "Relationship" && attribute(relation, "Id") == id) {
      const std::string target = attribute(relation, "Target");
      return target.starts_with('/') ? target.substr(1) : "xl/" + target;
    }
  return "";
}

}  // namespace

std::optional<Sheet> first_sheet(std::string_view bytes) {
  if (!bytes.starts_with("PK\x03\x04")) return std::nullopt;
  try {
    const Archive archive = opened(bytes);
    if (!archive) return std::nullopt;
    const auto book = parsed(archive.get(), "xl/workbook.xml");
    const auto relations = parsed(archive.get(), "xl/_rels/workbook.xml.rels");
    if (!book || !relations) return std::nullopt;
    std::vector<std::string> shared;
    if (const auto strings = parsed(archive.get(), "xl/sharedStrings.xml"))
      if (const Xml* const table = child(*strings, "sst"))
        for (const auto& [key, entry] : *table)
          if (local(key) == "si") shared.push_back(text_in(entry));
    const Xml* const top = child(*book, "workbook");
    const Xml* const sheets = top == nullptr ? nullptr : child(*top, "sheets");
    const Xml* const targets = child(*relations, "Relationships");
    if (sheets == nullptr || targets == nullptr) return std::nullopt;
    std::optional<Sheet> found;
    std::size_t count = 0;
    for (const auto& [key, sheet] : *sheets) {
      if (local(key) != "sheet") continue;
      ++count;
      if (found) continue;
      const auto content = parsed(archive.get(), path_of(*targets, attribute(sheet, "r:id")));
      const Xml* const page = content ? child(*content, "worksheet") : nullptr;
      const Xml* const rows = page == nullptr ? nullptr : child(*page, "sheetData");
      if (rows == nullptr) continue;
      std::string text = text_of(*rows, shared);
      if (text.find_first_not_of('\n') != std::string::npos)
        found = Sheet{std::move(text), attribute(sheet, "name"), 0};
    }
    if (found) found->sheets = count;
    return found;
  } catch (const std::exception&) {
    return std::nullopt;  // damaged
  }
}

#else

std::optional<Sheet> first_sheet(std::string_view) {
  return std::nullopt;
}

#endif

}  // namespace io
