#include "core/skinning/skinning.h"

#include <algorithm>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr std::int64_t kSkinningGrain = 2048;

/// Of an edge: a point whose weights give another place by more than that was not embedded where it is.
constexpr double kApart = 1e-6;

/// Edge vectors of an element from its first node, as columns.
Mat3 edges_of(const Tet& tet, const std::vector<Vec3>& x) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = x[at(tet[static_cast<std::size_t>(k) + 1])] - x[at(tet[0])];
  return edges;
}

/// The rotation of an element, proper also where it is inverted.
Mat3 rotation_of(const Tet& tet, const TetMesh& mesh, const std::vector<Vec3>& node_positions) {
  const Mat3 gradient = edges_of(tet, node_positions) * edges_of(tet, mesh.nodes).inverse();
  if (!gradient.allFinite()) return Mat3::Identity();
  const Eigen::JacobiSVD<Mat3> svd(gradient, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return u * svd.matrixV().transpose();
}

/// Elements of each node, ascending.
struct ElementLists {
  std::vector<Index> offsets, elements;
};

ElementLists elements_of_nodes(const TetMesh& mesh) {
  ElementLists list;
  list.offsets.assign(mesh.nodes.size() + 1, 0);
  for (const Tet& tet : mesh.tets)
    for (const Index node : tet) ++list.offsets[at(node) + 1];
  for (std::size_t i = 1; i < list.offsets.size(); ++i) list.offsets[i] += list.offsets[i - 1];
  list.elements.resize(4 * mesh.tets.size());
  std::vector<Index> next(list.offsets.begin(), list.offsets.end() - 1);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (const Index node : mesh.tets[e]) list.elements[at(next[at(node)]++)] = static_cast<Index>(e);
  return list;
}

/// Deformation gradients, averaged by volume of material over the elements of each node; only of nodes that are wanted.
std::vector<Mat3> nodal_gradients(const TetMesh& mesh, const std::vector<Vec3>& node_positions,
                                  const std::vector<bool>& wanted, const Threads& threads) {
  const ElementLists list = elements_of_nodes(mesh);
  std::vector<Mat3> gradients(mesh.nodes.size(), Mat3::Identity());
  threads.for_chunks(static_cast<std::int64_t>(mesh.nodes.size()), kSkinningGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto node = static_cast<std::size_t>(begin); node < static_cast<std::size_t>(end); ++node) {
                         if (!wanted[node] || list.offsets[node] == list.offsets[node + 1]) continue;
                         Mat3 sum = Mat3::Zero();
                         double volume = 0;
                         for (Index i = list.offsets[node]; i < list.offsets[node + 1]; ++i) {
                           const Tet& tet = mesh.tets[at(list.elements[at(i)])];
                           const Mat3 rest = edges_of(tet, mesh.nodes);
                           const double weight = mesh.fill_of(at(list.elements[at(i)])) * rest.determinant();
                           sum += weight * (edges_of(tet, node_positions) * rest.inverse());
                           volume += weight;
                         }
                         gradients[node] = sum / volume;
                       }
                     });
  return gradients;
}

/// det(F) F^-T without the division: columns are cross products of the others, so that it exists for any F.
Mat3 cofactor(const Mat3& F) {
  Mat3 c;
  c.col(0) = F.col(1).cross(F.col(2));
  c.col(1) = F.col(2).cross(F.col(0));
  c.col(2) = F.col(0).cross(F.col(1));
  return c;
}

/// Nodes of the elements that carry points.
std::vector<bool> carrying_nodes(const Embedding& embedding, const TetMesh& mesh) {
  std::vector<bool> carrying(mesh.nodes.size(), false);
  for (const Index element : embedding.elements)
    for (const Index node : mesh.tets[at(element)]) carrying[at(node)] = true;
  return carrying;
}

}  // namespace

std::vector<Vec3> skin_positions(const std::vector<Vec3>& rest_points, const Embedding& embedding, const TetMesh& mesh,
                                 const std::vector<Vec3>& node_positions, const Threads& threads) {
  CHECK(rest_points.size() == embedding.elements.size());
  CHECK(node_positions.size() == mesh.nodes.size());
  std::vector<Vec3> positions(rest_points.size());
  threads.for_chunks(static_cast<std::int64_t>(positions.size()), kSkinningGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         const Tet& tet = mesh.tets[at(embedding.elements[i])];
                         Vec3 displacement = Vec3::Zero(), carried = Vec3::Zero();
                         double moved = 0;
                         for (std::size_t k = 0; k < 4; ++k) {
                           const Vec3 move = node_positions[at(tet[k])] - mesh.nodes[at(tet[k])];
                           displacement += embedding.weights[i][k] * move;
                           carried += embedding.weights[i][k] * mesh.nodes[at(tet[k])];
                           moved = std::max(moved, move.squaredNorm());
                         }
                         // A point too far outside goes with the nearest one of the boundary, and stands off from there
                         // as the element turns.
                         const Vec3 apart = rest_points[i] - carried;
                         const double size2 = (mesh.nodes[at(tet[1])] - mesh.nodes[at(tet[0])]).squaredNorm();
                         if (moved > 0 && apart.squaredNorm() > kApart * kApart * size2)
                           displacement += rotation_of(tet, mesh, node_positions) * apart - apart;
                         positions[i] = rest_points[i] + displacement;
                       }
                     });
  return positions;
}

std::vector<Vec3> skin_normals(const std::vector<Vec3>& rest_normals, const Embedding& embedding, const TetMesh& mesh,
                               const std::vector<Vec3>& node_positions, const Threads& threads,
                               std::span<const Index> points) {
  CHECK(rest_normals.size() == (points.empty() ? embedding.elements.size() : points.size()));
  CHECK(node_positions.size() == mesh.nodes.size());
  const std::vector<Mat3> gradients = nodal_gradients(mesh, node_positions, carrying_nodes(embedding, mesh), threads);
  std::vector<Vec3> normals(rest_normals.size());
  threads.for_chunks(
      static_cast<std::int64_t>(normals.size()), kSkinningGrain, [&](std::int64_t begin, std::int64_t end) {
        for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
          const std::size_t point = points.empty() ? i : at(points[i]);
          const Tet& tet = mesh.tets[at(embedding.elements[point])];
          Mat3 gradient = Mat3::Zero();
          for (std::size_t k = 0; k < 4; ++k) gradient += embedding.weights[point][k] * gradients[at(tet[k])];
          const Vec3 normal = cofactor(gradient) * rest_normals[i];
          const double length = normal.norm();
          normals[i] =
              length > 0 ? Vec3(normal / length) : rest_normals[i];  // flattened to a line: no direction is right
        }
      });
  return normals;
}

std::vector<double> skin_values(const std::vector<double>& element_values, const Embedding& embedding,
                                const TetMesh& mesh, const Threads& threads) {
  CHECK(element_values.size() == mesh.tets.size());
  std::vector<double> sums(mesh.nodes.size(), 0.0), volumes(mesh.nodes.size(), 0.0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const double volume = mesh.fill_of(e) * edges_of(mesh.tets[e], mesh.nodes).determinant();
    for (const Index node : mesh.tets[e]) {
      sums[at(node)] += volume * element_values[e];
      volumes[at(node)] += volume;
    }
  }
  for (std::size_t n = 0; n < sums.size(); ++n)
    if (volumes[n] > 0) sums[n] /= volumes[n];
  std::vector<double> values(embedding.elements.size());
  threads.for_chunks(static_cast<std::int64_t>(values.size()), kSkinningGrain,
                     [&](std::int64_t begin, std::int64_t end) {
                       for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                         const Tet& tet = mesh.tets[at(embedding.elements[i])];
                         std::array<double, 4> nodal{};
                         for (std::size_t k = 0; k < 4; ++k) nodal[k] = sums[at(tet[k])];
                         double value = 0;
                         for (std::size_t k = 0; k < 4; ++k) value += embedding.weights[i][k] * nodal[k];
                         const auto [least, most] = std::minmax_element(nodal.begin(), nodal.end());
                         values[i] = std::clamp(value, *least, *most);
                       }
                     });
  return values;
}

}  // namespace softreel
