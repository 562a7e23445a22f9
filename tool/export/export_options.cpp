#include "tool/export/export_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/ranges.h>

#include "core/base/error.h"
#include "tool/export/formats.h"

namespace softreel {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 5> kUnits{
    {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};

double meters_per_unit(const std::string& text) {
  for (const auto& [name, meters] : kUnits)
    if (text == name) return meters;
  double meters = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, code] = std::from_chars(text.data(), end, meters);
  if (code != std::errc{} || stopped != end || !std::isfinite(meters) || !(meters > 0))
    throw input_error(
        fmt::format("--unit: \"{}\" is no unit.\n  Accepted: m, cm, mm, in, ft, or the metres of one unit, a number "
                    "above 0 (0.01 is cm).",
                    text));
  return meters;
}

UpAxis up_axis(const std::string& text) {
  if (text == "y") return UpAxis::Y;
  if (text == "z") return UpAxis::Z;
  throw input_error(fmt::format("--up: \"{}\" is not known.\n  Accepted: y, z.", text));
}

ExportSpace export_space(const std::string& text) {
  if (text.empty() || text == "object") return ExportSpace::Object;
  if (text == "world") return ExportSpace::World;
  throw input_error(fmt::format("--space: \"{}\" is not known.\n  Accepted: object (the file's own), world.", text));
}

/// "obj, ply": the formats for which all of `can` hold.
template <typename... Can>
std::string names_of(Can... can) {
  std::vector<std::string> names;
  for (const ExportFormat& format : export_formats())
    if (((format.*can) && ...)) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// `option` moves the export's world, which a format without transforms has only in world space.
void require_world(const char* option, const ExportFormat& format, ExportSpace space) {
  if (!format.has_units)
    throw input_error(
        fmt::format("{}: {} is in metres with Y up by its definition.\n  Accepted: no {} with it. Leave it out, or "
                    "export {} in a run of its own.",
                    option, format.name, option, format.name));
  if (space == ExportSpace::Object && !format.has_transform)
    throw input_error(
        fmt::format("{}: in object space, {} has the unit and axes of the mesh file.\n  Accepted: with --space world, "
                    "or with {}. Add --space world, or leave it out.",
                    option, format.name, names_of(&ExportFormat::has_transform, &ExportFormat::has_units)));
}

void require_sayable(const ExportWishes& wishes, const ExportFormat& format, ExportSpace space) {
  const auto require = [&](const char* option, const char* what, bool ExportFormat::*can) {
    if (format.*can) return;
    throw input_error(
        fmt::format("{}: {} holds no {}.\n  Accepted: with {}. Leave it out, or export {} in a run of its own.", option,
                    format.name, what, names_of(can), format.name));
  };
  if (wishes.normals) require("--normals", "normals", &ExportFormat::has_normals);
  if (wishes.fps) require("--fps", "frame rate", &ExportFormat::has_seconds);
  if (wishes.voxel) require("--voxel", "voxels", &ExportFormat::has_voxel);
  if (!wishes.unit.empty()) require_world("--unit", format, space);
  if (!wishes.up.empty()) require_world("--up", format, space);
}

}  // namespace

std::vector<const ExportFormat*> chosen_formats(const ExportWishes& wishes) {
  if (wishes.formats.empty()) return {&find_export_format("obj")};
  std::vector<const ExportFormat*> formats;
  for (const std::string& name : wishes.formats) {
    const ExportFormat* format = &find_export_format(name);
    if (std::find(formats.begin(), formats.end(), format) == formats.end()) formats.push_back(format);
  }
  return formats;
}

ExportSettings export_settings(const ExportWishes& wishes, const std::vector<const ExportFormat*>& formats) {
  ExportSettings settings;
  settings.space = export_space(wishes.space);
  if (!wishes.unit.empty()) settings.meters_per_unit = meters_per_unit(wishes.unit);
  if (!wishes.up.empty()) settings.up = up_axis(wishes.up);
  if (wishes.fps) settings.fps = *wishes.fps;
  settings.subframes = wishes.subframes;
  settings.normals = wishes.normals;
  settings.voxel = wishes.voxel.value_or(0);
  for (const ExportFormat* format : formats) require_sayable(wishes, *format, settings.space);
  return settings;
}

}  // namespace softreel
