/// What the torture compares: rotation methods by the names that shots give them, and the default iterated.
#pragma once

#include <array>

#include "core/dynamics/simulator.h"

namespace softreel::bench {

struct NamedMethod {
  const char* name;
  RotationMethod rotation;
};

/// The default first.
inline constexpr std::array<NamedMethod, 6> kMethods{{{"consistent", RotationMethod::Consistent},
                                                      {"energy", RotationMethod::Energy},
                                                      {"paper", RotationMethod::Paper},
                                                      {"polar_smooth", RotationMethod::PolarSmooth},
                                                      {"qr", RotationMethod::Qr},
                                                      {"none", RotationMethod::None}}};

/// A rotation method and how often a step linearises.
struct Scheme {
  const char* name;
  RotationMethod rotation;
  Linearize linearize;
};

/// One solve a step by every method, and the default rotation iterated to force balance.
inline constexpr std::array<Scheme, 7> kSchemes{
    {{"consistent", RotationMethod::Consistent, Linearize::Auto},
     {"energy", RotationMethod::Energy, Linearize::Auto},
     {"paper", RotationMethod::Paper, Linearize::Auto},
     {"polar_smooth", RotationMethod::PolarSmooth, Linearize::Auto},
     {"qr", RotationMethod::Qr, Linearize::Auto},
     {"none", RotationMethod::None, Linearize::Auto},
     {"consistent, iterated", RotationMethod::Consistent, Linearize::Iterated}}};

inline SolverParams params_of(const Scheme& scheme) {
  SolverParams params;
  params.rotation = scheme.rotation;
  params.linearize = scheme.linearize;
  return params;
}

/// Degrees a step from which the text calls it flutter: at 24 frames a second, some two degrees a second.
inline constexpr double kFlutter = 0.1;

/// Share of momentum, as Verdict's drifts, from which the text says that a free body lost or gained it.
inline constexpr double kDrift = 0.01;

}  // namespace softreel::bench
