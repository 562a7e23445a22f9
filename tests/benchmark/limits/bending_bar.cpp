#include "tests/benchmark/limits/bending_bar.h"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>

#include "tests/support/elastic_box.h"

namespace softreel::bench {
namespace {

constexpr double kLength = 1, kHeight = 0.25;

Vec3 weight(const Vec3&) {
  return {0, -kBarDensity * 9.81, 0};
}

double mean_sag(const std::vector<Vec3>& nodes, const HeldDisplacements& answer, const std::vector<Vec3>& corners) {
  double sum = 0;
  for (const Vec3& corner : corners)
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if ((nodes[i] - corner).norm() < 1e-9) sum -= answer.displacements[i].y();
  return sum / static_cast<double>(corners.size());
}

/// Lagrange polynomials of one interval at its points of Gauss: one row per point, one column per polynomial.
struct Interval {
  Eigen::VectorXd places, weights;
  Eigen::MatrixXd values, slopes;
};

/// Points and weights of Gauss on [-1, 1], by the eigenvalues of Golub and Welsch (1969).
void find_gauss(int points, Eigen::VectorXd& places, Eigen::VectorXd& weights) {
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
  for (int k = 1; k < points; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(jacobi);
  places = solver.eigenvalues();
  weights = 2 * solver.eigenvectors().row(0).transpose().cwiseAbs2();
}

/// Places of the polynomials' nodes on [-1, 1], ends included.
double chebyshev(int k, int degree) {
  return -std::cos(std::numbers::pi * k / degree);
}

Interval make_interval(double low, double high, int degree) {
  Interval interval;
  Eigen::VectorXd t;
  find_gauss(degree + 1, t, interval.weights);
  const double half = 0.5 * (high - low);
  interval.places = (low + half) + half * t.array();
  interval.weights *= half;
  interval.values.resize(degree + 1, degree + 1);
  interval.slopes.resize(degree + 1, degree + 1);
  for (int q = 0; q <= degree; ++q)
    for (int i = 0; i <= degree; ++i) {
      double value = 1, log_slope = 0;
      for (int k = 0; k <= degree; ++k) {
        if (k == i) continue;
        value *= (t[q] - chebyshev(k, degree)) / (chebyshev(i, degree) - chebyshev(k, degree));
        log_slope += 1 / (t[q] - chebyshev(k, degree));
      }
      interval.values(q, i) = value;
      interval.slopes(q, i) = value * log_slope / half;
    }
  return interval;
}

/// One direction of the grid of boxes.
struct Axis {
  Axis(const std::vector<double>& ends, int degree) {
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      intervals.push_back(make_interval(ends[k], ends[k + 1], degree));
      const double half = 0.5 * (ends[k + 1] - ends[k]);
      for (int i = k == 0 ? 0 : 1; i <= degree; ++i) nodes.push_back(ends[k] + half * (1 + chebyshev(i, degree)));
    }
    nodes.back() = ends.back();
  }
  Index count() const { return static_cast<Index>(nodes.size()); }
  std::vector<Interval> intervals;
  std::vector<double> nodes;
};

StrainPoint box_point(const std::array<const Interval*, 3>& box, const std::array<int, 3>& q, int degree) {
  StrainPoint point;
  point.weight = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    point.weight *= box[d]->weights[q[d]];
    point.position[static_cast<Eigen::Index>(d)] = box[d]->places[q[d]];
  }
  const int n = degree + 1;
  point.values.resize(n * n * n);
  point.gradients.resize(3, n * n * n);
  Eigen::Index at = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i, ++at) {
        const Vec3 value(box[0]->values(q[0], i), box[1]->values(q[1], j), box[2]->values(q[2], k));
        const Vec3 slope(box[0]->slopes(q[0], i), box[1]->slopes(q[1], j), box[2]->slopes(q[2], k));
        point.values[at] = value.prod();
        point.gradients.col(at) =
            Vec3(slope[0] * value[1] * value[2], value[0] * slope[1] * value[2], value[0] * value[1] * slope[2]);
      }
  return point;
}

Discretization make_boxes(const std::array<Axis, 3>& axes, int degree, const Lame& material) {
  Discretization result;
  for (const double z : axes[2].nodes)
    for (const double y : axes[1].nodes)
      for (const double x : axes[0].nodes) result.nodes.emplace_back(x, y, z);
  const auto boxes = [&](std::size_t d) { return static_cast<Index>(axes[d].intervals.size()); };
  for (Index c = 0; c < boxes(2); ++c)
    for (Index b = 0; b < boxes(1); ++b)
      for (Index a = 0; a < boxes(0); ++a) {
        StrainCell cell;
        for (Index k = c * degree; k <= (c + 1) * degree; ++k)
          for (Index j = b * degree; j <= (b + 1) * degree; ++j)
            for (Index i = a * degree; i <= (a + 1) * degree; ++i)
              cell.nodes.push_back(i + axes[0].count() * (j + axes[1].count() * k));
        const auto interval = [&](std::size_t d, Index k) { return &axes[d].intervals[static_cast<std::size_t>(k)]; };
        const std::array<const Interval*, 3> box{interval(0, a), interval(1, b), interval(2, c)};
        for (int k = 0; k <= degree; ++k)
          for (int j = 0; j <= degree; ++j)
            for (int i = 0; i <= degree; ++i) {
              cell.points.push_back(box_point(box, {i, j, k}, degree));
              cell.points.back().material = material;
            }
        result.cells.push_back(std::move(cell));
      }
  return result;
}

}  // namespace

BarAnswer bend_bar(Index across, TetRemedy remedy, double poisson_ratio) {
  const Discretization bar = discretize(test_support::make_bar(across), remedy, Lame::of(kBarModulus, poisson_ratio));
  const auto held = [](const Vec3& node) {
    const bool clamped = node.x() < 1e-9;
    return std::array<bool, 3>{clamped, clamped, clamped};
  };
  BarAnswer answer{0, solve_statics(bar, held, weight)};
  std::vector<Vec3> corners;
  for (const double y : {0.0, kHeight})
    for (const double z : {0.0, kHeight}) corners.emplace_back(kLength, y, z);
  answer.tip = mean_sag(bar.nodes, answer.statics, corners);
  return answer;
}

BarAnswer bend_bar_by_polynomials(int degree, double poisson_ratio) {
  const double middle = 0.5 * kHeight;
  const Axis along({0, 0.01, 0.05, 0.2, 0.55, kLength}, degree), across({0, 0.02, middle}, degree);
  const Discretization boxes = make_boxes({along, across, across}, degree, Lame::of(kBarModulus, poisson_ratio));
  const auto held = [&](const Vec3& node) {
    const bool clamped = node.x() == 0, in_y = node.y() == middle, in_z = node.z() == middle;
    return std::array<bool, 3>{clamped || in_y, clamped, clamped || in_y || in_z};
  };
  BarAnswer answer{0, solve_statics(boxes, held, weight)};
  answer.tip = mean_sag(boxes.nodes, answer.statics, {Vec3(kLength, 0, 0)});
  return answer;
}

}  // namespace softreel::bench
