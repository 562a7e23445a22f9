#include "tool/batch/sweep.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "core/base/error.h"
#include "tool/cache/key.h"
#include "tool/shot/schema.h"

namespace softreel {
namespace {

constexpr const char* kAccepted =
    "Accepted: a field and its values, such as body.tets=5000,10000 or gravity.acceleration=[0,-9.81,0],[0,0,0]; "
    "1..5/9 stands for nine numbers from 1 to 5, 1e4..1e6/5log for five by equal factors.";
constexpr int kMostOfARange = 1000;
/// File systems take 255 bytes.
constexpr std::size_t kLongestName = 160;

Error sweep_error(const std::string& text, const std::string& why, const std::string& next) {
  return input_error(fmt::format("--sweep: {} is wrong because {}.\n  {} {}", text, why, kAccepted, next));
}

std::string trimmed(const std::string& part) {
  const std::size_t first = part.find_first_not_of(" \t"), last = part.find_last_not_of(" \t");
  return first == std::string::npos ? std::string() : part.substr(first, last - first + 1);
}

/// Parts between the commas that are in no bracket, brace or quotes; nothing if these do not match.
std::optional<std::vector<std::string>> split(const std::string& text) {
  std::vector<std::string> parts{""};
  std::string open;  // the closing characters that are awaited
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool in_quotes = !open.empty() && (open.back() == '"' || open.back() == '\'');
    if (open.empty() && c == ',') {
      parts.emplace_back();
      continue;
    }
    parts.back() += c;
    if (in_quotes && open.back() == '"' && c == '\\' && i + 1 < text.size())
      parts.back() += text[++i];
    else if (!open.empty() && c == open.back())
      open.pop_back();
    else if (in_quotes)
      continue;
    else if (c == '[' || c == '{')
      open += c == '[' ? ']' : '}';
    else if (c == ']' || c == '}')
      return std::nullopt;
    else if (c == '"' || c == '\'')
      open += c;
  }
  if (!open.empty()) return std::nullopt;
  return parts;
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// "A..B/N" or "A..B/Nlog" taken apart; nothing if the text has another form.
struct Range {
  double first = 0, last = 0;
  int count = 0;
  bool by_factors = false;
};

std::optional<Range> parse_range(std::string_view text) {
  const std::size_t dots = text.find(".."), slash = text.rfind('/');
  if (dots == std::string_view::npos || slash == std::string_view::npos || slash < dots) return std::nullopt;
  const auto first = number(text.substr(0, dots)), last = number(text.substr(dots + 2, slash - dots - 2));
  Range range;
  std::string_view count = text.substr(slash + 1);
  range.by_factors = count.ends_with("log");
  if (range.by_factors) count.remove_suffix(3);
  const auto [end, code] = std::from_chars(count.data(), count.data() + count.size(), range.count);
  if (!first || !last || code != std::errc() || end != count.data() + count.size()) return std::nullopt;
  range.first = *first;
  range.last = *last;
  return range;
}

/// In twelve digits at most, which hides what rounding did to a value between the ends.
std::string number_text(double value) {
  return fmt::format("{:.12g}", value);
}

std::vector<std::string> values_of(const Range& range, const std::string& text) {
  if (range.count < 2 || range.count > kMostOfARange)
    throw sweep_error(text, fmt::format("{} is no number of values", range.count),
                      fmt::format("Take 2 to {} values.", kMostOfARange));
  if (range.by_factors && (range.first <= 0 || range.last <= 0))
    throw sweep_error(text, "equal factors need numbers above 0", "Leave out log, or begin above 0.");
  std::vector<std::string> values;
  for (int k = 0; k < range.count; ++k) {
    const double share = static_cast<double>(k) / (range.count - 1);
    const double value = range.by_factors ? range.first * std::pow(range.last / range.first, share)
                                          : range.first + share * (range.last - range.first);
    values.push_back(number_text(k == 0 ? range.first : k == range.count - 1 ? range.last : value));
  }
  return values;
}

/// What a value or a path adds to a folder's name: characters that a shell takes as they are. `lost` is set if another
/// text might give the same.
std::string folder_text(const std::string& text, bool& lost) {
  constexpr std::string_view kDropped = " []{}\"'", kPlain = "._+-=";
  // Blanks between the numbers of a list and the quotes round a word say nothing that another value could not; blanks
  // within quotes or a bare word do.
  const bool is_list = text.find_first_of("[{") != std::string::npos;
  char quote = 0;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto byte = static_cast<unsigned char>(c);
    if (kDropped.find(c) != std::string_view::npos) {
      const bool is_quote = c == '"' || c == '\'';
      if (quote == 0 ? is_quote : c == quote) {
        quote = quote == 0 ? c : 0;
        lost = lost || (!is_list && i > 0 && i + 1 < text.size());
      } else {
        lost = lost || quote != 0 || !is_list;
      }
      continue;
    }
    const bool is_plain = std::isalnum(byte) != 0 || byte >= 0x80 || kPlain.find(c) != std::string_view::npos;
    out += is_plain ? c : '_';
    lost = lost || (!is_plain && c != ',');
  }
  return out;
}

std::string name_of(const std::vector<Override>& values) {
  std::string name, whole;
  bool lost = false;
  for (const Override& one : values) {
    name += name.empty() ? "" : ",";
    name += folder_text(one.path, lost) + "=";
    name += folder_text(one.value, lost);
    whole += one.path + "=" + one.value + "\n";
  }
  if (name.size() <= kLongestName && !lost) return name;
  // What the name does not say, a few digits of the values' hash tell apart.
  std::size_t end = std::min(name.size(), kLongestName);
  while (end > 0 && end < name.size() && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;  // UTF-8
  return name.substr(0, end) + "~" + KeyHasher("variant").add(whole).key().substr(0, 6);
}

}  // namespace

SweepAxis parse_sweep(const std::string& text) {
  const std::size_t equals = text.find('=');
  SweepAxis axis;
  if (equals != std::string::npos) axis.path = trimmed(text.substr(0, equals));
  if (axis.path.empty()) throw sweep_error(text, "it is not of the form PATH=VALUE,VALUE", "Correct it.");
  try {
    explain_field(axis.path);
  } catch (const Error& unknown) {
    throw input_error("--sweep: " + std::string(unknown.what()));
  }
  const auto parts = split(text.substr(equals + 1));
  if (!parts) throw sweep_error(text, "its brackets or quotes do not match", "Close each that you open.");
  for (const std::string& part : *parts) {
    const std::string value = trimmed(part);
    if (value.empty()) throw sweep_error(text, "one of its values is empty", "Take the spare comma out.");
    const auto range = parse_range(value);
    const std::vector<std::string> all = range ? values_of(*range, text) : std::vector<std::string>{value};
    axis.values.insert(axis.values.end(), all.begin(), all.end());
  }
  std::set<std::string> seen;
  for (const std::string& value : axis.values)
    if (!seen.insert(value).second)
      throw sweep_error(text, fmt::format("the value {} is there twice", value), "Take one of them out.");
  return axis;
}

std::vector<Variant> expand_sweeps(const std::vector<SweepAxis>& axes, std::size_t limit) {
  std::vector<Variant> variants{{}};
  std::set<std::string> paths;
  for (const SweepAxis& axis : axes) {
    if (!paths.insert(axis.path).second)
      throw input_error(fmt::format(
          "--sweep: {} is given twice.\n  Accepted: each field once. Put all its values into one --sweep.", axis.path));
    if (variants.size() * axis.values.size() > limit)
      throw input_error(
          fmt::format("--sweep: the combinations are more than {}.\n  Accepted: at most {} jobs. Take fewer values.",
                      limit, limit));
    std::vector<Variant> longer;
    for (const Variant& variant : variants)
      for (const std::string& value : axis.values) {
        longer.push_back(variant);
        longer.back().values.push_back({axis.path, value, "--sweep"});
      }
    variants = std::move(longer);
  }
  for (Variant& variant : variants) variant.name = name_of(variant.values);
  return variants;
}

}  // namespace softreel
