#include "tool/stages/material_textures.h"

#include <gtest/gtest.h>

#include "core/base/error.h"

namespace softreel {
namespace {

TEST(MaterialTextures, RefuseColoursOnlyOfVerticesThatTrianglesUse) {
  Shot shot;
  BodySettings body;
  body.material = "paint";
  shot.materials["paint"].textures.vertex_colors = true;
  shot.bodies = {body};
  LoadedBody loaded;
  loaded.surface.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
  loaded.surface.triangles = {{0, 1, 2}};
  loaded.surface.colors = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0, 0, 300}};
  const MaterialTextures textures(shot);
  EXPECT_NO_THROW(textures.require_match(body, loaded));
  loaded.surface.triangles.push_back({0, 2, 3});
  EXPECT_THROW(textures.require_match(body, loaded), Error);
}

}  // namespace
}  // namespace softreel
