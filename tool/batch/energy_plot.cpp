#include "tool/batch/energy_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/base/check.h"

namespace softreel {
namespace {

constexpr double kWidth = 640, kHeight = 190;
constexpr double kLeft = 62, kRight = 76, kTop = 12, kBottom = 26;  ///< of the axes
constexpr double kLineOfText = 13;

struct Curve {
  const char* name;
  double FrameEnergy::*part;  ///< null: the total
};
constexpr std::array<Curve, 4> kCurves{{{"total", nullptr},
                                        {"kinetic", &FrameEnergy::kinetic},
                                        {"elastic", &FrameEnergy::elastic},
                                        {"gravity", &FrameEnergy::gravity}}};

double value_of(const FrameEnergy& energy, const Curve& curve) {
  return curve.part == nullptr ? energy.total() : energy.*curve.part;
}

/// Sums over the bodies, of frames that all of them have.
std::map<int, FrameEnergy> summed(const std::vector<BodyEnergies>& energies) {
  std::map<int, FrameEnergy> sums;
  std::map<int, std::size_t> bodies;
  for (const BodyEnergies& body : energies)
    for (const auto& [frame, known] : body.frames) {
      FrameEnergy& sum = sums[frame];
      sum.kinetic += known.energy.kinetic;
      sum.elastic += known.energy.elastic;
      sum.gravity += known.energy.gravity;
      bodies[frame] += 1;
    }
  std::erase_if(sums, [&](const auto& entry) { return bodies[entry.first] < energies.size(); });
  return sums;
}

/// From numbers to places in the drawing.
struct Axes {
  double first = 0, last = 1, low = 0, high = 1;
  double x(double frame) const { return kLeft + (frame - first) / (last - first) * (kWidth - kLeft - kRight); }
  double y(double value) const { return kHeight - kBottom - (value - low) / (high - low) * (kHeight - kTop - kBottom); }
};

Axes axes_for(const std::map<int, FrameEnergy>& sums) {
  Axes axes{static_cast<double>(sums.begin()->first), static_cast<double>(sums.rbegin()->first), 0, 0};
  for (const auto& [frame, energy] : sums)
    for (const Curve& curve : kCurves) {
      axes.low = std::min(axes.low, value_of(energy, curve));
      axes.high = std::max(axes.high, value_of(energy, curve));
    }
  if (axes.high == axes.low) axes.high = axes.low + 1;  // nothing moves: a line at the bottom
  return axes;
}

/// One unit for all numbers of an axis: "mJ" and 1e3, as fits the largest.
struct Unit {
  const char* name;
  double factor;
};
Unit unit_for(double largest) {
  for (const Unit unit : {Unit{"MJ", 1e-6}, Unit{"kJ", 1e-3}, Unit{"J", 1}, Unit{"mJ", 1e3}})
    if (largest * unit.factor >= 1) return unit;
  return {"\xC2\xB5J", 1e6};  // micro
}

std::string axis_lines(const Axes& axes) {
  const Unit unit = unit_for(std::max(std::abs(axes.low), std::abs(axes.high)));
  std::string svg;
  for (const double value : round_steps(axes.low * unit.factor, axes.high * unit.factor, 4)) {
    const double y = axes.y(value / unit.factor);
    svg += fmt::format("<line class=\"plot-axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>", kLeft,
                       kWidth - kRight, y, y);
    svg += fmt::format("<text class=\"plot-text\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:g} {}</text>",
                       kLeft - 6, y + 3.5, std::abs(value) < 1e-12 ? 0.0 : value, unit.name);
  }
  for (const double frame : round_steps(axes.first, axes.last, 8)) {
    if (frame != std::floor(frame)) continue;
    svg += fmt::format("<text class=\"plot-text\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>",
                       axes.x(frame), kHeight - 8, frame);
  }
  svg +=
      fmt::format("<text class=\"plot-text\" x=\"{:.1f}\" y=\"{:.1f}\">frame</text>", kWidth - kRight + 7, kHeight - 8);
  return svg;
}

/// Names at the right ends of the lines, moved apart where they would overlap.
std::string names_of_lines(const Axes& axes, const FrameEnergy& last) {
  struct Name {
    const char* text;
    double y;
  };
  std::vector<Name> names;
  for (const Curve& curve : kCurves) names.push_back({curve.name, axes.y(value_of(last, curve)) + 4});
  std::stable_sort(names.begin(), names.end(), [](const Name& a, const Name& b) { return a.y < b.y; });
  for (std::size_t i = 1; i < names.size(); ++i) names[i].y = std::max(names[i].y, names[i - 1].y + kLineOfText);
  double limit = kHeight - kBottom + 2;
  for (auto name = names.rbegin(); name != names.rend(); ++name, limit -= kLineOfText)
    name->y = std::min(name->y, limit);
  std::string svg;
  for (const Name& name : names)
    svg += fmt::format("<text class=\"plot-name plot-{0}\" x=\"{1:.1f}\" y=\"{2:.1f}\">{0}</text>", name.text,
                       kWidth - kRight + 7, name.y);
  return svg;
}

}  // namespace

std::vector<double> round_steps(double low, double high, int most) {
  CHECK(high > low);
  double step = std::pow(10, std::floor(std::log10((high - low) / most)));
  for (const double factor : {2.0, 2.5, 2.0})  // 1, 2, 5, 10
    if ((high - low) / step > most) step *= factor;
  std::vector<double> values;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) values.push_back(k * step);
  return values;
}

std::string energy_plot(const std::vector<BodyEnergies>& energies) {
  const std::map<int, FrameEnergy> sums = summed(energies);
  if (sums.size() < 2) return {};
  const Axes axes = axes_for(sums);
  std::string svg = fmt::format(
      "<svg class=\"plot\" viewBox=\"0 0 {0:g} {1:g}\" role=\"img\"><title>Energies of all bodies over frames {2} to "
      "{3}</title>",
      kWidth, kHeight, sums.begin()->first, sums.rbegin()->first);
  svg += axis_lines(axes);
  for (const Curve& curve : kCurves) {
    std::string points;
    for (const auto& [frame, energy] : sums)
      points += fmt::format("{:.1f},{:.1f} ", axes.x(frame), axes.y(value_of(energy, curve)));
    svg += fmt::format("<polyline class=\"plot-line plot-{}\" points=\"{}\"/>", curve.name, points);
  }
  return svg + names_of_lines(axes, sums.rbegin()->second) + "</svg>\n";
}

}  // namespace softreel
