/// The outcome of a batch as JUnit XML, which continuous integration shows.
#pragma once

#include <string>

#include "tool/batch/batch_result.h"

namespace softreel {

/// One suite with one case a job, in the common form (Ant's JUnit task; attributes and order of elements as Jenkins,
/// GitLab and Azure read them). A job that failed by itself is a failure, one that was killed or crashed an error, one
/// that was not started or was interrupted is skipped; one that was up to date passes.
/// timestamp: "2026-11-28T13:00:00", of the start. host: this machine's name.
std::string to_junit(const BatchResult& batch, const std::string& timestamp, const std::string& host);

}  // namespace softreel
