/// solver.error in a shot: what it leaves open, what stays, and what contradicts it.
#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

class ErrorDialOfAShot : public ShotFiles {
 protected:
  static std::string with_error(const std::string& of_body, const std::string& of_solver) {
    return body(of_body) + "[solver]\nerror = \"0.5%\"\n" + of_solver;
  }
};

TEST_F(ErrorDialOfAShot, LeavesOpenWhatIsNotGivenAlsoWhenWrittenAndReadAgain) {
  const Shot shot = load(with_error("", ""));
  for (const Shot& s : {shot, load(to_toml(shot))}) {
    EXPECT_DOUBLE_EQ(s.dial.error, 0.005);
    EXPECT_EQ(s.bodies[0].tets, 0);
    EXPECT_EQ(s.solver.substeps, 0);
    EXPECT_EQ(s.solver.tolerance, 0);
    EXPECT_EQ(s.solver.integrator, Integrator::Bdf2);
  }
}

TEST_F(ErrorDialOfAShot, KeepsWhatIsGiven) {
  const Shot shot = load(with_error("tets = 5000\n", "substeps = 3\ntolerance = 1e-4\nintegrator = \"newmark\"\n"));
  EXPECT_EQ(shot.bodies[0].tets, 5000);
  EXPECT_EQ(shot.solver.substeps, 3);
  EXPECT_EQ(shot.solver.tolerance, 1e-4);
  EXPECT_EQ(shot.solver.integrator, Integrator::Newmark);
}

TEST_F(ErrorDialOfAShot, ContradictsControlOfTheStepsAndLengths) {
  EXPECT_NE(message(with_error("", "step_error = 1e-4\n")).find("both choose the steps"), std::string::npos);
  EXPECT_NE(message(body("[solver]\nerror = 0.01\n")).find("solver.error"), std::string::npos);
  EXPECT_NE(message(body("[solver]\nerror = \"0%\"\n")).find("solver.error"), std::string::npos);
}

}  // namespace
}  // namespace softreel
