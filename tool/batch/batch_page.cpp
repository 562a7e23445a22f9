#include "tool/batch/batch_page.h"

#include <algorithm>

#include <fmt/format.h>

#include "tool/batch/batch_style.h"
#include "tool/batch/child_process.h"
#include "tool/batch/energy_plot.h"
#include "tool/cache/base64.h"
#include "tool/report/console.h"
#include "tool/report/markup.h"
#include "tool/report/run_report.h"
#include "tool/report/version.h"

namespace softreel {
namespace {

const char* class_of(JobState state) {
  switch (state) {
    case JobState::Done:
    case JobState::UpToDate:
      return "good";
    case JobState::Failed:
      return "bad";
    case JobState::Waiting:
    case JobState::Interrupted:
    case JobState::NotStarted:
      break;
  }
  return "idle";
}

std::string state_span(const JobResult& result) {
  const std::string why = result.state != JobState::Failed ? ""
                          : result.signal != 0             ? ": " + signal_text(result.signal)
                                                           : fmt::format(": status {}", result.status);
  return fmt::format("<span class=\"state {}\">{}{}</span>", class_of(result.state), word_of(result.state), why);
}

std::string image_tag(const std::vector<std::uint8_t>& png, const std::string& words, const std::string& type) {
  return fmt::format("<img{} alt=\"{}\" src=\"data:image/png;base64,{}\">",
                     type.empty() ? "" : " class=\"" + type + "\"", markup_text(words), base64(png));
}

std::string item_list(const std::string& title, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string html = "<h3>" + title + "</h3><ul>";
  for (const std::string& item : items) html += "<li>" + markup_text(item) + "</li>";
  return html + "</ul>\n";
}

/// The swept values, one a line; lines may break after dots and underscores.
std::string variant_lines(const BatchJob& job) {
  std::string html;
  for (const std::string& value : job.swept) {
    html += "<br><span class=\"faint\">";
    for (const char c : markup_text(value)) {
      html += c;
      if (c == '.' || c == '_') html += "<wbr>";
    }
    html += "</span>";
  }
  return html;
}

std::string card(const BatchJob& job, const JobResult& result, const JobPictures& pictures, std::size_t index) {
  const std::string picture =
      pictures.cover.empty()
          ? "<div class=\"none\">no picture</div>"
          : image_tag(pictures.cover, fmt::format("{}, frame {}", job.label(), pictures.cover_frame), "");
  return fmt::format("<a class=\"card{}\" href=\"#job{}\">{}<div class=\"words\"><b>{}</b>{}<br>{}</div></a>\n",
                     result.state == JobState::Failed ? " failed" : "", index, picture, markup_text(job.name),
                     variant_lines(job), state_span(result));
}

/// What failed, before everything else: a line each that leads to the whole message.
std::string failures(const BatchResult& batch) {
  std::string html;
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const JobResult& result = batch.results[i];
    if (result.state != JobState::Failed) continue;
    html += fmt::format("<li><a href=\"#job{}\">{}</a>: {}</li>\n", i, markup_text(batch.jobs[i].label()),
                        markup_text(result.message.substr(0, result.message.find('\n'))));
  }
  return html.empty() ? html : "<ul class=\"failures\">\n" + html + "</ul>\n";
}

std::string duration_or_dash(double seconds) {
  return seconds > 0 ? format_duration(seconds) : "&ndash;";
}

std::string table(const BatchResult& batch) {
  std::string html =
      "<table><tr><th>job</th><th>is</th><th class=\"number\">frames</th><th class=\"number\">traced now</th>"
      "<th class=\"number\">time</th><th class=\"number\">cpu time</th><th class=\"number\">memory</th>"
      "<th class=\"number\">expected</th></tr>\n";
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const JobResult& result = batch.results[i];
    const JobPlan& plan = result.plan;
    html += fmt::format(
        "<tr><td><a href=\"#job{}\">{}</td><td>{}{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>"
        "<td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td "
        "class=\"number\">{}</td></tr>\n",
        i, markup_text(batch.jobs[i].name) + "</a>" + variant_lines(batch.jobs[i]), state_span(result),
        result.attempts > 1 ? fmt::format(" ({} attempts)", result.attempts) : "",
        plan.known ? fmt::format("{}&ndash;{}", plan.first_frame, plan.last_frame) : "&ndash;",
        result.state == JobState::Done ? std::to_string(result.facts.traced) : "&ndash;",
        duration_or_dash(result.seconds), duration_or_dash(result.cpu_seconds),
        result.peak_bytes > 0 ? format_bytes(result.peak_bytes) : "&ndash;",
        plan.known ? format_bytes(plan.bytes) : "&ndash;");
  }
  return html + "</table>\n";
}

std::string stage_bars(const RunFacts& facts) {
  constexpr double kShown = 0.005;  // s: less is no bar
  double longest = 0;
  for (const StageSeconds& stage : facts.stages) longest = std::max(longest, stage.seconds);
  if (longest < kShown) return {};
  std::string html = "<h3>Time in each stage (stages run side by side)</h3><div class=\"stages\">";
  for (const StageSeconds& stage : facts.stages)
    if (stage.seconds >= kShown)
      html += fmt::format(
          "<span>{}</span><span class=\"bar\" style=\"width: {:.1f}%\"></span><span class=\"number\">{:.2f} s</span>",
          markup_text(stage.stage), 100 * stage.seconds / longest, stage.seconds);
  return html + "</div>\n";
}

std::string measures(const RunFacts& facts) {
  const std::string plot = energy_plot(facts.energies), bars = stage_bars(facts);
  if (plot.empty() && bars.empty()) return {};
  return "<div class=\"pair\"><div>" +
         (plot.empty() ? "" : "<h3>Energy over frames, gravity's against rest</h3>" + plot) + "</div><div>" + bars +
         "</div></div>\n";
}

std::string section(const BatchJob& job, const JobResult& result, const JobPictures& pictures, std::size_t index) {
  std::string html = fmt::format("<section id=\"job{}\"><div class=\"head\"><h2>{}{}</h2>{}</div>\n", index,
                                 markup_text(job.name), variant_lines(job), state_span(result));
  if (!result.message.empty()) html += "<pre class=\"bad\">" + markup_text(result.message) + "</pre>\n";
  if (result.state == JobState::UpToDate)
    html += "<p class=\"faint\">All was there already; what follows is of the run that made it.</p>\n";
  if (result.alone)
    html += "<p class=\"faint\">Expected to need more memory than there is for all jobs together: it ran alone.</p>\n";
  if (!pictures.sheet.empty()) html += image_tag(pictures.sheet, "frames of " + job.label(), "sheet") + "\n";
  if (pictures.missing > 0 && !pictures.sheet.empty())
    html += fmt::format("<p class=\"faint\">{} of the frames between are not there{}.</p>\n", pictures.missing,
                        pictures.problem.empty() ? "" : ": " + markup_text(pictures.problem));
  html += measures(result.facts);
  html += item_list("Warnings", result.warnings);
  html += item_list("Skipped, with the time it once took", result.facts.skipped);
  html += item_list("Made", result.facts.made);
  return html + "<h3>Command</h3><pre>" + markup_text(job.command_line()) + "</pre></section>\n";
}

}  // namespace

std::string counts_text(const BatchResult& batch) {
  std::string text;
  for (const JobState state :
       {JobState::Done, JobState::UpToDate, JobState::Failed, JobState::Interrupted, JobState::NotStarted})
    if (const int count = batch.count(state); count > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, word_of(state));
  return text;
}

std::string batch_page(const BatchResult& batch, const std::vector<JobPictures>& pictures, const std::string& when,
                       const std::string& host) {
  const std::string counts = counts_text(batch);
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>batch: {0}</title>"
      "<meta name=\"viewport\" content=\"width=device-width\"><style>{1}</style></head><body>\n"
      "<h1>Batch: {0}</h1>\n",
      counts, kBatchStyle);
  html += fmt::format("<p class=\"faint\">{} on {}, in {}; at most {} at one time, {} threads in all{}. {}</p>\n",
                      markup_text(when), markup_text(host), format_duration(batch.seconds), batch.jobs_at_one_time,
                      batch.threads, batch.bytes < 1e15 ? fmt::format(", {} of memory", format_bytes(batch.bytes)) : "",
                      markup_text(version_text()));
  html += "<pre>" + markup_text(batch.command) + "</pre>\n" + failures(batch) + "<div class=\"cards\">\n";
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) html += card(batch.jobs[i], batch.results[i], pictures[i], i);
  html += "</div>\n" + table(batch);
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) html += section(batch.jobs[i], batch.results[i], pictures[i], i);
  return html + "</body></html>\n";
}

}  // namespace softreel
