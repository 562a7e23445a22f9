/// Shaders of lit surfaces: which of them a mesh needs, and what they are told. Part of the EGL back end, which alone
/// may include it.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "render/image/image_io.h"
#include "render/preview/egl/gl_objects.h"
#include "render/preview/egl/gpu_sky.h"
#include "render/preview/egl/gpu_textures.h"
#include "render/preview/preview_lights.h"
#include "render/preview/shadow_views.h"
#include "render/scene/ground_mesh.h"
#include "render/scene/scene.h"

namespace softreel {

/// Units of textures; 0 has the shadow maps.
enum TextureUnit : GLuint { kColorUnit = 1, kRoughnessUnit, kNormalUnit, kBumpUnit, kSkyUnit };

/// Programs by the text of their shaders, each made when it is first asked for.
class GlPrograms {
 public:
  const GlProgram& of(const std::string& vertex, const std::string& fragment) {
    return programs_.try_emplace(vertex + fragment, vertex, fragment).first->second;
  }

 private:
  std::map<std::string, GlProgram> programs_;
};

/// What all shaders of one picture are told.
struct SurfaceView {
  ViewTransform view = ViewTransform::Standard;
  float exposure = 0;
  Environment environment;
  std::vector<ShadowView> shadows;  ///< in the layers of the texture at unit 0
  Eigen::Matrix4f clip_from_world;
  Vec3f eye;
  float pixel_angle = 0;        ///< rad, across a pixel in the middle of the picture
  const GpuSky* sky = nullptr;  ///< of the environment's image, bound to kSkyUnit; null: there is none
};

/// The first lines of a fragment shader.
std::string shader_head(const SurfaceView& view);
/// The environment and the exposure, for a program that is made current.
void set_surroundings(const GlProgram& program, const SurfaceView& view);

/// Whether light that comes through a body is seen as what is behind it, rather than as the surroundings.
bool is_see_through(const Appearance& appearance);
/// Whether meshes of this look may be lit at their vertices; else their details would be lost.
bool may_be_lit_at_vertices(const MotionMesh& mesh);

/// Chooses and prepares the programs of one picture. scene, view, programs and textures are kept by reference.
class SurfacePrograms {
 public:
  SurfacePrograms(const Scene& scene, const SurfaceView& view, GlPrograms& programs, GpuTextures& textures)
      : scene_(scene), lights_(preview_lights(scene)), view_(view), programs_(programs), textures_(textures) {
    if (scene.ground) ground_ = ground_shape(*scene.ground, scene.camera);
  }

  /// Makes the program for a body current. glass: it has a second output, the factor of what is behind.
  void use_for_body(const MotionMesh& mesh, bool flat, bool at_vertices, bool glass);
  /// in_shadow: whether shadows may fall there; without, it is cheaper.
  void use_for_ground(const Ground& ground, const MotionMesh& mesh, bool in_shadow);

 private:
  /// Names of #defines and their values.
  using Needs = std::map<std::string, int>;
  const GlProgram& program(const Needs& needs, bool at_vertices, bool in_shadow);
  bool may_be_hidden(bool is_sun, int light) const;
  bool ground_hides() const;
  std::string lights_text() const;
  void set_picture(const GlProgram& surface) const;
  void set_lights(const GlProgram& surface) const;
  void set_shadows(const GlProgram& surface) const;
  void set_appearance(const GlProgram& surface, const MotionMesh& mesh, bool flat) const;
  void set_layers(const GlProgram& surface, const MotionMesh& mesh) const;
  void set_maps(const GlProgram& surface, const TextureMaps& maps);
  void set_ground(const GlProgram& surface, const Ground& ground) const;

  const Scene& scene_;
  const PreviewLights lights_;
  const SurfaceView& view_;
  std::optional<GroundShape> ground_;
  GlPrograms& programs_;
  GpuTextures& textures_;
  std::set<const GlProgram*> prepared_;  ///< know what all shaders are told
};

}  // namespace softreel
