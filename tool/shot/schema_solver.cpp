// The table of how the motion is computed.
#include <fmt/format.h>

#include "tool/shot/codecs.h"
#include "tool/shot/schema_tables.h"

namespace softreel {
namespace {

void check_newmark(const Place& place, const TomlValue& value, Shot& shot) {
  const NewmarkParams& newmark = shot.solver.newmark;
  if (newmark.is_stable()) return;
  const TomlValue* beta = value.find("newmark_beta");
  const char* name = beta != nullptr ? "newmark_beta" : "newmark_gamma";
  const FieldText text{"", "", "", "", "2 newmark_beta at least newmark_gamma", "", false, false};
  throw value_error({place.path + "." + name, &text, place.problems}, *value.find(name),
                    fmt::format("2 x {:.6g} is below {:.6g}, so long steps would blow up", newmark.beta, newmark.gamma),
                    fmt::format("Say newmark_beta = {:.6g}, or leave both out for 1/4 and 1/2.", 0.5 * newmark.gamma));
}

}  // namespace

const Table<Shot>& solver_table() {
  static const Table<Shot> table = [] {
    Table<Shot> t;
    const auto of_solver = [](auto member) {
      return [member](auto& s) -> auto& {
        return s.solver.*member;
      };
    };
    using P = SolverParams;
    const auto of_newmark = [](auto member) {
      return [member](auto& s) -> auto& {
        return s.solver.newmark.*member;
      };
    };
    constexpr Range kTolerance{0, 1, true};
    t.sentence = "How the motion is computed.";
    t.add("rotation", of_solver(&P::rotation),
          choice<RotationMethod>({{"consistent", RotationMethod::Consistent},
                                  {"energy", RotationMethod::Energy},
                                  {"paper", RotationMethod::Paper},
                                  {"polar_smooth", RotationMethod::PolarSmooth},
                                  {"qr", RotationMethod::Qr},
                                  {"none", RotationMethod::None}}),
          "",
          "Of each tetrahedron: polar, by the paper's energy safely or by its bare Newton, polar averaged over "
          "neighbours, Gram-Schmidt (depends on the order of nodes), or none (small strain only).")
        .add("dilatation", of_solver(&P::dilatation),
             choice<Dilatation>({{"capped", Dilatation::Capped}, {"linear", Dilatation::Linear}}), "",
             "\"capped\" keeps strong stretch stable; \"linear\" is the bare linear material.")
        .add("integrator", of_solver(&P::integrator),
             choice<Integrator>(
                 {{"euler", Integrator::Euler}, {"bdf2", Integrator::Bdf2}, {"newmark", Integrator::Newmark}}),
             "",
             "dynamic: \"euler\" forgives most and damps most, \"bdf2\" damps what is fast only, \"newmark\" keeps "
             "energy (at its defaults).")
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
             "\"auto\" is \"start\" for \"euler\", else \"predictor\".")
        .add("substeps", of_solver(&P::substeps), whole<int>(1, 10000), "per frame", "Steps of time in a frame.")
        .add("tolerance", of_solver(&P::tolerance), number(kTolerance), "",
             "dynamic: residual of a step's linear solve over its right-hand side.")
        .add("force_tolerance", of_solver(&P::force_tolerance), number(kTolerance), "",
             "static, iterated: residual force over the body's scale of force.")
        .add("max_iterations", of_solver(&P::max_iterations), whole<int>(1, 1000000), "", "Of one linear solve.")
        .add("max_newton_iterations", of_solver(&P::max_newton_iterations), whole<int>(1, 1000000), "",
             "static: per frame; iterated: per step.")
        .add(
            "galerkin", [](auto& s) -> auto& { return s.solver.multigrid.galerkin; },
            choice<GalerkinMethod>({{"gather", GalerkinMethod::Gather},
                                    {"stream", GalerkinMethod::Stream},
                                    {"naive", GalerkinMethod::Naive}}),
            "", "How coarse matrices are formed; all give the same up to round-off.")
        .add("threads", &Shot::threads, whole<int>(0, 4096), "", "0: all processors. Results do not depend on it.");
    t.check = check_newmark;
    return t;
  }();
  return table;
}

}  // namespace softreel
