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
#include "render/scene/texture.h"

namespace softreel {

/// Lines along the edges of a mesh's triangles, for pictures of meshes: traced ones, and previews. They are as wide as
/// seen by the camera, not in metres, and lie in the surface: light and shadow fall on them.
struct EdgeLines {
  float width = 1;  ///< pixels, half of it on either side of the edge
  /// Most that a line may take of the inscribed circle of a triangle as the camera sees it, from either side; less
  /// where that circle is smaller than a pixel. So fine meshes get fainter lines instead of black ones.
  float max_share = 0.2f;
  Vec3f color = Vec3f::Zero();  ///< linear albedo, matt
  /// Per triangle, bit k: the edge from corner k to the next has a line. Empty: all have.
  std::vector<std::uint8_t> drawn;
};

/// A triangle mesh at one or more equally spaced times of the shutter: times[0] at opening, times.back() at closing.
struct MotionMesh {
  std::string name;
  std::vector<Triangle> triangles;
  /// Per triangle the normals of its corners, where hard edges give a vertex several; empty: those of its vertices.
  std::vector<Triangle> normal_triangles;
  struct Time {
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< unit, per vertex, or as normal_triangles count them; empty: the triangles are flat
  };
  std::vector<Time> times;  ///< 1: no motion blur
  /// m, per vertex, the shape at rest: what trees that rays are shot at are built from, to be fitted to the times.
  /// Meshes of one body share it over the frames. Null: the mesh knows none.
  std::shared_ptr<const std::vector<Vec3f>> rest_positions;
  Appearance appearance;
  std::string material;               ///< its name, for the channel of material ids
  std::vector<Vec3f> next_positions;  ///< at the next frame, for the channel of motion; empty: it stands still
  std::vector<float> strain;          ///< per vertex, for the channel of that name; empty: none
  std::optional<EdgeLines> lines;
  SurfaceColoring coloring;  ///< what varies over the surface

  /// Per triangle its corners among the normals.
  const std::vector<Triangle>& corners_of_normals() const {
    return normal_triangles.empty() ? triangles : normal_triangles;
  }
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
  /// The camera sees only the shadow on it, as alpha over nothing, and nothing of the surroundings; visible lamps are
  /// opaque before both. To all other rays it is there.
  bool shadow_catcher = false;
};

struct Scene {
  Camera camera;                      ///< at the closing of the shutter
  std::optional<Camera> next_camera;  ///< at the next frame, for the channel of motion; none: it stands still
  /// At equally spaced times of the shutter, the last one as `camera`; empty: it stands still.
  std::vector<Camera> camera_motion;
  ShutterCurve shutter;
  std::vector<MotionMesh> meshes;
  std::vector<AreaLight> area_lights;
  std::vector<SunLight> suns;
  Environment environment;
  std::optional<Ground> ground;
};

}  // namespace softreel
