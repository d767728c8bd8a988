#include "pingvox/io/png.hpp"

#include <png.h>

#include <cassert>
#include <csetjmp>
#include <limits>

namespace pingvox {
namespace {

/// What the bytes of a pixel are.
struct PngColour {
  int type;
  std::size_t channels;
};

void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto& out = *static_cast<std::ostream*>(png_get_io_ptr(png));
  out.write(reinterpret_cast<const char*>(bytes), static_cast<std::streamsize>(count));
  if (!out) png_error(png, "the stream is bad");
}

void flush(png_structp) {}

// By default libpng prints its errors.
[[noreturn]] void raise_error(png_structp png, png_const_charp) {
  png_longjmp(png, 1);
}
void ignore_warning(png_structp, png_const_charp) {}

/// false on an error of libpng, which leaves by longjmp: no local variable may need a destructor.
bool encode(png_structp png, png_infop info, std::size_t width, std::size_t height, const std::uint8_t* pixels,
            const PngColour& colour, std::ostream& out) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, &out, write_bytes, flush);
  // On pictures like ours nine times as fast as the default, and no larger.
  png_set_compression_level(png, 1);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_user_limits(png, std::numeric_limits<png_uint_32>::max() / 2, std::numeric_limits<png_uint_32>::max() / 2);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, colour.type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  for (std::size_t row = 0; row < height; ++row) png_write_row(png, pixels + row * width * colour.channels);
  png_write_end(png, info);
  return true;
}

Result<void> write_picture(std::size_t width, std::size_t height, std::span<const std::uint8_t> pixels,
                           const PngColour& colour, std::ostream& out) {
  assert(width > 0 && width < (std::size_t{1} << 31) && height > 0 && height < (std::size_t{1} << 31));
  assert(pixels.size() == width * height * colour.channels);
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, raise_error, ignore_warning);
  if (png == nullptr) return fail(Error::Code::kNoMemory, "out of memory: the picture was not written");
  png_infop info = png_create_info_struct(png);
  const bool done = info != nullptr && encode(png, info, width, height, pixels.data(), colour, out);
  png_destroy_write_struct(&png, &info);
  if (!done) return fail(Error::Code::kIo, "the picture could not be written");
  return {};
}

}  // namespace

Result<void> write_png(std::size_t width, std::size_t height, std::span<const std::uint8_t> rgb, std::ostream& out) {
  return write_picture(width, height, rgb, {PNG_COLOR_TYPE_RGB, 3}, out);
}

Result<void> write_grey_png(std::size_t width, std::size_t height, std::span<const std::uint8_t> grey_alpha,
                            std::ostream& out) {
  return write_picture(width, height, grey_alpha, {PNG_COLOR_TYPE_GRAY_ALPHA, 2}, out);
}

}  // namespace pingvox
