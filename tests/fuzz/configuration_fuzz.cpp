#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "server/engine/input/configuration.hpp"

/// Input: a configuration file. Whatever it is, it is taken, or refused with an error that names the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto parsed = isthmus::parse_configuration({reinterpret_cast<const char*>(data), size}, "c.toml");
  const std::string* error = std::get_if<std::string>(&parsed);
  if (error && !error->starts_with("c.toml:")) std::abort();
  return 0;
}
