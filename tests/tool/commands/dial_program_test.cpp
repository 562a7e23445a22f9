/// The error dial through the program: turned once, kept with what depends on it, and said in the report.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;
using nlohmann::json;

class ErrorDialOfTheProgram : public ::testing::Test {
 protected:
  /// The sphere without a size of its own, under solver.error.
  void start(const std::string& name) {
    folder_ = new_folder(name);
    std::string shot = sphere_shot("[solver]\nerror = \"10%\"\n");
    const std::string size = "tets = 700\n";
    shot.erase(shot.find(size), size.size());
    write_text(folder_ + "/sphere.obj", sphere_obj(12));
    write_text(folder_ + "/shot.toml", shot);
  }
  json report_of(const std::string& command, const std::string& options = "") {
    const Outcome outcome =
        run(fmt::format("softreel {0} {1}/shot.toml --output {1}/out --json {2}", command, folder_, options));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out);
  }

  std::string folder_;
};

TEST_F(ErrorDialOfTheProgram, IsTurnedOnceAndTheSecondRunDoesNothing) {
  start("dial_once");
  const json first = report_of("simulate", "--quiet");
  const json& error = first["bodies"][0]["error"];
  EXPECT_FALSE(error["from_cache"].get<bool>());
  EXPECT_DOUBLE_EQ(error["asked"], 0.1);
  EXPECT_TRUE(error["reached"].get<bool>());
  EXPECT_LE(error["believed"].get<double>(), 0.101);
  EXPECT_GE(error["tets"].get<int>(), 1500);
  EXPECT_NEAR(first["bodies"][0]["tets"].get<double>() / error["tets"].get<double>(), 1, 0.05);
  EXPECT_EQ(first["simulation"]["computed"], 4);
  const json second = report_of("simulate", "--quiet");
  EXPECT_TRUE(second["bodies"][0]["error"]["from_cache"].get<bool>());
  EXPECT_EQ(second["bodies"][0]["error"]["believed"], error["believed"]);
  EXPECT_EQ(second["simulation"]["computed"], 0);
}

TEST_F(ErrorDialOfTheProgram, IsInTheStatusAndAnotherErrorTurnsItAgain) {
  start("dial_status");
  const auto condition = [this](const std::string& options) {
    const json status = report_of("status", options);
    for (const json& stage : status["stages"])
      if (stage["stage"] == "dial") return stage["condition"].get<std::string>();
    return std::string("not listed");
  };
  EXPECT_EQ(condition(""), "missing");
  EXPECT_FALSE(exists(folder_ + "/out")) << "asking turns nothing";
  report_of("simulate", "--quiet");
  EXPECT_EQ(condition(""), "done");
  EXPECT_NE(condition("--set solver.error=20%"), "done");
}

TEST_F(ErrorDialOfTheProgram, RefusesWhatItsLimitsDoNotReach) {
  start("dial_limits");
  const Outcome outcome =
      run(fmt::format("softreel simulate {0}/shot.toml --output {0}/out --quiet --set solver.error=0.001% --set "
                      "solver.max_tets=13000 --set solver.max_substeps=4",
                      folder_));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("is not reached for body \"ball\""), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("Raise error, or these two."), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace softreel
