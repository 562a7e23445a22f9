#include "tests/support/elastic_box.h"

#include <algorithm>
#include <map>

namespace softreel::test_support {
namespace {

/// Numbers lattice nodes (in units of h / 2) in the order of their first use.
class NodeNumbers {
 public:
  NodeNumbers(TetMesh& mesh, double h) : mesh_(mesh), h_(h) {}
  Index operator()(std::array<Index, 3> node) {
    const auto [place, added] = numbers_.try_emplace(node, static_cast<Index>(mesh_.nodes.size()));
    if (added) mesh_.nodes.push_back(0.5 * h_ * Vec3(node[0], node[1], node[2]));
    return place->second;
  }

 private:
  TetMesh& mesh_;
  double h_;
  std::map<std::array<Index, 3>, Index> numbers_;
};

void add_tet(TetMesh& mesh, Tet tet) {
  const auto& x = mesh.nodes;
  const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(tet[k])]; };
  if (tet_volume(at(0), at(1), at(2), at(3)) < 0) std::swap(tet[2], tet[3]);
  mesh.tets.push_back(tet);
}

}  // namespace

TetMesh make_box(std::array<Index, 3> cubes, double h, const std::function<bool(Index, Index, Index)>& keep) {
  TetMesh mesh;
  mesh.lattice = {Vec3::Zero(), h};
  NodeNumbers number(mesh, h);
  const auto exists = [&](const std::array<Index, 3>& c) {
    for (std::size_t k = 0; k < 3; ++k)
      if (c[k] < 0 || c[k] >= cubes[k]) return false;
    return !keep || keep(c[0], c[1], c[2]);
  };
  for (Index z = 0; z < cubes[2]; ++z)
    for (Index y = 0; y < cubes[1]; ++y)
      for (Index x = 0; x < cubes[0]; ++x) {
        const std::array<Index, 3> cube{x, y, z};
        if (!exists(cube)) continue;
        const std::array<Index, 3> center{2 * x + 1, 2 * y + 1, 2 * z + 1};
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const Index side : {-1, 1}) {
            std::array<Index, 3> neighbor = cube, beyond = center;
            neighbor[axis] += side;
            beyond[axis] += 2 * side;
            const bool inner = exists(neighbor);
            if (inner && side < 0) continue;  // made from the other side
            const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
            std::array<Index, 4> corner;
            for (std::size_t k = 0; k < 4; ++k) {
              std::array<Index, 3> node = center;
              node[axis] += side;
              node[a] += k == 0 || k == 3 ? -1 : 1;
              node[b] += k < 2 ? -1 : 1;
              corner[k] = number(node);
            }
            const Index middle = number(center);
            if (inner) {
              const Index other = number(beyond);
              for (std::size_t k = 0; k < 4; ++k) add_tet(mesh, {middle, other, corner[k], corner[(k + 1) % 4]});
            } else {
              add_tet(mesh, {middle, corner[0], corner[1], corner[2]});
              add_tet(mesh, {middle, corner[0], corner[2], corner[3]});
            }
          }
      }
  return mesh;
}

TetMesh make_bar(Index across) {
  return make_box({4 * across, across, across}, 0.25 / across);
}

namespace {

using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

/// Shape gradients of a tetrahedron, one a row.
Eigen::Matrix<double, 4, 3> gradients(const TetMesh& mesh, const Tet& tet) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) = mesh.nodes[static_cast<std::size_t>(tet[static_cast<std::size_t>(k) + 1])] -
                   mesh.nodes[static_cast<std::size_t>(tet[0])];
  Eigen::Matrix<double, 4, 3> result;
  result.bottomRows<3>() = edges.inverse();
  result.row(0) = -result.bottomRows<3>().colwise().sum();
  return result;
}

void pin(ElasticSystem& system, const TetMesh& mesh, const std::function<bool(const Vec3&)>& is_pinned) {
  BlockMatrixd& K = system.matrix;
  const Index nodes = K.pattern.rows();
  double mean = 0;
  for (Index i = 0; i < nodes; ++i) mean += Block(K.block(K.pattern.find(i, i))).trace() / (3.0 * nodes);
  for (const Vec3& node : mesh.nodes) system.pinned.push_back(is_pinned && is_pinned(node) ? 1 : 0);
  for (Index i = 0; i < nodes; ++i)
    for (std::int64_t b = K.pattern.row_offsets[static_cast<std::size_t>(i)];
         b < K.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
      const Index j = K.pattern.column_indices[static_cast<std::size_t>(b)];
      if (!system.pinned[static_cast<std::size_t>(i)] && !system.pinned[static_cast<std::size_t>(j)]) continue;
      Block{K.block(b)} = i == j ? Mat3(mean * Mat3::Identity()) : Mat3(Mat3::Zero());
    }
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    if (system.pinned[i]) system.load[i].setZero();
}

}  // namespace

ElasticSystem assemble(const TetMesh& mesh, const ElasticParams& params,
                       const std::function<bool(const Vec3&)>& is_pinned, std::span<const double> stiffness_factor,
                       std::span<const Mat3> rotations) {
  ElasticSystem system;
  BlockMatrixd& K = system.matrix;
  K.pattern = stiffness_pattern(mesh.tets, static_cast<Index>(mesh.nodes.size()));
  K.values.assign(static_cast<std::size_t>(9 * K.pattern.blocks()), 0.0);
  system.load.assign(mesh.nodes.size(), Vec3::Zero());
  const double nu = params.poisson_ratio;
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const Tet& tet = mesh.tets[e];
    const double E = params.youngs_modulus * (stiffness_factor.empty() ? 1.0 : stiffness_factor[e]);
    const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
    const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
    const double V = mesh.fill_of(e) * tet_volume(at(0), at(1), at(2), at(3)), mass = 0.25 * V * params.density;
    Eigen::Matrix<double, 4, 3> a = gradients(mesh, tet);
    if (!rotations.empty()) a = a * rotations[e].transpose();
    for (int i = 0; i < 4; ++i) {
      const Index row = tet[static_cast<std::size_t>(i)];
      system.load[static_cast<std::size_t>(row)] += mass * Vec3(0, -9.81, 0);
      for (int j = 0; j < 4; ++j) {
        Block block(K.block(K.pattern.find(row, tet[static_cast<std::size_t>(j)])));
        const Vec3 a_i = a.row(i), a_j = a.row(j);
        block +=
            V * (lambda * a_i * a_j.transpose() + mu * a_j * a_i.transpose() + mu * a_i.dot(a_j) * Mat3::Identity());
        if (i == j && params.seconds > 0) block += mass / (params.seconds * params.seconds) * Mat3::Identity();
      }
    }
  }
  pin(system, mesh, is_pinned);
  return system;
}

double relative_residual(const BlockMatrixd& A, const std::vector<Vec3>& b, const std::vector<Vec3>& x) {
  double r = 0, scale = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    Vec3 rest = b[i];
    for (std::int64_t k = A.pattern.row_offsets[i]; k < A.pattern.row_offsets[i + 1]; ++k)
      rest -= Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(A.block(k)) *
              x[static_cast<std::size_t>(A.pattern.column_indices[static_cast<std::size_t>(k)])];
    r += rest.squaredNorm();
    scale += b[i].squaredNorm();
  }
  return std::sqrt(r / scale);
}

Eigen::MatrixXd dense(const BlockMatrixd& A) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * A.pattern.rows(), 3 * A.pattern.columns);
  for (Index i = 0; i < A.pattern.rows(); ++i)
    for (std::int64_t b = A.pattern.row_offsets[static_cast<std::size_t>(i)];
         b < A.pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b)
      result.block<3, 3>(3 * i, 3 * A.pattern.column_indices[static_cast<std::size_t>(b)]) =
          Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(A.block(b));
  return result;
}

}  // namespace softreel::test_support
