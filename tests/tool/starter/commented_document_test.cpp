// A document with comments is the same document, and says of every field what it is for.
#include "tool/starter/commented_document.h"

#include <sstream>

#include "tests/tool/shot/shot_files.h"
#include "tool/shot/schema.h"

namespace softreel {
namespace {

using CommentedDocument = ShotFiles;

TEST_F(CommentedDocument, ReadsAsTheSameShot) {
  const TomlValue document = parse_toml(kFullShot, "s.toml");
  const Shot before = parse_shot("s.toml", document);
  const std::string text = commented_document(document, {});
  const Shot after = parse_shot("s.toml", parse_toml(text, "s.toml"));
  EXPECT_EQ(to_toml(after), to_toml(before));
}

TEST_F(CommentedDocument, ExplainsEveryFieldWithItsUnit) {
  const std::string text = commented_document(parse_toml(kFullShot, "s.toml"), {});
  std::string in_a_line;  // comments broken into lines are whole again
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comment = line.find("# ");
    if (comment != std::string::npos) in_a_line += line.substr(comment + 2) + " ";
    if (line.starts_with("# ")) {
      EXPECT_LE(line.size(), 112u) << line;
    }
  }
  for (const char* path : {"body.*.fit", "body.*.pull[].stiffness", "material.*.density", "camera.f_number"}) {
    const FieldText& field = *find_field(path);
    const std::string said = field.unit.empty() ? field.sentence : field.unit + ": " + field.sentence;
    EXPECT_NE(in_a_line.find(said.substr(0, said.size() - 1)), std::string::npos) << path << ": " << said;
  }
}

TEST_F(CommentedDocument, PutsRemarksAfterWhatTheFieldMeans) {
  const TomlValue document = parse_toml("[body.a]\nmesh = \"a.ply\"\ntets = 5\n", "s.toml");
  const std::string text = commented_document(document, {{"body.a.tets", "Because."}, {"body.a", "Mine."}});
  EXPECT_NE(text.find("Because.\n"), std::string::npos) << text;
  EXPECT_LT(text.find("Mine."), text.find("[body.a]")) << text;
}

}  // namespace
}  // namespace softreel
