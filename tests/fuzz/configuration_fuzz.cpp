#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string_view>

#include "server/wire/message/server_configuration.hpp"

/// Input: a configuration file. Whatever it is, it is taken, or refused with an error that names the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    isthmus::parse_server_configuration({reinterpret_cast<const char*>(data), size}, "c.toml");
  } catch (const std::runtime_error& error) {
    if (!std::string_view(error.what()).starts_with("c.toml:")) std::abort();
  }
  return 0;
}
