// The table of how the motion is computed.
#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

constexpr int kMostSubsteps = 65536;

void check_substeps(const Place& place, const TomlValue& value, const SolverParams& solver) {
  if (solver.step_error == 0 || solver.max_substeps >= solver.substeps) return;
  const char* name = value.find("max_substeps") != nullptr ? "max_substeps" : "substeps";
  const FieldText text{"", "", "", "", "max_substeps not below substeps", "", false, false};
  throw value_error(
      {place.path + "." + name, &text, place.problems}, *value.find(name),
      fmt::format("a frame cannot have at least {} and at most {} steps", solver.substeps, solver.max_substeps),
      "Raise max_substeps.");
}

/// Both say how long steps are.
void check_dial(const Place& place, const TomlValue& value, const Shot& shot) {
  if (!shot.dial.is_on() || shot.solver.step_error == 0) return;
  const TomlValue& given = *value.find("step_error");
  const FieldText text{"", "", "", "", "error or step_error, not both", "", false, false};
  throw value_error(
      {place.path + ".step_error", &text, place.problems}, given,
      fmt::format("error is given too ({}), and both choose the steps", to_string(value.find("error")->origin)),
      "Remove one of the two; substeps can be given beside error.");
}

void check_newmark(const Place& place, const TomlValue& value, const NewmarkParams& newmark) {
  if (newmark.is_stable()) return;
  const TomlValue* beta = value.find("newmark_beta");
  const char* name = beta != nullptr ? "newmark_beta" : "newmark_gamma";
  const FieldText text{"", "", "", "", "2 newmark_beta at least newmark_gamma", "", false, false};
  throw value_error(
      {place.path + "." + name, &text, place.problems}, *value.find(name),
      fmt::format("twice newmark_beta = {:.6g} is below newmark_gamma = {:.6g}, so that long steps blow up",
                  newmark.beta, newmark.gamma),
      fmt::format("Say newmark_beta = {:.6g}, or leave both out for 1/4 and 1/2.", 0.5 * newmark.gamma));
}

using P = SolverParams;
using M = MultigridParams;

/// A member of the solver's parameters, as a member of the shot.
auto of_solver(auto member) {
  return [member](auto& s) -> auto& {
    return s.solver.*member;
  };
}

auto of_newmark(auto member) {
  return [member](auto& s) -> auto& {
    return s.solver.newmark.*member;
  };
}

auto of_multigrid(auto member) {
  return [member](auto& s) -> auto& {
    return s.solver.multigrid.*member;
  };
}

void add_material_law(Table<Shot>& t) {
  t.add("rotation", of_solver(&P::rotation), rotation_method(), "",
        "Of each tetrahedron: polar, by the paper's energy safely or by its bare Newton, polar averaged over "
        "neighbours, Gram-Schmidt (depends on the order of nodes), or none (small strain only).")
      .add("dilatation", of_solver(&P::dilatation),
           choice<Dilatation>({{"capped", Dilatation::Capped}, {"linear", Dilatation::Linear}}), "",
           "\"capped\" keeps strong stretch stable; \"linear\" is the bare linear material.")
      .add("recovery", of_solver(&P::recovery), toggle(), "",
           "dynamic: untangle elements that stay inverted or wound round an edge, by one rotation for each patch of "
           "them.");
}

void add_time_stepping(Table<Shot>& t) {
  t.add(
       "integrator", of_solver(&P::integrator),
       choice<Integrator>({{"euler", Integrator::Euler}, {"bdf2", Integrator::Bdf2}, {"newmark", Integrator::Newmark}}),
       "",
       "dynamic: \"euler\" forgives most and damps most, \"bdf2\" damps what is fast only, \"newmark\" keeps "
       "the energy of what the steps are short enough for (at its defaults); undamped and faster than that, a body "
       "may gain energy.")
      .add("newmark_beta", of_newmark(&NewmarkParams::beta), number({0.25, 1}), "",
           "\"newmark\": share of the last acceleration in the way, halved. At least newmark_gamma / 2.")
      .add("newmark_gamma", of_newmark(&NewmarkParams::gamma), number({0.5, 1}), "",
           "\"newmark\": share of the last acceleration in the velocity. Above 0.5 it damps and is of first order.")
      .add("linearize", of_solver(&P::linearize),
           choice<Linearize>({{"auto", Linearize::Auto},
                              {"start", Linearize::Start},
                              {"predictor", Linearize::Predictor},
                              {"iterated", Linearize::Iterated}}),
           "",
           "dynamic: a step's one solve takes rotations and forces at its \"start\" (of first order) or at the "
           "\"predictor\" of its end (keeps second order); \"iterated\" solves until forces balance at its end. "
           "\"auto\" is \"start\" for \"euler\", \"predictor\" for \"bdf2\", \"iterated\" for \"newmark\".")
      .add("substeps", of_solver(&P::substeps), absent_if_zero(whole<int>(1, 10000)), "per frame",
           "Steps of time in a frame; with step_error, the fewest; with error it is chosen where it is not given.")
      .add("step_error", of_solver(&P::step_error), number({0, 1}), "",
           "dynamic: steps get shorter until their estimated error of place, over the body's size, is below; 0: off.")
      .add("max_substeps", of_solver(&P::max_substeps), whole<int>(1, kMostSubsteps), "per frame",
           "step_error, error: the most steps of a frame. If they do not do, the run stops and says so.")
      .add("rest_tolerance", of_solver(&P::rest_tolerance), number({0, 1}), "",
           "dynamic: a body is not stepped if its velocities would move no point by more than this times its size in "
           "1/24 s, its forces balance to force_tolerance and its pins stay; 0: every body is stepped.")
      .add("matrix_lag", of_solver(&P::matrix_lag), number({0, 1}), "",
           "dynamic: within a frame, elements whose matrix would change by less than this times tolerance keep it; 0: "
           "only where nothing changes.")
      .add("keep_hierarchy", of_solver(&P::keep_hierarchy), toggle(), "",
           "dynamic: within a frame, coarse levels stay while the solver needs no more iterations with them.");
}

void add_dial(Table<Shot>& t) {
  const auto of_dial = [](auto member) {
    return [member](auto& s) -> auto& {
      return s.dial.*member;
    };
  };
  t.add("error", of_dial(&DialSettings::error), percent(), "",
        "Wanted error of the motion: distance of the surface's vertices from where ever finer meshes and steps would "
        "take them, root mean square over the vertices in the worst frame, over the diagonal of the body's box. The "
        "tets, substeps and tolerance that are not given are chosen for it, by short runs on coarse meshes, and the "
        "integrator is \"bdf2\" where none is given; each run says the error it believes in. The error of a body is "
        "another: how far its tetrahedra may be from its surface at rest.",
        "none: nothing is chosen")
      .add("max_tets", of_dial(&DialSettings::max_tets), whole<std::int64_t>(12000, 500000000), "",
           "error: the most tetrahedra of a body; the coarse runs that judge it take 12000. If they do not do, the run "
           "stops "
           "and says so.");
}

void add_limits(Table<Shot>& t) {
  constexpr Range kTolerance{0, 1, true};
  t.add("tolerance", of_solver(&P::tolerance), absent_if_zero(number(kTolerance)), "",
        "dynamic: residual of a step's linear solve over its right-hand side, tighter by itself where parts are very "
        "stiff; with error it is chosen where not given.")
      .add("force_tolerance", of_solver(&P::force_tolerance), absent_if_zero(number(kTolerance)), "",
           "static, iterated: residual force over the body's scale of force; with error it is chosen where not given.")
      .add("max_iterations", of_solver(&P::max_iterations), whole<int>(1, 1000000), "", "Of one linear solve.")
      .add("max_newton_iterations", of_solver(&P::max_newton_iterations), whole<int>(1, 1000000), "",
           "static: per frame; iterated: per step.");
}

void add_multigrid(Table<Shot>& t) {
  t.add("galerkin", of_multigrid(&M::galerkin),
        choice<GalerkinMethod>(
            {{"gather", GalerkinMethod::Gather}, {"stream", GalerkinMethod::Stream}, {"naive", GalerkinMethod::Naive}}),
        "", "How coarse matrices are formed; all give the same up to round-off.")
      .add("method", of_multigrid(&M::method),
           choice<SolveMethod>({{"cg", SolveMethod::ConjugateGradients}, {"cycles", SolveMethod::Cycles}}), "",
           "Conjugate gradients preconditioned by a multigrid cycle, or the cycles alone, as in the paper.")
      .add("cycle", of_multigrid(&M::coarse_cycle),
           choice<CycleKind>(
               {{"auto", CycleKind::Auto}, {"w", CycleKind::W}, {"v", CycleKind::V}, {"full_w", CycleKind::FullW}}),
           "",
           "Shape of a multigrid cycle; \"w\" is a V on the finest level. \"auto\" is \"w\", or \"full_w\" where "
           "stiffness differs by more than 10.")
      .add("smoother", of_multigrid(&M::smoother),
           choice<SmootherKind>({{"gauss_seidel", SmootherKind::GaussSeidel},
                                 {"one_way_gauss_seidel", SmootherKind::OneWayGaussSeidel},
                                 {"chebyshev", SmootherKind::Chebyshev}}),
           "",
           "Before and after coarse corrections: Gauss-Seidel forward and backward, or forward before and backward "
           "after (the paper's), or a Chebyshev polynomial.")
      .add("sweeps", of_multigrid(&M::sweeps), whole<int>(0, 100), "",
           "Of the smoother, before and after each coarse correction. 0: 2 if a poisson_ratio is above 0.475, else 1.")
      .add("chebyshev_degree", of_multigrid(&M::chebyshev_degree), whole<int>(1, 100), "",
           "Of the polynomial, where that is the smoother.");
}

}  // namespace

Codec<RotationMethod> rotation_method() {
  return choice<RotationMethod>({{"consistent", RotationMethod::Consistent},
                                 {"energy", RotationMethod::Energy},
                                 {"paper", RotationMethod::Paper},
                                 {"polar_smooth", RotationMethod::PolarSmooth},
                                 {"qr", RotationMethod::Qr},
                                 {"none", RotationMethod::None}});
}

const Table<Shot>& solver_table() {
  static const Table<Shot> table = [] {
    Table<Shot> t;
    t.sentence = "How the motion is computed.";
    add_material_law(t);
    add_time_stepping(t);
    add_dial(t);
    add_limits(t);
    add_multigrid(t);
    t.add("threads", &Shot::threads, whole<int>(0, 4096), "", "0: all processors. Results do not depend on it.");
    t.check = [](const Place& place, const TomlValue& value, Shot& shot) {
      check_newmark(place, value, shot.solver.newmark);
      check_dial(place, value, shot);
      check_substeps(place, value, shot.solver);
    };
    return t;
  }();
  return table;
}

}  // namespace softreel
