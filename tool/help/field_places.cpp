#include "tool/help/field_places.h"

#include <algorithm>

#include <fmt/format.h>

namespace softreel {
namespace {

/// Writes a pattern out, name by name and position by position.
class Expansion {
 public:
  explicit Expansion(bool guess) : guess_(guess) {}

  /// `pattern`: what is left of it, beginning with the separator; `at`: the table it continues in, null if there is
  /// none.
  void expand(const std::string& pattern, const TomlValue* at, const std::string& path) {
    const std::size_t special = std::min(pattern.find(".*"), pattern.find("[]"));
    if (special == std::string::npos) {
      if (leads_through_tables(at, pattern)) places_.push_back({path + pattern, follow(at, pattern)});
      return;
    }
    const TomlValue* inner = follow(at, pattern.substr(0, special));
    const std::string head = path + pattern.substr(0, special), rest = pattern.substr(special + 2);
    pattern[special] == '.' ? expand_names(rest, inner, head) : expand_positions(rest, inner, head);
  }
  std::vector<FieldPlace> take() { return std::move(places_); }

 private:
  /// False where a value of another kind stands in the way: a list of selections in that of one.
  static bool leads_through_tables(const TomlValue* at, const std::string& keys) {
    for (std::size_t dot = keys.find('.', 1); dot != std::string::npos; dot = keys.find('.', dot + 1))
      if (const TomlValue* inner = follow(at, keys.substr(0, dot)); inner != nullptr && inner->table() == nullptr)
        return false;
    return true;
  }
  static const TomlValue* follow(const TomlValue* at, const std::string& keys) {
    std::size_t begin = keys.starts_with('.') ? 1 : 0;
    while (at != nullptr && begin < keys.size()) {
      const std::size_t end = std::min(keys.find('.', begin), keys.size());
      at = at->find(keys.substr(begin, end - begin));
      begin = end + 1;
    }
    return at;
  }
  void expand_names(const std::string& rest, const TomlValue* table, const std::string& head) {
    const auto* entries = table == nullptr ? nullptr : table->table();
    const bool is_only_body = head == "body" && (entries == nullptr ? guess_ : entries->size() == 1);
    if (is_only_body) return expand(rest, entries == nullptr ? nullptr : &entries->front().value, head);
    if (entries == nullptr) return;
    for (const TomlEntry& entry : *entries) expand(rest, &entry.value, head + "." + key_text(entry.key));
  }
  void expand_positions(const std::string& rest, const TomlValue* list, const std::string& head) {
    const auto* items = list == nullptr ? nullptr : list->array();
    if (items == nullptr && guess_) expand(rest, nullptr, head + "[0]");
    if (items == nullptr) return;
    for (std::size_t i = 0; i < items->size(); ++i)
      if ((*items)[i].table() != nullptr) expand(rest, &(*items)[i], fmt::format("{}[{}]", head, i));
  }

  bool guess_;
  std::vector<FieldPlace> places_;
};

}  // namespace

std::vector<FieldPlace> field_places(const std::string& pattern, const TomlValue& document) {
  Expansion expansion(document.table()->empty());
  expansion.expand(pattern, &document, "");
  return expansion.take();
}

}  // namespace softreel
