/// Whether forces balance: StaticSolver::measure_pieces, and what is asked of its answer.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/dynamics/static_solver.h"

namespace softreel {

double p_wave_modulus(const ElasticLaw& law) {
  return law.lambda + 2 * law.mu;
}

namespace {

/// Nothing acts on the nodes: what there is of forces is round-off, and no tolerance of itself is within reach.
bool is_idle(const ForceBalance& nodes) {
  return std::isfinite(nodes.round_off) && std::max(nodes.scale, nodes.residual) <= nodes.round_off &&
         std::isfinite(nodes.residual);
}

bool is_idle(const PieceBalance& piece) {
  return is_idle(piece.sprung) && is_idle(piece.others);
}

bool balances(const PieceBalance& piece, double tolerance, double rounding) {
  const double enough = tolerance * piece.all.scale;
  const auto explained = [&](const ForceBalance& nodes) {
    return nodes.residual <= std::max(enough, rounding * nodes.round_off);
  };
  if (!std::isfinite(piece.all.residual)) return false;
  return explained(piece.all) && (piece.all.residual <= enough || (explained(piece.sprung) && explained(piece.others)));
}

/// Sums of squares, until take_roots.
void add_node(ForceBalance& nodes, const Vec3& force, double magnitude, double error) {
  nodes.residual += force.squaredNorm();
  nodes.scale += magnitude * magnitude;
  nodes.round_off += error * error;
}

void take_roots(ForceBalance& nodes) {
  nodes = {std::sqrt(nodes.residual), std::sqrt(nodes.scale), std::sqrt(nodes.round_off)};
}

/// What rounding its point and its target does to a spring's force. The force itself is no scale: stiff pulls that work
/// against each other would hide all others.
void add_spring_errors(const std::vector<ActivePull>& pulls, std::span<const Vec3> positions,
                       std::vector<double>& errors) {
  for (const ActivePull& pull : pulls) {
    const double factor = pull_factor(pull, positions);
    for (const Spring& spring : pull.springs) {
      double size = spring.target.norm();
      for (std::size_t k = 0; k < spring.count; ++k)
        size += std::abs(spring.weights[k]) * positions[static_cast<std::size_t>(spring.nodes[k])].norm();
      for (std::size_t k = 0; k < spring.count; ++k)
        errors[static_cast<std::size_t>(spring.nodes[k])] +=
            std::numeric_limits<double>::epsilon() * factor * spring.stiffness * std::abs(spring.weights[k]) * size;
    }
  }
}

}  // namespace

bool balances(const StaticState& state, double tolerance, double rounding) {
  return std::all_of(state.pieces.begin(), state.pieces.end(),
                     [&](const PieceBalance& piece) { return is_idle(piece) || balances(piece, tolerance, rounding); });
}

double imbalance(const StaticState& state) {
  double greatest = 0;
  for (const PieceBalance& piece : state.pieces) {
    if (is_idle(piece)) continue;
    const double share = piece.all.residual / piece.all.scale;
    if (std::isnan(share)) return share;
    greatest = std::max(greatest, share);
  }
  return greatest;
}

void StaticSolver::measure_pieces(StaticState& state) {
  const ElasticBody& body = parts_.body;
  std::vector<double> magnitudes(state.positions.size(), 0), errors(state.positions.size(), 0);
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    const ElementShape& shape = body.shapes[e];
    double strain_error = 0;
    for (std::size_t k = 0; k < 4; ++k)
      strain_error += shape.gradients.col(static_cast<Index>(k)).norm() *
                      state.positions[static_cast<std::size_t>(body.tets[e][k])].norm();
    strain_error = std::numeric_limits<double>::epsilon() * (strain_error + 4);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto node = static_cast<std::size_t>(body.tets[e][k]);
      const Vec3 gradient = shape.gradients.col(static_cast<Index>(k));
      magnitudes[node] += (parts_.stresses[e] * gradient).norm();
      errors[node] += shares_[e] * shape.volume * p_wave_modulus(body.laws[e]) * gradient.norm() * strain_error;
    }
  }
  const std::vector<double> of_elements = errors;
  add_spring_errors(pulls_, state.positions, errors);
  double work = 0;
  const Pieces& own = parts_.mesh_pieces();
  state.pieces.assign(static_cast<std::size_t>(own.count), {});
  for (std::size_t i = 0; i < magnitudes.size(); ++i) {
    double magnitude = magnitudes[i] + parts_.masses.mass[i] * parts_.model.gravity.norm();
    if (potential_ != nullptr) {
      magnitude += step_forces_[i].norm();
      errors[i] += std::numeric_limits<double>::epsilon() * potential_->weights[i] * state.positions[i].norm();
    }
    work += magnitude * state.positions[i].norm();  // of all forces, over a move as long as the node is far
    PieceBalance& piece = state.pieces[static_cast<std::size_t>(own.of_node[i])];
    const bool is_sprung = potential_ == nullptr && errors[i] > 2 * of_elements[i];
    for (ForceBalance* nodes : {&piece.all, is_sprung ? &piece.sprung : &piece.others})
      add_node(*nodes, state.forces[i], magnitude, errors[i]);
  }
  state.energy_noise += 4 * std::numeric_limits<double>::epsilon() * work;
  for (PieceBalance& piece : state.pieces)
    for (ForceBalance* nodes : {&piece.all, &piece.sprung, &piece.others}) take_roots(*nodes);
}

}  // namespace softreel
