/// Writers of formats on bodies of our own making, into memory, for tests.
#pragma once

#include <bit>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/srgb.h"
#include "tests/core/mesh/mesh_files.h"
#include "tool/export/exporter.h"
#include "tool/export/formats.h"

namespace softreel::testing {

/// Quads, a pentagon and a triangle in two groups, texture seams, a vertex that no polygon uses.
inline SurfaceMesh patchwork() {
  return import_text(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 9 9 9\nv 1 2 0\nv 0 2 0.1\n"
      "vt 0 0\nvt 0.1 0\nvt 0.1 1\nvt 0 1\nvt 0.7 0.3\n"
      "g left\nf 1/1 2/2 5/3 4/4\ng right\nf 2/5 3/2 6/3 5/1\ng\nf 4/1 5/2 6/3 8/4 9/5\nf 4/1 2/3 1/2\n");
}

/// One colour a vertex, each of bytes.
inline void paint_with_bytes(SurfaceMesh& mesh) {
  mesh.colors.clear();
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const auto byte = [&](std::size_t step) {
      return srgb_decode(static_cast<float>(static_cast<double>((37 + step * v) % 256) / 255));
    };
    mesh.colors.emplace_back(byte(11), byte(29), byte(53));
  }
}

/// One file of a format: bodies of meshes and samples, taken one after the other.
class FormatRun {
 public:
  explicit FormatRun(const std::string& format) : format_(find_export_format(format)) {
    target_.shot = "shot";
    target_.folder = folder_.path("");
    target_.camera = [](double) { return Camera{}; };
    target_.camera_cut = [](double, double) { return std::nullopt; };
    target_.sink = [this](std::span<const std::uint8_t> bytes) {
      file_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
  }

  ExportTarget& target() { return target_; }
  /// mesh is kept by reference.
  void add_body(const std::string& name, const SurfaceMesh& mesh) {
    ExportBody& body = target_.bodies.emplace_back();
    body.name = name;
    body.mesh = &mesh;
    body.material = "stuff";
  }
  void begin() { writer_ = format_.make(target_); }
  void append(double frame, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals = {},
              std::size_t body = 0) {
    if (!writer_) begin();
    writer_->append({body, frame, positions, normals, nullptr});
  }
  /// What the sink has got so far.
  std::size_t bytes_so_far() const { return file_.size(); }
  std::string finish() {
    writer_->finish();
    return file_;
  }

 private:
  TemporaryFolder folder_;
  const ExportFormat& format_;
  ExportTarget target_;
  std::unique_ptr<ExportWriter> writer_;
  std::string file_;
};

/// Each vertex moved its own way, more from sample to sample.
inline std::vector<Vec3> moved(const std::vector<Vec3>& positions, int sample) {
  std::vector<Vec3> result = positions;
  for (std::size_t v = 0; v < result.size(); ++v)
    result[v] +=
        0.1 * sample * Vec3(std::sin(1.0 + static_cast<double>(v)), std::cos(2.0 * static_cast<double>(v)), 1.0 / 3);
  return result;
}

inline std::vector<float> floats_of(const std::vector<Vec3>& values) {
  std::vector<float> floats;
  for (const Vec3& value : values)
    for (int k = 0; k < 3; ++k) floats.push_back(static_cast<float>(value[k]));
  return floats;
}

/// Bit for bit, the first values.size() of `read`.
inline void expect_same_floats(const std::vector<float>& read, const std::vector<float>& values) {
  ASSERT_GE(read.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(read[i]), std::bit_cast<std::uint32_t>(values[i])) << "number " << i;
}

/// The message of the Error that `work` throws; empty if it throws none.
template <typename Work>
std::string error_of(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace softreel::testing
