#include "tool/export/usda_export.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "core/base/check.h"
#include "render/scene/camera_frame.h"
#include "tool/export/body_samples.h"
#include "tool/export/export_colors.h"
#include "tool/export/float_values.h"
#include "tool/export/scratch_file.h"
#include "tool/export/usda_look.h"
#include "tool/export/usda_text.h"

namespace softreel {
namespace {

/// What of a body changes with time, each as "TIME: VALUE" lines.
struct BodyTexts {
  explicit BodyTexts(const std::string& folder) : points(folder), extents(folder), normals(folder) {}

  ScratchFile points, extents, normals;
  int samples = 0;
};

/// "[(lowest), (highest)]"
std::string extent_text(const std::vector<float>& points) {
  std::vector<float> corners{points.begin(), points.begin() + 3};
  corners.insert(corners.end(), points.begin(), points.begin() + 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    corners[i % 3] = std::min(corners[i % 3], points[i]);
    corners[3 + i % 3] = std::max(corners[3 + i % 3], points[i]);
  }
  return usda_vectors(corners, 3);
}

class UsdaFile : public ExportWriter {
 public:
  explicit UsdaFile(ExportTarget target) : target_(std::move(target)) {
    for (const ExportBody& body : target_.bodies) {
      require_texture_coordinates(fmt::format("{}.usda, body {}", target_.shot, body.name), *body.mesh,
                                  std::numeric_limits<float>::max());
      texts_.push_back(std::make_unique<BodyTexts>(target_.folder));
    }
  }

  void append(const ExportSample& sample) override {
    const ExportBody& body = target_.bodies[sample.body];
    BodyTexts& texts = *texts_[sample.body];
    CHECK(sample.positions.size() == body.mesh->positions.size());
    const std::string where = fmt::format("{}.usda, body {}, frame {}", target_.shot, body.name, sample.frame);
    write_sample(texts.points, sample.frame, where, sample.positions);
    write_line(texts.extents, sample.frame, extent_text(values_));
    if (target_.settings.normals) write_sample(texts.normals, sample.frame, where, sample.normals);
    ++texts.samples;
  }

  void finish() override {
    write_head();
    UsdaNames names, looks;
    names.unique("camera");
    names.unique("Looks");
    std::string materials;
    for (std::size_t b = 0; b < target_.bodies.size(); ++b) {
      CHECK(texts_[b]->samples == target_.times.count);
      const std::string look = looks.unique(target_.bodies[b].name);
      write_body(target_.bodies[b], *texts_[b], names.unique(target_.bodies[b].name), look);
      materials += usda_look(target_.bodies[b], look, fmt::format("/{}/Looks", root_name()), target_.folder);
    }
    write_camera();
    write("\n    def Scope \"Looks\"\n    {{\n{}    }}\n}}\n", materials);
  }

 private:
  template <typename... Values>
  void write(const char* form, const Values&... values) {
    const std::string text = fmt::format(fmt::runtime(form), values...);
    target_.sink({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }

  static void write_line(ScratchFile& file, double frame, const std::string& value) {
    file.write(fmt::format("            {}: {},\n", frame, value));
  }

  /// values_ holds the sample afterwards.
  void write_sample(ScratchFile& file, double frame, const std::string& where, std::span<const Vec3> values) {
    values_.clear();
    append_floats(where, values, values_);
    write_line(file, frame, usda_vectors(values_, 3));
  }

  std::string root_name() const { return UsdaNames().unique(target_.shot); }

  void write_head() {
    const ExportSettings& settings = target_.settings;
    write(
        "#usda 1.0\n(\n    defaultPrim = \"{}\"\n    endTimeCode = {}\n    framesPerSecond = {}\n"
        "    metersPerUnit = {}\n    startTimeCode = {}\n    timeCodesPerSecond = {}\n    upAxis = \"{}\"\n)\n\n",
        root_name(), target_.times.frame(target_.times.count - 1), settings.fps, settings.meters_per_unit,
        target_.times.first, settings.fps, settings.up == UpAxis::Z ? 'Z' : 'Y');
    write("def Xform \"{}\" (\n    kind = \"component\"\n)\n{{\n", root_name());
  }

  void write_samples(const char* attribute, const ScratchFile& samples) {
    write("        {}.timeSamples = {{\n", attribute);
    samples.copy_to(target_.sink);
    write("        }}\n");
  }

  void write_body(const ExportBody& body, const BodyTexts& texts, const std::string& name, const std::string& look) {
    write("    def Mesh \"{}\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n    {{\n", name);
    write_samples("float3[] extent", texts.extents);
    const std::string topology = usda_topology(*body.mesh, "        ");
    target_.sink({reinterpret_cast<const std::uint8_t*>(topology.data()), topology.size()});
    write("        rel material:binding = </{}/Looks/{}>\n", root_name(), look);
    if (target_.settings.normals) write_samples("normal3f[] normals", texts.normals);
    write_samples("point3f[] points", texts.points);
    if (shows_vertex_colors(body)) write_colors(*body.mesh);
    write("        custom string softreel:name = {}\n", usda_quoted(body.name));
    if (target_.settings.space == ExportSpace::Object)
      write("        matrix4d xformOp:transform = {}\n        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n",
            usda_matrix(body.transform));
    const std::string groups = usda_groups(*body.mesh, "        ");
    target_.sink({reinterpret_cast<const std::uint8_t*>(groups.data()), groups.size()});
    write("    }}\n\n");
  }

  /// Linear, which displayColor is.
  void write_colors(const SurfaceMesh& mesh) {
    std::vector<float> values;
    for (const Vec3f& color : linear_colors(mesh)) values.insert(values.end(), color.begin(), color.end());
    write("        color3f[] primvars:displayColor = {} (\n            interpolation = \"vertex\"\n        )\n",
          usda_vectors(values, 3));
  }

  /// The samples' times, and beside a cut one more just before it, as values go straight from one time to the next.
  std::vector<double> camera_times() const {
    std::vector<double> times;
    for (int k = 0; k < target_.times.count; ++k) {
      const double time = target_.times.frame(k);
      if (k > 0) {
        const std::optional<double> cut = target_.camera_cut(times.back(), time);
        if (cut && *cut - kBeforeCut > times.back()) times.push_back(*cut - kBeforeCut);
        if (cut && *cut < time) times.push_back(*cut);
      }
      times.push_back(time);
    }
    return times;
  }

  /// An attribute of the camera: a value where it stays, else one at each time. `text` makes that of one.
  template <typename Text>
  void write_keyed(const char* attribute, const Text& text) {
    const std::vector<double> times = camera_times();
    std::vector<std::string> values;
    for (const double time : times) values.push_back(fmt::format("{}", text(target_.camera(time))));
    if (std::all_of(values.begin(), values.end(), [&](const std::string& value) { return value == values.front(); })) {
      write("        {} = {}\n", attribute, values.front());
      return;
    }
    write("        {}.timeSamples = {{\n", attribute);
    for (std::size_t k = 0; k < times.size(); ++k) write("            {}: {},\n", times[k], values[k]);
    write("        }}\n");
  }

  /// USD's camera looks along -z with y up, as the frame's axes do turned round.
  void write_camera() {
    const Placement world = world_placement(target_.settings);
    const double tenths = 0.01 / target_.settings.meters_per_unit;  // of a unit in a millimetre
    const Camera first = target_.camera(target_.times.first);
    const double width = tenths * first.sensor_width_mm;
    write("    def Camera \"camera\"\n    {{\n        float2 clippingRange = ({}, {})\n",
          static_cast<float>(0.01 / target_.settings.meters_per_unit),
          static_cast<float>(1e4 / target_.settings.meters_per_unit));
    write_keyed("float focalLength",
                [&](const Camera& camera) { return static_cast<float>(tenths * camera.focal_length_mm); });
    write_keyed("float focusDistance", [&](const Camera& camera) {
      const double distance =
          camera.focus_distance > 0 ? camera.focus_distance : (camera.target - camera.position).norm();
      return static_cast<float>(distance / target_.settings.meters_per_unit);
    });
    write(
        "        float fStop = {}\n        float horizontalAperture = {}\n        float verticalAperture = {}\n"
        "        token projection = \"perspective\"\n",
        first.f_number, static_cast<float>(width), static_cast<float>(width / target_.aspect));
    write_keyed("matrix4d xformOp:transform", [&](const Camera& camera) { return usda_matrix(placed(camera, world)); });
    write("        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }}\n");
  }

  /// From the camera's own axes (right, up, backwards) to the export's world. The axes keep their length of 1.
  static Placement placed(const Camera& camera, const Placement& world) {
    const CameraFrame frame = camera_frame(camera, 1, 1);
    Mat3 axes;
    axes.col(0) = frame.right.cast<double>();
    axes.col(1) = frame.up.cast<double>();
    axes.col(2) = -frame.forward.cast<double>();
    const Mat3 turn = world.linear / std::cbrt(world.linear.determinant());
    return {turn * axes, world(frame.position.cast<double>())};
  }

  ExportTarget target_;
  std::vector<std::unique_ptr<BodyTexts>> texts_;
  std::vector<float> values_;
};

}  // namespace

ExportFormat usda_format() {
  ExportFormat format;
  format.name = "usda";
  format.about =
      "USD text, a file of the whole shot: meshes with time samples, materials with textures, camera; float32";
  format.file_per = FilePer::Shot;
  format.version = 5;
  format.has_normals = true;
  format.has_seconds = true;
  format.has_transform = true;
  format.needs_look = true;
  format.needs_camera = true;
  format.names_pictures = true;
  format.make = [](ExportTarget target) { return std::make_unique<UsdaFile>(std::move(target)); };
  return format;
}

}  // namespace softreel
