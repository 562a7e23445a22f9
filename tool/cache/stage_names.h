/// Names of the stages whose results the cache keeps: folders in it, and words of reports.
#pragma once

namespace softreel {

inline constexpr const char* kSurfaceStage = "surface";
inline constexpr const char* kDialStage = "dial";
inline constexpr const char* kTetrahedraStage = "tetrahedra";
inline constexpr const char* kSimulationStage = "simulation";
inline constexpr const char* kPictureStage = "picture";

}  // namespace softreel
