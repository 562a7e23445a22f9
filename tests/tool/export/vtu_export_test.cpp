#include "tool/export/vtu_export.h"

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/tetmesh/files/tet_mesh_file.h"
#include "tests/support/bcc_bar.h"
#include "tool/export/tet_fields.h"

namespace softreel {
namespace {

/// A bar of 1 x 0.2 x 0.2 m, softer in its second half.
struct Bar {
  FilledBody filled;
  std::vector<ElementMaterial> materials;
  SurfaceMesh surface;

  Bar() {
    filled.mesh = testing::kuhn_bar({4, 1, 1}, Vec3(1, 0.2, 0.2));
    materials.resize(filled.mesh.tets.size());
    for (std::size_t e = 0; e < materials.size(); ++e) {
      materials[e].youngs_modulus = testing::centroid(filled.mesh, e).x() < 0.5 ? 2e5 : 1e5;
      materials[e].poisson_ratio = 0.4;
    }
  }
};

/// 10 % longer, as much thinner as a free bar gets, and turned.
std::vector<Vec3> stretched(const Bar& bar, const Mat3& turn) {
  std::vector<Vec3> nodes;
  for (const Vec3& x : bar.filled.mesh.nodes)
    nodes.push_back(turn * Vec3(1.1 * x.x(), 0.96 * x.y(), 0.96 * x.z()) + Vec3(3, 0, -1));
  return nodes;
}

/// The file as text and bytes; blocks by the name of their array.
class VtuFile {
 public:
  explicit VtuFile(std::string bytes) : bytes_(std::move(bytes)) {}

  template <typename T>
  std::vector<T> values(const std::string& name) const {
    const std::size_t at = bytes_.find(fmt::format("Name=\"{}\"", name));
    EXPECT_NE(at, std::string::npos) << name;
    const std::size_t offset = std::stoul(bytes_.substr(bytes_.find("offset=\"", at) + 8));
    const char* const block = bytes_.data() + bytes_.find("raw\">\n_") + 7 + offset;
    std::uint64_t size = 0;
    std::memcpy(&size, block, sizeof size);
    std::vector<T> values(size / sizeof(T));
    std::memcpy(values.data(), block + sizeof size, size);
    return values;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

VtuFile write(const Bar& bar, const std::vector<Vec3>& nodes, const Placement& to_space = {}) {
  const Threads threads(1);
  std::string bytes;
  ExportTarget target;
  target.bodies.emplace_back();
  target.bodies[0].mesh = &bar.surface;
  target.bodies[0].scene_to_space = to_space;
  target.threads = &threads;
  target.sink = [&bytes](std::span<const std::uint8_t> part) { bytes.append(part.begin(), part.end()); };
  const auto writer = vtu_format().make(target);
  const TetSample tets{bar.filled, bar.materials, nodes, Dilatation::Capped};
  ExportSample sample;
  sample.tets = &tets;
  writer->append(sample);
  writer->finish();
  return VtuFile(bytes);
}

TEST(VtuExport, OfAStretchedAndTurnedBarHasItsStrainAndStressInEveryElement) {
  const Bar bar;
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const VtuFile file = write(bar, stretched(bar, turn));
  const auto strain = file.values<float>("strain"), green = file.values<float>("green_strain");
  const auto cauchy = file.values<float>("cauchy_stress"), mises = file.values<float>("von_mises_stress");
  const auto material = file.values<Index>("material");
  const Vec3 axis = turn.col(0);
  ASSERT_EQ(strain.size(), bar.materials.size());
  ASSERT_EQ(green.size(), 6 * strain.size());
  for (std::size_t e = 0; e < strain.size(); ++e) {
    EXPECT_NEAR(strain[e], 0.1, 1e-6);
    EXPECT_NEAR(green[6 * e], 0.5 * (1.1 * 1.1 - 1), 1e-6) << "in the axes at rest";
    EXPECT_NEAR(green[6 * e + 1], 0.5 * (0.96 * 0.96 - 1), 1e-6);
    EXPECT_NEAR(green[6 * e + 3], 0, 1e-6);
    const double along = 0.1 * bar.materials[e].youngs_modulus;
    EXPECT_NEAR(mises[e], along, 1e-6 * along);
    const double area = 0.96 * 0.96;
    EXPECT_NEAR(cauchy[6 * e], along / area * axis.x() * axis.x(), 2e-6 * along) << "in the axes of space";
    EXPECT_NEAR(cauchy[6 * e + 3], along / area * axis.x() * axis.y(), 2e-6 * along);
    EXPECT_EQ(material[e], bar.materials[e].youngs_modulus == bar.materials[0].youngs_modulus ? 0 : 1);
  }
}

TEST(VtuExport, HasTheDeformedNodesAndWhereTheyCameFromInTheUnitAskedFor) {
  const Bar bar;
  Placement centimetres;
  centimetres.linear *= 100;
  const std::vector<Vec3> nodes = stretched(bar, Mat3::Identity());
  const VtuFile file = write(bar, nodes, centimetres);
  const std::string& text = file.bytes();
  const TetMesh read = decode_tet_mesh("bar.vtu", text, ".vtu", Log());
  ASSERT_EQ(read.tets, bar.filled.mesh.tets) << "a reader of tetrahedra skips the arrays";
  const auto displacement = file.values<double>("displacement");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_EQ(read.nodes[i], Vec3(100 * nodes[i]));
    const Vec3 moved(displacement[3 * i], displacement[3 * i + 1], displacement[3 * i + 2]);
    EXPECT_LT((moved - 100 * (nodes[i] - bar.filled.mesh.nodes[i])).norm(), 1e-10);
  }
  for (const float strain : file.values<float>("strain")) EXPECT_NEAR(strain, 0.1, 1e-6) << "no unit";
}

TEST(VtuExport, ElementsOfNoVolumeHaveNoStressAndTheOthersKeepTheirs) {
  const Bar bar;
  std::vector<Vec3> nodes = bar.filled.mesh.nodes;
  const Tet& flat = bar.filled.mesh.tets[0];
  // The last node falls onto the first.
  nodes[static_cast<std::size_t>(flat[3])] = nodes[static_cast<std::size_t>(flat[0])];
  const VtuFile file = write(bar, nodes);
  const auto cauchy = file.values<float>("cauchy_stress");
  EXPECT_TRUE(std::isnan(cauchy[0]));
  EXPECT_TRUE(std::isfinite(file.values<float>("strain")[0]));
  EXPECT_NEAR(cauchy[cauchy.size() - 6], 0, 1e-3);
}

TEST(PvdText, ListsFilesByTheirTimeAndEscapesNames) {
  const std::vector<SeriesEntry> series{{"a&b.0001.vtu", 1, 0.5}, {"a&b.0002.vtu", 2, 0.75}};
  const std::string text = pvd_text(series);
  EXPECT_NE(text.find("timestep=\"0.5\" part=\"0\" file=\"a&amp;b.0001.vtu\""), std::string::npos) << text;
  EXPECT_NE(text.find("timestep=\"0.75\" part=\"0\" file=\"a&amp;b.0002.vtu\""), std::string::npos) << text;
}

}  // namespace
}  // namespace softreel
