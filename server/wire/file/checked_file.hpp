#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/wire/file/digest.hpp"

namespace isthmus {

/// A file of this program's own: its kind, the version of its form, and a SHA-256 of what it holds.
struct FileForm {
  std::string_view kind;  ///< at most 16 characters, the first of the file
  std::uint32_t version = 1;
};

/// Writes it complete or not at all. Returns the SHA-256 of the content. Throws std::runtime_error naming the
/// file and the reason.
Digest write_checked_file(const std::string& path, const FileForm& form,
                          std::span<const std::uint8_t> content);

/// What such a file holds, and the SHA-256 of that.
struct CheckedContent {
  std::vector<std::uint8_t> bytes;
  Digest sha256{};
};

/// Throws std::runtime_error naming the file and the reason: it cannot be read, is of another
/// kind or version, or is damaged.
CheckedContent read_checked_file(const std::string& path, const FileForm& form);

/// Whether a file begins as one of that kind.
bool is_of_kind(const std::string& path, const FileForm& form);

}  // namespace isthmus
