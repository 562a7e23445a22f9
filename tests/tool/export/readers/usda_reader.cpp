#include "tests/tool/export/readers/usda_reader.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>

namespace softreel::testing {
namespace {

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {}

  std::unique_ptr<UsdPrim> stage() {
    const std::string magic = "#usda 1.0\n";
    if (text_.rfind(magic, 0) != 0) fail("the first line is #usda 1.0");
    at_ = magic.size();
    auto root = std::make_unique<UsdPrim>();
    if (takes("(")) root->metadata = metadata();
    while (takes_word("def")) root->children.push_back(prim());
    skip_blanks();
    if (at_ != text_.size()) fail("a prim");
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw std::runtime_error("usda, line " + std::to_string(line) + ": expected " + expected);
  }

  void skip_blanks() {
    while (at_ < text_.size()) {
      if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0)
        ++at_;
      else if (text_[at_] == '#')
        at_ = std::min(text_.find('\n', at_), text_.size());
      else
        return;
    }
  }
  bool takes(const std::string& symbol) {
    skip_blanks();
    if (text_.compare(at_, symbol.size(), symbol) != 0) return false;
    at_ += symbol.size();
    return true;
  }
  void require(const std::string& symbol) {
    if (!takes(symbol)) fail(symbol);
  }
  static bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
  bool takes_word(const std::string& wanted) {
    skip_blanks();
    const std::size_t end = at_ + wanted.size();
    if (text_.compare(at_, wanted.size(), wanted) != 0 || (end < text_.size() && is_word(text_[end]))) return false;
    at_ = end;
    return true;
  }
  /// Letters, digits, '_' and ':'.
  std::string name() {
    skip_blanks();
    const std::size_t start = at_;
    while (at_ < text_.size() && (is_word(text_[at_]) || text_[at_] == ':')) ++at_;
    if (at_ == start) fail("a name");
    return text_.substr(start, at_ - start);
  }

  std::string quoted() {
    require("\"");
    std::string value;
    for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
      value += text_[at_];
    }
    require("\"");
    return value;
  }

  double number() {
    skip_blanks();
    double value = 0;
    const char* const start = text_.data() + at_;
    const auto [end, code] = std::from_chars(start, text_.data() + text_.size(), value);
    if (code != std::errc{}) fail("a number");
    at_ += static_cast<std::size_t>(end - start);
    return value;
  }

  UsdValue sequence(UsdValue::Kind kind, const std::string& end) {
    UsdValue value;
    value.kind = kind;
    while (!takes(end)) {
      value.items.push_back(this->value());
      if (!takes(",")) {
        require(end);
        break;
      }
    }
    return value;
  }

  UsdValue until(const std::string& mark, UsdValue::Kind kind) {
    const std::size_t end = text_.find(mark, at_);
    if (end == std::string::npos) fail(mark);
    UsdValue value;
    value.kind = kind;
    value.text = text_.substr(at_, end - at_);
    at_ = end + mark.size();
    return value;
  }

  UsdValue value() {
    UsdValue value;
    if (takes("[")) return sequence(UsdValue::Kind::List, "]");
    if (takes("(")) return sequence(UsdValue::Kind::Tuple, ")");
    if (takes("<")) return until(">", UsdValue::Kind::Path);
    if (takes("@@@")) return until("@@@", UsdValue::Kind::Asset);
    if (takes("@")) return until("@", UsdValue::Kind::Asset);
    skip_blanks();
    if (at_ < text_.size() && text_[at_] == '"') {
      value.kind = UsdValue::Kind::Text;
      value.text = quoted();
      return value;
    }
    value.kind = UsdValue::Kind::Number;
    value.number = number();
    return value;
  }

  /// Behind the '('.
  std::map<std::string, UsdValue> metadata() {
    std::map<std::string, UsdValue> entries;
    while (!takes(")")) {
      takes_word("prepend");
      const std::string key = name();
      require("=");
      entries[key] = value();
    }
    return entries;
  }

  /// Behind "def".
  std::unique_ptr<UsdPrim> prim() {
    auto prim = std::make_unique<UsdPrim>();
    prim->type = name();
    prim->name = quoted();
    if (prim->name.empty() || std::isdigit(static_cast<unsigned char>(prim->name[0])) != 0 ||
        !std::all_of(prim->name.begin(), prim->name.end(), is_word))
      fail("an identifier as name of a prim, before");
    if (takes("(")) prim->metadata = metadata();
    require("{");
    while (!takes("}")) {
      if (takes_word("def"))
        prim->children.push_back(this->prim());
      else
        property(*prim);
    }
    for (const auto& a : prim->children)
      for (const auto& b : prim->children)
        if (a != b && a->name == b->name) fail("names of children that differ, before");
    return prim;
  }

  void property(UsdPrim& prim) {
    takes_word("custom");
    takes_word("uniform");
    std::string type = name();
    if (takes("[]")) type += "[]";
    UsdProperty& property = prim.properties[name()];
    property.type = type;
    if (takes(".timeSamples")) {
      require("=");
      samples(property);
    } else {
      takes(".connect");
      if (takes("=")) property.value = value();
    }
    // Metadata stand on the line of the value: a '(' on a later one belongs to something else.
    if (takes("(")) property.metadata = metadata();
  }

  void samples(UsdProperty& property) {
    require("{");
    while (!takes("}")) {
      const double time = number();
      require(":");
      if (!property.samples.empty() && time <= property.samples.rbegin()->first) fail("times that grow, before");
      property.samples[time] = value();
      require(",");
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

template <typename T>
void collect(const UsdValue& value, std::vector<T>& numbers) {
  if (value.kind == UsdValue::Kind::Number) numbers.push_back(static_cast<T>(value.number));
  for (const UsdValue& item : value.items) collect(item, numbers);
}

}  // namespace

std::vector<float> UsdValue::floats() const {
  std::vector<float> numbers;
  collect(*this, numbers);
  return numbers;
}

std::vector<double> UsdValue::doubles() const {
  std::vector<double> numbers;
  collect(*this, numbers);
  return numbers;
}

const UsdPrim& UsdPrim::child(const std::string& path) const {
  const std::size_t slash = path.find('/');
  for (const auto& one : children)
    if (one->name == path.substr(0, slash))
      return slash == std::string::npos ? *one : one->child(path.substr(slash + 1));
  throw std::runtime_error("no prim " + path + " in " + name);
}

const UsdProperty& UsdPrim::property(const std::string& property_name) const {
  const auto found = properties.find(property_name);
  if (found == properties.end()) throw std::runtime_error("no property " + property_name + " of " + name);
  return found->second;
}

std::unique_ptr<UsdPrim> read_usda(const std::string& text) {
  return Parser(text).stage();
}

}  // namespace softreel::testing
