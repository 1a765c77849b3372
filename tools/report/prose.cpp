// SPDX-License-Identifier: BSD-3-Clause
#include "report/prose.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace report {

std::map<std::string, std::string> passages_of(const ProseText& text) {
  const auto fail = [&text](const std::string& what) {
    throw std::logic_error("text/" + std::string(text.name) + ".txt: " + what);
  };
  std::map<std::string, std::string> passages;
  std::string* passage = nullptr;
  for (std::size_t at = 0; at < text.text.size();) {
    const std::size_t end = std::min(text.text.find('\n', at), text.text.size());
    const std::string_view line = text.text.substr(at, end - at);
    at = end + 1;
    if (line.starts_with("# ")) {
      const auto [place, added] = passages.try_emplace(std::string(line.substr(2)));
      if (!added) fail("passage \"" + place->first + "\" is defined twice");
      passage = &place->second;
    } else if (!line.empty()) {
      if (passage == nullptr) fail("text before the first passage");
      if (!passage->empty()) *passage += ' ';
      *passage += line;
    }
  }
  for (const auto& [name, words] : passages) {
    if (words.empty()) fail("passage \"" + name + "\" is empty");
  }
  return passages;
}

std::string filled(std::string_view passage, ProseValues values) {
  std::string text;
  std::set<std::string_view> used;
  for (std::size_t at = 0; at < passage.size();) {
    const std::size_t open = std::min(passage.find('{', at), passage.size());
    text += passage.substr(at, open - at);
    if (open == passage.size()) break;
    const std::size_t close = passage.find('}', open);
    if (close == std::string_view::npos) throw std::logic_error("prose: \"{\" without \"}\"");
    const std::string_view name = passage.substr(open + 1, close - open - 1);
    const auto* const value =
        std::find_if(values.begin(), values.end(), [name](const auto& entry) { return entry.first == name; });
    if (value == values.end()) throw std::logic_error("prose: no value for {" + std::string(name) + "}");
    text += value->second;
    used.insert(name);
    at = close + 1;
  }
  for (const auto& [name, value] : values) {
    if (!used.contains(name)) throw std::logic_error("prose: no place for the value {" + std::string(name) + "}");
  }
  return text;
}

std::string prose(std::string_view chapter, std::string_view passage, ProseValues values) {
  const auto texts = prose_texts();
  const auto text =
      std::find_if(texts.begin(), texts.end(), [chapter](const ProseText& each) { return each.name == chapter; });
  if (text == texts.end()) throw std::logic_error("prose: no chapter \"" + std::string(chapter) + "\"");
  const auto passages = passages_of(*text);
  const auto found = passages.find(std::string(passage));
  if (found == passages.end()) {
    throw std::logic_error("text/" + std::string(chapter) + ".txt: no passage \"" + std::string(passage) + "\"");
  }
  return filled(found->second, values);
}

Section open_section(std::string_view chapter) {
  Section section;
  section.id = chapter;
  section.title = prose(chapter, "title");
  section.reading = prose(chapter, "reading");
  return section;
}

Html paragraph(std::string_view chapter, std::string_view passage, ProseValues values) {
  return {"<p>" + prose(chapter, passage, values) + "</p>"};
}

}  // namespace report
