#include "tool/batch/sweep.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

using Strings = std::vector<std::string>;

std::string refusal(const std::string& text) {
  try {
    parse_sweep(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::Input);
    return error.what();
  }
  return {};
}

TEST(Sweep, SplitsAtCommasOutsideBracketsAndQuotes) {
  EXPECT_EQ(parse_sweep("body.tets=5000,20000").values, (Strings{"5000", "20000"}));
  EXPECT_EQ(parse_sweep("gravity.acceleration=[0,-9.81,0],[0, 0, 0]").values, (Strings{"[0,-9.81,0]", "[0, 0, 0]"}));
  EXPECT_EQ(parse_sweep("body.mesh=\"a,b.ply\",'c,d.ply'").values, (Strings{"\"a,b.ply\"", "'c,d.ply'"}));
  EXPECT_EQ(parse_sweep("body.pull[0].keys=[{frame=1,translate=[0,1,0]}],[{frame=2}]").values.size(), 2U);
  EXPECT_EQ(parse_sweep("body.mesh=\"quote \\\" , inside\",b").values.size(), 2U);
  EXPECT_EQ(parse_sweep(" body.tets = 1000 , 2000 ").values, (Strings{"1000", "2000"}));
  EXPECT_EQ(parse_sweep("body.mesh=../a/b.ply,c..d/2.ply").values, (Strings{"../a/b.ply", "c..d/2.ply"}));
}

TEST(Sweep, ARangeHasBothEndsAndEqualStepsOrFactors) {
  EXPECT_EQ(parse_sweep("solver.substeps=1..5/5").values, (Strings{"1", "2", "3", "4", "5"}));
  EXPECT_EQ(parse_sweep("camera.margin=0.1..0.5/5").values, (Strings{"0.1", "0.2", "0.3", "0.4", "0.5"}));
  EXPECT_EQ(parse_sweep("camera.azimuth_deg=-90..90/3,7").values, (Strings{"-90", "0", "90", "7"}));
  const Strings factors = parse_sweep("material.rubber.youngs_modulus=1e4..1e6/5log").values;
  ASSERT_EQ(factors.size(), 5U);
  for (std::size_t k = 0; k < factors.size(); ++k)
    EXPECT_NEAR(std::log10(std::stod(factors[k])), 4 + 0.5 * static_cast<double>(k), 1e-9) << factors[k];
}

TEST(Sweep, RefusesWhatIsNoSweepAndSaysWhatIsAccepted) {
  for (const char* wrong : {"body.tets", "=1,2", "body.tets=", "body.tets=1,,2", "body.tets=1,2,",
                            "gravity.acceleration=[0,1", "gravity.acceleration=0]", "body.mesh=\"a", "body.tets=5,5",
                            "body.tets=1..5/1", "body.tets=1..5/0", "camera.margin=0..1/3log", "body.tets=1..5/2000"}) {
    const std::string message = refusal(wrong);
    EXPECT_TRUE(message.starts_with("--sweep: ")) << wrong << ": " << message;
    EXPECT_NE(message.find("Accepted: "), std::string::npos) << wrong << ": " << message;
  }
}

TEST(Sweep, NamesTheFieldNearestToAnUnknownOne) {
  const std::string message = refusal("material.rubber.youngs_modulos=1,2");
  EXPECT_NE(message.find("youngs_modulus"), std::string::npos) << message;
}

TEST(Sweep, AllCombinationsAreThereOnceTheLastAxisFastest) {
  const std::vector<Variant> variants =
      expand_sweeps({parse_sweep("body.tets=1,2"), parse_sweep("gravity.acceleration=[0,0,0],[0,-1,0],[1,0,0]")}, 100);
  ASSERT_EQ(variants.size(), 6U);
  std::set<std::pair<std::string, std::string>> seen;
  for (const Variant& variant : variants) {
    ASSERT_EQ(variant.values.size(), 2U);
    EXPECT_EQ(variant.values[0].path, "body.tets");
    seen.insert({variant.values[0].value, variant.values[1].value});
  }
  EXPECT_EQ(seen.size(), 6U);
  EXPECT_EQ(variants[0].values[0].value, variants[1].values[0].value);
  EXPECT_EQ(variants[1].name, "body.tets=1,gravity.acceleration=0_-1_0");
}

TEST(Sweep, NamesAreFoldersThatAShellTakesAndDependOnTheirOwnValuesOnly) {
  const auto names = [](const std::string& text) {
    Strings all;
    for (const Variant& variant : expand_sweeps({parse_sweep(text)}, 100)) all.push_back(variant.name);
    return all;
  };
  const Strings paths = names("body.mesh=a/x.ply,a_x.ply,../a x.ply,$(rm).ply,\"a'b.ply\"");
  EXPECT_EQ(std::set<std::string>(paths.begin(), paths.end()).size(), paths.size());
  for (const std::string& name : paths)
    EXPECT_EQ(name.find_first_of("/ $()'\"*?[]{}\\;&|<>`"), std::string::npos) << name;
  EXPECT_EQ(names("body.mesh=b/y.ply,a/x.ply")[1], paths[0]);
  const Strings blanks = names("body.mesh=\"my cat.obj\",\"mycat.obj\",\"my'cat.obj\"");
  EXPECT_EQ(std::set<std::string>(blanks.begin(), blanks.end()).size(), 3U);
  EXPECT_EQ(names("gravity.acceleration=[0, -1, 0],[0,-2,0]")[0], "gravity.acceleration=0_-1_0");
  std::string umlauts;
  for (int k = 0; k < 100; ++k) umlauts += "\xc3\xa4";
  for (const char* before : {"", "x"}) {
    const std::string name = names("body.mesh=" + (before + umlauts))[0];
    const std::string kept = name.substr(0, name.rfind('~'));
    EXPECT_EQ(static_cast<unsigned char>(kept.back()), 0xa4) << "no half of a character";
  }
  EXPECT_LT(names("body.mesh=" + std::string(3000, 'm'))[0].size(), 200U);
  EXPECT_NE(names("body.mesh=" + std::string(3000, 'm')), names("body.mesh=" + std::string(3001, 'm')));
}

TEST(Sweep, WithoutAxesThereIsOneVariantWithoutAName) {
  const std::vector<Variant> variants = expand_sweeps({}, 10);
  ASSERT_EQ(variants.size(), 1U);
  EXPECT_TRUE(variants[0].values.empty());
  EXPECT_EQ(variants[0].name, "");
}

TEST(Sweep, RefusesAFieldGivenTwiceAndTooManyCombinations) {
  EXPECT_THROW(expand_sweeps({parse_sweep("body.tets=1,2"), parse_sweep("body.tets=3,4")}, 100), Error);
  EXPECT_THROW(expand_sweeps({parse_sweep("body.tets=1..50/50"), parse_sweep("camera.margin=1..3/3")}, 149), Error);
  EXPECT_EQ(expand_sweeps({parse_sweep("body.tets=1..50/50"), parse_sweep("camera.margin=1..3/3")}, 150).size(), 150U);
}

}  // namespace
}  // namespace softreel
