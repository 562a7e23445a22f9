#include "core/mesh/readers/weight_reader.h"

#include "tests/core/mesh/mesh_files.h"

namespace softreel {
namespace {

using testing::TemporaryFolder;

std::vector<double> weights_in(const std::string& name, const std::string& text, const std::string& attribute = "") {
  const TemporaryFolder folder;
  return read_weights(folder.write(name, text), attribute);
}

std::string refused_weights(const std::string& name, const std::string& text, const std::string& attribute = "") {
  try {
    weights_in(name, text, attribute);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return "";
}

const std::string kPly =
    "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
    "property float x\nproperty uchar goal\nproperty float weight\nend_header\n3 0 1 2\n0 255 0.25\n1 0 1\n2 51 0\n";

TEST(WeightReader, TakesOneNumberALine) {
  EXPECT_EQ(weights_in("a.txt", "# goal\n0\r\n\n 0.25 \n1e0\n"), (std::vector<double>{0, 0.25, 1}));
  EXPECT_EQ(weights_in("a.txt",
                       "\xef\xbb\xbf"
                       "0.5\n1\n"),
            (std::vector<double>{0.5, 1}))
      << "a byte order mark";
}

TEST(WeightReader, TakesAPropertyOfPlyVertices) {
  EXPECT_EQ(weights_in("a.ply", kPly), (std::vector<double>{0.25, 1, 0}));
  EXPECT_EQ(weights_in("a.ply", kPly, "goal"), (std::vector<double>{1, 0, 0.2})) << "bytes count to 255";
}

TEST(WeightReader, NamesTheLineOfWhatIsNoWeight) {
  EXPECT_NE(refused_weights("a.txt", "0\nsoft\n").find("a.txt:2: 'soft' is not a number"), std::string::npos);
  EXPECT_NE(refused_weights("a.txt", "0\n1\n1.5\n").find("a.txt:3: 1.5 is no weight"), std::string::npos);
  EXPECT_NE(refused_weights("a.txt", "nan\n").find("no weight"), std::string::npos);
  const std::string unknown = refused_weights("a.ply", kPly, "gaol");
  for (const char* part : {"no number 'gaol'", "x, goal, weight", "Did you mean 'goal'?"})
    EXPECT_NE(unknown.find(part), std::string::npos) << unknown;
}

}  // namespace
}  // namespace softreel
