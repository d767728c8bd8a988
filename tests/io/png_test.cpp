#include "pingvox/io/png.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <random>
#include <sstream>
#include <vector>

using namespace pingvox;

namespace {

void expect_read_by_libpng(const std::string& bytes, png_uint_32 format, std::size_t width, std::size_t height,
                           const std::vector<std::uint8_t>& pixels) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(image.width, width);
  EXPECT_EQ(image.height, height);
  EXPECT_EQ(image.format, format);
  std::vector<std::uint8_t> read(pixels.size());
  ASSERT_NE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr), 0) << image.message;
  EXPECT_EQ(read, pixels);
}

TEST(Png, IsReadBackByLibpngPixelForPixel) {
  std::size_t pixels = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::size_t width = seed == 1 ? 1 : random() % 200 + 1, height = seed == 1 ? 1 : random() % 200 + 1;
    std::vector<std::uint8_t> rgb(width * height * 3);
    for (auto& value : rgb) value = static_cast<std::uint8_t>(random() % 5 * 60);
    std::ostringstream out;
    ASSERT_TRUE(write_png(width, height, rgb, out));
    expect_read_by_libpng(out.str(), PNG_FORMAT_RGB, width, height, rgb);
    pixels += width * height;
  }
  EXPECT_GT(pixels, 10'000U);
}

TEST(Png, InGreyIsReadBackByLibpngWithItsAlpha) {
  std::mt19937_64 random(5);
  const std::size_t width = 37, height = 11;
  std::vector<std::uint8_t> pixels(width * height * 2);
  for (auto& value : pixels) value = static_cast<std::uint8_t>(random());
  std::ostringstream out;
  ASSERT_TRUE(write_grey_png(width, height, pixels, out));
  expect_read_by_libpng(out.str(), PNG_FORMAT_GA, width, height, pixels);
}

TEST(Png, SaysWhenTheStreamIsBad) {
  std::ostringstream out;
  out.setstate(std::ios::badbit);
  const auto done = write_png(1, 1, std::vector<std::uint8_t>(3), out);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, Error::Code::kIo);
}

}  // namespace
