/// Everything in one picture, as plain values.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/types.h"
#include "render/scene/camera.h"
#include "render/scene/light.h"
#include "render/scene/material.h"

namespace softreel {

/// A triangle mesh at one or more equally spaced times of the shutter: times[0] at opening, times.back() at closing.
struct MotionMesh {
  std::string name;
  std::vector<Triangle> triangles;
  struct Time {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< unit, per vertex
  };
  std::vector<Time> times;  ///< 1: no motion blur
  Appearance appearance;
};

enum class GroundStyle {
  Plane,  ///< a large square
  Sweep   ///< a plane that bends up into a wall behind the subject, seen from the camera: a studio backdrop
};

struct Ground {
  GroundStyle style = GroundStyle::Plane;
  float height = 0;  ///< m, y of the plane
  float size = 40;   ///< m, edge of the square
  float sweep = 6;   ///< m from the origin, away from the camera, to where the wall starts to rise
  Appearance appearance;
  float checker = 0;  ///< m, edge of the squares of a two-tone pattern; 0: none
  Vec3f checker_color = Vec3f(0.4f, 0.4f, 0.4f);
};

struct Scene {
  Camera camera;
  std::vector<MotionMesh> meshes;
  std::vector<AreaLight> area_lights;
  std::vector<SunLight> suns;
  Environment environment;
  std::optional<Ground> ground;
};

}  // namespace softreel
