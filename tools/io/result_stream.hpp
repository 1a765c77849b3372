// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "io/descriptor.hpp"

namespace io {

/// A file that grows by one piece of text per finished piece of work, so that nothing is lost when the program is
/// interrupted.  Memory holds the places of the pieces, not their text.  Safe to use from several threads.
class ResultStream {
 public:
  /// Writes header and the pieces kept from an earlier run, then leaves the file open for more.
  /// @param header  whole lines
  /// @param kept    finished pieces by key, whole lines
  /// @throws std::invalid_argument  the file cannot be written, is no regular file, or another program has it open.
  ResultStream(std::string path, const std::string& header, const std::map<std::string, std::string>& kept);
  /// Goes on with the file of an interrupted run; begins it where there is none.  Each piece is followed by a line
  /// "# piece: KEY REMARK FINGERPRINT", which tells a finished one from one that was cut off; keys hold no blank.
  /// @throws std::invalid_argument  also where the file begins otherwise than with the header; it is then untouched.
  ResultStream(std::string path, const std::string& header);
  ResultStream(const ResultStream&) = delete;
  ResultStream& operator=(const ResultStream&) = delete;

  [[nodiscard]] bool contains(const std::string& key) const;
  /// Number of pieces.
  [[nodiscard]] std::size_t size() const;
  /// Text of a piece, read from the file.
  /// @throws std::out_of_range;  std::runtime_error  the file cannot be read.
  [[nodiscard]] std::string text(const std::string& key) const;
  /// What was said of a piece when it was appended.
  /// @throws std::out_of_range
  [[nodiscard]] std::string remark(const std::string& key) const;
  /// The piece reaches the file before this returns.
  /// @param text    whole lines
  /// @param remark  kept beside a piece that is followed by a line of its own: short, no blank, no end of line
  /// @throws std::runtime_error  the disk is full or the like; the file then holds whole pieces all the same, and takes
  ///                             no more.
  void append(const std::string& key, const std::string& text, const std::string& remark = "");
  /// Replaces the file by its final content, whole or not at all.
  void finish(const std::string& content);
  /// Removes the file, as its content stands elsewhere.
  void remove();

 private:
  struct Place {
    std::size_t begin, size;
    std::string remark;
  };
  void scan(const std::string& header);

  std::string path_;
  bool has_marks_;
  std::map<std::string, Place> pieces_;
  mutable std::mutex mutex_;
  Descriptor file_;
  std::size_t size_ = 0;  // bytes of the whole pieces in the file
  std::string failure_;   // why nothing more is written; empty: it is
};

}  // namespace io
