#include "core/dynamics/mesh_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr double kLowestOrder = 1, kHighestOrder = 2;
constexpr int kOrders = 11;
/// How much more the lowest order counts than the highest before anything is known: nearly every body has pins.
constexpr double kPinnedOdds = 5;

/// Edge length over that of one tetrahedron of the whole volume.
double edge_of(double tets) {
  return std::cbrt(1 / tets);
}

double mean_square(const std::vector<Vec3>& points) {
  double sum = 0;
  for (const Vec3& point : points) sum += point.squaredNorm();
  return sum / static_cast<double>(points.size());
}

/// Odds turned into shares of one; `logs` are their logarithms.
std::vector<double> shares_of(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  std::vector<double> shares;
  double total = 0;
  for (const double log : logs) total += shares.emplace_back(std::exp(log - most));
  for (double& share : shares) share /= total;
  return shares;
}

}  // namespace

SampledMotion plus(SampledMotion a, double factor, const SampledMotion& b) {
  CHECK(a.size() == b.size());
  for (std::size_t f = 0; f < a.size(); ++f) {
    CHECK(a[f].size() == b[f].size());
    for (std::size_t i = 0; i < a[f].size(); ++i) a[f][i] += factor * b[f][i];
  }
  return a;
}

double motion_size(const SampledMotion& a) {
  CHECK(!a.empty());
  double largest = 0;
  for (const std::vector<Vec3>& points : a) {
    CHECK(!points.empty());
    largest = std::max(largest, mean_square(points));
  }
  return std::sqrt(largest);
}

double motion_distance(const SampledMotion& a, const SampledMotion& b) {
  return motion_size(plus(a, -1, b));
}

void MeshErrors::add(double tets, SampledMotion motion) {
  CHECK(tets > (tets_.empty() ? 0 : tets_.back()));
  tets_.push_back(tets);
  motions_.push_back(std::move(motion));
}

MeshErrors::Line MeshErrors::line_of(double order) const {
  Line line;
  auto& [x, weights, limit, slope] = line;
  for (const double tets : tets_) {
    x.push_back(std::pow(edge_of(tets), order));
    weights.push_back(1 / (edge_of(tets) * edge_of(tets)));  // scatter is of the size of h
  }
  double total = 0, mean = 0, spread = 0;
  for (std::size_t i = 0; i < x.size(); ++i) total += weights[i];
  for (std::size_t i = 0; i < x.size(); ++i) mean += weights[i] * x[i] / total;
  for (std::size_t i = 0; i < x.size(); ++i) spread += weights[i] * (x[i] - mean) * (x[i] - mean);
  for (std::size_t i = 0; i < x.size(); ++i) {
    slope.push_back(weights[i] * (x[i] - mean) / spread);
    limit.push_back(weights[i] / total - mean * slope.back());
  }
  return line;
}

MeshErrors::OrderFit MeshErrors::fit_order(double order) const {
  const std::size_t meshes = tets_.size(), frames = motions_.front().size();
  const Line line = line_of(order);
  OrderFit fit{0, std::vector<double>(meshes, 0), 0};
  for (std::size_t f = 0; f < frames; ++f) {
    const std::size_t points = motions_.front()[f].size();
    std::vector<Vec3> limit(points, Vec3::Zero()), slope(points, Vec3::Zero()), apart(points);
    for (std::size_t m = 0; m < meshes; ++m)
      for (std::size_t i = 0; i < points; ++i) {
        limit[i] += line.limit[m] * motions_[m][f][i];
        slope[i] += line.slope[m] * motions_[m][f][i];
      }
    fit.slope = std::max(fit.slope, std::sqrt(mean_square(slope)));
    for (std::size_t m = 0; m < meshes; ++m) {
      for (std::size_t i = 0; i < points; ++i) apart[i] = motions_[m][f][i] - limit[i];
      fit.distances[m] = std::max(fit.distances[m], std::sqrt(mean_square(apart)));
      for (std::size_t i = 0; i < points; ++i) apart[i] -= line.x[m] * slope[i];
      fit.scatter += line.weights[m] * mean_square(apart);
    }
  }
  return fit;
}

void MeshErrors::fit() {
  CHECK(tets_.size() >= kFewest);
  std::vector<double> logs;
  orders_.clear();
  std::vector<OrderFit> fits;
  const double rounding = std::pow(1e-9 * motion_distance(motions_.front(), motions_.back()), 2) + 1e-300;
  for (int k = 0; k < kOrders; ++k) {
    const double share = static_cast<double>(k) / (kOrders - 1);
    orders_.push_back(kLowestOrder + share * (kHighestOrder - kLowestOrder));
    fits.push_back(fit_order(orders_.back()));
    // Least squares leave the scatter of a straight line through all meshes with two of them less.
    const double freedom = static_cast<double>(tets_.size()) - 2;
    logs.push_back(std::log(kPinnedOdds - share * (kPinnedOdds - 1)) -
                   0.5 * freedom * std::log(fits.back().scatter + rounding));
  }
  shares_ = shares_of(logs);
  order_ = log_slope_ = 0;
  measured_.assign(tets_.size(), 0);
  constexpr double kNothing = 1e-150;  // m: motions that are equal to the last bit
  for (int k = 0; k < kOrders; ++k) {
    const auto n = static_cast<std::size_t>(k);
    order_ += shares_[n] * orders_[n];
    log_slope_ += shares_[n] * std::log(fits[n].slope + kNothing);
    for (std::size_t m = 0; m < tets_.size(); ++m)
      measured_[m] += shares_[n] * std::log(fits[n].distances[m] + kNothing);
  }
  for (double& error : measured_) error = std::exp(error);
}

double MeshErrors::expected(double tets) const {
  return std::exp(log_slope_ + order_ * std::log(edge_of(tets)));
}

SampledMotion MeshErrors::expected_motion(double tets) const {
  std::vector<double> factors(tets_.size(), 0);
  for (std::size_t k = 0; k < orders_.size(); ++k) {
    const Line line = line_of(orders_[k]);
    for (std::size_t m = 0; m < factors.size(); ++m)
      factors[m] += shares_[k] * std::pow(edge_of(tets), orders_[k]) * line.slope[m];
  }
  SampledMotion motion = plus(motions_.front(), factors.front() - 1, motions_.front());
  for (std::size_t m = 1; m < factors.size(); ++m) motion = plus(std::move(motion), factors[m], motions_[m]);
  return motion;
}

double MeshErrors::tets_for(double error) const {
  return std::exp(3 * (log_slope_ - std::log(error)) / order_);
}

}  // namespace softreel
