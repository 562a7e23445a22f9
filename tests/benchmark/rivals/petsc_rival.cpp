// PETSc's GAMG: smoothed aggregation with the rigid modes as near-null space, interpolation reused.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <petscksp.h>

#include "tests/benchmark/rivals/rival.h"

namespace softreel::rivals {
namespace {

void check(PetscErrorCode code, const char* call) {
  if (code != 0) throw std::runtime_error(std::string("petsc_gamg: ") + call + " failed");
}

/// One process, one thread: PETSc is parallel by MPI only.
void start_petsc() {
  static const bool started = [] {
    check(PetscInitializeNoArguments(), "PetscInitialize");
    return true;
  }();
  static_cast<void>(started);
}

class PetscGamg : public Rival {
 public:
  explicit PetscGamg(const ScalarSystem& system) : system_(system) {
    start_petsc();
    make_matrix();
    set_near_null_space();
    check(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(system.load.size()), &b_), "VecCreateSeq");
    check(VecDuplicate(b_, &x_), "VecDuplicate");
    check(KSPCreate(PETSC_COMM_SELF, &solver_), "KSPCreate");
    check(KSPSetType(solver_, KSPCG), "KSPSetType");
    check(KSPSetNormType(solver_, KSP_NORM_UNPRECONDITIONED), "KSPSetNormType");
    PC preconditioner = nullptr;
    check(KSPGetPC(solver_, &preconditioner), "KSPGetPC");
    check(PCSetType(preconditioner, PCGAMG), "PCSetType");
    check(PCGAMGSetReuseInterpolation(preconditioner, PETSC_TRUE), "PCGAMGSetReuseInterpolation");
    check(KSPSetOperators(solver_, A_, A_), "KSPSetOperators");
    check(KSPSetUp(solver_), "KSPSetUp");
  }
  ~PetscGamg() override {
    // Nothing can be done about a failure here; the next solver would report it.
    static_cast<void>(KSPDestroy(&solver_));
    static_cast<void>(VecDestroy(&x_));
    static_cast<void>(VecDestroy(&b_));
    static_cast<void>(MatDestroy(&A_));
  }
  PetscGamg(const PetscGamg&) = delete;
  PetscGamg& operator=(const PetscGamg&) = delete;

  const char* name() const override { return "petsc_gamg"; }
  void update() override {
    PetscScalar* values = nullptr;
    check(MatSeqAIJGetArray(A_, &values), "MatSeqAIJGetArray");
    std::copy_n(system_.matrix.valuePtr(), system_.matrix.nonZeros(), values);
    check(MatSeqAIJRestoreArray(A_, &values), "MatSeqAIJRestoreArray");
    check(KSPSetOperators(solver_, A_, A_), "KSPSetOperators");
    check(KSPSetUp(solver_), "KSPSetUp");
  }
  int solve(double tolerance, Eigen::VectorXd& x) override {
    PetscScalar* values = nullptr;
    check(VecGetArray(b_, &values), "VecGetArray");
    std::copy(system_.load.begin(), system_.load.end(), values);
    check(VecRestoreArray(b_, &values), "VecRestoreArray");
    check(KSPSetTolerances(solver_, tolerance, 0, PETSC_DEFAULT, 10000), "KSPSetTolerances");
    check(KSPSolve(solver_, b_, x_), "KSPSolve");
    KSPConvergedReason reason{};
    check(KSPGetConvergedReason(solver_, &reason), "KSPGetConvergedReason");
    if (reason < 0) throw std::runtime_error("petsc_gamg: did not converge");
    const PetscScalar* solution = nullptr;
    check(VecGetArrayRead(x_, &solution), "VecGetArrayRead");
    x = Eigen::Map<const Eigen::VectorXd>(solution, system_.load.size());
    check(VecRestoreArrayRead(x_, &solution), "VecRestoreArrayRead");
    PetscInt iterations = 0;
    check(KSPGetIterationNumber(solver_, &iterations), "KSPGetIterationNumber");
    return static_cast<int>(iterations);
  }

 private:
  /// Row by row; the matrix is symmetric, so its columns are its rows.
  void make_matrix() {
    const auto n = static_cast<PetscInt>(system_.load.size());
    const int* const starts = system_.matrix.outerIndexPtr();
    std::vector<PetscInt> row_lengths;
    for (PetscInt row = 0; row < n; ++row) row_lengths.push_back(starts[row + 1] - starts[row]);
    check(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, row_lengths.data(), &A_), "MatCreateSeqAIJ");
    check(MatSetBlockSize(A_, 3), "MatSetBlockSize");
    for (PetscInt row = 0; row < n; ++row)
      check(MatSetValues(A_, 1, &row, row_lengths[static_cast<std::size_t>(row)],
                         system_.matrix.innerIndexPtr() + starts[row], system_.matrix.valuePtr() + starts[row],
                         INSERT_VALUES),
            "MatSetValues");
    check(MatAssemblyBegin(A_, MAT_FINAL_ASSEMBLY), "MatAssemblyBegin");
    check(MatAssemblyEnd(A_, MAT_FINAL_ASSEMBLY), "MatAssemblyEnd");
    check(MatSetOption(A_, MAT_SPD, PETSC_TRUE), "MatSetOption");
  }

  void set_near_null_space() {
    Vec coordinates = nullptr;
    check(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(system_.load.size()), &coordinates), "VecCreateSeq");
    check(VecSetBlockSize(coordinates, 3), "VecSetBlockSize");
    PetscScalar* values = nullptr;
    check(VecGetArray(coordinates, &values), "VecGetArray");
    for (std::size_t i = 0; i < system_.positions.size(); ++i)
      std::copy(system_.positions[i].begin(), system_.positions[i].end(), values + 3 * i);
    check(VecRestoreArray(coordinates, &values), "VecRestoreArray");
    MatNullSpace modes = nullptr;
    check(MatNullSpaceCreateRigidBody(coordinates, &modes), "MatNullSpaceCreateRigidBody");
    check(MatSetNearNullSpace(A_, modes), "MatSetNearNullSpace");
    check(MatNullSpaceDestroy(&modes), "MatNullSpaceDestroy");
    check(VecDestroy(&coordinates), "VecDestroy");
  }

  const ScalarSystem& system_;
  Mat A_ = nullptr;
  Vec b_ = nullptr, x_ = nullptr;
  KSP solver_ = nullptr;
};

}  // namespace

std::unique_ptr<Rival> make_petsc_gamg(const ScalarSystem& system) {
  return std::make_unique<PetscGamg>(system);
}

}  // namespace softreel::rivals
