// SPDX-License-Identifier: Apache-2.0
#include "compositor/encode.h"

#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <zstd.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace goldthread {
namespace {

using Rgb = std::vector<std::uint8_t>;

Rgb smooth(ImageSize size) {
  Rgb rgb;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      rgb.push_back(static_cast<std::uint8_t>(127 + 100 * std::sin(0.02 * x)));
      rgb.push_back(static_cast<std::uint8_t>(127 + 100 * std::cos(0.03 * y)));
      rgb.push_back(static_cast<std::uint8_t>(127 + 80 * std::sin(0.01 * (x + y))));
    }
  }
  return rgb;
}

Rgb noise(ImageSize size) {
  std::mt19937 random(1);
  Rgb rgb(3 * std::size_t(size.width) * std::size_t(size.height));
  for (auto& value : rgb) value = static_cast<std::uint8_t>(random());
  return rgb;
}

Rgb decode_zstd(const Buffer& bytes, std::size_t size) {
  Rgb rgb(size + 1);  // one more, to see that there is no more
  const std::size_t length = ZSTD_decompress(rgb.data(), rgb.size(), bytes.data(), bytes.size());
  EXPECT_FALSE(ZSTD_isError(length));
  rgb.resize(std::min(length, rgb.size()));
  return rgb;
}

Rgb decode_jpeg(const Buffer& bytes, ImageSize size) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  Rgb rgb(3 * std::size_t(size.width) * std::size_t(size.height));
  int width = 0, height = 0, subsampling = 0, colorspace = 0;
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  EXPECT_EQ(tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling,
                                &colorspace),
            0);
  EXPECT_EQ((ImageSize{width, height}), size);
  EXPECT_EQ(
      tjDecompress2(decoder.get(), data, bytes.size(), rgb.data(), width, 0, height, TJPF_RGB, 0),
      0);
  return rgb;
}

double psnr_db(const Rgb& a, const Rgb& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum);
}

const ImageSize kSizes[] = {{1, 1}, {1, 100}, {317, 1}, {17, 33}, {512, 256}};

TEST(Encode, ZstdIsExact) {
  for (const ImageSize size : kSizes) {
    for (const Rgb& rgb : {smooth(size), noise(size)}) {
      EXPECT_EQ(decode_zstd(encode_pixels(rgb, size, Encoding::kZstdRgb), rgb.size()), rgb);
    }
  }
}

TEST(Encode, JpegOfASmoothPictureIsAbove40Decibels) {
  const ImageSize size{512, 256};
  const Rgb rgb = smooth(size);
  const Buffer bytes = encode_pixels(rgb, size, Encoding::kJpeg);
  EXPECT_GT(psnr_db(rgb, decode_jpeg(bytes, size)), 40);
  EXPECT_LT(bytes.size(), rgb.size() / 8);
}

TEST(Encode, JpegHoldsAnySizeAndNoise) {
  for (const ImageSize size : kSizes) {
    for (const Rgb& rgb : {smooth(size), noise(size)}) {
      decode_jpeg(encode_pixels(rgb, size, Encoding::kJpeg), size);
    }
  }
}

}  // namespace
}  // namespace goldthread
