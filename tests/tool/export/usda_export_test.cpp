// USDA, read back by a reader written from its grammar.
#include <cmath>
#include <map>
#include <optional>

#include "render/scene/camera_frame.h"
#include "tests/tool/export/format_runs.h"
#include "tests/tool/export/readers/usda_reader.h"
#include "tool/export/usda_text.h"

namespace softreel {
namespace {

using testing::UsdPrim;
using testing::UsdValue;

/// The file of one body at one frame.
auto usda_of(const std::string& name, const SurfaceMesh& mesh) {
  testing::FormatRun run("usda");
  run.add_body(name, mesh);
  run.append(1, mesh.positions);
  return run.finish();
}

TEST(UsdaExport, PointsAreTheNearestFloatsInFileOrderAtEverySample) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.add_body("cloth", mesh);
  run.target().times = {1, 2, 5};
  run.target().settings.fps = 30;
  for (int s = 0; s < 5; ++s) run.append(1 + 0.5 * s, testing::moved(mesh.positions, s));
  const auto stage = testing::read_usda(run.finish());
  EXPECT_EQ(stage->metadata.at("timeCodesPerSecond").number, 30);
  EXPECT_EQ(stage->metadata.at("startTimeCode").number, 1);
  EXPECT_EQ(stage->metadata.at("endTimeCode").number, 3);
  EXPECT_EQ(stage->metadata.at("defaultPrim").text, "shot");
  const auto& samples = stage->child("shot/cloth").property("points").samples;
  ASSERT_EQ(samples.size(), 5U);
  for (int s = 0; s < 5; ++s) {
    const std::vector<float> read = samples.at(1 + 0.5 * s).floats(),
                             expected = testing::floats_of(testing::moved(mesh.positions, s));
    EXPECT_EQ(read.size(), expected.size());
    testing::expect_same_floats(read, expected);
  }
}

TEST(UsdaExport, AwkwardFloatsReadBackBitForBit) {
  SurfaceMesh mesh;
  std::mt19937 random(3);
  for (int v = 0; v < 3000; ++v) {
    Vec3& p = mesh.positions.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      p[k] = std::isfinite(value) ? value : -0.0;
    }
  }
  testing::FormatRun run("usda");
  run.add_body("cloud", mesh);
  run.append(1, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  testing::expect_same_floats(stage->child("shot/cloud").property("points").samples.at(1).floats(),
                              testing::floats_of(mesh.positions));
}

TEST(UsdaExport, HasPolygonsTexturesPerCornerAndGroupsOfTheFile) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.add_body("cloth", mesh);
  run.append(1, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  const UsdPrim& body = stage->child("shot/cloth");
  const auto integers = [](const UsdValue& value) {
    std::vector<Index> result;
    for (const double number : value.doubles()) result.push_back(static_cast<Index>(number));
    return result;
  };
  EXPECT_EQ(integers(body.property("faceVertexCounts").value), std::vector<Index>({4, 4, 5, 3}));
  EXPECT_EQ(integers(body.property("faceVertexIndices").value), mesh.polygons.corner_vertices);
  EXPECT_EQ(body.property("subdivisionScheme").value.text, "none");
  const auto& st = body.property("primvars:st");
  EXPECT_EQ(st.metadata.at("interpolation").text, "faceVarying");
  const std::vector<float> values = st.value.floats();
  const std::vector<Index> indices = integers(body.property("primvars:st:indices").value);
  ASSERT_EQ(indices.size(), mesh.polygons.corner_textures.size());
  for (std::size_t c = 0; c < indices.size(); ++c) {
    const Vec2 at = mesh.texture_coordinates[static_cast<std::size_t>(mesh.polygons.corner_textures[c])];
    EXPECT_EQ(values[2 * static_cast<std::size_t>(indices[c])], static_cast<float>(at.x()));
    EXPECT_EQ(values[2 * static_cast<std::size_t>(indices[c]) + 1], static_cast<float>(at.y()));
  }
  EXPECT_EQ(integers(body.child("left").property("indices").value), std::vector<Index>({0}));
  EXPECT_EQ(integers(body.child("right").property("indices").value), std::vector<Index>({1}));
  EXPECT_EQ(body.child("right").property("elementType").value.text, "face");
}

TEST(UsdaExport, MaterialsOfFacesAreSubsetsOfFacesBesideTheirGroups) {
  SurfaceMesh mesh = testing::unit_box();
  const auto polygons = static_cast<Index>(mesh.polygons.size());
  mesh.groups = {{"box", {0, 1, 2, 3, 4, 5, 6, 7}}, {"red", {0, 1, 2, 3, 4, 5, 6, 7}}};
  mesh.polygons.polygon_groups.assign(mesh.polygons.size(), 0);
  mesh.polygons.polygon_materials.assign(mesh.polygons.size(), -1);
  mesh.polygons.polygon_materials.back() = 1;
  const auto stage = testing::read_usda(usda_of("box", mesh));
  const UsdPrim& red = stage->child("shot/box/red");
  EXPECT_EQ(red.property("elementType").value.text, "face");
  EXPECT_EQ(red.property("indices").value.doubles(), std::vector<double>({static_cast<double>(polygons - 1)}));
  EXPECT_EQ(stage->child("shot/box/box").property("indices").value.doubles().size(), mesh.polygons.size());
}

TEST(UsdaExport, GroupsThatNoPolygonNamesAreSubsetsOfPoints) {
  SurfaceMesh mesh = testing::unit_box();
  mesh.groups = {{"left hand", {0, 5}}};
  const auto stage = testing::read_usda(usda_of("box", mesh));
  const UsdPrim& group = stage->child("shot/box/left_hand");
  EXPECT_EQ(group.property("elementType").value.text, "point");
  EXPECT_EQ(group.property("indices").value.doubles(), std::vector<double>({0, 5}));
  EXPECT_EQ(group.property("softreel:name").value.text, "left hand");
}

TEST(UsdaExport, ExtentsEncloseThePointsOfTheirSample) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.add_body("cloth", mesh);
  run.target().times = {1, 1, 2};
  for (int s = 0; s < 2; ++s) run.append(1 + s, testing::moved(mesh.positions, 3 * s));
  const auto stage = testing::read_usda(run.finish());
  const UsdPrim& body = stage->child("shot/cloth");
  for (const double frame : {1.0, 2.0}) {
    const std::vector<float> extent = body.property("extent").samples.at(frame).floats(),
                             points = body.property("points").samples.at(frame).floats();
    for (std::size_t k = 0; k < 3; ++k) {
      float low = points[k], high = points[k];
      for (std::size_t i = k; i < points.size(); i += 3) {
        low = std::min(low, points[i]);
        high = std::max(high, points[i]);
      }
      EXPECT_EQ(extent[k], low);
      EXPECT_EQ(extent[3 + k], high);
    }
  }
}

TEST(UsdaExport, CutsOfTheCameraAreCutsBetweenSamplesToo) {
  const SurfaceMesh mesh = testing::patchwork();
  testing::FormatRun run("usda");
  run.add_body("cloth", mesh);
  run.target().times = {1, 1, 4};
  run.target().camera = [](double frame) {
    Camera camera;
    camera.position = Vec3f(frame < 2.5 ? 0.0f : frame < 4 ? 10.0f : 20.0f, 0, 5);
    camera.target = camera.position - Vec3f(0, 0, 1);
    return camera;
  };
  run.target().camera_cut = [](double after, double until) {
    std::optional<double> cut;
    for (const double at : {2.5, 4.0})
      if (at > after && at <= until) cut = at;
    return cut;
  };
  for (int s = 0; s < 4; ++s) run.append(1 + s, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  std::map<double, double> x;
  for (const auto& [time, value] : stage->child("shot/camera").property("xformOp:transform").samples)
    x[time] = value.doubles()[12];
  const std::map<double, double> expected{{1, 0}, {2, 0}, {2.499, 0}, {2.5, 10}, {3, 10}, {3.999, 10}, {4, 20}};
  EXPECT_EQ(x, expected);
}

TEST(UsdaExport, NamesOfAnyBytesAreUtf8) {
  SurfaceMesh mesh = testing::patchwork();
  mesh.groups.front().name = "caf\xe9";
  const std::string text = usda_of("cloth", mesh);
  EXPECT_EQ(text.find('\xe9'), std::string::npos);
  EXPECT_NE(text.find("caf\xef\xbf\xbd"), std::string::npos) << "the sign for what cannot be read";
}

TEST(UsdaExport, KeepsBodiesApartWhateverTheirNamesAndOrder) {
  const SurfaceMesh mesh = testing::patchwork(), box = testing::unit_box();
  testing::FormatRun run("usda");
  run.target().shot = "2nd take";
  run.add_body("a b", mesh);
  run.add_body("a_b", box);
  run.add_body("camera", box);
  run.target().times = {1, 1, 3};
  run.target().settings.normals = true;
  for (int s = 0; s < 3; ++s) {
    run.append(1 + s, testing::moved(mesh.positions, s), vertex_normals(mesh, mesh.positions), 0);
    run.append(1 + s, testing::moved(box.positions, s), vertex_normals(box, box.positions), 1);
    run.append(1 + s, testing::moved(box.positions, 7 * s), vertex_normals(box, box.positions), 2);
  }
  const auto stage = testing::read_usda(run.finish());
  EXPECT_EQ(stage->metadata.at("defaultPrim").text, "_2nd_take");
  const auto points = [&](const std::string& path) {
    return stage->child("_2nd_take/" + path).property("points").samples.at(3).floats();
  };
  testing::expect_same_floats(points("a_b"), testing::floats_of(testing::moved(mesh.positions, 2)));
  testing::expect_same_floats(points("a_b_1"), testing::floats_of(testing::moved(box.positions, 2)));
  testing::expect_same_floats(points("camera_1"), testing::floats_of(testing::moved(box.positions, 14)));
  EXPECT_EQ(stage->child("_2nd_take/camera").type, "Camera");
  EXPECT_EQ(stage->child("_2nd_take/a_b").property("softreel:name").value.text, "a b");
  for (const UsdValue& normal : stage->child("_2nd_take/a_b_1").property("normals").samples.at(2).items) {
    const std::vector<double> n = normal.doubles();
    EXPECT_NEAR(Vec3(n[0], n[1], n[2]).norm(), 1, 1e-6);
  }
  const UsdPrim& look = stage->child("_2nd_take/Looks/a_b_1/surface");
  EXPECT_EQ(look.property("info:id").value.text, "UsdPreviewSurface");
}

/// Where a point of the scene comes to lie in the picture, in shares of half its width and height.
Vec2 seen_by(const Camera& camera, const Vec3& point, double aspect) {
  const CameraFrame frame = camera_frame(camera, static_cast<int>(1000 * aspect), 1000);
  const Vec3 way = point - frame.position.cast<double>();
  const double depth = way.dot(frame.forward.cast<double>());
  return {way.dot(frame.right.cast<double>()) / depth / frame.half_width,
          way.dot(frame.up.cast<double>()) / depth / frame.half_height};
}

TEST(UsdaExport, TheCameraSeesPointsWhereTheShotsCameraDoesInAnyUnitAndUpAxis) {
  const SurfaceMesh mesh = testing::unit_box();
  const auto camera_at = [](double frame) {
    Camera camera;
    camera.position = Vec3f(static_cast<float>(frame), 2, 5);
    camera.focal_length_mm = static_cast<float>(40 + frame);
    return camera;
  };
  for (const double unit : {1.0, 0.01})
    for (const UpAxis up : {UpAxis::Y, UpAxis::Z}) {
      testing::FormatRun run("usda");
      run.add_body("box", mesh);
      run.target().camera = camera_at;
      run.target().aspect = 1.5;
      run.target().times = {1, 1, 2};
      run.target().settings.meters_per_unit = unit;
      run.target().settings.up = up;
      run.append(1, mesh.positions);
      run.append(2, mesh.positions);
      const auto stage = testing::read_usda(run.finish());
      EXPECT_EQ(stage->metadata.at("metersPerUnit").number, unit);
      EXPECT_EQ(stage->metadata.at("upAxis").text, up == UpAxis::Y ? "Y" : "Z");
      const UsdPrim& camera = stage->child("shot/camera");
      for (const double frame : {1.0, 2.0}) {
        const std::vector<double> rows = camera.property("xformOp:transform").samples.at(frame).doubles();
        const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(rows.data());  // rows are columns of ours
        EXPECT_NEAR(Mat3(matrix.topLeftCorner<3, 3>()).determinant(), 1, 1e-6);
        const Vec3 point(0.3, -0.2, 0.4);
        const Vec3 turned = up == UpAxis::Y ? point : Vec3(point.x(), -point.z(), point.y());
        const Vec3 there = turned / unit;
        const Eigen::Vector4d local = matrix.inverse() * there.homogeneous();
        const double focal = camera.property("focalLength").samples.at(frame).number;
        // Apertures and focal length are in tenths of a unit: only their ratio is seen, but it must be real.
        EXPECT_NEAR(focal * unit / 10, 0.001 * (40 + frame), 1e-6);
        const double wide = camera.property("horizontalAperture").value.number,
                     high = camera.property("verticalAperture").value.number;
        const Vec2 seen(local.x() / -local.z() * focal / (0.5 * wide), local.y() / -local.z() * focal / (0.5 * high));
        EXPECT_NEAR((seen - seen_by(camera_at(frame), point, 1.5)).norm(), 0, 1e-5);
      }
    }
}

TEST(UsdaExport, InObjectSpaceTheMeshCarriesItsPlacement) {
  const SurfaceMesh mesh = testing::unit_box();
  testing::FormatRun run("usda");
  run.add_body("box", mesh);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(0, 1, 2).normalized()).toRotationMatrix();
  run.target().bodies[0].transform = {2 * turn, Vec3(1, -2, 5)};
  run.append(1, mesh.positions);
  const auto stage = testing::read_usda(run.finish());
  const UsdPrim& body = stage->child("shot/box");
  const std::vector<double> rows = body.property("xformOp:transform").value.doubles();
  ASSERT_EQ(rows.size(), 16U);
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(rows.data());
  for (const Vec3& p : mesh.positions)
    EXPECT_NEAR((Eigen::Vector4d(matrix * p.homogeneous()).head<3>() - run.target().bodies[0].transform(p)).norm(), 0,
                1e-12);
  EXPECT_EQ(body.property("xformOpOrder").value.items.at(0).text, "xformOp:transform");
}

TEST(UsdaNames, AreIdentifiersAndDiffer) {
  UsdaNames names;
  EXPECT_EQ(names.unique("left arm"), "left_arm");
  EXPECT_EQ(names.unique("left-arm"), "left_arm_1");
  EXPECT_EQ(names.unique("3"), "_3");
  EXPECT_EQ(names.unique(""), "_");
  EXPECT_EQ(usda_quoted("say \"a\\b\""), "\"say \\\"a\\\\b\\\"\"");
}

}  // namespace
}  // namespace softreel
