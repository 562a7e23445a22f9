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

/// The straight line y = limit + slope x through values with weights, for all points of a frame at once.
struct Line {
  std::vector<double> limit, slope;  ///< as sums over the values
};

/// The weights that make limit and slope of a weighted least-squares line out of its values.
Line line_weights(const std::vector<double>& x, const std::vector<double>& weights) {
  double total = 0, mean = 0, spread = 0;
  for (std::size_t i = 0; i < x.size(); ++i) total += weights[i];
  for (std::size_t i = 0; i < x.size(); ++i) mean += weights[i] * x[i] / total;
  for (std::size_t i = 0; i < x.size(); ++i) spread += weights[i] * (x[i] - mean) * (x[i] - mean);
  Line line;
  for (std::size_t i = 0; i < x.size(); ++i) {
    line.slope.push_back(weights[i] * (x[i] - mean) / spread);
    line.limit.push_back(weights[i] / total - mean * line.slope.back());
  }
  return line;
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

double motion_distance(const SampledMotion& a, const SampledMotion& b) {
  CHECK(a.size() == b.size());
  CHECK(!a.empty());
  double largest = 0;
  for (std::size_t f = 0; f < a.size(); ++f) {
    CHECK(a[f].size() == b[f].size());
    CHECK(!a[f].empty());
    std::vector<Vec3> apart(a[f].size());
    for (std::size_t i = 0; i < a[f].size(); ++i) apart[i] = a[f][i] - b[f][i];
    largest = std::max(largest, mean_square(apart));
  }
  return std::sqrt(largest);
}

void MeshErrors::add(double tets, SampledMotion motion) {
  CHECK(tets > (tets_.empty() ? 0 : tets_.back()));
  tets_.push_back(tets);
  motions_.push_back(std::move(motion));
}

MeshErrors::OrderFit MeshErrors::fit_order(double order) const {
  const std::size_t meshes = tets_.size(), frames = motions_.front().size();
  std::vector<double> x, weights;
  for (const double tets : tets_) {
    x.push_back(std::pow(edge_of(tets), order));
    weights.push_back(1 / (edge_of(tets) * edge_of(tets)));  // scatter is of the size of h
  }
  const Line line = line_weights(x, weights);
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
      for (std::size_t i = 0; i < points; ++i) apart[i] -= x[m] * slope[i];
      fit.scatter += weights[m] * mean_square(apart);
    }
  }
  return fit;
}

void MeshErrors::fit() {
  CHECK(tets_.size() >= kFewest);
  std::vector<double> orders, logs;
  std::vector<OrderFit> fits;
  const double rounding = std::pow(1e-9 * motion_distance(motions_.front(), motions_.back()), 2) + 1e-300;
  for (int k = 0; k < kOrders; ++k) {
    const double share = static_cast<double>(k) / (kOrders - 1);
    orders.push_back(kLowestOrder + share * (kHighestOrder - kLowestOrder));
    fits.push_back(fit_order(orders.back()));
    // Least squares leave the scatter of a straight line through all meshes with two of them less.
    const double freedom = static_cast<double>(tets_.size()) - 2;
    logs.push_back(std::log(kPinnedOdds - share * (kPinnedOdds - 1)) -
                   0.5 * freedom * std::log(fits.back().scatter + rounding));
  }
  const std::vector<double> shares = shares_of(logs);
  order_ = log_slope_ = 0;
  measured_.assign(tets_.size(), 0);
  constexpr double kNothing = 1e-150;  // m: motions that are equal to the last bit
  for (int k = 0; k < kOrders; ++k) {
    const auto n = static_cast<std::size_t>(k);
    order_ += shares[n] * orders[n];
    log_slope_ += shares[n] * std::log(fits[n].slope + kNothing);
    for (std::size_t m = 0; m < tets_.size(); ++m)
      measured_[m] += shares[n] * std::log(fits[n].distances[m] + kNothing);
  }
  for (double& error : measured_) error = std::exp(error);
}

double MeshErrors::expected(double tets) const {
  return std::exp(log_slope_ + order_ * std::log(edge_of(tets)));
}

double MeshErrors::tets_for(double error) const {
  return std::exp(3 * (log_slope_ - std::log(error)) / order_);
}

}  // namespace softreel
