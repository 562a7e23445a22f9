#include "assets/generator/rig.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <fmt/format.h>

namespace softreel::sculpt {
namespace {

/// 0 before `from`, 1 after `to`, at rest at both.
double ramp(double frame, double from, double to) {
  const double t = std::clamp((frame - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Rises over 4 frames after `from` and falls over 4 before `to`.
double during(double frame, double from, double to) {
  return ramp(frame, from, from + 4) * (1 - ramp(frame, to - 4, to));
}

double wave(double frame, double from, double period) {
  return std::sin(2 * std::numbers::pi * (frame - from) / period);
}

Quaternion turned(double x, double y, double z) {
  constexpr double kDegree = std::numbers::pi / 180;
  return Quaternion(Eigen::AngleAxisd(z * kDegree, Vec3::UnitZ()) * Eigen::AngleAxisd(y * kDegree, Vec3::UnitY()) *
                    Eigen::AngleAxisd(x * kDegree, Vec3::UnitX()));
}

/// Numbers of one accessor after the other.
class Numbers {
 public:
  int add(const std::vector<float>& numbers, int width) {
    const char* comma = count_ > 0 ? "," : "";
    const std::size_t size = numbers.size() * sizeof(float), at = bytes_.size();
    views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})", comma, at, size);
    std::string bounds;
    if (width == 1) bounds = fmt::format(R"(,"min":[{}],"max":[{}])", numbers.front(), numbers.back());
    accessors_ += fmt::format(R"({}{{"bufferView":{},"componentType":5126,"count":{},"type":"{}"{}}})", comma, count_,
                              numbers.size() / static_cast<std::size_t>(width),
                              width == 1 ? "SCALAR" : fmt::format("VEC{}", width), bounds);
    bytes_.resize(at + size);
    std::memcpy(bytes_.data() + at, numbers.data(), size);
    return count_++;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  const std::string& views() const { return views_; }
  const std::string& accessors() const { return accessors_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::string views_, accessors_;
  int count_ = 0;
};

/// A clip's channels and samplers.
struct Clip {
  std::string channels, samplers;
  int count = 0;

  void add(std::size_t node, const char* path, int input, int output) {
    const char* comma = count > 0 ? "," : "";
    channels += fmt::format(R"({}{{"sampler":{},"target":{{"node":{},"path":"{}"}}}})", comma, count, node, path);
    samplers += fmt::format(R"({}{{"input":{},"output":{},"interpolation":"LINEAR"}})", comma, input, output);
    ++count;
  }
};

void put(std::vector<std::uint8_t>& out, std::uint32_t word) {
  for (unsigned k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(word >> (8 * k)));
}

/// A chunk of a .glb file, filled up to four bytes.
void put_chunk(std::vector<std::uint8_t>& out, std::uint32_t type, std::vector<std::uint8_t> bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(static_cast<std::uint8_t>(filler));
  put(out, static_cast<std::uint32_t>(bytes.size()));
  put(out, type);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::vector<float> rotations(const Rig& rig, const RigNode& node) {
  std::vector<float> numbers;
  for (int frame = 0; frame <= rig.frames; ++frame) {
    const Quaternion q = node.turn(frame);
    for (const double x : {q.x(), q.y(), q.z(), q.w()}) numbers.push_back(static_cast<float>(x));
  }
  return numbers;
}

std::vector<float> translations(const Rig& rig, const RigNode& node) {
  std::vector<float> numbers;
  for (int frame = 0; frame <= rig.frames; ++frame)
    for (const double x : (node.place + node.move(frame)).eval()) numbers.push_back(static_cast<float>(x));
  return numbers;
}

}  // namespace

Rig make_puppet() {
  Rig rig;
  rig.name = "puppet";
  rig.clip = "hello";
  rig.frames = 72;
  // Looks round to the raised arm, then to the other side, and nods twice.
  rig.nodes.push_back(
      {"head", Vec3(0, 0.66, 0.02),
       [](double f) {
         const double look = -24 * during(f, 4, 26) + 20 * during(f, 26, 44);
         const double nod = 15 * during(f, 44, 70) * wave(f, 44, 13);
         return turned(nod, look, -9 * during(f, 4, 26));
       },
       [](double f) { return Vec3(-0.03 * during(f, 4, 26) + 0.03 * during(f, 26, 44), 0.02 * during(f, 2, 44), 0); }});
  // Waves three times.
  rig.nodes.push_back({"right_arm", Vec3(-0.11, 0.505, 0.0),
                       [](double f) { return turned(0, 0, -16 * during(f, 2, 34) * (1 + wave(f, 4, 10)) / 1.4); },
                       [](double f) { return Vec3(0, 0.03 * during(f, 2, 34), 0); }});
  return rig;
}

std::vector<std::uint8_t> encode_glb(const Rig& rig) {
  Numbers numbers;
  Clip clip;
  std::vector<float> times;
  for (int frame = 0; frame <= rig.frames; ++frame) times.push_back(static_cast<float>(frame / rig.fps));
  const int input = numbers.add(times, 1);
  std::string nodes, roots;
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const RigNode& node = rig.nodes[n];
    const char* comma = n > 0 ? "," : "";
    nodes += fmt::format(R"({}{{"name":"{}","translation":[{},{},{}]}})", comma, node.name, node.place.x(),
                         node.place.y(), node.place.z());
    roots += fmt::format("{}{}", comma, n);
    clip.add(n, "rotation", input, numbers.add(rotations(rig, node), 4));
    clip.add(n, "translation", input, numbers.add(translations(rig, node), 3));
  }
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"softreel make_assets"}},"scene":0,"scenes":[{{"nodes":[{}]}}],)"
      R"("nodes":[{}],"animations":[{{"name":"{}","channels":[{}],"samplers":[{}]}}],)"
      R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}})",
      roots, nodes, rig.clip, clip.channels, clip.samplers, numbers.bytes().size(), numbers.views(),
      numbers.accessors());
  std::vector<std::uint8_t> chunks;
  put_chunk(chunks, 0x4E4F534A, {json.begin(), json.end()}, ' ');
  put_chunk(chunks, 0x004E4942, numbers.bytes(), '\0');
  std::vector<std::uint8_t> file;
  put(file, 0x46546C67);
  put(file, 2);
  put(file, static_cast<std::uint32_t>(12 + chunks.size()));
  file.insert(file.end(), chunks.begin(), chunks.end());
  return file;
}

}  // namespace softreel::sculpt
