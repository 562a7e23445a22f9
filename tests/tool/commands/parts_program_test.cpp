/// Which shared libraries a command maps, from the dynamic loader's own account: none that it does not use.
#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace softreel {
namespace {

using namespace softreel::testing;

/// The libraries behind the parts, as the names of their files begin.
constexpr const char* kHeavy[] = {"libassimp", "libembree", "libEGL", "libepoxy", "libopenvdb", "softreel_part_"};

/// Adds the names of the files that one process mapped: what stands after the last / of "calling init: PATH" lines.
void add_mapped(const std::string& loader_log, std::set<std::string>& names) {
  std::istringstream lines(loader_log);
  for (std::string line; std::getline(lines, line);)
    if (line.find("calling init: ") != std::string::npos) names.insert(line.substr(line.rfind('/') + 1));
}

struct Mapped {
  Outcome outcome;
  std::set<std::string> names;

  bool has(const std::string& beginning) const {
    return std::any_of(names.begin(), names.end(), [&](const std::string& n) { return n.starts_with(beginning); });
  }
  /// The heavy libraries among them, by their entries in kHeavy.
  std::set<std::string> heavy() const {
    std::set<std::string> found;
    for (const char* library : kHeavy)
      if (has(library)) found.insert(library);
    return found;
  }
};

/// Runs softreel with `arguments` and collects what it mapped, the programs that it starts (ffmpeg) included.
Mapped run_traced(const std::string& arguments, const std::string& environment = "") {
  const std::string folder = new_folder("loader");
  Mapped mapped;
  mapped.outcome =
      run(fmt::format("export {} LD_DEBUG=files LD_DEBUG_OUTPUT={}/log; softreel {}", environment, folder, arguments));
  for (const std::string& file : files_under(folder)) add_mapped(read_text(folder + "/" + file), mapped.names);
  EXPECT_TRUE(mapped.has("libstdc++")) << "the loader said nothing";
  return mapped;
}

using Names = std::set<std::string>;

TEST(Parts, NoneIsLoadedForHelpAndFields) {
  for (const char* arguments : {"--help", "render --help", "fields", "explain tets", "completion bash"}) {
    const Mapped mapped = run_traced(arguments);
    EXPECT_EQ(mapped.outcome.status, 0) << arguments << mapped.outcome.err;
    EXPECT_EQ(mapped.heavy(), Names()) << arguments;
  }
}

TEST(Parts, NoneIsLoadedToSayWhichThereAre) {
  const Mapped mapped = run_traced("--version", "PATH=/nowhere");  // ffmpeg would load its own
  EXPECT_EQ(mapped.outcome.status, 0) << mapped.outcome.err;
  EXPECT_EQ(mapped.heavy(), Names());
}

TEST(Parts, NoneIsLoadedToCheckAShotOfAnObjOrItsStatus) {
  const std::string folder = shot_folder("parts_check");
  for (const char* command : {"check", "status"}) {
    const Mapped mapped = run_traced(fmt::format("{0} {1}/shot.toml --output {1}/out", command, folder));
    EXPECT_EQ(mapped.outcome.status, 0) << command << mapped.outcome.err;
    EXPECT_EQ(mapped.heavy(), Names()) << command;
  }
}

TEST(Parts, NoneIsLoadedToInspectAnObj) {
  const std::string folder = shot_folder("parts_inspect");
  const Mapped mapped = run_traced(fmt::format("inspect {}/sphere.obj", folder));
  EXPECT_EQ(mapped.outcome.status, 0) << mapped.outcome.err;
  EXPECT_EQ(mapped.heavy(), Names());
}

TEST(Parts, RenderLoadsEmbreeForThePicture) {
  const std::string folder = shot_folder("parts_render");
  const Mapped mapped = run_traced(fmt::format("render {0}/shot.toml --output {0}/out --frames 1 --quiet", folder));
  EXPECT_EQ(mapped.outcome.status, 0) << mapped.outcome.err;
  EXPECT_EQ(mapped.heavy(), Names({"libembree", "softreel_part_"}));
}

TEST(Parts, PreviewLoadsEglInsteadOfEmbree) {
  const std::string folder = shot_folder("parts_preview");
  const Mapped mapped = run_traced(fmt::format("preview {0}/shot.toml --output {0}/out --frames 1 --quiet", folder));
  // Where no device can be opened, the part that says so is loaded all the same.
  EXPECT_TRUE(mapped.has("softreel_part_egl")) << mapped.outcome.err;
  EXPECT_TRUE(mapped.has("libEGL")) << mapped.outcome.err;
  EXPECT_FALSE(mapped.has("libembree"));
  EXPECT_FALSE(mapped.has("libassimp"));
}

TEST(Parts, PreviewSaysWhichLibraryOfOpenGlIsMissing) {
  const std::string folder = shot_folder("parts_no_gl");
  for (const std::vector<std::string>& missing :
       {std::vector<std::string>{"libEGL.so.1"}, std::vector<std::string>{"libGL.so.1", "libOpenGL.so.0"}}) {
    const std::string libraries = new_folder("parts_no_" + missing[0]);
    for (const std::string& library : missing) write_text(libraries + "/" + library, "");  // which no loader takes
    const Outcome outcome =
        run(fmt::format("export LD_LIBRARY_PATH={1}:$LD_LIBRARY_PATH; softreel preview {0}/shot.toml --output {0}/out "
                        "--frames 1 --quiet",
                        folder, libraries));
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("The preview cannot draw: a library cannot be loaded"), std::string::npos)
        << outcome.err;
    for (const std::string& library : missing) EXPECT_NE(outcome.err.find(library), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("Install libegl1, libgl1 and libgl1-mesa-dri"), std::string::npos) << outcome.err;
  }
}

TEST(Parts, PreviewNamesTheErrorOfAContextThatItDoesNotGet) {
  const std::string folder = shot_folder("parts_old_gl");
  // The drivers of Mesa alone, which do as the other variable says.
  const Outcome outcome = run(
      fmt::format("export __EGL_VENDOR_LIBRARY_FILENAMES=/usr/share/glvnd/egl_vendor.d/50_mesa.json "
                  "MESA_GL_VERSION_OVERRIDE=2.1; softreel preview {0}/shot.toml --output {0}/out --frames 1 --quiet",
                  folder));
  const std::string refusal = "no OpenGL 3.3 context (EGL error ";
  const bool refused = outcome.err.find(refusal) != std::string::npos;
  if (!refused && has_no_egl(outcome)) GTEST_SKIP() << "no Mesa here: " << outcome.err;
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_TRUE(refused) << outcome.err;
  EXPECT_EQ(outcome.err.find(refusal + "0x3000)"), std::string::npos) << "that is success: " << outcome.err;
}

#if SOFTREEL_HAS_OPENVDB
TEST(Parts, LevelSetsAloneLoadOpenVdb) {
  const std::string folder = shot_folder("parts_export");
  const auto exported = [&](const char* format) {
    return run_traced(
        fmt::format("export {0}/shot.toml --output {0}/out --frames 1 --quiet --format {1}", folder, format));
  };
  EXPECT_EQ(exported("vtu").heavy(), Names());
  const Mapped mapped = exported("vdb");
  EXPECT_EQ(mapped.outcome.status, 0) << mapped.outcome.err;
  EXPECT_EQ(mapped.heavy(), Names({"libopenvdb", "softreel_part_"}));
}
#endif

TEST(Parts, OtherMeshFormatsLoadAssimpWhoseErrorsAreOurs) {
  const std::string folder = new_folder("parts_assimp");
  write_text(folder + "/broken.gltf", "{\"asset\":");
  const Mapped mapped = run_traced(fmt::format("inspect {}/broken.gltf", folder));
  EXPECT_EQ(mapped.outcome.status, 2) << "an error thrown in a part was not caught as one: " << mapped.outcome.err;
  EXPECT_NE(mapped.outcome.err.find("broken.gltf: the mesh cannot be read"), std::string::npos) << mapped.outcome.err;
  EXPECT_EQ(mapped.heavy(), Names({"libassimp", "softreel_part_"}));
}

}  // namespace
}  // namespace softreel
