#include "tool/batch/junit.h"

#include <fmt/format.h>

#include "tool/batch/child_process.h"
#include "tool/report/markup.h"
#include "tool/report/run_report.h"
#include "tool/report/version.h"

namespace softreel {
namespace {

/// Text as the value of an attribute: a line feed there would be read as a blank.
std::string attribute(const std::string& text) {
  std::string out;
  for (const char c : markup_text(text)) out += c == '\n' ? std::string("&#10;") : std::string(1, c);
  return out;
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::string complaint(const JobResult& result) {
  const char* element = result.signal != 0 ? "error" : "failure";
  const std::string type = result.signal != 0 ? signal_text(result.signal) : fmt::format("status {}", result.status);
  return fmt::format("      <{0} message=\"{1}\" type=\"{2}\">{3}</{0}>\n", element,
                     attribute(first_line(result.message)), attribute(type), markup_text(result.message));
}

std::string test_case(const BatchJob& job, const JobResult& result) {
  const std::string open = fmt::format("    <testcase name=\"{}\" classname=\"{}\" time=\"{:.3f}\"",
                                       attribute(job.label()), attribute(job.shot), result.seconds);
  switch (result.state) {
    case JobState::Done:
    case JobState::UpToDate:
      return open + "/>\n";
    case JobState::Failed:
      return open + ">\n" + complaint(result) + "    </testcase>\n";
    case JobState::Waiting:
    case JobState::Interrupted:
    case JobState::NotStarted:
      break;
  }
  return open + ">\n      <skipped/>\n    </testcase>\n";
}

/// Warnings, and what was not to be done, a line each.
std::string remarks(const BatchResult& batch) {
  std::string text;
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) {
    const std::string label = batch.jobs[i].label();
    if (batch.results[i].state == JobState::UpToDate) text += label + ": all was there already\n";
    for (const std::string& warning : batch.results[i].warnings) text += label + ": warning: " + warning + "\n";
  }
  return text;
}

}  // namespace

std::string to_junit(const BatchResult& batch, const std::string& timestamp, const std::string& host) {
  int failures = 0, errors = 0;
  for (const JobResult& result : batch.results)
    if (result.state == JobState::Failed) (result.signal != 0 ? errors : failures) += 1;
  const int skipped =
      batch.count(JobState::Interrupted) + batch.count(JobState::NotStarted) + batch.count(JobState::Waiting);
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  xml += fmt::format(
      "  <testsuite id=\"0\" name=\"softreel batch\" package=\"softreel\" timestamp=\"{}\" hostname=\"{}\" "
      "tests=\"{}\" "
      "failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\">\n",
      attribute(timestamp), attribute(host), batch.jobs.size(), failures, errors, skipped, batch.seconds);
  const auto property = [&](const char* name, const std::string& value) {
    xml += fmt::format("      <property name=\"{}\" value=\"{}\"/>\n", name, attribute(value));
  };
  xml += "    <properties>\n";
  property("command", batch.command);
  property("version", version_text());
  property("jobs_at_one_time", std::to_string(batch.jobs_at_one_time));
  property("threads", std::to_string(batch.threads));
  property("memory_bytes", fmt::format("{:.0f}", batch.bytes));
  xml += "    </properties>\n";
  for (std::size_t i = 0; i < batch.jobs.size(); ++i) xml += test_case(batch.jobs[i], batch.results[i]);
  xml += "    <system-out>" + markup_text(remarks(batch)) + "</system-out>\n    <system-err></system-err>\n";
  return xml + "  </testsuite>\n</testsuites>\n";
}

}  // namespace softreel
