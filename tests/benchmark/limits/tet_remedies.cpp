#include "tests/benchmark/limits/tet_remedies.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/elasticity/elastic_body.h"

namespace softreel::bench {
namespace {

/// Of Puso and Solberg: the share of the material that stays with the elements, and the largest lambda of it over mu.
constexpr double kElementShare = 0.05, kLargestRatio = 25;

ElementShape shape_of(const TetMesh& mesh, const Tet& tet) {
  return find_element_shape(nodes_of(tet, mesh.nodes));
}

Vec3 center_of(const TetMesh& mesh, const Tet& tet) {
  Vec3 center = Vec3::Zero();
  for (const Index node : tet) center += 0.25 * mesh.nodes[static_cast<std::size_t>(node)];
  return center;
}

/// One constant strain an element.
std::vector<StrainCell> linear_cells(const TetMesh& mesh, const Lame& material) {
  std::vector<StrainCell> cells;
  for (const Tet& tet : mesh.tets) {
    const ElementShape shape = shape_of(mesh, tet);
    const StrainPoint point{shape.volume, material, shape.gradients, Eigen::Vector4d::Constant(0.25),
                            center_of(mesh, tet)};
    cells.push_back({{tet.begin(), tet.end()}, {point}});
  }
  return cells;
}

/// The mean strain of the elements round each node, weighted by their volumes; a quarter of each belongs to the node.
std::vector<StrainCell> nodal_cells(const TetMesh& mesh, const Lame& material) {
  const NodeElements around = gather_node_elements(mesh.tets, static_cast<Index>(mesh.nodes.size()));
  std::vector<StrainCell> cells;
  for (std::size_t a = 0; a < mesh.nodes.size(); ++a) {
    std::map<Index, Vec3> sums;  // of V / 4 b_i
    double volume = 0;
    for (std::int64_t k = around.offsets[a]; k < around.offsets[a + 1]; ++k) {
      const Tet& tet = mesh.tets[around.entries[static_cast<std::size_t>(k)] / 4];
      const ElementShape shape = shape_of(mesh, tet);
      volume += shape.volume / 4;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto sum = sums.try_emplace(tet[i], Vec3::Zero()).first;
        sum->second += shape.volume / 4 * shape.gradients.col(static_cast<Eigen::Index>(i));
      }
    }
    StrainCell cell;
    StrainPoint point{volume, material, Eigen::Matrix3Xd(3, sums.size()), {}, mesh.nodes[a]};
    for (const auto& [node, sum] : sums) {
      point.gradients.col(static_cast<Eigen::Index>(cell.nodes.size())) = sum / volume;
      cell.nodes.push_back(node);
    }
    cell.points.push_back(std::move(point));
    cells.push_back(std::move(cell));
  }
  return cells;
}

void append(std::vector<StrainCell>& cells, std::vector<StrainCell> more) {
  std::move(more.begin(), more.end(), std::back_inserter(cells));
}

constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

/// Shape functions L_i (2 L_i - 1) of corners and 4 L_i L_j of edges, and their gradients, at barycentric L.
StrainPoint quadratic_point(const Gradients& b, const Vec4& L) {
  StrainPoint point;
  point.gradients.resize(3, 10);
  point.values.resize(10);
  for (Eigen::Index i = 0; i < 4; ++i) {
    point.values[i] = L[i] * (2 * L[i] - 1);
    point.gradients.col(i) = (4 * L[i] - 1) * b.col(i);
  }
  for (std::size_t k = 0; k < 6; ++k) {
    const auto i = static_cast<Eigen::Index>(kEdges[k][0]), j = static_cast<Eigen::Index>(kEdges[k][1]);
    const auto at = static_cast<Eigen::Index>(4 + k);
    point.values[at] = 4 * L[i] * L[j];
    point.gradients.col(at) = 4 * (L[i] * b.col(j) + L[j] * b.col(i));
  }
  return point;
}

Discretization quadratic(const TetMesh& mesh, const Lame& material) {
  // Exact for polynomials of degree 2, which the energy is of.
  const double inner = (5 + 3 * std::sqrt(5.0)) / 20, outer = (5 - std::sqrt(5.0)) / 20;
  Discretization result{mesh.nodes, {}};
  std::map<std::pair<Index, Index>, Index> middles;
  for (const Tet& tet : mesh.tets) {
    StrainCell cell{{tet.begin(), tet.end()}, {}};
    for (const auto& [i, j] : kEdges) {
      const auto [at, added] =
          middles.try_emplace(std::minmax(tet[i], tet[j]), static_cast<Index>(result.nodes.size()));
      const auto place = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
      if (added) result.nodes.push_back(0.5 * (place(i) + place(j)));
      cell.nodes.push_back(at->second);
    }
    const ElementShape shape = shape_of(mesh, tet);
    for (int q = 0; q < 4; ++q) {
      Vec4 L = Vec4::Constant(outer);
      L[q] = inner;
      StrainPoint point = quadratic_point(shape.gradients, L);
      point.weight = shape.volume / 4;
      point.material = material;
      for (std::size_t i = 0; i < 4; ++i)
        point.position += L[static_cast<Eigen::Index>(i)] * mesh.nodes[static_cast<std::size_t>(tet[i])];
      cell.points.push_back(std::move(point));
    }
    result.cells.push_back(std::move(cell));
  }
  return result;
}

}  // namespace

const char* name_of(TetRemedy remedy) {
  switch (remedy) {
    case TetRemedy::Quadratic:
      return "10-node tetrahedra";
    case TetRemedy::NodalPressure:
      return "nodally averaged pressure";
    case TetRemedy::NodalStrain:
      return "nodally averaged strain";
    case TetRemedy::None:
      break;
  }
  return "linear tetrahedra";
}

Discretization discretize(const TetMesh& mesh, TetRemedy remedy, const Lame& material) {
  Discretization result{mesh.nodes, {}};
  switch (remedy) {
    case TetRemedy::None:
      result.cells = linear_cells(mesh, material);
      break;
    case TetRemedy::Quadratic:
      return quadratic(mesh, material);
    case TetRemedy::NodalPressure:
      result.cells = linear_cells(mesh, {-2 * material.mu / 3, material.mu});
      append(result.cells, nodal_cells(mesh, {material.bulk(), 0}));
      break;
    case TetRemedy::NodalStrain: {
      const Lame kept{kElementShare * std::min(material.lambda, kLargestRatio * material.mu),
                      kElementShare * material.mu};
      result.cells = linear_cells(mesh, kept);
      append(result.cells, nodal_cells(mesh, {material.lambda - kept.lambda, material.mu - kept.mu}));
      break;
    }
  }
  return result;
}

}  // namespace softreel::bench
