#include "tool/starter/commented_document.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "core/base/check.h"
#include "tool/shot/schema.h"

namespace softreel {
namespace {

constexpr std::size_t kWidth = 110;     ///< of the whole text
constexpr std::size_t kShortLine = 46;  ///< longer ones have their comment above
constexpr std::size_t kSectionGap = 2;  ///< blanks before a comment beside a line

const FieldText& text_of(const std::string& path) {
  const FieldText* text = find_field(path);
  CHECK(text != nullptr);
  return *text;
}

/// Tables that have a heading; selections and keys are written in place.
bool is_section(const std::string& path, const TomlValue& value) {
  const bool holds_tables =
      value.array() != nullptr && !value.array()->empty() && value.array()->front().table() != nullptr;
  if (value.table() == nullptr && !holds_tables) return false;
  return path.find(".select") == std::string::npos && text_of(path).is_table;
}

/// "m: Scales the body ...: "a" or "b"."
std::string comment_of(const std::string& path, const Remarks& remarks) {
  const FieldText& text = text_of(path);
  std::string comment = text.unit.empty() ? text.sentence : text.unit + ": " + text.sentence;
  if (text.type == "text" && text.accepted.starts_with('"') && text.sentence.find('"') == std::string::npos) {
    if (comment.ends_with('.')) comment.pop_back();
    comment += ": " + text.accepted + ".";
  }
  const auto remark = remarks.find(path);
  return remark == remarks.end() ? comment : comment + " " + remark->second;
}

/// A list of tables on a line for each.
std::string value_text(const TomlValue& value) {
  const auto* items = value.array();
  if (items == nullptr || items->size() < 2 || items->front().table() == nullptr) return to_text(value);
  std::string text = "[\n";
  for (const TomlValue& item : *items) text += "  " + to_text(item) + ",\n";
  return text + "]";
}

class Writer {
 public:
  explicit Writer(const Remarks& remarks) : remarks_(remarks) {}

  void write(const TomlValue::Table& entries, const std::string& path) {
    write_lines(entries, path);
    for (const TomlEntry& entry : entries) {
      const std::string at = path.empty() ? key_text(entry.key) : path + "." + key_text(entry.key);
      if (!is_section(at, entry.value)) continue;
      const std::string heading = heading_path(at);
      if (entry.value.array() != nullptr) {
        for (std::size_t i = 0; i < entry.value.array()->size(); ++i)
          write_section("[[" + heading + "]]", *(*entry.value.array())[i].table(), fmt::format("{}[{}]", at, i));
      } else if (text_of(at).type == "tables by name" && path.empty()) {
        for (const TomlEntry& named : *entry.value.table())
          write_section(fmt::format("[{}.{}]", heading, key_text(named.key)), *named.value.table(),
                        at + "." + key_text(named.key));
      } else {
        write_section("[" + heading + "]", *entry.value.table(), at);
      }
    }
  }
  std::string take() { return std::move(out_); }

 private:
  /// Without positions: headings of lists name none.
  static std::string heading_path(std::string path) {
    for (std::size_t open = path.find('['); open != std::string::npos; open = path.find('['))
      path.erase(open, path.find(']') - open + 1);
    return path;
  }

  void write_section(const std::string& heading, const TomlValue::Table& entries, const std::string& path) {
    const auto remark = remarks_.find(path);
    out_ += "\n" + comment_lines(remark == remarks_.end() ? text_of(path).sentence
                                                          : text_of(path).sentence + " " + remark->second);
    out_ += heading + "\n";
    write(entries, path);
  }

  void write_lines(const TomlValue::Table& entries, const std::string& path) {
    std::size_t column = 0;
    std::vector<std::pair<std::string, std::string>> lines;  // with their comments
    for (const TomlEntry& entry : entries) {
      const std::string at = path.empty() ? key_text(entry.key) : path + "." + key_text(entry.key);
      if (is_section(at, entry.value)) continue;
      lines.emplace_back(key_text(entry.key) + " = " + value_text(entry.value), comment_of(at, remarks_));
      if (is_short(lines.back().first)) column = std::max(column, lines.back().first.size() + kSectionGap);
    }
    for (const auto& [line, comment] : lines) {
      if (is_short(line)) {
        const std::string beside = comment_lines(comment, column);
        out_ += line + beside.substr(line.size());
      } else {
        out_ += comment_lines(comment) + line + "\n";
      }
    }
  }

  static bool is_short(const std::string& line) {
    return line.size() <= kShortLine && line.find('\n') == std::string::npos;
  }

  const Remarks& remarks_;
  std::string out_;
};

}  // namespace

std::string comment_lines(const std::string& text, std::size_t indent) {
  std::string out, line;
  const auto flush = [&] {
    out += std::string(indent, ' ') + "# " + line + "\n";
    line.clear();
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (!line.empty() && indent + 2 + line.size() + 1 + word.size() > kWidth) flush();
    line += (line.empty() ? "" : " ") + word;
    at = end + 1;
  }
  flush();
  return out;
}

std::string commented_document(const TomlValue& document, const Remarks& remarks) {
  Writer writer(remarks);
  writer.write(*document.table(), "");
  return writer.take();
}

}  // namespace softreel
