#include "render/image/image_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <memory>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <OpenEXRConfig.h>
#include <fmt/format.h>
#include <png.h>

#include "core/base/check.h"
#include "core/base/error.h"
#include "render/image/image_library_versions.h"
#include "render/image/png_file.h"
#include "render/image/radiance_file.h"
#include "render/image/unreadable_picture.h"
#include "render/image/view_transform.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_LINEAR
#include <stb/stb_image.h>

namespace softreel {

namespace {

/// Collects what OpenEXR writes.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}

  void write(const char data[], int size) override {
    const auto end = position_ + static_cast<std::size_t>(size);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, data, static_cast<std::size_t>(size));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = static_cast<std::size_t>(position); }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t position_ = 0;
};

std::size_t pixel_count(int width, int height) {
  CHECK(width > 0);
  CHECK(height > 0);
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

/// A slice over one channel; the first pixel of the data window is pixels[0].
Imf::Slice float_slice(const Channel& channel, int width, const Imath::Box2i& window) {
  auto* pixels = const_cast<float*>(channel.pixels.data());  // OpenEXR has one slice type for reading and writing
  return Imf::Slice::Make(Imf::FLOAT, pixels, window, sizeof(float), sizeof(float) * static_cast<std::size_t>(width));
}

/// Height x width x 4.
std::vector<std::uint8_t> interleaved(const DisplayImage& image) {
  CHECK(image.alpha.size() == pixel_count(image.width, image.height));
  std::vector<std::uint8_t> pixels;
  pixels.reserve(4 * image.alpha.size());
  for (std::size_t k = 0; k < image.alpha.size(); ++k) {
    for (std::size_t c = 0; c < 3; ++c) pixels.push_back(image.pixels[3 * k + c]);
    pixels.push_back(image.alpha[k]);
  }
  return pixels;
}

std::string ending(const std::string& path) {
  const auto dot = path.rfind('.');
  std::string end = dot == std::string::npos ? "" : path.substr(dot + 1);
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end;
}

EnvironmentImage from_display(const DisplayImage& display) {
  EnvironmentImage image{display.width, display.height, {}};
  image.pixels.reserve(pixel_count(display.width, display.height));
  for (std::size_t k = 0; k < pixel_count(display.width, display.height); ++k) {
    const float seen = display.alpha.empty() ? 1.0f : static_cast<float>(display.alpha[k]) / 255;
    const auto linear = [&](std::size_t c) {
      const float code = static_cast<float>(display.pixels[3 * k + c]) / 255;
      return seen * (display.linear ? code : srgb_decode(code));
    };
    image.pixels.emplace_back(linear(0), linear(1), linear(2));
  }
  return image;
}

/// A small file may claim any size.
void require_size(std::int64_t width, std::int64_t height, const std::string& path) {
  constexpr double kMostPixels = 1 << 28;
  if (width < 1 || height < 1 || static_cast<double>(width) * static_cast<double>(height) > kMostPixels)
    throw unreadable_picture(path, fmt::format("its display window has {} x {} pixels", width, height),
                             "an EXR of at most 268 million pixels");
}

/// Of the display window.
std::pair<int, int> exr_size(const std::string& path) {
  std::int64_t width = 0, height = 0;
  try {
    const Imath::Box2i full = Imf::InputFile(path.c_str()).header().displayWindow();
    width = std::int64_t{full.max.x} - full.min.x + 1;
    height = std::int64_t{full.max.y} - full.min.y + 1;
  } catch (const std::exception& failure) {
    throw unreadable_picture(path, failure.what(), "a scan-line EXR picture");
  }
  require_size(width, height, path);
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// All of the picture, black where the file has no data; what lies beyond the picture is left out.
Image whole_picture(Image image, const std::string& path) {
  require_size(image.full_width, image.full_height, path);
  if (image.left == 0 && image.top == 0 && image.width == image.full_width && image.height == image.full_height)
    return image;
  Image whole{image.full_width, image.full_height, {}};
  for (const Channel& channel : image.channels) {
    Channel& pasted = whole.channels.emplace_back(
        Channel{channel.name, std::vector<float>(pixel_count(whole.width, whole.height), 0.0f)});
    for (int y = std::max(0, image.top); y < std::min(whole.height, image.top + image.height); ++y)
      for (int x = std::max(0, image.left); x < std::min(whole.width, image.left + image.width); ++x)
        pasted
            .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(whole.width) + static_cast<std::size_t>(x)] =
            channel.pixels[static_cast<std::size_t>(y - image.top) * static_cast<std::size_t>(image.width) +
                           static_cast<std::size_t>(x - image.left)];
  }
  return whole;
}

EnvironmentImage from_channels(const Image& image, const std::string& path) {
  const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
  if (r == nullptr || g == nullptr || b == nullptr)
    throw unreadable_picture(path, "it lacks one of the channels R, G, B", "an EXR with colour channels");
  EnvironmentImage out{image.width, image.height, {}};
  out.pixels.reserve(r->pixels.size());
  for (std::size_t k = 0; k < r->pixels.size(); ++k) out.pixels.emplace_back(r->pixels[k], g->pixels[k], b->pixels[k]);
  return out;
}

using StbPixels = std::unique_ptr<void, decltype(&stbi_image_free)>;

/// 16 bits a value, as stored: libpng's simple reader would take them through the file's gamma, which data do not have.
TexturePicture read_png_16(const std::string& path) {
  int width = 0, height = 0, components = 0;
  stbi_us* data = stbi_load_16(path.c_str(), &width, &height, &components, 3);
  const StbPixels owner(data, &stbi_image_free);
  if (data == nullptr) throw unreadable_picture(path, stbi_failure_reason(), "a complete PNG picture");
  TexturePicture picture{width, height, {}, 16};
  for (std::size_t k = 0; k < pixel_count(width, height); ++k)
    picture.pixels.push_back(Vec3f(data[3 * k], data[3 * k + 1], data[3 * k + 2]) / 65535);
  return picture;
}

/// PNG or JPEG: the numbers of its colours as they are stored, whatever gamma or transparency the file tells. values:
/// of a pixel, 4 with its alpha.
DisplayImage read_stored(const std::string& path, const char* kind, int values = 3) {
  int width = 0, height = 0, components = 0;
  stbi_uc* data = stbi_load(path.c_str(), &width, &height, &components, values);
  const StbPixels owner(data, &stbi_image_free);
  if (data == nullptr) throw unreadable_picture(path, stbi_failure_reason(), kind);
  return {width, height, {data, data + static_cast<std::size_t>(values) * pixel_count(width, height)}};
}

/// Whether a PNG says that its values are linear.
bool has_linear_values(const std::string& path) {
  std::array<std::uint8_t, 64> beginning{};
  std::ifstream(path, std::ios::binary)
      .read(reinterpret_cast<char*>(beginning.data()), static_cast<std::streamsize>(beginning.size()));
  return is_linear_png(beginning);
}

void require_finite(const EnvironmentImage& image, const std::string& path) {
  for (std::size_t k = 0; k < image.pixels.size(); ++k)
    if (!image.pixels[k].allFinite() || image.pixels[k].minCoeff() < 0)
      throw input_error(
          fmt::format("{}: pixel ({}, {}) has the radiance ({}, {}, {}), which no light has.\n"
                      "  Accepted: finite numbers of 0 or more. Repair the picture, for example by clamping it.",
                      path, k % static_cast<std::size_t>(image.width), k / static_cast<std::size_t>(image.width),
                      image.pixels[k].x(), image.pixels[k].y(), image.pixels[k].z()));
}

}  // namespace

std::vector<std::uint8_t> encode_png(const DisplayImage& image, const Threads* threads) {
  CHECK(image.pixels.size() == 3 * pixel_count(image.width, image.height));
  const PngValues values = image.linear ? PngValues::Linear : PngValues::Srgb;
  if (image.alpha.empty()) return png_file(image.width, image.height, 3, image.pixels, values, threads);
  return png_file(image.width, image.height, 4, interleaved(image), values, threads);
}

std::vector<std::uint8_t> encode_exr(const Image& image) {
  MemoryStream stream;
  try {
    const Imath::Box2i window({image.left, image.top}, {image.left + image.width - 1, image.top + image.height - 1});
    const bool is_whole = image.full_width == 0;
    const Imath::Box2i full({0, 0}, {image.full_width - 1, image.full_height - 1});
    Imf::Header header(is_whole ? window : full, window);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const auto& [name, text] : image.attributes) header.insert(name, Imf::StringAttribute(text));
    Imf::FrameBuffer frame;
    for (const Channel& channel : image.channels) {
      CHECK(channel.pixels.size() == pixel_count(image.width, image.height));
      header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
      frame.insert(channel.name, float_slice(channel, image.width, header.dataWindow()));
    }
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  } catch (const std::exception& failure) {
    throw work_error(fmt::format("Compressing an EXR of {} x {} pixels failed: {}.\n  Free some memory and run again.",
                                 image.width, image.height, failure.what()));
  }
  return stream.take();
}

DisplayImage over_grey(DisplayImage image) {
  constexpr int kGrey = 128;
  for (std::size_t k = 0; k < image.alpha.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint8_t& value = image.pixels[3 * k + c];
      value = static_cast<std::uint8_t>((value * image.alpha[k] + kGrey * (255 - image.alpha[k]) + 127) / 255);
    }
  image.alpha.clear();
  return image;
}

DisplayImage read_png(const std::string& path) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&header, path.c_str()) == 0)
    throw unreadable_picture(path, header.message, "a PNG picture");
  const bool has_alpha = (header.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  header.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;  // as those of 8 bits, where the file names no gamma
  header.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  DisplayImage image{static_cast<int>(header.width), static_cast<int>(header.height), {}};
  const std::size_t pixels = pixel_count(image.width, image.height), values = has_alpha ? 4 : 3;
  image.linear = has_linear_values(path);
  if (image.linear) {  // libpng would take them through the sRGB curve
    png_image_free(&header);
    image.pixels = read_stored(path, "a complete PNG picture", static_cast<int>(values)).pixels;
  } else {
    image.pixels.resize(values * pixels);
    if (png_image_finish_read(&header, nullptr, image.pixels.data(), 0, nullptr) == 0)
      throw unreadable_picture(path, header.message, "a complete PNG picture");
  }
  if (!has_alpha) return image;
  image.alpha.resize(pixels);
  for (std::size_t k = 0; k < pixels; ++k) {
    std::copy_n(image.pixels.begin() + static_cast<std::ptrdiff_t>(4 * k), 3,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(3 * k));
    image.alpha[k] = image.pixels[4 * k + 3];
  }
  image.pixels.resize(3 * pixels);
  return image;
}

Image read_exr(const std::string& path) {
  try {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    Image image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}};
    const Imath::Box2i full = file.header().displayWindow();
    image.left = window.min.x - full.min.x;
    image.top = window.min.y - full.min.y;
    image.full_width = full.max.x - full.min.x + 1;
    image.full_height = full.max.y - full.min.y + 1;
    const std::size_t pixels = pixel_count(image.width, image.height);
    for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c)
      image.channels.push_back({c.name(), std::vector<float>(pixels)});
    for (auto a = file.header().begin(); a != file.header().end(); ++a)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
        image.attributes[a.name()] = text->value();
    Imf::FrameBuffer frame;
    for (const Channel& channel : image.channels) frame.insert(channel.name, float_slice(channel, image.width, window));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return image;
  } catch (const std::exception& failure) {
    throw unreadable_picture(path, failure.what(), "a scan-line EXR picture");
  }
}

TexturePicture read_texture_picture(const std::string& path) {
  const std::string end = ending(path);
  const auto of_display = [](const DisplayImage& image) {
    TexturePicture picture{image.width, image.height, {}, 8};
    for (std::size_t k = 0; k < image.pixels.size(); k += 3)
      picture.pixels.push_back(Vec3f(image.pixels[k], image.pixels[k + 1], image.pixels[k + 2]) / 255);
    return picture;
  };
  const auto of_numbers = [](EnvironmentImage image) {
    return TexturePicture{image.width, image.height, std::move(image.pixels), 32};
  };
  if (end == "png")
    return stbi_is_16_bit(path.c_str()) != 0 ? read_png_16(path)
                                             : of_display(read_stored(path, "a complete PNG picture"));
  if (end == "jpg" || end == "jpeg") return of_display(read_stored(path, "a JPEG picture"));
  if (end == "hdr") return of_numbers(read_radiance(path));
  if (end != "exr")
    throw unreadable_picture(path, fmt::format("'.{}' names no known format", end),
                             "files ending in .exr, .hdr, .png, .jpg, .jpeg");
  Image image = whole_picture(read_exr(path), path);
  if (const Channel* grey = image.find("Y"); grey != nullptr && image.find("R") == nullptr) {
    const std::vector<float> values = grey->pixels;
    image.channels = {{"R", values}, {"G", values}, {"B", values}};
  }
  return of_numbers(from_channels(image, path));
}

std::pair<int, int> picture_size(const std::string& path) {
  const std::string end = ending(path);
  if (end == "hdr") return radiance_size(path);
  if (end == "exr") return exr_size(path);
  int width = 0, height = 0, components = 0;
  if (stbi_info(path.c_str(), &width, &height, &components) == 0)
    throw unreadable_picture(path, stbi_failure_reason(), "files ending in .exr, .hdr, .png, .jpg, .jpeg");
  return {width, height};
}

EnvironmentImage read_environment(const std::string& path) {
  const std::string end = ending(path);
  EnvironmentImage image;
  if (end == "exr")
    image = from_channels(whole_picture(read_exr(path), path), path);
  else if (end == "hdr")
    image = read_radiance(path);
  else if (end == "png")
    image = from_display(read_png(path));
  else if (end == "jpg" || end == "jpeg")
    image = from_display(read_stored(path, "a JPEG picture"));
  else
    throw unreadable_picture(path, fmt::format("'.{}' names no known format", end),
                             "files ending in .exr, .hdr, .png, .jpg, .jpeg");
  require_finite(image, path);
  return image;
}

std::vector<ImageLibraryVersion> image_library_versions() {
  return {{"OpenEXR", OPENEXR_VERSION_STRING, false}, {"libpng", png_get_libpng_ver(nullptr), true}};
}

}  // namespace softreel
