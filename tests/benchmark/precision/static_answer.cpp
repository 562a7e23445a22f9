#include "tests/benchmark/precision/static_answer.h"

#include <stdexcept>

#include <fmt/format.h>

#include "tests/benchmark/bench.h"
#include "tests/benchmark/precision/work_precision.h"

namespace softreel::bench {

SolverParams uncapped_params() {
  SolverParams params;
  params.dilatation = Dilatation::Linear;
  return params;
}

StaticAnswer find_static_answer(BodyModel model, const SolverParams& params) {
  const Threads threads(1);
  const Log silent{[](const std::string&) {}, [](const std::string&) {}};
  StageTimes times;
  const double start = thread_seconds();
  Simulator simulator(std::move(model), params, threads, silent, times);
  const StepReport report = simulator.find_equilibrium(1);
  StaticAnswer answer;
  answer.seconds = thread_seconds() - start;
  if (!report.ok()) throw std::runtime_error(fmt::format("softreel found no equilibrium: {}", report.culprit));
  answer.positions = simulator.state().positions;
  answer.elastic_energy = simulator.measure().elastic_energy;
  return answer;
}

StaticAnswer time_static_answer(const BodyModel& model, const SolverParams& params) {
  StaticAnswer answer = find_static_answer(model, params);
  answer.seconds = steady_seconds(answer.seconds, [&] { return find_static_answer(model, params).seconds; });
  return answer;
}

}  // namespace softreel::bench
