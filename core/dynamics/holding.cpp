#include "core/dynamics/holding.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {
namespace {

constexpr double kCarriedShare = 1e-9;  ///< of a weight that a max_force just carries

/// What holds each piece: of those that joints tie together, or of those of the mesh by themselves.
struct Holding {
  const Pieces& pieces;
  std::vector<std::uint8_t> firmly{};  ///< by a pin, or by a pull or glue without a limit
  std::vector<double> strength{};      ///< of the pulls and glues with one, N: never less than their summed force
  std::vector<double> weight{};        ///< N

  std::size_t piece(Index node) const {
    return static_cast<std::size_t>(pieces.of_node[static_cast<std::size_t>(node)]);
  }

  /// The pieces that a pull acts on from outside, ascending.
  std::vector<std::size_t> pulled(const ActivePull& pull) const {
    std::vector<std::size_t> found;
    for (const Spring& spring : pull.springs) {
      const std::size_t own = piece(spring.nodes[0]);
      const std::size_t other = spring.joins_material() ? piece(spring.nodes[4]) : own;
      if (spring.stiffness == 0 || (spring.joins_material() && own == other)) continue;
      found.insert(found.end(), {own, other});
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }
};

Holding find_holding(const Simulator::Parts& parts, const Pieces& pieces, const PinnedNodes& pinned,
                     const std::vector<ActivePull>& pulls) {
  const auto count = static_cast<std::size_t>(pieces.count);
  Holding holding{pieces, std::vector<std::uint8_t>(count, 0), std::vector<double>(count, 0),
                  std::vector<double>(count, 0)};
  for (std::size_t i = 0; i < parts.nodes(); ++i) {
    const std::size_t piece = holding.piece(static_cast<Index>(i));
    holding.weight[piece] += parts.masses.mass[i] * parts.model.gravity.norm();
    if (pinned.held[i] != 0) holding.firmly[piece] = 1;
  }
  for (const ActivePull& pull : pulls)
    for (const std::size_t piece : holding.pulled(pull)) {
      if (pull.max_force > 0)
        holding.strength[piece] += pull.max_force;
      else
        holding.firmly[piece] = 1;
    }
  return holding;
}

/// "piece 2 of the body (near (0, 1, 0))"
std::string describe_piece(const Simulator::Parts& parts, const Pieces& pieces, std::size_t piece) {
  const auto node = static_cast<std::size_t>(
      std::find(pieces.of_node.begin(), pieces.of_node.end(), static_cast<Index>(piece)) - pieces.of_node.begin());
  const Vec3& at = parts.model.mesh.nodes[node];
  return fmt::format("{} (near ({:.6g}, {:.6g}, {:.6g}))",
                     pieces.count == 1 ? "the body" : fmt::format("piece {} of the body", piece), at.x(), at.y(),
                     at.z());
}

/// A piece that nothing holds has no equilibrium under gravity.
void check_held(const Simulator::Parts& parts, const std::vector<std::uint8_t>& held, double frame) {
  const auto loose = std::find(held.begin(), held.end(), std::uint8_t{0});
  if (loose == held.end()) return;
  throw input_error(fmt::format(
      "{}: at frame {} no pin or pull holds {}, so under gravity it falls for ever and has no equilibrium.\n  "
      "Accepted: a pin or pull on every piece, or no gravity. Add a pin, set gravity to 0, or use mode = \"dynamic\" "
      "with start = \"rest\".",
      parts.model.name, frame, describe_piece(parts, parts.pieces, static_cast<std::size_t>(loose - held.begin()))));
}

void check_strength(const Simulator::Parts& parts, const Holding& holding, double frame) {
  for (std::size_t piece = 0; piece < holding.weight.size(); ++piece) {
    const double strength = holding.strength[piece], weight = holding.weight[piece];
    if (holding.firmly[piece] != 0 || strength == 0 || strength >= (1 - kCarriedShare) * weight) continue;
    throw input_error(fmt::format(
        "{}: at frame {} pulls and glue of max_force = {:.6g} N in all hold {}, which weighs {:.6g} N, so it falls for "
        "ever and has no equilibrium.\n  Accepted: a max_force above the weight, or 0, which is no limit. Raise it, "
        "add a pin, lower gravity, or use mode = \"dynamic\" with start = \"rest\".",
        parts.model.name, frame, strength, describe_piece(parts, holding.pieces, piece), weight));
  }
}

}  // namespace

void check_holding(const Simulator::Parts& parts, const std::vector<std::uint8_t>& held, const PinnedNodes& pinned,
                   const std::vector<ActivePull>& pulls, double frame) {
  if (parts.model.gravity.isZero(0)) return;
  check_held(parts, held, frame);
  check_strength(parts, find_holding(parts, parts.pieces, pinned, pulls), frame);
  if (!parts.joints.empty()) check_strength(parts, find_holding(parts, parts.mesh_pieces(), pinned, pulls), frame);
}

std::string find_spent_pull(const Simulator::Parts& parts, const PinnedNodes& pinned, const Grabs& grabs,
                            const std::vector<GlueBond>& bonds, double frame, std::span<const Vec3> positions) {
  const BodyModel& model = parts.model;
  const Holding holding = find_holding(parts, parts.mesh_pieces(), pinned, parts.pulls_at(frame, grabs, bonds));
  const auto is_spent = [&](const ActivePull& pull) {
    const std::vector<std::size_t> pieces = holding.pulled(pull);
    return pull_factor(pull, positions) < 1 &&
           std::any_of(pieces.begin(), pieces.end(), [&](std::size_t piece) { return holding.firmly[piece] == 0; });
  };
  const auto blamed = [](const std::string& name, double max_force) {
    return fmt::format("{}: it pulls with all of its max_force of {:.6g} N", name, max_force);
  };
  for (std::size_t p = 0; p < model.pulls.size(); ++p) {
    const Grab grab = p < grabs.pulls.size() ? grabs.pulls[p] : Grab{};
    for (const ActivePull& pull :
         active_pulls({model.pulls[p]}, model.surface_points, model.embedding, model.mesh, frame, {&grab, 1}))
      if (is_spent(pull)) return blamed(model.pulls[p].name, pull.max_force);
  }
  for (std::size_t g = 0; g < model.glues.size(); ++g) {
    const auto own = bonds_of(bonds, static_cast<std::int64_t>(g));
    if (!own.empty() && is_spent(glue_springs(model.glues[g], own, model.mesh, frame)))
      return blamed(model.glues[g].name, model.glues[g].max_force);
  }
  return {};
}

}  // namespace softreel
