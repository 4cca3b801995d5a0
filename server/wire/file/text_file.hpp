#pragma once

#include <string>

namespace isthmus {

/// Reads a text that a user wrote. Throws std::runtime_error naming the file and the reason: it cannot be
/// read, or is a directory, a pipe or anything else but a regular file, which would be taken for an empty one
/// or wait for somebody to write.
std::string read_text_file(const std::string& path);

/// For a file that holds keys. Throws std::runtime_error naming the file and what to do where others may
/// write it: they could put keys of their own there. Returns a warning where they may read it; else nothing.
std::string check_key_file(const std::string& path);

}  // namespace isthmus
