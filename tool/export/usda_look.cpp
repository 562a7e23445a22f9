#include "tool/export/usda_look.h"

#include <filesystem>

#include <fmt/format.h>

#include "tool/export/export_colors.h"
#include "tool/export/export_look.h"
#include "tool/export/usda_text.h"
#include "tool/shot/plain_path.h"

namespace softreel {
namespace {

std::string color_text(const Vec3f& v) {
  return fmt::format("({}, {}, {})", v.x(), v.y(), v.z());
}

/// One input of the surface that may be a picture's.
struct Picture {
  const char* name;    ///< of its prim
  const char* input;   ///< of the surface
  const char* type;    ///< of that
  const char* output;  ///< of the picture
  std::string path;
  bool is_color = false;
};

class LookWriter {
 public:
  LookWriter(const ExportBody& body, std::string path, const std::string& folder)
      : body_(body), path_(std::move(path)), folder_(folder) {
    const TextureSettings& t = body.textures;
    if (body.mesh->polygons.corner_textures.empty()) return;
    for (Picture picture : {Picture{"base_color", "diffuseColor", "color3f", "rgb", t.base_color, true},
                            Picture{"roughness", "roughness", "float", "g", t.roughness},
                            Picture{"normal", "normal", "normal3f", "rgb", t.normal}})
      if (!picture.path.empty()) pictures_.push_back(std::move(picture));
  }

  std::string text() {
    write_surface();
    if (shows_vertex_colors(body_)) write_vertex_colors();
    if (!pictures_.empty()) write_coordinates();
    for (const Picture& picture : pictures_) write_picture(picture);
    return std::move(text_);
  }

 private:
  template <typename... Values>
  void line(const char* form, const Values&... values) {
    text_ += "                " + fmt::format(fmt::runtime(form), values...) + "\n";
  }

  void begin(const char* name, const char* id) {
    text_ += fmt::format("\n            def Shader \"{}\"\n            {{\n", name);
    line("uniform token info:id = \"{}\"", id);
  }
  void end() { text_ += "            }\n"; }

  /// A connection to a picture, if there is one for this input; else the value, unless it is the default.
  void input(const char* type, const char* name, const std::string& value, bool is_default = false) {
    for (const Picture& picture : pictures_)
      if (picture.input == std::string_view(name)) {
        line("{} inputs:{}.connect = <{}/{}.outputs:{}>", type, name, path_, picture.name, picture.output);
        return;
      }
    if (!is_default) line("{} inputs:{} = {}", type, name, value);
  }

  void write_surface() {
    const Appearance& a = body_.appearance;
    const float opacity = 1 - (1 - a.metallic) * a.transmission;
    const auto ior = a.transmission >= 1 ? a.ior : static_cast<float>(ior_of(dielectric_reflectance(a)));
    begin("surface", "UsdPreviewSurface");
    input("float", "clearcoat", fmt::to_string(a.coat), a.coat == 0);
    input("float", "clearcoatRoughness", fmt::to_string(a.coat_roughness), a.coat == 0);
    if (shows_vertex_colors(body_))
      line("color3f inputs:diffuseColor.connect = <{}/vertex_colors.outputs:result>", path_);
    else
      input("color3f", "diffuseColor", color_text(a.base_color));
    input("color3f", "emissiveColor", color_text(a.emission), a.emission.isZero(0));
    input("float", "ior", fmt::to_string(ior), ior == 1.5f);
    input("float", "metallic", fmt::to_string(a.metallic));
    input("normal3f", "normal", "", true);
    input("float", "opacity", fmt::to_string(opacity), opacity == 1);
    input("float", "roughness", fmt::to_string(a.roughness));
    line("token outputs:surface");
    end();
  }

  void write_vertex_colors() {
    begin("vertex_colors", "UsdPrimvarReader_float3");
    line("string inputs:varname = \"displayColor\"");
    line("float3 outputs:result");
    end();
  }

  bool is_placed() const { return body_.textures.scale != Vec2::Ones() || !body_.textures.offset.isZero(0); }

  void write_coordinates() {
    const TextureSettings& t = body_.textures;
    begin("coordinates", "UsdPrimvarReader_float2");
    line("string inputs:varname = \"st\"");
    line("float2 outputs:result");
    end();
    if (!is_placed()) return;
    begin("placed", "UsdTransform2d");
    line("float2 inputs:in.connect = <{}/coordinates.outputs:result>", path_);
    line("float2 inputs:scale = ({}, {})", static_cast<float>(t.scale.x()), static_cast<float>(t.scale.y()));
    line("float2 inputs:translation = ({}, {})", static_cast<float>(t.offset.x()), static_cast<float>(t.offset.y()));
    line("float2 outputs:result");
    end();
  }

  void write_picture(const Picture& picture) {
    constexpr const char* kWraps[] = {"repeat", "clamp", "mirror"};
    const char* const wrap = kWraps[static_cast<std::size_t>(body_.textures.wrap)];
    const bool is_srgb = picture.is_color && picture_kind(picture.path) != PictureKind::Other;
    begin(picture.name, "UsdUVTexture");
    if (picture.path == body_.textures.normal && picture.input == std::string_view("normal")) {
      const auto s = static_cast<float>(body_.textures.normal_strength);  // texels of 0 to 1 stand for -1 to 1
      line("float4 inputs:bias = ({}, {}, -1, 0)", -s, -s);
      line("float4 inputs:scale = ({}, {}, 2, 1)", 2 * s, 2 * s);
    }
    line("asset inputs:file = {}", usda_asset(picture.path, folder_));
    line("token inputs:sourceColorSpace = \"{}\"", is_srgb ? "sRGB" : "raw");
    line("float2 inputs:st.connect = <{}/{}.outputs:result>", path_, is_placed() ? "placed" : "coordinates");
    line("token inputs:wrapS = \"{}\"", wrap);
    line("token inputs:wrapT = \"{}\"", wrap);
    line("{} outputs:{}", picture.output == std::string_view("g") ? "float" : "float3", picture.output);
    end();
  }

  const ExportBody& body_;
  std::string path_;  ///< of the material
  const std::string& folder_;
  std::vector<Picture> pictures_;
  std::string text_;
};

}  // namespace

std::string usda_asset(const std::string& path, const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path base = plain_path(fs::absolute(folder.empty() ? "." : folder)), file = plain_path(fs::absolute(path)),
                 text = file.lexically_relative(base);
  std::error_code none;
  const bool leads_there = fs::equivalent(base / text, file, none);
  std::string relative = (leads_there || !fs::exists(file, none) ? text : file).generic_string();
  if (!relative.starts_with('.') && !relative.starts_with('/')) relative.insert(0, "./");
  const char* const quote = relative.find('@') == std::string::npos ? "@" : "@@@";
  return quote + relative + quote;
}

std::string usda_look(const ExportBody& body, const std::string& name, const std::string& parent,
                      const std::string& folder) {
  const std::string path = parent + "/" + name;
  return fmt::format(
      "        def Material \"{}\"\n        {{\n            token outputs:surface.connect = "
      "<{}/surface.outputs:surface>\n            custom string softreel:name = {}\n{}        }}\n",
      name, path, usda_quoted(body.material), LookWriter(body, path, folder).text());
}

}  // namespace softreel
