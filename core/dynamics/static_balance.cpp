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

/// Nothing acts on the piece: what there is of forces is round-off, and no tolerance of itself is within reach.
bool is_idle(const PieceBalance& piece) {
  return std::isfinite(piece.round_off) && std::max(piece.scale, piece.residual) <= piece.round_off &&
         std::isfinite(piece.residual);
}

}  // namespace

bool balances(const StaticState& state, double tolerance, double rounding) {
  return std::all_of(state.pieces.begin(), state.pieces.end(), [&](const PieceBalance& piece) {
    if (is_idle(piece)) return true;
    return std::isfinite(piece.residual) &&
           piece.residual <= std::max(tolerance * piece.scale, rounding * piece.round_off);
  });
}

double imbalance(const StaticState& state) {
  double greatest = 0;
  for (const PieceBalance& piece : state.pieces) {
    if (is_idle(piece)) continue;
    const double share = piece.residual / piece.scale;
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
  // What rounding its point and its target does to a spring's force. The force itself is no scale: stiff pulls that
  // work against each other would hide all others.
  for (const ActivePull& pull : pulls_) {
    const double factor = pull_factor(pull, state.positions);
    for (const Spring& spring : pull.springs) {
      double size = spring.target.norm();
      for (std::size_t k = 0; k < spring.count; ++k)
        size += std::abs(spring.weights[k]) * state.positions[static_cast<std::size_t>(spring.nodes[k])].norm();
      for (std::size_t k = 0; k < spring.count; ++k)
        errors[static_cast<std::size_t>(spring.nodes[k])] +=
            std::numeric_limits<double>::epsilon() * factor * spring.stiffness * std::abs(spring.weights[k]) * size;
    }
  }
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
    piece.residual += state.forces[i].squaredNorm();
    piece.scale += magnitude * magnitude;
    piece.round_off += errors[i] * errors[i];
  }
  state.energy_noise += 4 * std::numeric_limits<double>::epsilon() * work;
  for (PieceBalance& piece : state.pieces)
    piece = {std::sqrt(piece.residual), std::sqrt(piece.scale), std::sqrt(piece.round_off)};
}

}  // namespace softreel
