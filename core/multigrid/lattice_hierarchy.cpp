#include "core/multigrid/lattice_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/base/check.h"
#include "core/multigrid/coarse_solver.h"

namespace softreel {
namespace {

/// Coarsening that keeps more nodes than this share ends the hierarchy: further levels would not pay.
constexpr double kLeastReduction = 0.8;

/// A level is the last if factoring it takes at most so many multiply-adds a block of the mesh's matrix: then it costs
/// less than the iterations it saves (slender and thin bodies, which coarse lattices bend badly).
constexpr double kCheapFactorWork = 100;

/// A level that ends the hierarchy although factoring it takes more multiply-adds a block of the mesh's matrix, some
/// times what a step takes otherwise, is worth another try.
constexpr double kDearFactorWork = 1000;

/// Multiply-adds that no step can wait for, about half a minute. Up to there flat tetrahedra are best factored: cycles
/// on lattices far coarser than they are thick took 100 iterations at 10 to 1 and did not converge at 100 to 1.
constexpr double kMostFactorWork = 1e11;

/// Copies by stiffness that make more than so many times the coarse nodes are left out altogether: where stiff and soft
/// elements are mixed one by one, copies carry nothing together and each level is nearly as large as the one before. At
/// a contrast of 1e4 in a tenth of the elements that saved two thirds of the time for a quarter more iterations.
constexpr double kMostCopies = 2;

/// Lattice coordinates are kept far inside the range of lattice_key.
constexpr double kMostSpacings = 500000;

Vec3 lower_corner(const std::vector<Vec3>& points) {
  Vec3 low = points.front();
  for (const Vec3& point : points) low = low.cwiseMin(point);
  return low;
}

Vec3 upper_corner(const std::vector<Vec3>& points) {
  Vec3 high = points.front();
  for (const Vec3& point : points) high = high.cwiseMax(point);
  return high;
}

double volume_of(const TetMesh& mesh, const Tet& tet) {
  const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(tet[k])]; };
  return std::abs(tet_volume(at(0), at(1), at(2), at(3)));
}

/// Spacing of the BCC lattice whose tetrahedra, 12 per cube, have the mesh's median volume; 0 for no tetrahedra.
/// Volume, not edges: it says how many nodes there are, and the median minds neither slivers nor a few large elements.
double typical_spacing(const TetMesh& mesh) {
  std::vector<double> volumes;
  for (const Tet& tet : mesh.tets) volumes.push_back(volume_of(mesh, tet));
  if (volumes.empty()) return 0;
  const auto middle = volumes.begin() + static_cast<std::ptrdiff_t>(volumes.size() / 2);
  std::nth_element(volumes.begin(), middle, volumes.end());
  return std::cbrt(12 * *middle);
}

/// The same around each node, from the mean volume of its tetrahedra; of a node of none `otherwise`.
std::vector<double> node_spacings(const TetMesh& mesh, double otherwise) {
  std::vector<double> volumes(mesh.nodes.size(), 0.0), tets(mesh.nodes.size(), 0.0);
  for (const Tet& tet : mesh.tets) {
    const double volume = volume_of(mesh, tet);
    for (const Index node : tet) {
      volumes[static_cast<std::size_t>(node)] += volume;
      ++tets[static_cast<std::size_t>(node)];
    }
  }
  std::vector<double> spacings;
  for (std::size_t i = 0; i < volumes.size(); ++i)
    spacings.push_back(tets[i] > 0 ? std::cbrt(12 * volumes[i] / tets[i]) : otherwise);
  return spacings;
}

/// The lattice whose doublings cover the mesh: its own, or for a mesh made elsewhere one of like tetrahedra.
LatticeFrame finest_frame(const TetMesh& mesh) {
  LatticeFrame frame = mesh.lattice;
  const Vec3 low = lower_corner(mesh.nodes);
  const double extent = (upper_corner(mesh.nodes) - low).maxCoeff();
  if (!(frame.spacing > 0)) frame = {low, typical_spacing(mesh)};
  if (!(frame.spacing > 0)) frame.spacing = extent > 0 ? extent : 1.0;
  // A frame far away or absurdly fine for the mesh would leave the range of lattice coordinates.
  const double reach = (low - frame.origin).cwiseAbs().maxCoeff() + extent;
  if (2 * reach / frame.spacing > kMostSpacings) frame.origin = low;
  frame.spacing = std::max(frame.spacing, 2 * extent / kMostSpacings);
  return frame;
}

/// Young's modulus of the stiffest element with both nodes, per block; empty if all are alike within `contrast`.
std::vector<double> block_stiffness(const TetMesh& mesh, std::span<const double> element_stiffness,
                                    const BlockPattern& pattern, double contrast) {
  if (element_stiffness.empty()) return {};
  CHECK(element_stiffness.size() == mesh.tets.size());
  const auto [least, greatest] = std::minmax_element(element_stiffness.begin(), element_stiffness.end());
  if (*greatest <= contrast * *least) return {};
  std::vector<double> stiffest(static_cast<std::size_t>(pattern.blocks()), 0.0);
  for (std::size_t e = 0; e < mesh.tets.size(); ++e)
    for (const Index i : mesh.tets[e])
      for (const Index j : mesh.tets[e]) {
        double& value = stiffest[static_cast<std::size_t>(pattern.find(i, j))];
        value = std::max(value, element_stiffness[e]);
      }
  // A block of no element joins bodies (glue), as stiff as the softer of its ends.
  for (Index i = 0; i < pattern.rows(); ++i)
    for (std::int64_t b = pattern.row_offsets[static_cast<std::size_t>(i)];
         b < pattern.row_offsets[static_cast<std::size_t>(i) + 1]; ++b) {
      const auto block = static_cast<std::size_t>(b);
      if (stiffest[block] > 0) continue;
      const Index j = pattern.column_indices[block];
      stiffest[block] = std::min(stiffest[static_cast<std::size_t>(pattern.find(i, i))],
                                 stiffest[static_cast<std::size_t>(pattern.find(j, j))]);
    }
  return stiffest;
}

/// Greedy colouring in the order of rows: each takes the first colour that no earlier neighbour has.
std::vector<Index> color_rows(const BlockPattern& pattern, Index& colors) {
  std::vector<Index> color(static_cast<std::size_t>(pattern.rows()), -1), taken_by;
  colors = 0;
  for (std::size_t i = 0; i < color.size(); ++i) {
    for (std::int64_t b = pattern.row_offsets[i]; b < pattern.row_offsets[i + 1]; ++b) {
      const Index taken = color[static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)])];
      if (taken >= 0) taken_by[static_cast<std::size_t>(taken)] = static_cast<Index>(i);
    }
    Index free = 0;
    while (free < colors && taken_by[static_cast<std::size_t>(free)] == static_cast<Index>(i)) ++free;
    if (free == colors) {
      ++colors;
      taken_by.push_back(-1);
    }
    color[i] = free;
  }
  return color;
}

/// Rows sorted by colour, in their old order within one: old row of each new one.
std::vector<Index> order_by_color(const BlockPattern& pattern, std::vector<Index>& color_offsets) {
  Index colors = 0;
  const std::vector<Index> color = color_rows(pattern, colors);
  color_offsets.assign(static_cast<std::size_t>(colors) + 1, 0);
  for (const Index c : color) ++color_offsets[static_cast<std::size_t>(c) + 1];
  std::partial_sum(color_offsets.begin(), color_offsets.end(), color_offsets.begin());
  std::vector<Index> next(color_offsets.begin(), color_offsets.end() - 1), order(color.size());
  for (std::size_t i = 0; i < color.size(); ++i)
    order[static_cast<std::size_t>(next[static_cast<std::size_t>(color[i])]++)] = static_cast<Index>(i);
  return order;
}

/// The pattern with rows and columns renumbered; source[b] is the old position of the mirror of new block b.
BlockPattern permuted(const BlockPattern& pattern, const std::vector<Index>& order, std::vector<std::int64_t>& source) {
  const std::vector<Index> number = inverted(order);
  BlockPattern result;
  result.columns = pattern.columns;
  source.reserve(static_cast<std::size_t>(pattern.blocks()));
  std::vector<std::pair<Index, std::int64_t>> row;
  for (const Index old_row : order) {
    row.clear();
    const auto r = static_cast<std::size_t>(old_row);
    for (std::int64_t b = pattern.row_offsets[r]; b < pattern.row_offsets[r + 1]; ++b)
      row.emplace_back(number[static_cast<std::size_t>(pattern.column_indices[static_cast<std::size_t>(b)])], b);
    std::sort(row.begin(), row.end());
    for (const auto& [column, block] : row) {
      result.column_indices.push_back(column);
      source.push_back(pattern.find(pattern.column_indices[static_cast<std::size_t>(block)], old_row));
    }
    result.row_offsets.push_back(result.blocks());
  }
  return result;
}

WeightMatrix permuted(const WeightMatrix& matrix, const std::vector<Index>& row_order,
                      const std::vector<Index>& column_order) {
  const std::vector<Index> number = inverted(column_order);
  WeightMatrix result;
  result.columns = matrix.columns;
  std::vector<std::pair<Index, double>> row;
  for (const Index old_row : row_order) {
    row.clear();
    const auto r = static_cast<std::size_t>(old_row);
    for (std::int64_t e = matrix.row_offsets[r]; e < matrix.row_offsets[r + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      row.emplace_back(number[static_cast<std::size_t>(matrix.column_indices[entry])], matrix.weights[entry]);
    }
    std::sort(row.begin(), row.end());
    for (const auto& [column, weight] : row) {
      result.column_indices.push_back(column);
      result.weights.push_back(weight);
    }
    result.row_offsets.push_back(result.entries());
  }
  return result;
}

/// Levels before they are coloured.
struct PlainLevel {
  LevelNodes nodes;
  BlockPattern pattern;
  WeightMatrix prolongation;
};

/// coarsen, without regard to stiffness if that makes too many copies: then fine.block_stiffness is emptied.
Coarsening coarsen_with_few_copies(LevelNodes& fine, const BlockPattern& pattern, const LatticeFrame& frame,
                                   const MultigridParams& params) {
  const CoarseningParams coarsening{params.dropped_weight, params.stiffness_contrast};
  Coarsening coarse = coarsen(fine, pattern, frame, coarsening);
  if (fine.block_stiffness.empty()) return coarse;
  Coarsening plain = coarsen({fine.positions, {}, fine.spacings}, pattern, frame, coarsening);
  if (static_cast<double>(coarse.nodes.positions.size()) <=
      kMostCopies * static_cast<double>(plain.nodes.positions.size()))
    return coarse;
  fine.block_stiffness.clear();
  return plain;
}

/// Whether a coarsening is worth a level. Nodes that stay are no reason against it, as long as there are fewer nodes.
bool pays(const Coarsening& coarse, const PlainLevel& fine) {
  const auto nodes = static_cast<double>(coarse.nodes.positions.size());
  return nodes <= kLeastReduction * fine.pattern.rows() || (coarse.staying > 0 && nodes < fine.pattern.rows());
}

/// A coarsening that pays where that to the next lattice does not: first without regard to stiffness, whose copies each
/// inclusion has on all levels, then on lattices that are coarser still (flat tetrahedra are smaller by volume than
/// their edges are long).
std::optional<Coarsening> coarsen_further(PlainLevel& fine, LatticeFrame& frame, const MultigridParams& params) {
  LevelNodes& nodes = fine.nodes;
  nodes.block_stiffness.clear();
  const bool leap = factor_work(fine.pattern) > kMostFactorWork;
  const double extent = (upper_corner(nodes.positions) - lower_corner(nodes.positions)).maxCoeff();
  do {
    Coarsening coarse = coarsen(nodes, fine.pattern, frame, {params.dropped_weight, params.stiffness_contrast});
    if (pays(coarse, fine)) return coarse;
    frame.spacing *= 2;
  } while (leap && frame.spacing < 2 * extent);
  return std::nullopt;
}

bool is_dear(const BlockPattern& last, const BlockPattern& finest, const MultigridParams& params) {
  return last.rows() > params.bottom_nodes &&
         factor_work(last) > kDearFactorWork * static_cast<double>(finest.blocks());
}

/// What to do where the next lattice does not pay and the last level is dear.
enum class Rescue : std::uint8_t { Try, Leave };

std::vector<PlainLevel> coarsen_repeatedly(PlainLevel finest, LatticeFrame frame, const MultigridParams& params,
                                           Rescue rescue) {
  std::vector<PlainLevel> levels;
  levels.push_back(std::move(finest));
  const double cheap = kCheapFactorWork * static_cast<double>(levels.front().pattern.blocks());
  while (levels.back().pattern.rows() > params.bottom_nodes) {
    PlainLevel& fine = levels.back();
    if (levels.size() > 1 && factor_work(fine.pattern) <= cheap) break;
    frame.spacing *= 2;
    std::optional<Coarsening> found =
        levels.size() == 1
            ? coarsen_with_few_copies(fine.nodes, fine.pattern, frame, params)
            : coarsen(fine.nodes, fine.pattern, frame, {params.dropped_weight, params.stiffness_contrast});
    if (!pays(*found, fine)) {
      if (found->staying > 0) continue;  // the next lattice takes more of those that stay
      if (rescue == Rescue::Leave || !is_dear(fine.pattern, levels.front().pattern, params)) break;
      found = coarsen_further(fine, frame, params);
      if (!found) break;
    }
    Coarsening& coarse = *found;
    fine.prolongation = std::move(coarse.prolongation);
    BlockPattern pattern = galerkin_pattern(fine.pattern, transpose(fine.prolongation), fine.prolongation);
    coarse.nodes.block_stiffness =
        restrict_stiffness(fine.nodes.block_stiffness, fine.pattern, fine.prolongation, pattern);
    levels.push_back({std::move(coarse.nodes), std::move(pattern), {}});
  }
  return levels;
}

/// The levels of a mesh. Where tetrahedra of very different sizes are mixed, as a file may have them, one lattice has
/// more nodes around the large ones than they have themselves: then each part is coarsened from its own size on.
std::vector<PlainLevel> find_levels(const TetMesh& mesh, std::span<const double> element_stiffness,
                                    const BlockPattern& pattern, const MultigridParams& params) {
  const LatticeFrame frame = finest_frame(mesh);
  const auto levels_by = [&](std::vector<double> spacings, Rescue rescue) {
    std::vector<double> stiffness = block_stiffness(mesh, element_stiffness, pattern, params.stiffness_contrast);
    return coarsen_repeatedly({{mesh.nodes, std::move(stiffness), std::move(spacings)}, pattern, {}}, frame, params,
                              rescue);
  };
  if (mesh.lattice.spacing > 0 || !mesh.spacings.empty()) return levels_by(mesh.spacings, Rescue::Try);
  std::vector<PlainLevel> levels = levels_by({}, Rescue::Leave);
  if (!is_dear(levels.back().pattern, pattern, params)) return levels;
  std::vector<PlainLevel> by_size = levels_by(node_spacings(mesh, frame.spacing), Rescue::Try);
  return factor_work(by_size.back().pattern) < factor_work(levels.back().pattern) ? by_size : levels;
}

LatticeLevel colored(const PlainLevel& plain, const std::vector<Index>& order, std::vector<Index> color_offsets,
                     std::vector<std::int64_t>& source) {
  LatticeLevel level;
  level.pattern = permuted(plain.pattern, order, source);
  level.color_offsets = std::move(color_offsets);
  level.rank = order;
  for (Index i = 0; i < level.pattern.rows(); ++i) {
    level.diagonal.push_back(level.pattern.find(i, i));
    CHECK(level.diagonal.back() >= 0);
  }
  return level;
}

}  // namespace

LatticeHierarchy build_lattice_hierarchy(const TetMesh& mesh, std::span<const double> element_stiffness,
                                         const BlockPattern& pattern, const MultigridParams& params) {
  CHECK(!mesh.nodes.empty());
  CHECK(pattern.rows() == static_cast<Index>(mesh.nodes.size()));
  const std::vector<PlainLevel> plain = find_levels(mesh, element_stiffness, pattern, params);
  LatticeHierarchy hierarchy;
  std::vector<std::vector<Index>> orders, color_offsets(plain.size());
  for (std::size_t h = 0; h < plain.size(); ++h) orders.push_back(order_by_color(plain[h].pattern, color_offsets[h]));
  for (std::size_t h = 0; h < plain.size(); ++h) {
    std::vector<std::int64_t> source;
    LatticeLevel level = colored(plain[h], orders[h], std::move(color_offsets[h]), source);
    if (h + 1 < plain.size()) {
      level.prolongation = permuted(plain[h].prolongation, orders[h], orders[h + 1]);
      level.restriction = transpose(level.prolongation);
    }
    if (h == 0) hierarchy.source_blocks = std::move(source);
    hierarchy.levels.push_back(std::move(level));
  }
  hierarchy.mesh_nodes = std::move(orders.front());
  return hierarchy;
}

}  // namespace softreel
