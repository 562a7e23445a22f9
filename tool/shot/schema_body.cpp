// The tables of bodies: placement, size of the tetrahedra, regions, pins, pulls, materials.
#include <fmt/format.h>

#include "core/tetmesh/files/tet_mesh_file.h"
#include "render/pathtrace/materials/sheen.h"
#include "tool/shot/codecs.h"
#include "tool/shot/keyed_appearance.h"
#include "tool/shot/schema_tables.h"
#include "tool/shot/shot_follow.h"
#include "tool/shot/shot_select.h"

namespace softreel {
namespace {

constexpr std::int64_t kMostTets = 500000000;
/// From 0.5 on the material is incompressible, which has no finite stiffness; near it the numbers degrade.
constexpr Range kPoissonRatio{0, 0.499, false};
/// Between the normals of two triangles.
constexpr Range kCrease{0, 180, true};
/// What takes all light has no finite thickness.
constexpr Range kTint{0.001, 1, false};
/// Within what single precision can walk through.
constexpr Range kScattering{1e-6, 1e6, false};

/// A track that moves nothing.
Track<Transform> resting_track() {
  return Track<Transform>{{{0, Transform{}, Ease::Smooth}}};
}

const Table<RegionSettings>& region_table() {
  static const Table<RegionSettings> table = [] {
    using R = RegionSettings;
    Table<R> t;
    t.sentence = "A part of the body with another stiffness or material.";
    t.require("select", &R::select, selection_codec(), "", "Which part: tetrahedra whose centroid it takes.")
        .add("material", &R::material, optional_of(text()), "", "Name of the region's material.")
        .add("stiffness", &R::stiffness, optional_of(number(kPositive)), "",
             "Factor on the Young's modulus of the body.");
    t.check = [](const Place& place, const TomlValue& value, RegionSettings& region) {
      check_alternatives(place, value, "body.*.region[]");
      if (!region.material && !region.stiffness)
        throw value_error(place, value, "it changes nothing", "Give it a material or a stiffness.");
    };
    return t;
  }();
  return table;
}

/// The fields that pins and pulls share.
template <typename S>
void add_motion_fields(Table<S>& table) {
  Field<S> keys;
  const Codec<Motion> codec = motion_codec();
  keys.text = {"keys",
               codec.type,
               "",
               "the points stay where they rest",
               codec.accepted,
               "Where the points are taken, frame by frame; before the first key and after the last, that key holds.",
               false,
               false};
  keys.parts = codec.parts;
  keys.read = [parse = codec.parse](const Place& place, const TomlValue& value, S& out) {
    Motion motion = parse(place, value);
    out.keys = std::move(motion.track);
    out.pivot_given = motion.pivot_given;
  };
  keys.write = [print = codec.print](const S& in) -> std::optional<TomlValue> {
    if (in.follow) return std::nullopt;
    return print({in.keys, in.pivot_given});
  };
  table.fields.push_back(std::move(keys));
  table
      .add("keys_unit", &S::keys_in_box, choice<bool>({{"m", false}, {"box", true}}), "",
           "What translate and pivot of the keys count: metres, or heights and coordinates of the placed body's box.")
      .add("active", &S::active, frame_ranges_codec(), "frames",
           "When it holds, both frames included; [[1, 10], [11, 20]] leaves no gap.", "always")
      .add("follow", &S::follow, follow_codec(), "",
           "An animated node or surface that takes the points along; instead "
           "of keys.",
           "none")
      .add("grab", &S::grab, absent_if_zero(toggle()), "",
           "Takes the points where they are at the first active frame, without a jump, and moves them on from there as "
           "keys or what is followed moves. In a dynamic shot it holds from the next step on, so for two frames or "
           "more.",
           "false");
}

const Table<PinSettings>& pin_table() {
  static const Table<PinSettings> table = [] {
    Table<PinSettings> t;
    t.sentence = "Points that are held exactly, where they rest or where keys take them.";
    t.require("select", &PinSettings::select, selection_codec(), "", "Which points of the surface are held.");
    add_motion_fields(t);
    t.check = [](const Place& place, const TomlValue& value, PinSettings& pin) {
      check_alternatives(place, value, "body.*.pin[]");
      if (pin.keys.keys.empty()) pin.keys = resting_track();
    };
    return t;
  }();
  return table;
}

const Table<PullSettings>& pull_table() {
  static const Table<PullSettings> table = [] {
    using P = PullSettings;
    Table<P> t;
    t.sentence = "Springs from points to where keys take them; the points give way as far as the body resists.";
    t.add("select", &P::select, selection_codec(), "", "Which points of the surface are pulled.",
          "must be given, but with weights: the points of a weight above 0")
        .require("stiffness", &P::stiffness, keyed(number(kNotNegative), "N/m"), "N/m", "Of all springs together.");
    add_motion_fields(t);
    t.add("falloff", &P::falloff, number(kNotNegative), "m",
          "Springs weaken smoothly to nothing at this distance from the selection's centre; 0: all are equal.")
        .add("max_force", &P::max_force, number(kNotNegative), "N", "Of all springs together; 0: no limit.")
        .add("weights", &P::weights, weights_codec(), "",
             "Painted weights, factors on the springs' shares of the stiffness: a soft pin where keys move nothing.",
             "1 everywhere");
    t.check = [select = t.fields.front().text](const Place& place, const TomlValue& value, PullSettings& pull) {
      check_alternatives(place, value, "body.*.pull[]");
      if (pull.select.terms.empty() && !pull.weights) throw missing_error(place, value, select);
      if (pull.keys.keys.empty()) pull.keys = resting_track();
    };
    return t;
  }();
  return table;
}

/// Fields that say where the body stands and how finely it is divided.
void add_placement_fields(Table<BodySettings>& t) {
  using B = BodySettings;
  t.require("mesh", &B::mesh, file_path(), "",
            "The surface: PLY, OBJ, STL, glTF and what else assimp reads; or tetrahedra.")
      .add("up", &B::up, choice<UpAxis>({{"x", UpAxis::X}, {"y", UpAxis::Y}, {"z", UpAxis::Z}}), "",
           "The file's axis that points up.")
      .add("fit", &B::fit, absent_if_zero(number(kPositive)), "m",
           "Scales the body to this height and stands it on the ground, centred; instead of scale.", "as in the file")
      .add("scale", &B::scale, number(kPositive), "", "Factor on the file's numbers; instead of fit.")
      .add("translate", &B::translate, vector_of<Vec3>(kAnyNumber), "m", "Moves the body, after fit and rotation.")
      .add("rotate_deg", &B::rotate_deg, vector_of<Vec3>(kAnyNumber), "degrees",
           "Turns the body about the fixed axes: x first, then y, then z.")
      .add("material", &B::material, text(), "", "Name of a [material.NAME].",
           "the only material, or the one named \"default\", which is built in where there is none")
      .add("crease_deg", &B::crease_deg, number(kCrease), "degrees",
           "Edges look hard where the normals of two triangles differ by more than this at rest: 180 is smooth "
           "everywhere, 40 suits what is made of flat and round parts.")
      .add("tets", &B::tets, absent_if_zero(whole<std::int64_t>(1, kMostTets)), "",
           "How many tetrahedra fill the body, within 5 %; instead of edge, error or tetrahedra.",
           std::to_string(kDefaultTets))
      .add("edge", &B::edge, absent_if_zero(number(kPositive)), "m", "Longest edge of the tetrahedra; instead of tets.",
           "from tets")
      .add("error", &B::error, body_length(), "m",
           "How far the tetrahedra may be from the surface: sizes are graded to keep to that; instead of tets.",
           "what tets gives")
      .add("tetrahedra", &B::tetrahedra, file_path(), "",
           "Tetrahedra made elsewhere, in the place and unit of mesh: .mesh (Medit), .msh (Gmsh), .vtk, .vtu; instead "
           "of tets. Such a file as mesh is both: its boundary is the surface.",
           "made by softreel")
      .add("graded", &B::graded, toggle(), "",
           "With tets: sizes fine where the surface asks for it and coarse inside; with edge: coarse inside only. With "
           "error they are always graded.")
      .add("mode", &B::mode, choice<TetMode>({{"conforming", TetMode::Conforming}, {"embedded", TetMode::Embedded}}),
           "",
           "How tetrahedra fill the surface: they end at it, or whole lattice cells hold it, weighted by how full they "
           "are, which keeps parts thinner than an edge.")
      .add("optimize", &B::optimize, toggle(), "",
           "Makes the worst angles of the tetrahedra better, for some seconds more.")
      .add("thickness", &B::thickness, absent_if_zero(number(kPositive)), "m",
           "Of open sheets in the surface, which then become solid.",
           "open parts count as closed where they nearly are")
      .add("rotation", &B::rotation, optional_of(rotation_method()), "",
           "Of this body's tetrahedra, so that bodies of two methods can be seen side by side.", "solver.rotation");
}

void check_body(const Place& place, const TomlValue& value, BodySettings& body) {
  if (!is_file_name(body.name)) {
    const FieldText name{"", "", "", "", kFileNameAccepted, "", false, false};
    throw value_error({place.path, &name, place.problems}, value, "files are named after the body", "Rename it.");
  }
  check_alternatives(place, value, "body.*");
  // Tetrahedra as mesh are as many as they are: that a size was given beside them can then be said.
  const bool sized =
      body.edge > 0 || body.tets > 0 || body.error.value > 0 || !body.tetrahedra.empty() || is_tet_mesh_file(body.mesh);
  if (!sized) body.tets = kDefaultTets;
  body.mesh_origin = value.find("mesh")->origin;
}

}  // namespace

const Table<BodySettings>& body_table() {
  static const Table<BodySettings> table = [] {
    using B = BodySettings;
    Table<B> t;
    t.sentence = "A soft body: a surface that is filled with tetrahedra.";
    add_placement_fields(t);
    t.add_list("region", &B::regions, region_table())
        .add_list("pin", &B::pins, pin_table())
        .add_list("pull", &B::pulls, pull_table());
    // Where the body is fitted, there is no scale to write.
    for (Field<B>& field : t.fields)
      if (field.text.path == "scale")
        field.write = [write = field.write](const B& body) { return body.fit > 0 ? std::nullopt : write(body); };
    t.check = check_body;
    return t;
  }();
  return table;
}

const Table<MaterialSettings>& material_table() {
  static const Table<MaterialSettings> table = [] {
    Table<MaterialSettings> t;
    t.sentence = "How a body resists deformation and how it looks.";
    const auto physics = [&t](const char* name, double ElementMaterial::*member, const Range& range, const char* unit,
                              const char* sentence) {
      t.add(
          name, [member](auto& m) -> auto& { return m.physics.*member; }, number(range), unit, sentence);
    };
    using E = ElementMaterial;
    physics("youngs_modulus", &E::youngs_modulus, kPositive, "Pa",
            "Stiffness: stress per strain. Gel 1e4, rubber 1e6.");
    physics("poisson_ratio", &E::poisson_ratio, kPoissonRatio, "",
            "How much it thins when stretched: 0 like cork, 0.3 if you do not know, 0.45 to 0.49 like gel and flesh.");
    physics("density", &E::density, kPositive, "kg/m^3", "Mass per volume; water has 1000.");
    physics("damping_mass", &E::damping_mass, kNotNegative, "1/s", "Slows all motion, as in syrup (Rayleigh).");
    physics("damping_stiffness", &E::damping_stiffness, kNotNegative, "s", "Slows deformation only (Rayleigh).");
    const auto share = [&t](const char* name, float Appearance::*member, const char* sentence) {
      add_keyed(t, name, member, kShare, "", sentence);
    };
    const auto color = [&t](const char* name, Vec3f Appearance::*member, const Range& range, const char* unit,
                            const char* sentence) { add_keyed(t, name, member, range, unit, sentence); };
    const auto number_of = [&t](const char* name, float Appearance::*member, const Range& range, const char* unit,
                                const char* sentence) { add_keyed(t, name, member, range, unit, sentence); };
    using A = Appearance;
    color("base_color", &A::base_color, kShare, "linear", "Share of the light that comes back.");
    share("roughness", &A::roughness, "0 mirrors, 1 is matte.");
    share("metallic", &A::metallic, "How much of it is metal.");
    share("specular", &A::specular, "Strength of its own reflections: 0.08 of this head-on.");
    share("transmission", &A::transmission, "How much of what is not metal is glass.");
    number_of("ior", &A::ior, {1, 5, false}, "", "Refractive index of the glass.");
    color("absorption", &A::absorption, kNotNegative, "1/m", "How fast the glass takes light in.");
    color("emission", &A::emission, kNotNegative, "W/(m^2 sr)", "Light that the surface gives off.");
    share("coat", &A::coat, "How much of it is under clear varnish.");
    share("coat_roughness", &A::coat_roughness, "Of the varnish: 0 mirrors, 1 is matte.");
    number_of("coat_ior", &A::coat_ior, {1, 5, false}, "", "Refractive index of the varnish.");
    color("coat_color", &A::coat_color, kTint, "linear", "What white looks like through the varnish.");
    share("sheen", &A::sheen, "How much of it is under fine fibres, as of velvet: bright rims.");
    number_of("sheen_roughness", &A::sheen_roughness, {Sheen::kLeastRoughness, 1, false}, "",
              "Of the fibres: low at the very rim only, 1 all over.");
    color("sheen_color", &A::sheen_color, kShare, "linear", "Colour of the fibres.");
    share("subsurface", &A::subsurface, "How much of what is neither metal nor glass scatters light inside the body.");
    color("subsurface_radius", &A::subsurface_radius, kScattering, "m",
          "How far its colours spread inside: they come out 2.5 times that away on average; for a closed surface.");
    number_of("subsurface_scale", &A::subsurface_scale, {0.001, 1000, false}, "", "Factor on subsurface_radius.");
    number_of("subsurface_anisotropy", &A::subsurface_anisotropy, {-0.95, 0.95, false}, "",
              "Which way the inside scatters: 0 all ways, above 0 forwards, which lets thin parts glow.");
    add_texture_fields(t);
    return t;
  }();
  return table;
}

}  // namespace softreel
