/// What is printed arrives, or the program does not say that it was done.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

TEST(StandardOutput, ThatTakesNothingIsSaidWithStatusOne) {
  const std::string folder = shot_folder("output_full");
  for (const char* command :
       {"--help", "--version", "--version --json", "man", "fields", "explain", "explain body.*.tets --json",
        "completion bash", "render --help", "check {0}/shot.toml", "status {0}/shot.toml --output {0}/out --json",
        "inspect {0}/sphere.obj --json", "new {0}/sphere.obj -o - --tets 500"}) {
    const Outcome outcome = run(fmt::format("softreel {} >/dev/full", fmt::format(fmt::runtime(command), folder)));
    EXPECT_EQ(outcome.status, 1) << command;
    EXPECT_NE(outcome.err.find("softreel: cannot write to standard output: No space left on device\n"),
              std::string::npos)
        << command << ": " << outcome.err;
  }
}

TEST(StandardOutput, WhoseReaderIsGoneEndsTheProgramInSilence) {
  // The reader has closed it before the program prints; whether the signal is ignored is inherited.
  for (const char* before : {"", "trap '' PIPE; "}) {
    const Outcome outcome = run(fmt::format("{}(sleep 0.2; (softreel fields); echo $? >&2) | true", before));
    EXPECT_EQ(outcome.err.find("softreel"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err, "0\n");
  }
}

TEST(StandardOutput, ThatIsClosedMattersToWhatPrintsOnly) {
  EXPECT_EQ(run("softreel fields >&-").status, 1);
  EXPECT_EQ(run("softreel rendr >/dev/full").status, 2) << "a mistake keeps its status";
}

}  // namespace
}  // namespace softreel
