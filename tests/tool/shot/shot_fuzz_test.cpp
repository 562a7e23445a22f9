// Mutilated shots: each is either a shot or an Error, whatever was done to it.
#include <random>

#include "tests/tool/shot/shot_files.h"

namespace softreel {
namespace {

using FuzzShot = ShotFiles;

/// Pieces that change the meaning of a document rather than only its letters.
const std::vector<std::string>& pieces() {
  static const std::vector<std::string> all{"[",          "]",         "{",          "}",
                                            "=",          "\"",        "\n",         ",",
                                            ".",          "-",         "1e",         "inf",
                                            "nan",        "[[",        "]]",         "\"\"\"",
                                            "'''",        "#",         "{}",         "[]",
                                            "0x",         "true",      "1979-05-27", "99999999999999999999",
                                            "\xff",       "\\u",       "body",       "use = [\"s.toml\"]\n",
                                            "keys = 3\n", "[light]\n", "\r\n"};
  return all;
}

std::string mutated(std::string text, std::mt19937_64& random) {
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t changes = 1 + below(3);
  for (std::size_t i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = below(text.size()), count = std::min(text.size() - at, 1 + below(4));
    switch (below(6)) {
      case 0:
        text.erase(at, count);
        break;
      case 1:
        text.insert(at, pieces()[below(pieces().size())]);
        break;
      case 2:
        text[at] = static_cast<char>(random() % 256);
        break;
      case 3:
        text.replace(at, count, pieces()[below(pieces().size())]);
        break;
      case 4:
        // Another digit: a value that is often as good.
        if (const std::size_t digit = text.find_first_of("0123456789", at); digit != std::string::npos)
          text[digit] = static_cast<char>('0' + below(10));
        break;
      default:
        text.insert(below(text.size()), text.substr(at, 40));
    }
  }
  return text;
}

TEST_F(FuzzShot, IsAShotOrAnError) {
  std::mt19937_64 random(20081122);
  int shots = 0, errors = 0;
  for (int i = 0; i < 600; ++i) {
    const std::string text = mutated(kFullShot, random);
    try {
      const std::string written = to_toml(load(text));
      EXPECT_EQ(to_toml(load(written)), written) << text;
      ++shots;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input);
      EXPECT_NE(std::string(error.what()).find("Accepted: "), std::string::npos) << error.what();
      ++errors;
    }
  }
  EXPECT_GT(shots, 20);
  EXPECT_GT(errors, 100);
}

TEST_F(FuzzShot, IsAShotOrAnErrorUnderMutilatedOverrides) {
  std::mt19937_64 random(7);
  write("s.toml", kFullShot);
  const std::vector<std::string> sound{"body.first_by_name.tets=3", "light[1].power=3", "shot.frames=[1, 2]",
                                       "body.second_by_name.pin[0].keys[1].translate=[1, 2, 3]", "shot.name=x"};
  for (int i = 0; i < 600; ++i) {
    const std::string text = mutated(sound[static_cast<std::size_t>(i) % sound.size()], random);
    try {
      to_toml(load_shot("s.toml", {parse_override(text)}));
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::Input) << text;
    }
  }
}

}  // namespace
}  // namespace softreel
