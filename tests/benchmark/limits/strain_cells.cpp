#include "tests/benchmark/limits/strain_cells.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <Eigen/SparseCholesky>

#include "tests/benchmark/bench.h"

namespace softreel::bench {
namespace {

/// Small systems are solved again for this long, s, as the first time pays for memory.
constexpr double kTiming = 0.02;

/// Sum of weight (lambda b_i b_j^T + mu b_j b_i^T + mu (b_i . b_j) I) over the cell's points.
Eigen::MatrixXd cell_stiffness(const StrainCell& cell) {
  const auto n = static_cast<Eigen::Index>(cell.nodes.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (const StrainPoint& point : cell.points) {
    const Eigen::Matrix3Xd& b = point.gradients;
    const double lambda = point.weight * point.material.lambda, mu = point.weight * point.material.mu;
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) {
        const Vec3 b_i = b.col(i), b_j = b.col(j);
        Mat3 block = lambda * b_i * b_j.transpose() + mu * b_j * b_i.transpose();
        block.diagonal().array() += mu * b_i.dot(b_j);
        K.block<3, 3>(3 * i, 3 * j) += block;
      }
  }
  return K;
}

/// Solves K u = load; processor time of one solution, s: the least of as many as fit into kTiming.
double time_factor(const Eigen::SparseMatrix<double>& K, const Eigen::VectorXd& load, Eigen::VectorXd& u) {
  double least = std::numeric_limits<double>::infinity();
  const double begin = thread_seconds();
  do {
    const double start = thread_seconds();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(K);
    u = solver.solve(load);
    least = std::min(least, thread_seconds() - start);
    if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > 0))
      throw std::runtime_error("limits: a stiffness matrix is not definite");
  } while (thread_seconds() - begin < kTiming);
  return least;
}

class StaticSystem {
 public:
  StaticSystem(const Discretization& discretization, const HeldComponents& held) : discretization_(discretization) {
    for (const Vec3& node : discretization.nodes)
      for (const bool is_held : held(node)) numbers_.push_back(is_held ? -1 : unknowns_++);
  }

  HeldDisplacements solve(const BodyForce& force) const {
    const Eigen::SparseMatrix<double> K = stiffness();
    const Eigen::VectorXd load = find_load(force);
    HeldDisplacements answer{{}, unknowns_, K.nonZeros(), 0};
    Eigen::VectorXd u;
    answer.solve_seconds = time_factor(K, load, u);
    for (std::size_t i = 0; i < discretization_.nodes.size(); ++i) {
      Vec3& displacement = answer.displacements.emplace_back(Vec3::Zero());
      for (std::size_t c = 0; c < 3; ++c)
        if (const Index row = numbers_[3 * i + c]; row >= 0) displacement[static_cast<Eigen::Index>(c)] = u[row];
    }
    return answer;
  }

 private:
  Index number(Index node, Eigen::Index component) const {
    return numbers_[static_cast<std::size_t>(3 * node + component)];
  }

  Eigen::SparseMatrix<double> stiffness() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const StrainCell& cell : discretization_.cells) {
      const Eigen::MatrixXd K = cell_stiffness(cell);
      for (Eigen::Index j = 0; j < K.cols(); ++j)
        for (Eigen::Index i = 0; i < K.rows(); ++i) {
          const Index row = number(cell.nodes[static_cast<std::size_t>(i / 3)], i % 3);
          const Index column = number(cell.nodes[static_cast<std::size_t>(j / 3)], j % 3);
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, K(i, j));
        }
    }
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

  Eigen::VectorXd find_load(const BodyForce& force) const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(unknowns_);
    for (const StrainCell& cell : discretization_.cells)
      for (const StrainPoint& point : cell.points) {
        if (point.values.size() == 0) continue;
        const Vec3 weighted = point.weight * force(point.position);
        for (std::size_t i = 0; i < cell.nodes.size(); ++i)
          for (Eigen::Index c = 0; c < 3; ++c)
            if (const Index row = number(cell.nodes[i], c); row >= 0)
              load[row] += point.values[static_cast<Eigen::Index>(i)] * weighted[c];
      }
    return load;
  }

  const Discretization& discretization_;
  std::vector<Index> numbers_;  ///< per node and component; -1: held
  Index unknowns_ = 0;
};

}  // namespace

Lame Lame::of(double youngs_modulus, double poisson_ratio) {
  return {youngs_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio)),
          youngs_modulus / (2 * (1 + poisson_ratio))};
}

HeldDisplacements solve_statics(const Discretization& discretization, const HeldComponents& held,
                                const BodyForce& force) {
  return StaticSystem(discretization, held).solve(force);
}

}  // namespace softreel::bench
