// SPDX-License-Identifier: BSD-3-Clause
// How fast files are read, in every format.  Prints case,method,setting,error,seconds: a format, what reads it, the
// megabytes of the file, the largest relative error of a point, and the seconds of processor time per megabyte, the
// least of the repeats, as other programs of the machine only add to it.  The rows of `wc -l` are that
// program on the same file, to compare with.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"

namespace {

using Complex = std::complex<double>;

struct Points {
  std::vector<double> hertz;
  std::vector<Complex> value;
};

// A spectrum of an electrode; every number has nine digits, as instruments write them.
Points points_of(std::size_t count) {
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double hertz = std::pow(10, -3 + 9 * static_cast<double>(i) / static_cast<double>(count));
    points.hertz.push_back(hertz);
    points.value.push_back(20.0 + 300.0 / (1.0 + std::pow(Complex(0, hertz), 0.8)));
  }
  return points;
}

std::string text(const char* form, double a, double b, double c) {
  char buffer[256];
  return {buffer, static_cast<std::size_t>(std::snprintf(buffer, sizeof buffer, form, a, b, c))};
}

// A format whose rows are printed by one pattern of frequency and two numbers.
std::string table(const Points& points, const std::string& head, const char* row, bool is_negative = false) {
  std::string content = head;
  for (std::size_t i = 0; i < points.hertz.size(); ++i)
    content += text(row, points.hertz[i], points.value[i].real(), (is_negative ? -1 : 1) * points.value[i].imag());
  return content;
}

std::string polar_table(const Points& points, const std::string& head, const char* row, bool in_decibels = false) {
  std::string content = head;
  for (std::size_t i = 0; i < points.hertz.size(); ++i) {
    const double magnitude = std::abs(points.value[i]);
    content += text(row, points.hertz[i], in_decibels ? 20 * std::log10(magnitude) : magnitude,
                    std::arg(points.value[i]) * 180 / std::numbers::pi);
  }
  return content;
}

std::string with_commas(std::string content, std::size_t from) {
  std::replace(content.begin() + static_cast<std::ptrdiff_t>(from), content.end(), '.', ',');
  return content;
}

std::string utf16(const std::string& content) {
  std::string wide = "\xFF\xFE";
  for (const char c : content) (wide += c) += '\0';
  return wide;
}

template <typename Number>
void append(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

std::string universal58(const Points& points, bool is_binary) {
  const auto count = static_cast<double>(points.hertz.size());
  std::string content = "    -1\n    58\n";
  if (is_binary)
    content =
        text("    -1\n    58b     1     2          11%12.0f     0     0           0           0\n", 24 * count, 0, 0);
  content +=
      "frame\nNONE\n01-Jan-20 10:00:00\nNONE\nNONE\n    4         1    1         0 NONE               5   3 NONE     "
      "          2   1\n" +
      text("%10.0f%10.0f", is_binary ? 6 : 5, count, 0) +
      "         0  0.00000e+00  0.00000e+00  0.00000e+00\n        18    0    0    0 NONE                 Hz            "
      "      \n";
  for (int i = 0; i < 3; ++i) content += "         1    0    0    0 NONE                 ohm                 \n";
  for (std::size_t i = 0; i < points.hertz.size(); ++i) {
    if (is_binary)
      for (const double number : {points.hertz[i], points.value[i].real(), points.value[i].imag()})
        append(content, number);
    else
      content += text("%13.5e%13.5e%13.5e", points.hertz[i], points.value[i].real(), points.value[i].imag()) +
                 (i % 2 == 1 ? "\n" : "");
  }
  return content + (is_binary ? "    -1\n" : "\n    -1\n");
}

std::string matlab(const Points& points) {
  std::string content = "MATLAB 5.0 MAT-file";
  content.resize(116, ' ');
  content.resize(124, '\0');
  append<std::uint32_t>(content, 0x4D490100U);
  const auto element = [](std::uint32_t type, const std::string& bytes) {
    std::string tagged;
    append(tagged, type);
    append(tagged, static_cast<std::uint32_t>(bytes.size()));
    tagged += bytes;
    tagged.resize((tagged.size() + 7) / 8 * 8, '\0');
    return tagged;
  };
  const auto variable = [&](const std::string& name, bool is_complex, const std::vector<std::string>& parts) {
    std::string flags, dimensions;
    append<std::uint32_t>(flags, is_complex ? 0x806U : 6U);
    append<std::uint32_t>(flags, 0U);
    append(dimensions, static_cast<std::int32_t>(points.hertz.size()));
    append<std::int32_t>(dimensions, 1);
    std::string inner = element(6, flags) + element(5, dimensions) + element(1, name);
    for (const auto& part : parts) inner += element(9, part);
    content += element(14, inner);
  };
  std::string hertz, real, imaginary;
  for (std::size_t i = 0; i < points.hertz.size(); ++i) {
    append(hertz, points.hertz[i]);
    append(real, points.value[i].real());
    append(imaginary, points.value[i].imag());
  }
  variable("f_Hz", false, {hertz});
  variable("Z_ohm", true, {real, imaginary});
  return content;
}

struct Format {
  std::string name;
  std::function<std::string(const Points&)> content;
};

const std::vector<Format>& formats() {
  const std::string gamry =
      "EXPLAIN\r\nTAG\tEISPOT\r\nZCURVE\tTABLE\r\n\tPt\tTime\tFreq\tZreal\tZimag\tZmod\tZphz\r\n\t#"
      "\ts\tHz\tohm\tohm\tohm\t\xB0\r\n";
  const std::string biologic =
      "EC-Lab ASCII FILE\r\nNb header lines : 4     \r\n\r\n"
      "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\t|Z|/Ohm\tPhase(Z)/deg\ttime/s\tcycle number\t\r\n";
  const std::string zview =
      "ZPLOT2 ASCII\r\n  Freq(Hz)\tAmpl\tBias\tTime(Sec)\tZ'(a)\tZ''(b)\tGD\tErr\tRange\r\nEnd Comments\r\n";
  const std::string versastudio =
      "<Application>\n</Application>\n<Segment1>\nType=2\nDefinition=Segment #, Point #, Frequency(Hz), Z Real, Z "
      "Imag, 0\n";
  const std::string ch_instruments =
      "A.C. Impedance\nInstrument Model:  CHI660E\n\nFreq/Hz, Z'/ohm, Z\"/ohm, Z/ohm, Phase/deg\n\n";
  static const std::vector<Format> all{
      {"table", [](const Points& p) { return table(p, "f_Hz,re,im\n", "%.9g,%.9g,%.9g\n"); }},
      {"table of 17 digits", [](const Points& p) { return table(p, "f_Hz,re,im\n", "%.17g,%.17g,%.17g\n"); }},
      {"table of blanks", [](const Points& p) { return table(p, "Freq/Hz Z' Z''\n", "%15.8e %15.8e %15.8e\n"); }},
      {"decimal commas", [](const Points& p) { return with_commas(table(p, "f_Hz;re;im\n", "%.9g;%.9g;%.9g\n"), 11); }},
      {"UTF-16", [](const Points& p) { return utf16(table(p, "f_Hz\tre\tim\n", "%.9g\t%.9g\t%.9g\n")); }},
      {"magnitude and phase",
       [](const Points& p) { return polar_table(p, "Frequency (Hz),|Z|,theta (deg)\n", "%.9g,%.9g,%.9g\n"); }},
      {"rheology", [](const Points& p) { return table(p, "f (Hz)\tG' (Pa)\tG'' (Pa)\n", "%.9g\t%.9g\t%.9g\n"); }},
      {"dielectric", [](const Points& p) { return table(p, "f (Hz)\teps'\teps''\n", "%.9g\t%.9g\t%.9g\n", true); }},
      {"Gamry", [=](const Points& p) { return table(p, gamry, "\t0\t1.5\t%.9g\t%.9g\t%.9g\t312.5\t-12.5\r\n"); }},
      {"BioLogic",
       [=](const Points& p) { return table(p, biologic, "%.9E\t%.9E\t%.9E\t3.0E+002\t-1.0\t1.5\t1.0\r\n", true); }},
      {"ZView", [=](const Points& p) { return table(p, zview, "%.9E\t1.0E-02\t0\t2\t%.9E\t%.9E\t0\t0\t3\r\n"); }},
      {"VersaStudio", [=](const Points& p) { return table(p, versastudio, "1,0,%.9g,%.9g,%.9g\n") + "</Segment1>\n"; }},
      {"CH Instruments", [=](const Points& p) { return table(p, ch_instruments, "%.8e, %.8e, %.8e, 9.8e+1, -1.6\n"); }},
      {"Touchstone RI", [](const Points& p) { return table(p, "# Hz S RI R 50\n", "%.9g %.9g %.9g\n"); }},
      {"Touchstone MA", [](const Points& p) { return polar_table(p, "# Hz S MA R 50\n", "%.9g %.9g %.9g\n"); }},
      {"Touchstone DB", [](const Points& p) { return polar_table(p, "# Hz S DB R 50\n", "%.9g %.9g %.9g\n", true); }},
      {"UFF58", [](const Points& p) { return universal58(p, false); }},
      {"UFF58b", [](const Points& p) { return universal58(p, true); }},
      {"MAT", matlab},
  };
  return all;
}

double processor_seconds(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double least_seconds(int who, int repeats, const std::function<void()>& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const double begin = processor_seconds(who);
    work();
    least = std::min(least, processor_seconds(who) - begin);
  }
  return least;
}

void measure(const Format& format, const std::string& path, std::size_t count, int repeats) {
  const Points points = points_of(count);
  {
    std::ofstream stream(path, std::ios::binary);
    stream << format.content(points);
    if (!stream.flush()) throw std::runtime_error("cannot write " + path);
  }
  const double megabytes = static_cast<double>(std::filesystem::file_size(path)) / 1e6;
  double error = 0;
  const double seconds = least_seconds(RUSAGE_SELF, repeats, [&] {
    const auto read = io::read_frequency_response(path, {});
    error = read.data.size() == count ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(count, read.data.size()); i += 1 + count / 1000)
      error = std::max(error, std::abs(read.data.value()[i] - points.value[i]) / std::abs(points.value[i]));
  });
  const auto print = [&](const char* method, double off, double taken) {
    std::printf("%s,%s,%.1f MB,%.1e,%.2e\n", format.name.c_str(), method, megabytes, off, taken / megabytes);
  };
  print("fracfit", error, seconds);
  if (format.name != "table") return;
  const std::string command = "wc -l '" + path + "' > /dev/null";
  print("wc -l", 0, least_seconds(RUSAGE_CHILDREN, repeats, [&] {
          if (std::system(command.c_str()) != 0) throw std::runtime_error("cannot run " + command);
        }));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::string_view(argv[1]) == "--smoke";
  const int repeats = smoke ? 1 : 15;
  std::string folder = (std::filesystem::temp_directory_path() / "reading-speed-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no temporary folder");
  std::printf("# %s, GCC %s, least of %d\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE, __VERSION__,
              repeats);
  for (const Format& format : formats()) {
    try {
      measure(format, folder + "/file", smoke ? 100 : 100000, repeats);
    } catch (const io::DataError& error) {  // a format that this build was told to leave out
      std::printf("# %s: %s\n", format.name.c_str(), error.what());
    }
  }
  // The first of them once more, with 10^6 rows.
  if (!smoke) measure(formats().front(), folder + "/file", 1000000, repeats);
  std::filesystem::remove_all(folder);
}
