#include "tests/benchmark/precision/methods.h"

#include <cmath>

#include <fmt/format.h>

#include "tests/benchmark/precision/static_answer.h"
#include "tests/benchmark/rivals/rival.h"

namespace softreel::bench {
namespace {

Method softreel_method(const std::string& label, const std::string& curve, const std::string& tuned,
                       std::vector<double> tolerances, const std::function<SolverParams(double tolerance)>& params) {
  Method method{label, curve, false, tuned, std::move(tolerances), 1, {}};
  method.make = [params](const BodyModel& model, double tolerance, const Threads& threads) {
    return make_softreel(model, params(tolerance), threads);
  };
  return method;
}

/// Of whoever solves one linear system a step by iteration.
std::vector<double> one_solve_tolerances() {
  return {1e-1, 1e-3, 1e-6};
}

Method scheme(const std::string& integrator_name, Integrator integrator, const std::string& linearize_name,
              Linearize linearize, const std::string& tuned) {
  const bool iterated = linearize == Linearize::Iterated;
  Method method = softreel_method(integrator_name + ", " + linearize_name, "softreel " + integrator_name, tuned,
                                  iterated ? std::vector<double>{1e-3, 1e-5} : one_solve_tolerances(),
                                  [=](double tolerance) { return scheme_params(integrator, linearize, tolerance); });
  method.ours = true;
  return method;
}

/// Left out where its library is missing.
void add_direct(std::vector<Method>& methods, DirectSolver solver, const std::string& label, const std::string& tuned,
                std::vector<double> tolerances) {
  Method method{label, label, false, tuned, std::move(tolerances), 1, {}};
  method.make = [solver](const BodyModel& model, double linear_tolerance, const Threads&) {
    SolverParams params = scheme_params(Integrator::Euler, Linearize::Start, 1e-3);
    if (std::isfinite(linear_tolerance)) params.tolerance = linear_tolerance;
    return make_direct(model, params, solver);
  };
  if (solver != DirectSolver::Cholmod || rivals::has_cholmod()) methods.push_back(std::move(method));
}

}  // namespace

SolverParams scheme_params(Integrator integrator, Linearize linearize, double tolerance) {
  SolverParams params = uncapped_params();
  params.integrator = integrator;
  params.linearize = linearize;
  (linearize == Linearize::Iterated ? params.force_tolerance : params.tolerance) = tolerance;
  return params;
}

std::vector<Method> softreel_schemes() {
  const std::string start = "one solve a step, linearised at its start";
  const std::string predictor = "one solve a step, linearised at x + h v + h^2 a / 2";
  const std::string iterated = "Newton with line search until forces balance at the step's end";
  return {scheme("Euler", Integrator::Euler, "start", Linearize::Start, start + "; softreel's default, at 1e-3"),
          scheme("Euler", Integrator::Euler, "iterated", Linearize::Iterated, iterated),
          scheme("BDF2", Integrator::Bdf2, "start", Linearize::Start, start),
          scheme("BDF2", Integrator::Bdf2, "predictor", Linearize::Predictor, predictor + "; default of BDF2"),
          scheme("BDF2", Integrator::Bdf2, "iterated", Linearize::Iterated, iterated),
          scheme("Newmark", Integrator::Newmark, "start", Linearize::Start, start),
          scheme("Newmark", Integrator::Newmark, "predictor", Linearize::Predictor, predictor + "; default of Newmark"),
          scheme("Newmark", Integrator::Newmark, "iterated", Linearize::Iterated, iterated)};
}

std::vector<Method> softreel_variants() {
  const auto euler = [](RotationMethod rotation, double tolerance) {
    SolverParams params = scheme_params(Integrator::Euler, Linearize::Start, tolerance);
    params.rotation = rotation;
    return params;
  };
  return {
      softreel_method("paper 2008", "paper 2008 (V-cycles)",
                      "the paper as printed: rotations of eq. (3) by its bare Newton, one solve a step by plain "
                      "V-cycles of one forward and one backward sweep",
                      {1e-1, 1e-3},
                      [euler](double tolerance) {
                        SolverParams params = euler(RotationMethod::Paper, tolerance);
                        params.multigrid.method = SolveMethod::Cycles;
                        params.multigrid.coarse_cycle = CycleKind::V;
                        params.multigrid.smoother = SmootherKind::OneWayGaussSeidel;
                        params.keep_hierarchy = false;
                        params.matrix_lag = 0;
                        return params;
                      }),
      softreel_method("small strain", "small strain", "linear elasticity without rotations, Euler, softreel's solver",
                      {1e-3}, [euler](double tolerance) { return euler(RotationMethod::None, tolerance); }),
      softreel_method("smoothed polar", "smoothed polar",
                      "sec. 5 of the paper: rotations averaged over neighbours, Euler, softreel's solver", {1e-3},
                      [euler](double tolerance) { return euler(RotationMethod::PolarSmooth, tolerance); })};
}

std::vector<Method> rival_methods() {
  std::vector<Method> methods;
  add_direct(methods, DirectSolver::EigenLdlt, "Eigen LDLT",
             "Euler, one solve a step as softreel's, by Eigen's simplicial LDLT; order of elimination kept", {kNone});
  add_direct(methods, DirectSolver::Cholmod, "CHOLMOD",
             "the same by CHOLMOD's supernodal Cholesky; order of elimination kept", {kNone});
  const std::string gradients =
      "the same by Eigen's conjugate gradients, started from the accelerations of the last two steps as softreel's "
      "solver, preconditioned by ";
  add_direct(methods, DirectSolver::EigenCgIncompleteCholesky, "CG + incomplete Cholesky",
             gradients + "incomplete Cholesky", one_solve_tolerances());
  add_direct(methods, DirectSolver::EigenCgDiagonal, "CG + Jacobi", gradients + "the diagonal", one_solve_tolerances());
  Method xpbd{"XPBD",
              "XPBD",
              false,
              "small steps (Macklin et al. 2019): one iteration in each of 8, 16, 32 ... substeps a frame",
              {kNone},
              8,
              [](const BodyModel& model, double, const Threads&) {
                return make_xpbd(model, {1, 1});
              }};
  methods.push_back(std::move(xpbd));
  for (const auto& [iterations, memory] : {std::pair(10, 0), std::pair(50, 0), std::pair(10, 5)}) {
    Method projective{fmt::format("projective dynamics, {} iterations{}", iterations, memory > 0 ? ", L-BFGS" : ""),
                      "projective dynamics",
                      false,
                      memory > 0 ? "the same with a memory of 5 moves and a line search (Liu et al. 2017)"
                                 : "Bouaziz et al. 2014 with one prefactored matrix; 10 iterations a step are usual",
                      {kNone},
                      1,
                      [iterations, memory](const BodyModel& model, double, const Threads&) {
                        return make_projective_dynamics(model, {iterations, memory});
                      }};
    methods.push_back(std::move(projective));
  }
  return methods;
}

std::vector<Method> all_methods() {
  std::vector<Method> methods = softreel_schemes();
  for (Method& method : softreel_variants()) methods.push_back(std::move(method));
  for (Method& method : rival_methods()) methods.push_back(std::move(method));
  return methods;
}

Table method_table(const std::vector<Method>& methods) {
  Table table{
      "precision_methods", "The methods, and how each was tuned", {"method", "curve in plots", "what and how"}, {}};
  for (const Method& method : methods) table.add({method.label, method.curve, method.tuned});
  return table;
}

}  // namespace softreel::bench
