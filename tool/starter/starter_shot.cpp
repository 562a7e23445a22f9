#include "tool/starter/starter_shot.h"

#include <cctype>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/bodies/constraint_stage.h"
#include "tool/bodies/weight_maps.h"
#include "tool/farm/shell_text.h"
#include "tool/shot/plain_path.h"
#include "tool/shot/preset_library.h"
#include "tool/shot/schema.h"
#include "tool/shot/shot_layers.h"
#include "tool/shot/shot_select.h"
#include "tool/starter/commented_document.h"
#include "tool/starter/starter_stage.h"

namespace softreel {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNew = "new";  ///< the file of values that are our own
constexpr double kEarth = 9.81;      ///< m/s^2
/// Weight, in shares of what the material can bear: rho g L / E of a body that stands, sag over length of one that is
/// held at one end.
constexpr double kStandingLoad = 0.01, kHangingSag = 0.04;
constexpr double kPullStiffness = 1.5;  ///< of the pull, over that of a bar of the body's volume and length
constexpr double kLegsBear = 2;         ///< legs of half the mean section carry a body as well as its own width would
constexpr double kRestOfPull = 0.05;    ///< of it, once the body is let go

/// A name that needs no quotes in TOML and can begin the name of a file.
std::string body_name(const std::string& mesh) {
  std::string name;
  for (const char c : fs::path(mesh).stem().string())
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
  if (name.empty()) return "body";
  // "body.mesh" is a field of the only body, not the body of mesh.obj.
  return find_field("body.*." + name) == nullptr ? name : name + "_body";
}

/// `path` as a file in `folder` says it: from there, or from the root where the two have nothing but that in common, or
/// where the way from there goes through a link.
std::string path_from(const std::string& path, const fs::path& folder) {
  const fs::path file = plain_path(fs::absolute(path));
  const fs::path from = plain_path(fs::absolute(folder.empty() ? "." : folder));
  const auto first_folder = [](const fs::path& one) {
    auto part = one.begin();
    return ++part == one.end() ? fs::path() : *part;
  };
  const fs::path relative = file.lexically_relative(from);
  const bool leads_there = first_folder(file) == first_folder(from) && plain_path(from / relative) == file;
  return leads_there ? relative.generic_string() : file.string();
}

/// Paths in a document that other files say, as the new shot must say them.
void rebase_paths(TomlValue& value, const std::string& at, const fs::path& folder) {
  if (auto* items = value.array())
    for (TomlValue& item : *items) rebase_paths(item, at, folder);
  if (auto* entries = value.table())
    for (TomlEntry& entry : *entries)
      rebase_paths(entry.value, at.empty() ? key_text(entry.key) : at + "." + key_text(entry.key), folder);
  const std::string* text = value.text();
  const FieldText* field = text == nullptr ? nullptr : find_field(at);
  if (field == nullptr || (field->type != "path" && field->type != "path or table") || value.origin.file == kNew ||
      fs::path(*text).is_absolute())
    return;
  value.data = path_from((fs::path(value.origin.file).parent_path() / *text).string(), folder);
}

std::string two_digits(double value) {
  return fmt::format("{:.2g}", value);
}

double number_in(const TomlValue& document, const std::string& material, const char* field, double otherwise) {
  const TomlValue* table = document.find("material");
  const TomlValue* found = table == nullptr ? nullptr : table->find(material);
  found = found == nullptr ? nullptr : found->find(field);
  if (found == nullptr) return otherwise;
  if (const auto* whole = std::get_if<std::int64_t>(&found->data)) return static_cast<double>(*whole);
  const auto* number = std::get_if<double>(&found->data);
  return number == nullptr ? otherwise : *number;
}

/// Acceleration that the body carries without losing its shape, m/s^2.
double bearable_weight(const StarterBody& body, double youngs_modulus, double density) {
  if (body.loose_pieces > 0) return 0;
  const double unit = youngs_modulus / (density * body.length);
  // A beam that is held at one end sags by 1.5 rho g L^4 / (E h^2).
  const double slender = body.slenderness;
  const double most = body.stands ? kStandingLoad * std::min(1.0, kLegsBear * body.leg_share) * unit
                                  : kHangingSag * unit / (1.5 * slender * slender);
  return std::min(kEarth, std::stod(two_digits(most)));
}

class StarterText {
 public:
  StarterText(const StarterOptions& options, const RunContext& context)
      : options_(options),
        folder_(fs::path(options.output).parent_path()),
        name_(body_name(options.mesh)),
        body_(choose_body(options.mesh, name_, options.wishes, context)) {}

  StarterShot make() {
    load_preset();
    load_material();
    TomlValue document = assemble();
    rebase_paths(document, "", folder_);
    add_remarks();
    StarterShot shot{opening() + commented_document(document, remarks_), name_, facts()};
    check(shot.text);
    return shot;
  }

 private:
  std::string at(const std::string& field) const { return "body." + name_ + "." + field; }

  void load_preset() {
    if (options_.like.empty()) return;
    preset_file_ = preset_file(options_.like);
    preset_ = load_layers(preset_file_, {});
    parse_shot(preset_file_, preset_);  // says its mistakes
  }

  void load_material() {
    material_ = options_.material;
    const bool from_preset = !preset_file_.empty() && !options_.material_given;
    const TomlValue* bodies = from_preset ? preset_.find("body") : nullptr;
    const TomlValue* worn =
        bodies == nullptr || bodies->table()->empty() ? nullptr : bodies->table()->front().value.find("material");
    if (worn != nullptr && worn->text() != nullptr && preset_.find("material") != nullptr &&
        preset_.find("material")->find(*worn->text()) != nullptr) {
      material_ = *worn->text();
      material_file_ = preset_file_;
      material_tree_ = preset_;
    } else {
      material_file_ = material_file(material_);
      material_tree_ = load_layers(material_file_, {});
    }
    fit_look();
    modulus_ = number_in(material_tree_, material_, "youngs_modulus", 1e5);
    density_ = number_in(material_tree_, material_, "density", 1000);
  }

  /// Takes out of the material what this mesh has nothing for.
  void fit_look() {
    const SurfaceMesh& mesh = body_.loaded.file_mesh;
    auto& fields = *material_tree_.find("material")->find(material_)->table();
    const auto is_unfit = [&mesh](const TomlEntry& field) {
      return (mesh.colors.empty() && field.key == "vertex_colors") ||
             (mesh.triangle_textures.empty() && field.key.ends_with("_texture"));
    };
    for (const TomlEntry& field : fields)
      if (is_unfit(field)) left_out_ += (left_out_.empty() ? "" : ", ") + field.key;
    std::erase_if(fields, is_unfit);
  }

  /// The body's own table, its pin and its pull.
  std::string body_text() const {
    const BodySettings& settings = body_.settings;
    const auto quoted = [](const std::string& text) { return to_text(toml_value(text)); };
    std::string text = fmt::format("[body.{}]\nmesh = {}\n", name_, quoted(path_from(settings.mesh, folder_)));
    static constexpr const char* kAxes[] = {"x", "y", "z"};
    text += fmt::format("up = \"{}\"\n", kAxes[static_cast<int>(settings.up)]);
    text += settings.fit > 0 ? fmt::format("fit = {}\n", settings.fit) : fmt::format("scale = {}\n", settings.scale);
    if (!settings.translate.isZero(0))
      text += fmt::format("translate = [{}, {}, {}]\n", settings.translate.x(), settings.translate.y(),
                          settings.translate.z());
    text += fmt::format("material = {}\n", quoted(material_));
    if (settings.has_creases()) text += fmt::format("crease_deg = {}\n", settings.crease_deg);
    if (!body_.loaded.given) text += fmt::format("tets = {}\n", settings.tets);
    if (settings.mode == TetMode::Embedded) text += "mode = \"embedded\"\n";
    if (settings.thickness > 0) text += fmt::format("thickness = {}\n", settings.thickness);
    return text;
  }

  /// Held at one end, pulled at the other, and let go but for a faint spring to where it stood: what has thin legs gets
  /// up again after the recoil.
  std::string own_motion() const {
    const auto select = [](const StarterSelection& one) {
      TomlValue value = *selection_codec().print(one.select);
      const auto without_unit = [](TomlValue& term) {  // names of groups count in nothing
        if (term.find("group") != nullptr)
          std::erase_if(*term.table(), [](const TomlEntry& entry) { return entry.key == "unit"; });
      };
      without_unit(value);
      if (auto* terms = value.array())
        for (TomlValue& term : *terms) without_unit(term);
      return to_text(value);
    };
    const double L = body_.length;
    const auto move = [L](double x, double y, double z) {
      return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", x * L, y * L, z * L);
    };
    std::string text = fmt::format("\n[[body.{0}.pin]]\nselect = {1}\n\n[[body.{0}.pull]]\nselect = {2}\n", name_,
                                   select(body_.held), select(body_.pulled));
    const double stiffness = kPullStiffness * modulus_ * body_.volume / (L * L);
    text +=
        fmt::format("stiffness = [ {{ frame = 42, value = {}, ease = \"constant\" }}, {{ frame = 43, value = {} }} ]\n",
                    std::stod(two_digits(stiffness)), std::stod(two_digits(kRestOfPull * stiffness)));
    text += fmt::format(
        "keys = [ {{ frame = 1 }}, {{ frame = 12, translate = {} }}, {{ frame = 26, translate = {} }}, "
        "{{ frame = 42, translate = {}, ease = \"constant\" }}, {{ frame = 43 }} ]\n",
        body_.stands ? move(0.04, -0.08, 0.03) : move(0, 0.05, 0),
        body_.stands ? move(0.12, 0.35, 0.05) : move(0, 0.28, 0.08),
        body_.stands ? move(-0.25, 0.35, 0.08) : move(0, 0.15, -0.2));
    return text;
  }

  /// A body whose balance under its weight is found quickly and surely: one piece, filled in the usual way.
  bool is_simple() const { return body_.pieces == 1 && body_.fill_reason.empty(); }

  std::string time_and_weight() const {
    const double weight = bearable_weight(body_, modulus_, density_);
    return fmt::format("[shot]\nframes = [1, 72]\nfps = 24\nstart = \"{}\"\n[gravity]\nacceleration = [0, {}, 0]\n",
                       weight > 0 && is_simple() ? "equilibrium" : "rest", weight > 0 ? -weight : 0.0);
  }

  TomlValue assemble() {
    const std::string heads = "schema = 1\n";
    TomlValue own = parse_toml(heads + time_and_weight() + body_text() + own_motion() + stage_for(body_), kNew);
    if (!preset_file_.empty()) take_from_preset(own);
    // The material comes after the body that wears it.
    TomlValue materials = toml_value(TomlValue::Table{});
    materials.table()->push_back(toml_entry(material_, *material_tree_.find("material")->find(material_)));
    auto& entries = *own.table();
    std::size_t after = 0;
    while (entries[after].key != "body") ++after;
    entries.insert(entries.begin() + static_cast<std::ptrdiff_t>(after) + 1,
                   toml_entry("material", std::move(materials)));
    return own;
  }

  /// All but bodies and materials is the preset's; of its first body the motion, where it fits this mesh.
  void take_from_preset(TomlValue& own) {
    for (TomlEntry& entry : *own.table())
      if (entry.key != "body" && entry.key != "schema")
        if (const TomlValue* theirs = preset_.find(entry.key)) entry.value = *theirs;
    std::erase_if(*own.table(), [this](const TomlEntry& entry) {
      return entry.key != "body" && entry.key != "schema" && preset_.find(entry.key) == nullptr;
    });
    if (TomlValue* settings = own.find("shot"); settings != nullptr && settings->table() != nullptr)
      std::erase_if(*settings->table(), [](const TomlEntry& entry) { return entry.key == "name"; });
    const TomlValue* bodies = preset_.find("body");
    if (bodies == nullptr || bodies->table() == nullptr || bodies->table()->empty()) return;
    const TomlValue& theirs = bodies->table()->front().value;
    TomlValue moved = own;
    TomlValue::Table& body = *moved.find("body")->find(name_)->table();
    std::erase_if(body, [](const TomlEntry& entry) { return entry.key == "pin" || entry.key == "pull"; });
    for (const char* kind : {"pin", "pull"})
      if (const TomlValue* motion = theirs.find(kind)) body.push_back(toml_entry(kind, *motion));
    motion_from_preset_ = moves(moved);
    if (motion_from_preset_) own = std::move(moved);
  }

  /// True if the selections of the document take points of this mesh.
  bool moves(const TomlValue& document) const {
    try {
      TomlValue whole = document;
      TomlValue materials = toml_value(TomlValue::Table{});
      materials.table()->push_back(toml_entry(material_, toml_value(TomlValue::Table{})));
      std::erase_if(*whole.table(), [](const TomlEntry& entry) { return entry.key == "material"; });
      whole.table()->push_back(toml_entry("material", std::move(materials)));
      const Shot shot = parse_shot(kNew, whole);
      return !constraints_of(shot).pins.empty();
    } catch (const Error&) {
      return false;
    }
  }

  void add_remarks() {
    remarks_[at("up")] = body_.up_reason;
    remarks_[at(body_.settings.fit > 0 ? "fit" : "scale")] = body_.size_reason;
    remarks_[at("material")] = "The library in presets/materials has others: softreel new --material NAME.";
    if (body_.settings.has_creases())
      remarks_[at("crease_deg")] = "Chosen because the mesh has edges sharper than this between flat or smooth parts.";
    if (!body_.fill_reason.empty())
      remarks_[at(body_.settings.thickness > 0               ? "thickness"
                  : body_.settings.mode == TetMode::Embedded ? "mode"
                                                             : "tets")] = body_.fill_reason;
    if (!body_.loaded.given) {
      std::string& remark = remarks_[at("tets")];
      remark += std::string(remark.empty() ? "" : " ") + "Fewer are faster, more bend more truly.";
    }
    remarks_["material." + key_text(material_)] = fmt::format("A copy of {}.", path_from(material_file_, folder_));
    if (preset_file_.empty()) {
      const double weight = bearable_weight(body_, modulus_, density_);
      remarks_["gravity.acceleration"] =
          body_.loose_pieces > 0
              ? fmt::format("None, for {} of the {} pieces of the mesh are not held and would fall for ever.",
                            body_.loose_pieces, body_.pieces)
          : weight < kEarth
              ? fmt::format("The earth's is {}: so soft a body of this size would sink into itself.", kEarth)
              : "The earth's.";
      remarks_["light[0]"] = "Key: large and near, high, from the left of the camera.";
      remarks_["light[1]"] = "Rim: from behind, draws the outline.";
      remarks_["render.samples"] = "For a finished picture 64 to 256.";
    }
    if (motion_from_preset_) return;
    remarks_[at("pin[0]")] = fmt::format("Takes {}.", body_.held.words) + other_groups();
    remarks_[at("pull[0]")] = fmt::format("Takes {}.", body_.pulled.words);
    remarks_[at("pull[0].stiffness")] =
        "Twice as much brings the points nearer to where the keys want them. After frame 42 they are let go, but for a "
        "faint spring to where they were.";
  }

  std::string other_groups() const {
    std::string names;
    for (const VertexGroup& group : body_.loaded.surface.groups)
      if (names.size() < 60) names += (names.empty() ? "" : ", ") + group.name;
    return names.empty() ? ""
                         : fmt::format(" The mesh has groups, too: select = {{ group = \"NAME\" }} with {}.", names);
  }

  std::vector<std::string> facts() const {
    const Vec3 file = used_bounds(body_.loaded.file_mesh).size(), placed = used_bounds(body_.loaded.surface).size();
    std::vector<std::string> lines{
        fmt::format("{}: {:.4g} x {:.4g} x {:.4g} in the file, {:.3g} x {:.3g} x {:.3g} m in the scene", options_.mesh,
                    file.x(), file.y(), file.z(), placed.x(), placed.y(), placed.z())};
    for (const std::string& fact : body_.loaded.facts) lines.push_back(fact);
    lines.push_back(fmt::format("filled with {} tetrahedra{}", body_.tets,
                                body_.pieces > 1 ? fmt::format(" in {} pieces", body_.pieces) : ""));
    if (!body_.fill_reason.empty()) lines.push_back(body_.fill_reason);
    if (motion_from_preset_)
      lines.push_back(fmt::format("held and pulled as in {}", options_.like));
    else
      lines.push_back(fmt::format("holds {} ({} points), pulls {} ({} points)", body_.held.words, body_.held.points,
                                  body_.pulled.words, body_.pulled.points));
    if (!left_out_.empty())
      lines.push_back(
          fmt::format("left out of {}, for the mesh has no colours or texture coordinates: {}", material_, left_out_));
    if (!preset_file_.empty() && !motion_from_preset_)
      lines.push_back(fmt::format("pins and pulls of {} do not fit this mesh; these are others", options_.like));
    return lines;
  }

  std::string opening() const {
    const std::string file = options_.output.empty() ? name_ + ".toml" : fs::path(options_.output).filename().string();
    std::string text = comment_lines(fmt::format("{}: a first shot of {}, made by softreel new.", name_,
                                                 fs::path(options_.mesh).filename().string()));
    text += "#\n";
    for (const std::string& fact : facts()) text += comment_lines("  " + fact);
    text += "#\n# Next:\n";
    for (const char* command : {"check {}                        # what mesh and selections hold",
                                "preview {} --mode fast          # the motion, in seconds",
                                "render {}                       # the pictures and their movie",
                                "explain body.*.pin[].select --shot {}   # any field"})
      text += "#   softreel " + fmt::format(fmt::runtime(command), shell_command({file})) + "\n";
    return text + "# Lengths are in metres, y is up, colours are linear RGB.\n\n";
  }

  /// Of the body as it is loaded, with the weights that this shot paints.
  BodyConstraints constraints_of(const Shot& shot) const {
    LoadedBody loaded = body_.loaded;
    loaded.weight_maps = read_weight_maps(shot.bodies.front(), {}, loaded.file_mesh);
    return resolve_constraints(shot, shot.bodies.front(), loaded, Log{});
  }

  /// What was written is read again, and its selections are taken.
  void check(const std::string& text) const {
    const std::string file = (folder_ / kNew).string();  // relative paths start there
    const TomlValue document = parse_toml(text, file);
    constraints_of(parse_shot(file, document));
  }

  const StarterOptions& options_;
  fs::path folder_;
  std::string name_;
  StarterBody body_;
  std::string preset_file_, material_, material_file_, left_out_;
  TomlValue preset_ = toml_value(TomlValue::Table{}), material_tree_;
  double modulus_ = 0, density_ = 0;
  bool motion_from_preset_ = false;
  Remarks remarks_;
};

}  // namespace

StarterShot make_starter_shot(const StarterOptions& options, const RunContext& context) {
  return StarterText(options, context).make();
}

}  // namespace softreel
