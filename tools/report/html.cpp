// SPDX-License-Identifier: BSD-3-Clause
#include "report/html.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "report/figure_data.hpp"
#include "report/prose.hpp"

namespace report {

namespace {

constexpr std::string_view style = R"css(
:root{color-scheme:light dark;--ink:#222;--grid:#ddd;--mix:0%}
*{box-sizing:border-box}
body{margin:0;background:#f4f4f1;color:#1c1c1c;font:16px/1.55 "Source Serif 4",Charter,"Bitstream Charter",Georgia,"DejaVu Serif",serif}
main{max-width:66rem;margin:0 auto;padding:2.5rem 2.75rem 4rem;background:#fff;box-shadow:0 0 12px #0001}
h1,h2,h3,nav,table,figcaption,.reading,.notice,.sub{font-family:"Source Sans 3","Helvetica Neue",Arial,"DejaVu Sans",sans-serif}
h1{font-size:1.9rem;line-height:1.2;margin:0 0 .3rem}
h2{font-size:1.4rem;margin:3rem 0 .8rem;padding-top:.6rem;border-top:2px solid #1c1c1c}
h3{font-size:1.08rem;margin:2rem 0 .4rem}
p,ul{max-width:46rem;margin:.6rem 0}
li{margin:.35rem 0}
.sub{color:#555;margin:0 0 1.4rem;max-width:46rem}
nav{font-size:.92rem;margin:1.2rem 0;columns:2;max-width:46rem}
nav ol{margin:0;padding-left:1.4rem}
nav li{margin:0;padding:.15rem 0}
nav a,a{color:#00538a}
.reading{background:#eef4f8;border-left:4px solid #0072b2;padding:.6rem .9rem;font-size:.93rem;max-width:46rem;margin:.8rem 0 1.2rem}
.reading b{color:#00538a}
.verdict{background:#f3f3ef;border-left:4px solid #1c1c1c;padding:.55rem .9rem;margin:0 0 .9rem;max-width:none}
.notice{background:#fdf1e3;border-left:4px solid #d55e00;padding:.7rem .9rem;margin:1rem 0;max-width:46rem}
figure{margin:1.6rem 0 1.8rem}
figure svg{width:100%;height:auto;display:block;background:#fff}
.circuit{display:block;max-width:100%;height:auto}.circuit text{fill:currentColor;stroke:none;font-size:13px;text-anchor:middle}
figcaption,caption{font-size:.9rem;color:#333;text-align:left;line-height:1.45}
figcaption{margin-top:.3rem;max-width:52rem}
.files{color:#777;font-size:.84rem}
.scroll{overflow-x:auto;margin:1.2rem 0 1.5rem}
table{border-collapse:collapse;font-size:.87rem;line-height:1.35}
caption{caption-side:top;padding-bottom:.45rem;max-width:52rem}
th{border-bottom:1.5px solid #1c1c1c;padding:.25rem .7rem;vertical-align:bottom;font-weight:600;text-align:right}
td{padding:.2rem .7rem;border-bottom:1px solid #e4e4e0;text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
th.word,td.word{text-align:left;white-space:normal}
td.word{min-width:7rem}
td.long{min-width:22rem}
.more{font-size:.9rem;color:#333;margin:.3rem 0}
details{margin:1rem 0}summary{cursor:pointer}
.formula{font-family:"Source Sans 3","Helvetica Neue",Arial,"DejaVu Sans",sans-serif;font-size:.95em}
td>.formula{display:inline-block;min-width:13rem}
tbody tr:hover{background:#f6f8fa}
code,pre{font:.88em/1.4 "DejaVu Sans Mono",Consolas,monospace}
pre{background:#f4f4f1;padding:.6rem .8rem;overflow-x:auto}
.live,.tooltip{font-family:"Source Sans 3","Helvetica Neue",Arial,"DejaVu Sans",sans-serif}
.live .bar{display:flex;flex-wrap:wrap;gap:.3rem 1rem;align-items:center;font-size:.88rem;margin:.2rem 0 .5rem}
.bar label{display:inline-flex;gap:.35rem;align-items:center}
.bar sup{line-height:0}
.bar i{width:1.5rem;height:0;border-top:2px solid var(--stroke)}
.bar i.dashed{border-top-style:dashed}.bar i.dotted{border-top-style:dotted}
.bar i.band{height:.7rem;border:0;background:var(--stroke);opacity:.4}
.bar i.open_points{width:.55rem;height:.55rem;border:1.5px solid var(--stroke);border-radius:50%}
.live .panels{display:grid;gap:.3rem}
.live svg{background:none;width:100%;touch-action:pan-y;cursor:crosshair;user-select:none}
.live svg text{font-size:13px;fill:currentColor}.live svg .title{font-size:14.5px}
.live .grid{stroke:var(--grid);stroke-width:.8}
.live .frame,.live .box{fill:none;stroke:currentColor;stroke-width:.8}
.live .box{stroke-dasharray:4 3;fill:#8883}.live .box[width="0"]{display:none}
.live g,.marks circle,.bar i{--stroke:color-mix(in srgb,var(--c),white var(--mix))}
.live g path,.live g circle{fill:none;stroke:var(--stroke);stroke-width:1.6}
.live g circle{stroke-width:1.2}.live .points circle{fill:var(--stroke)}
.live .dashed path{stroke-dasharray:8 5}.live .dotted path{stroke-dasharray:2 4}
.live .band path{fill:var(--stroke);stroke:none;opacity:.35}
.live .marks circle{stroke:var(--stroke);stroke-width:2.4}
.tooltip{position:absolute;z-index:2;pointer-events:none;background:#fff;color:#222;border:1px solid #999;padding:.3rem .55rem;font-size:.85rem;line-height:1.35;white-space:pre}
@media screen and (prefers-color-scheme:dark){
:root{--ink:#f0f0ec;--grid:#3a3a3a;--mix:35%}
body,pre{background:#121212;color:#e6e6e2}main{background:#1b1b1b;box-shadow:none}
h2{border-color:#e6e6e2}th{border-color:#bbb}td{border-color:#333}tbody tr:hover{background:#262b30}
a,nav a,.reading b{color:#7cc0ee}.sub,.files,.more,figcaption,caption{color:#b5b5b0}
.reading{background:#1d2a33}.notice{background:#35281b}.verdict{background:#262624;border-color:#e6e6e2}
.tooltip{background:#2a2a2a;color:#eee;border-color:#777}
.print svg{color-scheme:light;color:#000}
}
@media print{.bar input,.bar button,.tooltip,.marks{display:none}body{background:#fff}main{box-shadow:none;max-width:none;padding:0}figure,table{break-inside:avoid}}
@media (max-width:640px){main{padding:1.2rem}nav{columns:1}}
)css";

// A word with more bytes than this gets a wide column, so that it does not break into many lines.
constexpr std::size_t long_word = 60;

bool is_id_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.' || c == ':';
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return {};
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool is_drawn_by_page(const Figure& figure) {
  return !figure.link.empty();
}

std::string plain_text(std::string_view html) {
  std::string text;
  bool tag = false;
  for (const char c : html) {
    if (c == '<') tag = true;
    if (!tag) text += c;
    if (c == '>') tag = false;
  }
  return text;
}

// The picture for those who see the page: drawn by its script, or as gnuplot has drawn it.
std::string picture_html(const Figure& figure, const std::filesystem::path& svg) {
  const std::string drawn = read_text(svg);
  const std::string missing =
      "<div class=\"notice\">" + prose("page", "no-picture", {{"name", figure.name}}) + "</div>\n";
  if (is_drawn_by_page(figure)) {
    const std::string elsewhere =
        "<div class=\"notice\">" + prose("page", "no-script", {{"name", figure.name}}) + "</div>\n";
    return "<script type=\"application/json\" class=\"figure-data\">" + figure_data(figure) + "</script>\n<noscript>" +
           (drawn.empty() ? missing : elsewhere) + "</noscript>\n";
  }
  if (drawn.empty()) return missing;
  return "<div class=\"print\" role=\"img\" aria-label=\"" + escape_html(plain_text(figure.caption)) + "\">" +
         inline_svg(drawn, figure.name + "-") + "</div>\n";
}

std::string figure_html(const Figure& figure, const std::filesystem::path& folder) {
  const std::string stem = "figures/" + figure.name;
  const std::filesystem::path svg = folder / (stem + ".svg");
  std::string html = "<figure id=\"figure-" + figure.name + "\">\n";
  if (!figure.verdict.empty()) html += "<div class=\"verdict\">" + figure.verdict + "</div>\n";
  html += picture_html(figure, svg) + "<figcaption>" + figure.caption;
  if (std::filesystem::exists(folder / (stem + ".gp"))) {
    html += " <span class=\"files\">[";
    if (std::filesystem::exists(svg))
      html += "<a href=\"" + stem + ".svg\">SVG</a>, <a href=\"" + stem + ".png\">PNG</a>, ";
    html += "<a href=\"" + stem + ".gp\">script with the data</a>]</span>";
  }
  return html + "</figcaption>\n</figure>\n";
}

bool is_word_column(const Table& table, std::size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [column](const auto& row) { return std::holds_alternative<std::string>(row[column]); });
}

std::string cell_html(const Cell& cell, const Column& column) {
  if (const std::string* word = std::get_if<std::string>(&cell)) {
    return column.formula ? html_formula(*word) : escape_html(*word);
  }
  const double value = std::get<double>(cell);
  return html_number(std::abs(value) < column.zero_below ? 0 : value, column.digits);
}

std::string table_html(const Table& table) {
  const std::string link = "<span class=\"files\">[<a href=\"tables/" + table.name + ".csv\">CSV</a>]</span>";
  if (!table.on_page) return "<p class=\"more\">" + table.caption + " " + link + "</p>\n";
  std::vector<std::size_t> shown;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (table.columns[c].on_page) shown.push_back(c);
  }
  const std::string caption = table.caption + " " + link;
  std::string html = table.folded ? "<details><summary>" + caption + "</summary>\n" : "";
  html +=
      "<div class=\"scroll\"><table>\n" + (table.folded ? "" : "<caption>" + caption + "</caption>\n") + "<thead><tr>";
  for (const std::size_t c : shown) {
    html += (is_word_column(table, c) ? "<th class=\"word\">" : "<th>") + table.columns[c].heading + "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < std::min(table.rows.size(), table.rows_on_page); ++r) {
    const auto& row = table.rows[r];
    html += "<tr>";
    for (const std::size_t c : shown) {
      const std::string* word = std::get_if<std::string>(&row[c]);
      const bool is_long = word != nullptr && word->size() > long_word;
      html += is_long ? "<td class=\"word long\">" : is_word_column(table, c) ? "<td class=\"word\">" : "<td>";
      html += cell_html(row[c], table.columns[c]) + "</td>";
    }
    html += "</tr>\n";
  }
  html += "</tbody></table>";
  if (table.rows.size() > table.rows_on_page) {
    html += "<p class=\"more\">" +
            prose("page", "more-rows",
                  {{"shown", std::to_string(table.rows_on_page)}, {"all", std::to_string(table.rows.size())}}) +
            "</p>";
  }
  return html + "</div>\n" + (table.folded ? "</details>\n" : "");
}

bool answers(const Section& section) {
  return std::any_of(section.blocks.begin(), section.blocks.end(), [](const Block& block) {
    const Figure* figure = std::get_if<Figure>(&block);
    return figure != nullptr && is_drawn_by_page(*figure);
  });
}

std::string block_html(const Block& block, const std::filesystem::path& folder) {
  if (const Figure* figure = std::get_if<Figure>(&block)) return figure_html(*figure, folder);
  if (const Table* table = std::get_if<Table>(&block)) return table_html(*table);
  return std::get<Html>(block).text + "\n";
}

std::string contents_html(const Page& page) {
  std::string html = "<nav><ol>\n";
  for (std::size_t i = page.before_contents; i < page.sections.size(); ++i) {
    const Section& section = page.sections[i];
    html += "<li><a href=\"#" + section.id + "\">" + plain_text(section.title) + "</a></li>\n";
  }
  return html + "</ol></nav>\n";
}

std::string section_html(const Section& section, const std::string& number, const std::filesystem::path& folder) {
  std::string html = "<section id=\"" + section.id + "\">\n<h2>" + number + section.title + "</h2>\n";
  if (!section.reading.empty())
    html += "<div class=\"reading\">" + prose("page", "how-to-read", {{"reading", section.reading}}) + "</div>\n";
  for (const Block& block : section.blocks) html += block_html(block, folder);
  return html + "</section>\n";
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

namespace {

/// The end of an exponent that begins at `from`: a name or number with its sign, or the brackets around it.
std::size_t end_of_exponent(std::string_view formula, std::size_t from) {
  std::size_t end = from;
  if (end < formula.size() && formula[end] == '(') {
    int depth = 0;
    while (end < formula.size()) {
      depth += formula[end] == '(' ? 1 : formula[end] == ')' ? -1 : 0;
      ++end;
      if (depth == 0) break;
    }
    return end;
  }
  if (end < formula.size() && formula[end] == '-') ++end;
  while (end < formula.size() &&
         (std::isalnum(static_cast<unsigned char>(formula[end])) != 0 || formula[end] == '.' || formula[end] == '_'))
    ++end;
  return end;
}

std::string with_raised_exponents(std::string_view formula) {
  std::string html;
  for (std::size_t i = 0; i < formula.size(); ++i) {
    if (formula[i] != '^') {
      html += escape_html(formula.substr(i, 1));
      continue;
    }
    const std::size_t end = end_of_exponent(formula, i + 1);
    std::string_view exponent = formula.substr(i + 1, end - i - 1);
    // Raised, it needs no brackets.
    if (exponent.starts_with('(') && exponent.ends_with(')')) exponent = exponent.substr(1, exponent.size() - 2);
    html += "<sup>" + with_raised_exponents(exponent) + "</sup>";
    i = end - 1;
  }
  return html;
}

}  // namespace

std::string html_formula(std::string_view formula) {
  return "<span class=\"formula\">" + with_raised_exponents(formula) + "</span>";
}

std::string html_sentence(std::string_view note) {
  std::string sentence(note);
  if (sentence.empty()) return sentence;
  if (sentence.front() >= 'a' && sentence.front() <= 'z') sentence.front() += 'A' - 'a';
  if (!sentence.ends_with('.')) sentence += '.';
  return escape_html(sentence);
}

std::string html_number(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*e", digits - 1, value);
  const std::string scientific = buffer;
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  std::string text = scientific.substr(0, e);
  std::string power;
  if (exponent >= -4 && exponent < 6) {
    // Rounded to the digits first, so that 380 does not come out as 380.4 where two digits are asked for.
    const double rounded = std::strtod(scientific.c_str(), nullptr);
    std::snprintf(buffer, sizeof buffer, "%.*f", std::max(0, digits - 1 - exponent), rounded);
    text = buffer;
  } else {
    power = "·10<sup>" + std::string(exponent < 0 ? "−" : "") + std::to_string(std::abs(exponent)) + "</sup>";
  }
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  if (text.front() == '-') text.replace(0, 1, "−");
  return text + power;
}

std::string html_seconds(double seconds) {
  if (seconds < 1e-6) return html_number(1e9 * seconds, 2) + " ns";
  if (seconds < 1e-3) return html_number(1e6 * seconds, 2) + " µs";
  if (seconds < 1) return html_number(1e3 * seconds, 2) + " ms";
  return html_number(seconds, 2) + " s";
}

std::string inline_svg(std::string_view svg, std::string_view prefix) {
  const std::size_t root = svg.find("<svg");
  if (root == std::string_view::npos) return {};
  svg.remove_prefix(root);
  std::string result;
  result.reserve(svg.size() + svg.size() / 16);
  // gnuplot writes attributes with either quote, and refers to ids by href='#id' and by url(#id).
  static constexpr std::string_view marks[] = {" id=\"", " id='", "\tid=\"", "\nid=\"", "href=\"#", "href='#", "url(#"};
  for (std::size_t at = 0; at < svg.size();) {
    // Drops titles: browsers show them as tooltips, and gnuplot's only read "Gnuplot" and "gnuplot_plot_1".
    if (svg.compare(at, 7, "<title>") == 0) {
      const std::size_t end = svg.find("</title>", at);
      if (end == std::string_view::npos) return {};
      at = end + std::string_view("</title>").size();
      continue;
    }
    const auto mark = std::find_if(std::begin(marks), std::end(marks), [&](std::string_view candidate) {
      return svg.compare(at, candidate.size(), candidate) == 0;
    });
    if (mark == std::end(marks)) {
      result += svg[at++];
      continue;
    }
    result += *mark;
    at += mark->size();
    if (at < svg.size() && is_id_character(svg[at])) result += prefix;
  }
  return result;
}

std::string page_html(const Page& page, const std::filesystem::path& folder) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      // Browsers then refuse whatever would be loaded.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "script-src 'unsafe-inline'\">\n<title>" +
      escape_html(page.title) + "</title>\n<style>" + std::string(style) + "</style>\n</head>\n<body>\n<main>\n<h1>" +
      escape_html(page.title) + "</h1>\n<p class=\"sub\">" + page.subtitle + "</p>\n";
  if (!page.notice.empty()) html += "<div class=\"notice\">" + page.notice + "</div>\n";
  for (std::size_t i = 0; i < page.sections.size(); ++i) {
    if (i == page.before_contents) html += contents_html(page);
    const std::string number = i < page.before_contents ? "" : std::to_string(i - page.before_contents + 1) + "&ensp;";
    html += section_html(page.sections[i], number, folder);
  }
  html += "</main>\n";
  if (std::any_of(page.sections.begin(), page.sections.end(), answers))
    html += "<script>\n" + std::string(figure_script()) + "</script>\n";
  return html + "</body>\n</html>\n";
}

}  // namespace report
