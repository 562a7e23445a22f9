#include "core/dynamics/joints.h"

#include <algorithm>
#include <numeric>

namespace softreel {
std::vector<Joint> find_joints(const std::vector<Glue>& glues, const std::vector<GlueBond>& bonds) {
  std::vector<Joint> joints;
  for (const GlueBond& bond : bonds)
    joints.push_back({glues[static_cast<std::size_t>(bond.glue)].points[at(bond.point)].element, bond.element});
  std::sort(joints.begin(), joints.end());
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  return joints;
}

std::span<const GlueBond> bonds_of(const std::vector<GlueBond>& bonds, std::int64_t glue) {
  const auto begin =
      std::find_if(bonds.begin(), bonds.end(), [glue](const GlueBond& bond) { return bond.glue == glue; });
  const auto end = std::find_if(begin, bonds.end(), [glue](const GlueBond& bond) { return bond.glue != glue; });
  return {begin, end};
}

std::span<const GlueBond> bonds_that_hold(const std::vector<GlueBond>& bonds, const Glue& glue, std::int64_t number,
                                          double frame) {
  const std::span<const GlueBond> known = bonds_of(bonds, number);
  const bool holds =
      !known.empty() && active_range(glue.active, known.front().since) == active_range(glue.active, frame);
  return holds ? known : std::span<const GlueBond>();
}

Pieces join_pieces(const Pieces& pieces, const std::vector<Tet>& tets, const std::vector<Joint>& joints) {
  std::vector<Index> first(at(pieces.count));
  std::iota(first.begin(), first.end(), 0);
  // Few joints and fewer pieces: the lower number spreads until nothing changes.
  for (bool changed = true; changed;) {
    changed = false;
    for (const Joint& joint : joints) {
      Index& a = first[at(pieces.of_node[at(tets[at(joint.element)][0])])];
      Index& b = first[at(pieces.of_node[at(tets[at(joint.other)][0])])];
      changed = changed || a != b;
      a = b = std::min(a, b);
    }
  }
  Pieces joined{0, std::vector<Index>(pieces.of_node.size(), -1)};
  std::vector<Index> numbers(first.size(), -1);
  for (std::size_t i = 0; i < joined.of_node.size(); ++i) {
    Index& number = numbers[at(first[at(pieces.of_node[i])])];
    if (number < 0) number = joined.count++;
    joined.of_node[i] = number;
  }
  return joined;
}

BlockPattern join_pattern(const BlockPattern& pattern, const std::vector<Tet>& tets, const std::vector<Joint>& joints) {
  if (joints.empty()) return pattern;
  std::vector<std::pair<Index, Index>> added;
  for (const Joint& joint : joints)
    for (const Index i : tets[at(joint.element)])
      for (const Index j : tets[at(joint.other)]) {
        added.emplace_back(i, j);
        added.emplace_back(j, i);
      }
  std::sort(added.begin(), added.end());
  added.erase(std::unique(added.begin(), added.end()), added.end());
  BlockPattern joined;
  joined.columns = pattern.columns;
  std::size_t next = 0;
  std::vector<Index> row;
  for (Index i = 0; i < pattern.rows(); ++i) {
    row.assign(pattern.column_indices.begin() + pattern.row_offsets[at(i)],
               pattern.column_indices.begin() + pattern.row_offsets[at(i) + 1]);
    for (; next < added.size() && added[next].first == i; ++next) row.push_back(added[next].second);
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    joined.column_indices.insert(joined.column_indices.end(), row.begin(), row.end());
    joined.row_offsets.push_back(joined.blocks());
  }
  return joined;
}

}  // namespace softreel
