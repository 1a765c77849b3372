// SPDX-License-Identifier: BSD-3-Clause
// MAT-files of level 5 and 7.3 (HDF5), through libmatio where the build has it: a vector of frequencies named as a
// column would be, and complex vectors, or one real and one imaginary vector, of its length.
//
// libmatio is loaded with the first such file: it brings HDF5 and thirty further libraries, whose loading is a third of
// every start of the program.
#include "io/data_error.hpp"
#include "io/formats/format.hpp"

#ifdef FRACFIT_MATIO
#include <dlfcn.h>
#include <fcntl.h>
#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <memory>

#include "io/column_name.hpp"
#include "io/descriptor.hpp"
#endif

namespace io {

#ifdef FRACFIT_MATIO
namespace {

using Vector = NamedVector;

/// The functions of libmatio that are called here, under the types of its header.
struct Matio {
  decltype(&Mat_Open) open = nullptr;
  decltype(&Mat_Close) close = nullptr;
  decltype(&Mat_VarReadNextInfo) read_next_info = nullptr;
  decltype(&Mat_VarReadDataAll) read_data = nullptr;
  decltype(&Mat_VarFree) free = nullptr;
};

// FRACFIT_MATIO is the name under which the library that the build found is loaded.  It stays loaded.
Matio loaded_matio(const std::string& file) {
  Matio matio;
  void* library = ::dlopen(FRACFIT_MATIO, RTLD_NOW | RTLD_LOCAL);
  const auto find = [library](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    return function != nullptr;
  };
  if (library == nullptr || !find(matio.open, "Mat_Open") || !find(matio.close, "Mat_Close") ||
      !find(matio.read_next_info, "Mat_VarReadNextInfo") || !find(matio.read_data, "Mat_VarReadDataAll") ||
      !find(matio.free, "Mat_VarFree"))
    throw DataError(file, 0, 0, std::string("is a MAT-file, and libmatio, which reads them, fails: ") + ::dlerror());
  // HDF5, which libmatio brings, writes its errors to the terminal unless told not to.
  int (*write_errors_by)(std::int64_t, void*, void*) = nullptr;
  if (find(write_errors_by, "H5Eset_auto2")) write_errors_by(0, nullptr, nullptr);
  return matio;
}

template <typename Number>
void append(const matvar_t& variable, std::size_t count, Vector& vector) {
  const auto part = [&](const void* data, std::size_t i) {
    return static_cast<double>(static_cast<const Number*>(data)[i]);
  };
  const auto* split = vector.is_complex ? static_cast<const mat_complex_split_t*>(variable.data) : nullptr;
  for (std::size_t i = 0; i < count; ++i) {
    if (split != nullptr)
      vector.values.emplace_back(part(split->Re, i), part(split->Im, i));
    else
      vector.values.emplace_back(part(variable.data, i), 0.0);
  }
}

bool is_of_hdf5(const Source& source) {
  return source.bytes.starts_with("MATLAB 7.3 MAT-file");
}

// libmatio reads from files alone; what came through a pipe has become bytes already.  In memory, or for HDF5, which
// asks for a path that leads somewhere, in a temporary file.
class Copy {
 public:
  explicit Copy(const Source& source) : name_(name_for(source)), file_(opened(name_)) {
    for (std::string_view rest = source.bytes; !rest.empty();) {
      const auto written = ::write(file_.number(), rest.data(), rest.size());
      if (written <= 0) {
        remove();
        throw DataError(source.file, 0, 0, "cannot be copied for libmatio");
      }
      rest.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  Copy(const Copy&) = delete;
  Copy& operator=(const Copy&) = delete;
  ~Copy() { remove(); }

  [[nodiscard]] std::string path() const {
    return name_.empty() ? "/proc/self/fd/" + std::to_string(file_.number()) : name_;
  }

 private:
  static std::string name_for(const Source& source) {
    if (!is_of_hdf5(source)) return "";
    const char* const folder = std::getenv("TMPDIR");
    return std::string(folder != nullptr && *folder != '\0' ? folder : "/tmp") + "/fracfit-XXXXXX";
  }
  static int opened(std::string& name) {
    return name.empty() ? ::memfd_create("matlab", MFD_CLOEXEC) : ::mkostemp(name.data(), O_CLOEXEC);
  }
  void remove() const {
    if (!name_.empty()) ::unlink(name_.c_str());
  }

  std::string name_;  // empty: in memory
  Descriptor file_;
};

std::vector<Vector> vectors_in(const Source& source) {
  const Matio matio = loaded_matio(source.file);
  constexpr std::size_t most_values = 10'000'000;
  const Copy copy(source);
  const std::unique_ptr<mat_t, decltype(matio.close)> file(matio.open(copy.path().c_str(), MAT_ACC_RDONLY),
                                                           matio.close);
  if (!file) throw DataError(source.file, 0, 0, "is a damaged MAT-file");
  bool has_variables = false;
  std::vector<Vector> vectors;
  while (const std::unique_ptr<matvar_t, decltype(matio.free)> variable{matio.read_next_info(file.get()), matio.free}) {
    has_variables = true;
    const bool is_number = variable->class_type == MAT_C_DOUBLE || variable->class_type == MAT_C_SINGLE;
    if (!is_number || variable->rank != 2 || variable->name == nullptr) continue;
    const std::size_t rows = variable->dims[0], columns = variable->dims[1];
    if ((rows != 1 && columns != 1) || rows == 0 || columns == 0 || rows > most_values || columns > most_values)
      continue;
    if (matio.read_data(file.get(), variable.get()) != 0 || variable->data == nullptr)
      throw DataError(source.file, 0, 0, "is damaged: variable " + quoted(variable->name) + " cannot be read");
    Vector vector{variable->name, {}, variable->isComplex != 0};
    if (variable->class_type == MAT_C_DOUBLE)
      append<double>(*variable, rows * columns, vector);
    else
      append<float>(*variable, rows * columns, vector);
    vectors.push_back(std::move(vector));
  }
  // libmatio does not tell the one from the other.
  if (!has_variables && is_of_hdf5(source))
    throw DataError(source.file, 0, 0, "is a MAT-file without variables, or a damaged one");
  return vectors;
}

std::string names_of(const std::vector<Vector>& vectors) {
  std::vector<std::string> names;
  for (const auto& each : vectors) names.push_back(each.name);
  return names.empty() ? "none" : shortened_list(names);
}

}  // namespace

std::optional<std::vector<NamedVector>> matlab_vectors(const Source& source) {
  if (!source.bytes.starts_with("MATLAB 5.0 MAT-file") && !is_of_hdf5(source)) return std::nullopt;
  return vectors_in(source);
}

std::optional<Recognised> read_matlab(const Source& source) {
  const auto found_vectors = matlab_vectors(source);
  if (!found_vectors) return std::nullopt;
  const std::vector<Vector>& vectors = *found_vectors;
  const Vector *frequency = nullptr, *real = nullptr, *imaginary = nullptr;
  ColumnMeaning unit_of_frequency{}, unit_of_real{};
  double sign = 1;
  for (const auto& each : vectors) {
    if (each.is_complex) continue;
    ColumnMeaning meaning = column_meaning(each.name);
    if (meaning.quantity == Quantity::frequency && frequency == nullptr) {
      if (meaning.unit.empty() && !source.frequency_unit.empty())
        meaning = column_meaning("f[" + source.frequency_unit + "]");
      frequency = &each;
      unit_of_frequency = std::move(meaning);
    } else if (meaning.quantity == Quantity::real) {
      real = &each;
      unit_of_real = std::move(meaning);
    } else if (meaning.quantity == Quantity::imaginary || meaning.quantity == Quantity::negative_imaginary) {
      imaginary = &each;
      sign = meaning.quantity == Quantity::imaginary ? 1 : -1;
    }
  }
  if (frequency == nullptr)
    throw DataError(source.file, 0, 0,
                    "holds no vector of frequencies among its vectors (" + names_of(vectors) +
                        "); expected one named f_Hz, omega or the like");
  if (!unit_of_frequency.problem.empty())
    throw DataError(source.file, 0, 0, "variable " + quoted(frequency->name) + ": " + unit_of_frequency.problem);
  const std::size_t count = frequency->values.size();
  Recognised found{"MAT-file", {}};
  const auto add = [&](const std::string& name, std::vector<std::complex<double>> values, const std::string& unit) {
    SampledCurve curve{{},
                       std::move(values),
                       unit,
                       name,
                       unit_of_frequency.in_hertz ? frac::FrequencyUnit::hertz : frac::FrequencyUnit::rad_per_s};
    for (const auto& each : frequency->values) curve.omega.push_back(unit_of_frequency.factor * each.real());
    found.sweeps.push_back({name, std::move(curve)});
  };
  for (const auto& each : vectors)
    if (each.is_complex && each.values.size() == count) add(each.name, each.values, column_meaning(each.name).unit);
  if (real != nullptr && imaginary != nullptr && real->values.size() == count && imaginary->values.size() == count) {
    std::vector<std::complex<double>> values;
    for (std::size_t i = 0; i < count; ++i)
      values.emplace_back(real->values[i].real(), sign * imaginary->values[i].real());
    add(real->name + "/" + imaginary->name, std::move(values), unit_of_real.unit);
  }
  if (found.sweeps.empty())
    throw DataError(source.file, 0, 0,
                    "holds no response of " + std::to_string(count) + " values beside " + quoted(frequency->name) +
                        " among its vectors (" + names_of(vectors) + "); expected a complex vector, or re and im");
  return found;
}

#else

std::optional<std::vector<NamedVector>> matlab_vectors(const Source& source) {
  if (source.bytes.starts_with("MATLAB 5.0 MAT-file") || source.bytes.starts_with("MATLAB 7.3 MAT-file"))
    throw DataError(source.file, 0, 0, "is a MAT-file; this fracfit was built without libmatio, which reads them");
  return std::nullopt;
}

std::optional<Recognised> read_matlab(const Source& source) {
  static_cast<void>(matlab_vectors(source));
  return std::nullopt;
}

#endif

}  // namespace io
