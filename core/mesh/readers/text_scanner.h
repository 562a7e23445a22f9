/// Lines, words and numbers of a text file, without copies and with the number of the line at hand.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace softreel::detail {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r' || c == '\n';
}

/// Cuts the next word off the front of `rest`; empty if there is none left.
inline std::string_view take_word(std::string_view& rest) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_blank(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_blank(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

/// `text` without blanks at its ends.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// True if all of `word` is a number: decimal, exponent, sign, "nan", "inf". Correctly rounded to the nearest double;
/// what is too large becomes infinite, what is too small 0.
inline bool parse_number(std::string_view word, double& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  if (result.ptr != end) return false;
  if (result.ec == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
  return result.ec != std::errc::invalid_argument;
}

/// True if all of `word` is a whole number that fits.
inline bool parse_integer(std::string_view word, std::int64_t& value) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+') word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto result = std::from_chars(word.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

/// Walks over the lines of a text, whether they end in LF, CR LF or CR, the last one with or without an end.
class LineScanner {
 public:
  explicit LineScanner(std::string_view text) : text_(text) {}

  /// The next line without its end; false after the last one.
  bool next(std::string_view& line) {
    if (position_ >= text_.size()) return false;
    std::size_t end = position_;
    while (end < text_.size() && text_[end] != '\n' && text_[end] != '\r') ++end;
    line = text_.substr(position_, end - position_);
    if (end + 1 < text_.size() && text_[end] == '\r' && text_[end + 1] == '\n') ++end;
    position_ = end + 1 < text_.size() ? end + 1 : text_.size();
    ++line_number_;
    return true;
  }

  /// Number of the line last read, from 1.
  std::int64_t line_number() const { return line_number_; }
  /// Everything after the line last read.
  std::string_view rest() const { return text_.substr(position_); }

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::int64_t line_number_ = 0;
};

}  // namespace softreel::detail
