#include "tool/shot/shot_follow.h"

namespace softreel {
namespace {

/// A clip that stands still or runs backwards has no time at which it starts.
constexpr Range kSpeed{1e-6, 1e6, false};

const Table<FollowSettings>& follow_table() {
  static const Table<FollowSettings> table = [] {
    using F = FollowSettings;
    using Binding = FollowedSurface::Binding;
    Table<F> t;
    t.sentence = "An animated node or surface of a scene file, or a point cache, that takes the points along.";
    t.require("file", &F::file, file_path(), "", "glTF, FBX and what else assimp reads, or a point cache: .pc2, .mdd.")
        .add("node", &F::node, text(), "", "Node that the points move with, rigidly; instead of mesh.", "none")
        .add("mesh", &F::mesh, text(), "",
             "Mesh, by its own or its node's name, whose skinned and morphed surface the points hang on.",
             "all meshes of the file")
        .add("clip", &F::clip, text(), "", "Name of the animation.", "the only one of the file")
        .add("start", &F::start, optional_of(number(kAnyNumber)), "frames",
             "Frame of the shot at which the clip starts; before it and after its end the clip's ends hold.",
             "the shot's first frame")
        .add("speed", &F::speed, number(kSpeed), "", "Seconds of the clip for each of the shot.")
        .add("reference", &F::reference, optional_of(number(kAnyNumber)), "frames",
             "Frame of the shot at which what is followed belongs to the body at rest.",
             "by vertex: none, as points are where their vertices are; else the pose that the file shows without its "
             "clips")
        .add("placement", &F::in_scene, choice<bool>({{"body", false}, {"scene", true}}), "",
             "How the file's numbers come into the scene: as those of the body's mesh (up, fit, scale, translate, "
             "rotate_deg), or as they are, in metres and Y up.")
        .add("bind", &F::bind,
             optional_of(choice<Binding>({{"nearest", Binding::Nearest}, {"vertex", Binding::Vertex}})), "",
             "What a point hangs on: the triangle nearest to it at the reference, or the vertex of its number.",
             "vertex where there are as many as the body has and no reference is given, else nearest");
    t.check = [](const Place& place, const TomlValue& value, F& follow) {
      if (follow.node.empty()) return;
      for (const char* field : {"mesh", "bind"})
        if (value.find(field) != nullptr)
          throw value_error(place, value, std::string("it has node and ") + field,
                            "Follow a node, or a mesh with its surface.");
    };
    return t;
  }();
  return table;
}

/// Text that is one of a few; empty: left out.
Codec<std::string> one_of(const std::vector<std::string>& names) {
  Codec<std::string> codec = text();
  codec.accepted = choices_text(names);
  codec.parse = [names](const Place& place, const TomlValue& value) {
    return names[parse_choice(place, value, names)];
  };
  return codec;
}

const Table<WeightSource>& weights_table() {
  static const Table<WeightSource> table = [] {
    using W = WeightSource;
    Table<W> t;
    t.sentence = "A weight from 0 to 1 for each vertex, in the order of the mesh file.";
    t.add("file", &W::file, file_path(), "", "Text with one number a line, or a PLY file.", "the mesh file")
        .add("attribute", &W::attribute, text(), "", "Property of the PLY file's vertices.", "weight")
        .add("color", &W::color, one_of({"red", "green", "blue"}), "",
             "Channel of the mesh file's vertex colours, as painted.", "none");
    t.check = [](const Place& place, const TomlValue& value, W& source) {
      const bool painted = !source.color.empty(), other = !source.file.empty() || !source.attribute.empty();
      if (painted != other) return;
      throw value_error(place, value, painted ? "it has a colour and a file or attribute" : "it says nothing",
                        "Give file, attribute (with or without a file), or color.");
    };
    return t;
  }();
  return table;
}

/// A codec of a struct that a table describes, written on one line.
template <typename S>
Codec<S> inline_table(const Table<S>& table, const std::string& type, const std::string& accepted) {
  Codec<S> codec;
  codec.type = type;
  codec.accepted = accepted;
  codec.parts = table_texts(table, ".");
  codec.parse = [&table](const Place& place, const TomlValue& value) {
    S out;
    read_table(table, place, value, out);
    return out;
  };
  codec.print = [&table](const S& in) -> std::optional<TomlValue> { return write_table(table, in); };
  return codec;
}

}  // namespace

Codec<std::optional<FollowSettings>> follow_codec() {
  return optional_of(
      inline_table(follow_table(), "table", "{ file, node | mesh, clip, start, speed, reference, placement, bind }"));
}

Codec<std::optional<WeightSource>> weights_codec() {
  Codec<WeightSource> codec =
      inline_table(weights_table(), "path or table", "a path in quotes, or { file | attribute | color }");
  codec.parse = [parse = codec.parse](const Place& place, const TomlValue& value) {
    if (value.text() == nullptr) return parse(place, value);
    return WeightSource{file_path().parse(place, value), "", ""};
  };
  return optional_of(codec);
}

}  // namespace softreel
