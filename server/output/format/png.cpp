#include "server/output/format/png.hpp"

#include <png.h>

#include <stdexcept>

namespace isthmus {
namespace {

std::string encode(png_image& image, const std::vector<std::uint8_t>& pixels) {
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0) {
    const std::string reason = image.message;
    png_image_free(&image);
    throw std::runtime_error("cannot be encoded as PNG: " + reason);
  }
  bytes.resize(size);
  return bytes;
}

png_image image_of(int width, int height, png_uint_32 format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  return image;
}

}  // namespace

std::string grey_png(int width, int height, const std::vector<std::uint8_t>& pixels) {
  png_image image = image_of(width, height, PNG_FORMAT_GRAY);
  return encode(image, pixels);
}

}  // namespace isthmus
