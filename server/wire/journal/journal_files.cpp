#include "server/wire/journal/journal_files.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace isthmus {
namespace {

namespace fs = std::filesystem;

std::string numbered(const std::string& kind, int number, const std::string& extension) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "%06d", number);
  return kind + "-" + digits + extension;
}

std::string in(const std::string& directory, const std::string& name) {
  return (fs::path(directory) / name).string();
}

/// The number in "kind-000012.extension"; 0 where the name is not of that form.
int number_of(const std::string& name, const std::string& kind, const std::string& extension) {
  if (name.size() <= kind.size()) return 0;
  int number = 0;
  std::from_chars(name.data() + kind.size() + 1, name.data() + name.size(), number);
  return number > 0 && numbered(kind, number, extension) == name ? number : 0;
}

std::string not_of_a_journal(const std::string& directory, const std::string& file) {
  return directory + ": holds " + file + ", which is no segment of a journal; give another directory";
}

}  // namespace

JournalFiles list_journal(const std::string& directory) {
  JournalFiles files;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::string path = entry->path().string();
    if (const int segment = number_of(name, "journal", ".lcm"))
      files.segments.emplace(segment, path);
    else if (const int after = number_of(name, "snapshot", ".isthmus"))
      files.snapshots.emplace(after, path);
    else if (entry->path().extension() == ".lcm")
      throw std::runtime_error(not_of_a_journal(directory, name));
  }
  if (error) throw std::runtime_error(directory + ": " + error.message());
  return files;
}

bool is_journal(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return false;
  try {
    return !list_journal(path).segments.empty();
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::string segment_path(const std::string& directory, int segment) {
  return in(directory, numbered("journal", segment, ".lcm"));
}
std::string snapshot_path(const std::string& directory, int segment) {
  return in(directory, numbered("snapshot", segment, ".isthmus"));
}
std::string trajectory_path(const std::string& directory, int segment) {
  return in(directory, numbered("trajectory", segment, ".isthmus"));
}

}  // namespace isthmus
