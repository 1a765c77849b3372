// SPDX-License-Identifier: BSD-3-Clause
#include "io/zip_archive.hpp"

#include <zip.h>

#include <memory>
#include <stdexcept>

namespace io {

namespace {

[[noreturn]] void fail(const std::string& what, const char* cause) {
  throw std::runtime_error("zip archive, " + what + ": " + cause);
}

}  // namespace

std::string zip_archive(const std::vector<ArchivedFile>& files) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* buffer = zip_source_buffer_create(nullptr, 0, 0, &error);
  if (buffer == nullptr) fail("buffer", zip_error_strerror(&error));
  // The archive and we hold the buffer: it outlives the closing, which fills it.
  zip_source_keep(buffer);
  const std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> owner(buffer, zip_source_free);
  zip_t* archive = zip_open_from_source(buffer, ZIP_TRUNCATE, &error);
  if (archive == nullptr) {
    zip_source_free(buffer);
    fail("buffer", zip_error_strerror(&error));
  }
  constexpr time_t first_date_of_zip = 315532800;  // 1980-01-01
  for (const ArchivedFile& file : files) {
    zip_source_t* content = zip_source_buffer(archive, file.content.data(), file.content.size(), 0);
    const zip_int64_t index =
        content == nullptr ? -1 : zip_file_add(archive, file.path.c_str(), content, ZIP_FL_ENC_UTF_8);
    if (index < 0 || zip_file_set_mtime(archive, static_cast<zip_uint64_t>(index), first_date_of_zip, 0) != 0) {
      const std::string cause = zip_strerror(archive);
      if (content != nullptr && index < 0) zip_source_free(content);
      zip_discard(archive);
      fail(file.path, cause.c_str());
    }
  }
  if (zip_close(archive) != 0) {
    const std::string cause = zip_strerror(archive);
    zip_discard(archive);
    fail("end", cause.c_str());
  }
  zip_stat_t size;
  if (zip_source_stat(buffer, &size) != 0 || zip_source_open(buffer) != 0)
    fail("reading", zip_error_strerror(zip_source_error(buffer)));
  std::string bytes(static_cast<std::size_t>(size.size), '\0');
  const zip_int64_t got = zip_source_read(buffer, bytes.data(), size.size);
  zip_source_close(buffer);
  if (got != static_cast<zip_int64_t>(size.size)) fail("reading", "too few bytes");
  return bytes;
}

}  // namespace io
