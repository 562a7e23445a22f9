// What every material of presets/materials promises: light that adds up, and numbers that are sound.
#include <algorithm>

#include "tests/render/scattering_checks.h"
#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

class MaterialLibrary : public ShotFiles {
 protected:
  /// Every material by its name, with the file's text.
  struct Entry {
    std::string name, text;
    MaterialSettings material;
  };
  static std::vector<Entry> library() {
    std::vector<Entry> all;
    for (const auto& file : fs::directory_iterator(fs::path(SOFTREEL_SOURCE_DIR) / "presets/materials")) {
      if (file.path().extension() != ".toml") continue;
      const std::string name = file.path().stem();
      std::ifstream in(file.path());
      const std::string text(std::istreambuf_iterator<char>(in), {});
      write("materials/" + name + ".toml", text);
      const Shot shot = load("schema = 1\nuse = [\"materials/" + name + ".toml\"]\n[shot]\nframes = [1, 1]\n" +
                             "[body.b]\nmesh = \"b.ply\"\nmaterial = \"" + name + "\"\n");
      all.push_back({name, text, shot.materials.at(name)});
    }
    std::sort(all.begin(), all.end(), [](const Entry& a, const Entry& b) { return a.name < b.name; });
    return all;
  }
  /// A twin whose lobes are wide, to draw directions from.
  static Bsdf rougher(Appearance look) {
    look.roughness = std::min(1.0f, look.roughness + 0.1f);
    look.coat_roughness = std::min(1.0f, look.coat_roughness + 0.1f);
    return Bsdf(look);
  }
};

TEST_F(MaterialLibrary, HoldsAtLeastTwelveWithALineOfWordsEach) {
  const std::vector<Entry> all = library();
  EXPECT_GE(all.size(), 12u);
  std::ifstream in(fs::path(SOFTREEL_SOURCE_DIR) / "presets/materials/README.md");
  const std::string index(std::istreambuf_iterator<char>(in), {});
  for (const Entry& entry : all) {
    EXPECT_EQ(entry.text.substr(0, 2), "# ") << entry.name;
    EXPECT_NE(index.find("| `" + entry.name + "` |"), std::string::npos) << entry.name << " is not in README.md";
  }
}

TEST_F(MaterialLibrary, MovesLikeSomething) {
  for (const Entry& entry : library()) {
    const ElementMaterial& physics = entry.material.physics;
    EXPECT_GE(physics.youngs_modulus, 1e4) << entry.name << ": softer ones flow under their weight";
    EXPECT_LE(physics.youngs_modulus, 1e7) << entry.name << ": stiffer ones do not visibly deform";
    EXPECT_LE(physics.poisson_ratio, 0.49) << entry.name;
    EXPECT_GT(physics.density, 50) << entry.name;
    EXPECT_LT(physics.density, 4000) << entry.name;
    EXPECT_GT(physics.damping_mass + physics.damping_stiffness, 0) << entry.name;
  }
}

TEST_F(MaterialLibrary, NeverReturnsMoreLightThanArrives) {
  for (const Entry& entry : library())
    for (const bool inside : {false, true}) {
      if (inside && entry.material.appearance.transmission == 0) continue;
      const Bsdf bsdf(entry.material.appearance);
      for (const float cosine : {0.05f, 0.3f, 0.7f, 1.0f})
        EXPECT_LE(sampled_albedo(bsdf, direction(std::acos(cosine), 0.4f), inside).maxCoeff(), 1.015)
            << entry.name << ' ' << cosine << ' ' << inside;
    }
}

TEST_F(MaterialLibrary, WouldReturnAllLightIfItWereWhite) {
  for (const Entry& entry : library()) {
    Appearance look = entry.material.appearance;
    look.base_color = look.coat_color = look.sheen_color = Vec3f::Ones();
    const Bsdf bsdf(look);
    for (const float cosine : {0.1f, 0.4f, 0.9f})
      EXPECT_NEAR(sampled_albedo(bsdf, direction(std::acos(cosine), 0.4f), false).x(), 1, 0.02)
          << entry.name << ' ' << cosine;
  }
}

TEST_F(MaterialLibrary, ReflectsTheSameBothWays) {
  for (const Entry& entry : library()) {
    Appearance look = entry.material.appearance;
    look.transmission = 0;  // the compensation of rough glass is not reciprocal (bsdf.h)
    const Bsdf bsdf(look);
    for (const float polar : {0.15f, 0.55f, 0.9f, 1.4f}) {
      const Vec3f o = direction(0.5f, 0.2f), i = direction(polar, 3.3f);
      const Vec3f there = bsdf.evaluate(o, i, false).value / i.z(), back = bsdf.evaluate(i, o, false).value / o.z();
      EXPECT_TRUE((there - back).norm() <= 2e-3f * there.norm() + 1e-6f)
          << entry.name << ": " << there.transpose() << " | " << back.transpose();
    }
  }
}

TEST_F(MaterialLibrary, DrawsWhatItSays) {
  // Moments of the directions that sample() draws against the density that evaluate() gives. Five standard deviations
  // in 7 moments of some 50 cases: one false alarm in ten thousand runs of other numbers; these are always the same.
  for (const Entry& entry : library())
    for (const bool inside : {false, true}) {
      if (inside && entry.material.appearance.transmission == 0) continue;
      const Bsdf bsdf(entry.material.appearance), proposal = rougher(entry.material.appearance);
      for (const float polar : {0.3f, 1.2f})
        EXPECT_LT(moment_mismatch(bsdf, proposal, direction(polar, 0.5f), inside, 40000), 5)
            << entry.name << ' ' << polar << ' ' << inside;
    }
}

}  // namespace
}  // namespace softreel
