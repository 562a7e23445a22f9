#include "tests/benchmark/steppers/descent_memory.h"

#include <vector>

namespace softreel::bench {
namespace {

double dot(const DescentMemory::Vectors& a, const DescentMemory::Vectors& b) {
  return a.cwiseProduct(b).sum();
}

}  // namespace

void DescentMemory::remember(const Vectors& move, const Vectors& change) {
  const double curvature = dot(move, change);
  if (length_ == 0 || !(curvature > 0)) return;
  if (moves_.size() == length_) moves_.pop_front();
  moves_.push_back({move, change, 1 / curvature});
}

DescentMemory::Vectors DescentMemory::direction(const Vectors& descent, const Precondition& precondition) const {
  Vectors q = descent;
  std::vector<double> shares(moves_.size());
  for (std::size_t k = moves_.size(); k-- > 0;) {
    shares[k] = moves_[k].inverse_curvature * dot(moves_[k].move, q);
    q -= shares[k] * moves_[k].change;
  }
  Vectors result = precondition(q);
  for (std::size_t k = 0; k < moves_.size(); ++k) {
    const double share = moves_[k].inverse_curvature * dot(moves_[k].change, result);
    result += (shares[k] - share) * moves_[k].move;
  }
  return result;
}

}  // namespace softreel::bench
