#include "core/elasticity/thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/elasticity/elastic_body.h"
#include "core/elasticity/element.h"

namespace softreel {
namespace {

constexpr double kReach = 2;        ///< of a ball, in radii: above the root of 3, as nodes are seldom at the middle
constexpr double kSameModulus = 2;  ///< ratio up to which neighbours bend as one

std::span<const Index> neighbors_of(const BlockPattern& pattern, Index node) {
  const auto i = static_cast<std::size_t>(node);
  const auto first = static_cast<std::size_t>(pattern.row_offsets[i]),
             last = static_cast<std::size_t>(pattern.row_offsets[i + 1]);
  return std::span(pattern.column_indices).subspan(first, last - first);
}

/// 1 per node whose elements do not bend as one.
std::vector<std::uint8_t> find_seams(const TetMesh& mesh, std::span<const double> moduli) {
  const std::size_t n = mesh.nodes.size();
  std::vector<double> least(n, std::numeric_limits<double>::infinity()), greatest(n, 0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (const Index node : mesh.tets[e]) {
      const auto i = static_cast<std::size_t>(node);
      least[i] = std::min(least[i], moduli[e]);
      greatest[i] = std::max(greatest[i], moduli[e]);
    }
  std::vector<std::uint8_t> seams(n);
  for (std::size_t i = 0; i < n; ++i) seams[i] = greatest[i] > kSameModulus * least[i] ? 1 : 0;
  return seams;
}

/// Nodes of the boundary and of seams.
std::vector<Index> find_ends(const TetMesh& mesh, std::vector<std::uint8_t> seams) {
  for (const Triangle& face : boundary_faces(mesh))
    for (const Index node : face) seams[static_cast<std::size_t>(node)] = 1;
  std::vector<Index> ends;
  for (std::size_t i = 0; i < seams.size(); ++i)
    if (seams[i] != 0) ends.push_back(static_cast<Index>(i));
  return ends;
}

/// Distance from each node to the nearest of `ends`, as far as nodes pass on which is theirs.
std::vector<double> find_depths(const std::vector<Vec3>& nodes, const BlockPattern& neighbors,
                                std::vector<Index> front) {
  std::vector<double> depths(nodes.size(), std::numeric_limits<double>::infinity());
  std::vector<Index> nearest(nodes.size(), -1), next;
  for (const Index end : front) {
    depths[static_cast<std::size_t>(end)] = 0;
    nearest[static_cast<std::size_t>(end)] = end;
  }
  for (; !front.empty(); front.swap(next)) {
    next.clear();
    for (const Index node : front) {
      const Index end = nearest[static_cast<std::size_t>(node)];
      for (const Index neighbor : neighbors_of(neighbors, node)) {
        const auto j = static_cast<std::size_t>(neighbor);
        const double distance = (nodes[j] - nodes[static_cast<std::size_t>(end)]).norm();
        if (!(distance < depths[j])) continue;
        depths[j] = distance;
        nearest[j] = end;
        next.push_back(neighbor);
      }
    }
  }
  return depths;
}

/// Radius of the thickest ball that reaches each node, through nodes that no thicker one has reached; 0 on seams, which
/// stop it.
std::vector<double> find_radii(const std::vector<Vec3>& nodes, const BlockPattern& neighbors,
                               const std::vector<double>& depths, const std::vector<std::uint8_t>& seams) {
  std::vector<Index> order(nodes.size()), reached;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return depths[static_cast<std::size_t>(a)] > depths[static_cast<std::size_t>(b)];
  });
  std::vector<double> radii(nodes.size(), -1);
  for (std::size_t i = 0; i < radii.size(); ++i)
    if (seams[i] != 0) radii[i] = 0;
  for (const Index center : order) {
    const auto c = static_cast<std::size_t>(center);
    radii[c] = std::max(radii[c], depths[c]);
    reached.assign(1, center);
    while (!reached.empty()) {
      const Index node = reached.back();
      reached.pop_back();
      for (const Index neighbor : neighbors_of(neighbors, node)) {
        const auto j = static_cast<std::size_t>(neighbor);
        if (radii[j] >= 0 || (nodes[j] - nodes[c]).norm() > kReach * depths[c]) continue;
        radii[j] = depths[c];
        reached.push_back(neighbor);
      }
    }
  }
  return radii;
}

}  // namespace

std::vector<double> find_thickness(const TetMesh& mesh, const BlockPattern& neighbors, std::span<const double> moduli) {
  const std::vector<std::uint8_t> seams = find_seams(mesh, moduli);
  const std::vector<double> radii =
      find_radii(mesh.nodes, neighbors, find_depths(mesh.nodes, neighbors, find_ends(mesh, seams)), seams);
  std::vector<double> thickness;
  thickness.reserve(mesh.tets.size());
  for (const Tet& tet : mesh.tets) {
    double radius = 0;
    for (const Index node : tet) radius = std::max(radius, radii[static_cast<std::size_t>(node)]);
    const Gradients gradients = find_element_shape(nodes_of(tet, mesh.nodes)).gradients;
    const double least_height = 1 / std::sqrt(gradients.colwise().squaredNorm().maxCoeff());
    thickness.push_back(std::max(2 * radius, least_height));
  }
  return thickness;
}

}  // namespace softreel
