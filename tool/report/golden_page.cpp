#include "tool/report/golden_page.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/image/flip.h"
#include "tool/cache/base64.h"
#include "tool/report/markup.h"

namespace softreel {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: dark; }
body { background: #17181b; color: #d8d9dc; font: 15px/1.5 system-ui, sans-serif; max-width: 1060px; margin: 2em auto;
  padding: 0 1em; }
h1 { font-size: 1.5em; font-weight: 600; } h2 { font-size: 1.15em; font-weight: 600; margin-top: 2.2em; }
table { border-collapse: collapse; width: 100%; } td, th { text-align: left; padding: .35em .8em .35em 0;
  border-bottom: 1px solid #303238; vertical-align: top; } th { font-weight: 600; color: #9a9ca3; }
td:nth-child(-n+2) { white-space: nowrap; }
.changed { color: #ff9d5c; } .same { color: #7fc98f; } .cause { color: #f0d9a8; }
figure { margin: 1em 0; } figcaption { color: #9a9ca3; margin-top: .4em; }
.pair { position: relative; line-height: 0; --at: 50%; }
.pair img, .difference img { width: 100%; image-rendering: auto; border-radius: 3px; }
.pair .now { position: absolute; inset: 0; clip-path: inset(0 0 0 var(--at)); }
.pair::after { content: ""; position: absolute; top: 0; bottom: 0; left: var(--at); width: 2px; margin-left: -1px;
  background: #fff; box-shadow: 0 0 4px #000; pointer-events: none; }
.tag { position: absolute; top: .7em; line-height: 1.2; background: #000a; padding: .25em .6em; border-radius: 3px;
  pointer-events: none; } .tag.left { left: .7em; } .tag.right { right: .7em; }
input[type=range] { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0; cursor: ew-resize; }
input[type=range]:focus-visible { opacity: .4; }
.scale { height: 14px; border-radius: 3px; } .ticks { display: flex; justify-content: space-between; color: #9a9ca3;
  font-size: .85em; }
)";

std::string image_tag(const std::vector<std::uint8_t>& png, const std::string& name, const std::string& type = "") {
  return fmt::format("<img{} alt=\"{}\" src=\"data:image/png;base64,{}\">",
                     type.empty() ? "" : " class=\"" + type + "\"", markup_text(name), base64(png));
}

/// The colours of the difference picture, as a gradient of CSS.
std::string gradient() {
  constexpr int kStops = 16;
  std::string stops;
  for (int k = 0; k <= kStops; ++k) {
    const Vec3f color = 255 * magma(static_cast<float>(k) / kStops);
    stops += fmt::format(", rgb({}, {}, {})", std::lround(color.x()), std::lround(color.y()), std::lround(color.z()));
  }
  return "linear-gradient(to right" + stops + ")";
}

std::string anchor(const GoldenPageFrame& frame) {
  return fmt::format("{}-{}", markup_text(frame.shot), frame.frame);
}

std::string table(const std::vector<GoldenPageFrame>& frames) {
  std::string rows;
  for (const GoldenPageFrame& frame : frames) {
    const std::string name = fmt::format("{}, frame {}", markup_text(frame.shot), frame.frame);
    rows += fmt::format("<tr><td>{}</td><td class=\"{}\">{}</td><td>{}{}</td></tr>\n",
                        frame.changed ? fmt::format("<a href=\"#{}\">{}</a>", anchor(frame), name) : name,
                        frame.changed ? "changed" : "same", frame.changed ? "changed" : "as before",
                        markup_text(frame.verdict),
                        frame.cause.empty() ? "" : "<br><span class=\"cause\">" + markup_text(frame.cause) + "</span>");
  }
  return "<table><tr><th>frame</th><th>is</th><th>because</th></tr>\n" + rows + "</table>\n";
}

std::string section(const GoldenPageFrame& frame) {
  std::string html =
      fmt::format("<h2 id=\"{}\">{}, frame {}</h2>\n<p>{}<br><span class=\"cause\">{}</span></p>\n", anchor(frame),
                  markup_text(frame.shot), frame.frame, markup_text(frame.verdict), markup_text(frame.cause));
  if (frame.golden.empty() || frame.difference.empty())
    return html + "<figure class=\"difference\">" + image_tag(frame.now, "now") +
           "<figcaption>the frame as it is now</figcaption></figure>\n";
  html +=
      "<figure><div class=\"pair\">" + image_tag(frame.golden, "golden image") +
      image_tag(frame.now, "the frame now", "now") +
      "<span class=\"tag left\">golden</span><span class=\"tag right\">now</span>"
      "<input type=\"range\" min=\"0\" max=\"100\" step=\"0.1\" value=\"50\" aria-label=\"golden or now\" "
      "oninput=\"this.parentNode.style.setProperty('--at', this.value + '%')\"></div>"
      "<figcaption>Drag: the golden image on the left, the frame as it is now on the right.</figcaption></figure>\n";
  html += "<figure class=\"difference\">" + image_tag(frame.difference, "difference") +
          fmt::format(
              "<div class=\"scale\" style=\"background: {}\"></div><div class=\"ticks\"><span>0: looks the "
              "same</span><span>FLIP error</span><span>1: green for blue</span></div></figure>\n",
              gradient());
  return html;
}

}  // namespace

std::string golden_page(const std::vector<GoldenPageFrame>& frames) {
  const auto changed = std::count_if(frames.begin(), frames.end(), [](const auto& frame) { return frame.changed; });
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>golden images: {0} of {1} "
      "changed</title>"
      "<meta name=\"viewport\" content=\"width=device-width\"><style>{2}</style></head><body>\n<h1>Golden images: {0} "
      "of "
      "{1} changed</h1>\n",
      changed, frames.size(), kStyle);
  html += table(frames);
  for (const GoldenPageFrame& frame : frames)
    if (frame.changed) html += section(frame);
  return html + "</body></html>\n";
}

}  // namespace softreel
