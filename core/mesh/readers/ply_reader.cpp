#include "core/mesh/readers/ply_reader.h"

#include <algorithm>
#include <map>

#include "core/mesh/readers/ply_values.h"
#include "core/mesh/readers/vertex_colors.h"

namespace softreel::detail {
namespace {

enum class Role { None, X, Y, Z, U, V, Group, Corners, CornerTextures, Red, Green, Blue };

Role role_of_vertex_property(const PlyProperty& property) {
  const std::string& name = property.name;
  if (property.is_list) return Role::None;
  if (name == "x") return Role::X;
  if (name == "y") return Role::Y;
  if (name == "z") return Role::Z;
  if (name == "s" || name == "u" || name == "texture_u") return Role::U;
  if (name == "t" || name == "v" || name == "texture_v") return Role::V;
  if (name == "red" || name == "diffuse_red") return Role::Red;
  if (name == "green" || name == "diffuse_green") return Role::Green;
  if (name == "blue" || name == "diffuse_blue") return Role::Blue;
  return name.size() > kPlyGroupPrefix.size() && name.starts_with(kPlyGroupPrefix) ? Role::Group : Role::None;
}

Role role_of_face_property(const PlyProperty& property) {
  const std::string& name = property.name;
  if (!property.is_list) return name == "group" ? Role::Group : Role::None;
  if (name == "vertex_indices" || name == "vertex_index") return Role::Corners;
  return name == "texcoord" ? Role::CornerTextures : Role::None;
}

/// What a colour of this type has for full: bytes count to 255, floating-point numbers to 1.
double full_color(PlyType type) {
  if (type == PlyType::UInt8) return 255;
  return type == PlyType::UInt16 ? 65535 : 1;
}

/// Reads the body; Values is one of the classes of ply_values.h.
template <typename Values>
class PlyBody {
 public:
  PlyBody(const MeshSource& source, const PlyHeader& header, const Log& log)
      : source_(source), header_(header), log_(log), values_(source, header) {}

  SurfaceMesh read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else if (element.name == "tristrips")
        read_strips(element);
      else
        skip(element);
    }
    check_indices();
    finish_textures();
    collect_face_groups();
    skipped_.report(source_, log_);
    return std::move(mesh_);
  }

 private:
  /// A row has at least a byte, so that a count beyond the file's size is a broken header, found before any allocation.
  void check_count(const PlyElement& element) const {
    if (!element.properties.empty() && static_cast<std::size_t>(element.count) > values_.bytes_left())
      throw cut_off(source_, values_.place());
  }

  void read_vertices(const PlyElement& element) {
    check_count(element);
    std::vector<Role> roles;
    std::vector<std::size_t> group_of;
    unsigned found = 0;
    for (const PlyProperty& property : element.properties) {
      roles.push_back(role_of_vertex_property(property));
      found |= 1U << static_cast<unsigned>(roles.back());
      group_of.push_back(mesh_.groups.size());
      if (roles.back() == Role::Group)
        mesh_.groups.push_back({decode_ply_name(property.name.substr(kPlyGroupPrefix.size())), {}});
    }
    const auto has = [&](Role role) { return (found >> static_cast<unsigned>(role) & 1U) != 0; };
    if (!has(Role::X) || !has(Role::Y) || !has(Role::Z))
      throw broken_file(source_, "", "the vertices have no x, y and z", "properties x, y and z of element vertex",
                        "Export the mesh again");
    has_vertex_textures_ = has(Role::U) && has(Role::V);
    has_colors_ = has(Role::Red) && has(Role::Green) && has(Role::Blue);
    for (std::int64_t row = 0; row < element.count; ++row) read_vertex(element, roles, group_of);
  }

  void read_vertex(const PlyElement& element, const std::vector<Role>& roles,
                   const std::vector<std::size_t>& group_of) {
    std::array<double, 12> row{};
    for (std::size_t p = 0; p < roles.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.is_list) {
        read_list(property, list_);
        continue;
      }
      const double value = values_.next(property.type);
      row[static_cast<std::size_t>(roles[p])] = roles[p] < Role::Red ? value : value / full_color(property.type);
      if (roles[p] == Role::Group && value != 0)
        mesh_.groups[group_of[p]].vertices.push_back(static_cast<Index>(mesh_.positions.size()));
    }
    const auto at = [&](Role role) { return row[static_cast<std::size_t>(role)]; };
    mesh_.positions.emplace_back(at(Role::X), at(Role::Y), at(Role::Z));
    if (has_vertex_textures_) mesh_.texture_coordinates.emplace_back(at(Role::U), at(Role::V));
    if (has_colors_) mesh_.colors.push_back(displayed_color(at(Role::Red), at(Role::Green), at(Role::Blue)));
  }

  void read_faces(const PlyElement& element) {
    check_count(element);
    std::vector<Role> roles;
    for (const PlyProperty& property : element.properties) roles.push_back(role_of_face_property(property));
    const bool has_corners = std::find(roles.begin(), roles.end(), Role::Corners) != roles.end();
    for (std::int64_t row = 0; row < element.count && !roles.empty(); ++row) {
      const double group = read_face(element, roles);
      if (!has_corners) continue;
      if (close_polygon(mesh_.polygons))
        finish_face(group);
      else
        skipped_.add(values_.place());
    }
  }

  /// Appends the corners of a face, keeps its texture coordinates aside, and returns its group, or -1.
  double read_face(const PlyElement& element, const std::vector<Role>& roles) {
    double group = -1;
    textures_.clear();
    for (std::size_t p = 0; p < roles.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.is_list) {
        std::vector<double>& list = roles[p] == Role::CornerTextures ? textures_ : list_;
        read_list(property, list);
        if (roles[p] == Role::Corners)
          for (const double corner : list) mesh_.polygons.corner_vertices.push_back(vertex_index(corner));
      } else {
        const double value = values_.next(property.type);
        if (roles[p] == Role::Group) group = value;
      }
    }
    return group;
  }

  /// Keeps what the face says beside its corners.
  void finish_face(double group) {
    face_groups_.push_back(group);
    const std::size_t end = mesh_.polygons.corner_vertices.size();
    const std::size_t corners = end - static_cast<std::size_t>(*(mesh_.polygons.offsets.end() - 2));
    if (textures_.size() != 2 * corners) return;
    mesh_.polygons.corner_textures.resize(end - corners, -1);
    for (std::size_t k = 0; k < corners; ++k) {
      mesh_.polygons.corner_textures.push_back(static_cast<Index>(face_textures_.size()));
      face_textures_.emplace_back(textures_[2 * k], textures_[2 * k + 1]);
    }
  }

  void read_strips(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::int64_t row = 0; row < element.count; ++row)
      for (const PlyProperty& property : element.properties) {
        if (!property.is_list) {
          values_.next(property.type);
          continue;
        }
        read_list(property, list_);
        if (property.name == "vertex_indices" || property.name == "vertex_index") add_strip(list_);
      }
  }

  /// Triangle k of a strip has corners k, k + 1, k + 2; every second one is turned.
  void add_strip(const std::vector<double>& strip) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < strip.size(); ++i) {
      if (strip[i] == -1) {
        begin = i + 1;
      } else if (i >= begin + 2) {
        const bool turned = (i - begin) % 2 == 1;
        for (const std::size_t corner : {i - 2, turned ? i : i - 1, turned ? i - 1 : i})
          mesh_.polygons.corner_vertices.push_back(vertex_index(strip[corner]));
        if (close_polygon(mesh_.polygons)) face_groups_.push_back(-1);
      }
    }
  }

  void skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    for (std::int64_t row = 0; row < element.count; ++row)
      for (const PlyProperty& property : element.properties)
        if (property.is_list)
          read_list(property, list_);
        else
          values_.next(property.type);
  }

  void read_list(const PlyProperty& property, std::vector<double>& list) {
    const double count = values_.next(property.count_type);
    if (!(count >= 0) || count != std::floor(count) || count > static_cast<double>(values_.bytes_left()))
      throw broken_file(source_, values_.place(), fmt::format("the list '{}' has {} entries", property.name, count),
                        "a whole number that the rest of the file can hold",
                        "Export the mesh again; the file may be cut off");
    list.resize(static_cast<std::size_t>(count));
    for (double& value : list) value = values_.next(property.type);
  }

  /// Faces may stand before the vertices: the upper bound is checked once all is read.
  Index vertex_index(double value) {
    if (!(value >= 0) || value != std::floor(value) || value > INT32_MAX)
      throw bad_index(source_, values_.place(), "vertex", fmt::format("{}", value), mesh_.positions.size());
    if (value > largest_index_) {
      largest_index_ = value;
      largest_place_ = values_.place();
    }
    return static_cast<Index>(value);
  }

  void check_indices() const {
    if (largest_index_ >= static_cast<double>(mesh_.positions.size()))
      throw bad_index(source_, largest_place_, "vertex", fmt::format("{}", largest_index_), mesh_.positions.size());
  }

  /// Texture coordinates of faces win over those of vertices.
  void finish_textures() {
    if (!face_textures_.empty()) {
      mesh_.polygons.corner_textures.resize(mesh_.polygons.corner_vertices.size(), -1);
      mesh_.texture_coordinates = std::move(face_textures_);
    } else if (has_vertex_textures_) {
      mesh_.polygons.corner_textures = mesh_.polygons.corner_vertices;
    }
  }

  void collect_face_groups() {
    std::map<double, Index> group_of;
    for (const double value : face_groups_)
      if (value >= 0) group_of.emplace(value, 0);
    if (group_of.empty()) return;
    for (auto& [value, group] : group_of) {
      group = static_cast<Index>(mesh_.groups.size());
      mesh_.groups.push_back({fmt::format("{}", value), {}});
    }
    for (std::size_t p = 0; p < face_groups_.size(); ++p) {
      const auto found = group_of.find(face_groups_[p]);
      mesh_.polygons.polygon_groups.push_back(found == group_of.end() ? -1 : found->second);
      if (found == group_of.end()) continue;
      std::vector<Index>& vertices = mesh_.groups[static_cast<std::size_t>(found->second)].vertices;
      const auto corner = mesh_.polygons.corner_vertices.begin();
      vertices.insert(vertices.end(), corner + mesh_.polygons.offsets[p], corner + mesh_.polygons.offsets[p + 1]);
    }
    for (const auto& [value, group] : group_of) {
      std::vector<Index>& vertices = mesh_.groups[static_cast<std::size_t>(group)].vertices;
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
  }

  const MeshSource& source_;
  const PlyHeader& header_;
  const Log& log_;
  Values values_;
  SurfaceMesh mesh_;
  bool has_vertex_textures_ = false, has_colors_ = false;
  std::vector<double> list_, textures_;
  std::vector<Vec2> face_textures_;
  std::vector<double> face_groups_;  ///< per polygon, -1 for none
  double largest_index_ = -1;
  std::string largest_place_;
  SkippedFaces skipped_;
};

}  // namespace

SurfaceMesh read_ply(const MeshSource& source, const Log& log) {
  const PlyHeader header = read_ply_header(source);
  if (header.encoding == PlyEncoding::Text) return PlyBody<PlyTextValues>(source, header, log).read();
  if (header.encoding == PlyEncoding::LittleEndian) return PlyBody<PlyBinaryValues<false>>(source, header, log).read();
  return PlyBody<PlyBinaryValues<true>>(source, header, log).read();
}

}  // namespace softreel::detail
