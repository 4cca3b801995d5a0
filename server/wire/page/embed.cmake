# Writes files into a C++ source: cmake -DOUTPUT=asset.cpp -DFILES=PATH=FILE;... -P embed.cmake
# asset.hpp declares what it defines.
set(types ".html=text/html; charset=utf-8" ".css=text/css" ".js=text/javascript" ".svg=image/svg+xml")
set(arrays "")
set(rows "")
set(number 0)
foreach(entry IN LISTS FILES)
  string(REGEX MATCH "^([^=]+)=(.+)$" _ "${entry}")
  set(path "${CMAKE_MATCH_1}")
  set(file "${CMAKE_MATCH_2}")
  file(READ "${file}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(....,....,....,....,....,....,....,....,....,....,....,....,....,....,....,....,)" "\\1\n" bytes "${bytes}")
  get_filename_component(extension "${file}" LAST_EXT)
  set(type "")
  foreach(known IN LISTS types)
    string(FIND "${known}" "${extension}=" at)
    if(at EQUAL 0)
      string(REPLACE "${extension}=" "" type "${known}")
    endif()
  endforeach()
  if(type STREQUAL "")
    message(FATAL_ERROR "${file}: no content type is known for ${extension}")
  endif()
  string(APPEND arrays "const unsigned char bytes${number}[] = {\n${bytes}};\n")
  string(APPEND rows "    {\"${path}\", \"${type}\", text(bytes${number})},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "// Made by embed.cmake.
#include \"server/wire/page/http/asset.hpp\"

#include <array>
#include <cstddef>

namespace isthmus {
namespace {

${arrays}
template <std::size_t size>
std::string_view text(const unsigned char (&bytes)[size]) {
  return {reinterpret_cast<const char*>(bytes), size};
}

const std::array<Asset, ${number}>& assets() {
  static const std::array<Asset, ${number}> all = {{
${rows}  }};
  return all;
}

}  // namespace

const Asset* find_asset(std::string_view path) {
  if (path == \"/\") path = \"/index.html\";
  for (const Asset& asset : assets())
    if (asset.path == path) return &asset;
  return nullptr;
}

}  // namespace isthmus
")
