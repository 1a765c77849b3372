// SPDX-License-Identifier: BSD-3-Clause
// A file without a name, which the C library of a browser lacks; all files are in memory there.
#include <unistd.h>

#include <cstdlib>

extern "C" int memfd_create(const char*, unsigned) {
  char name[] = "/tmp/fracfit-XXXXXX";
  const int file = ::mkstemp(name);
  if (file >= 0) ::unlink(name);
  return file;
}
