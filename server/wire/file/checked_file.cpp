#include "server/wire/file/checked_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "server/output/format/atomic_file.hpp"
#include "server/wire/file/file_bytes.hpp"

namespace isthmus {
namespace {

/// How such a file begins, little-endian.
struct Header {
  std::array<char, 16> kind = {};
  std::uint32_t version = 0;
  std::uint32_t zero = 0;
  std::uint64_t content_bytes = 0;
  Digest sha256 = {};
};
static_assert(sizeof(Header) == 64 && std::endian::native == std::endian::little);

std::array<char, 16> padded(std::string_view kind) {
  std::array<char, 16> padded{};
  std::ranges::copy(kind.substr(0, padded.size()), padded.begin());
  return padded;
}

Header read_header(FileBytes& file) {
  Header header;
  const auto bytes = file.at(0, sizeof header);
  if (bytes.size() == sizeof header) std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

std::string_view as_text(const void* bytes, std::size_t size) {
  return {static_cast<const char*>(bytes), size};
}

}  // namespace

Digest write_checked_file(const std::string& path, const FileForm& form,
                          std::span<const std::uint8_t> content) {
  Header header;
  header.kind = padded(form.kind);
  header.version = form.version;
  header.content_bytes = content.size();
  header.sha256 = sha256(content);
  AtomicFile file(path);
  file.write(as_text(&header, sizeof header));
  file.write(as_text(content.data(), content.size()));
  file.commit();
  return header.sha256;
}

CheckedContent read_checked_file(const std::string& path, const FileForm& form) {
  FileBytes file(path);
  const Header header = read_header(file);
  const auto fail = [&](const std::string& why) { throw std::runtime_error(path + ": " + why); };
  if (header.kind != padded(form.kind)) fail("no file of kind " + std::string(form.kind));
  if (header.version != form.version) {
    fail("is of version " + std::to_string(header.version) + "; this program reads version " +
         std::to_string(form.version));
  }
  const auto size = static_cast<std::uint64_t>(file.size()) - sizeof header;
  if (header.content_bytes != size || header.zero != 0) fail("is damaged: its size is not what it says");
  const auto bytes = file.at(sizeof header, static_cast<std::int64_t>(size));
  if (bytes.size() != size || sha256(bytes) != header.sha256) fail("is damaged: its checksum is another");
  return {{bytes.begin(), bytes.end()}, header.sha256};
}

bool is_of_kind(const std::string& path, const FileForm& form) {
  FileBytes file(path);
  return read_header(file).kind == padded(form.kind);
}

}  // namespace isthmus
