// Runs a fuzz target without libFuzzer: seeded mutations of its seeds, the same on every machine.
//
//   fuzz_NAME ROUNDS       so many mutated inputs of each seed
//   fuzz_NAME FILE ...     these inputs
//
// An input that crashes the target, hangs or asks for more memory than its size excuses is left as fuzz_failure.bin.
#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>
#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "tests/fuzz/fuzz_target.h"

namespace {

/// The input at work, for the handler of what goes wrong.
std::string current;

/// No reader needs more than this many bytes a byte of its input, and a few for its tables.
constexpr std::size_t kBytesPerByte = 2000, kBytesBeside = std::size_t{1} << 20;

constexpr unsigned kHangSeconds = 30;

/// Only what a signal handler may do.
void keep_input(int signal) {
  const int file = ::open("fuzz_failure.bin", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const bool kept = file >= 0 && ::write(file, current.data(), current.size()) >= 0;
  constexpr char kSaid[] = "a fuzz target failed; its input is fuzz_failure.bin in the working folder\n";
  if (kept && ::write(STDERR_FILENO, kSaid, sizeof kSaid - 1) < 0) ::_exit(3);
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

void run(std::string input) {
  current = std::move(input);
  ::alarm(kHangSeconds);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(current.data()), current.size());
  ::alarm(0);
}

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t n) {
  return n == 0 ? 0 : static_cast<std::size_t>(random() % n);
}

/// Replaces a number of a text by one that readers stumble over.
void replace_number(std::string& bytes, Random& random) {
  constexpr const char* kNumbers[] = {
      "0",   "-1",  "1",   "4294967295", "2147483647",  "-2147483648", "9223372036854775807",
      "nan", "inf", "-0",  "1e308",      "-1e308",      "1e-320",      "0.1",
      "",    "x",   "1e9", "65536",      "1e999999999", "3.5",         "99999999999999999999"};
  const auto is_number = [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  const auto start = bytes.begin() + static_cast<std::ptrdiff_t>(below(random, bytes.size()));
  const auto begin = std::find_if(start, bytes.end(), is_number);
  const auto end = std::find_if_not(begin, bytes.end(), is_number);
  bytes.replace(begin, end, kNumbers[below(random, std::size(kNumbers))]);
}

/// Overwrites 4 bytes, as binary counts and indices have.
void replace_word(std::string& bytes, Random& random) {
  constexpr std::uint32_t kWords[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000, 0x00ffffff};
  if (bytes.size() < 5) return;
  const std::uint32_t word = kWords[below(random, std::size(kWords))];
  const std::size_t at = 1 + below(random, bytes.size() - 4);
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<char>(word >> (8 * k));
}

void mutate(std::string& bytes, const std::string& other, Random& random) {
  const std::size_t at = 1 + below(random, bytes.size() - 1);
  switch (random() % 8) {
    case 0:
      bytes[at] = static_cast<char>(random());
      break;
    case 1:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
      break;
    case 2:
      bytes.resize(at);
      break;
    case 3:
      bytes.erase(at, 1 + below(random, 16));
      break;
    case 4:  // a piece of it again
      bytes.insert(at, bytes.substr(below(random, bytes.size()), 1 + below(random, 200)));
      break;
    case 5:  // spliced with another one
      bytes = bytes.substr(0, at) + other.substr(below(random, other.size()));
      break;
    case 6:
      replace_word(bytes, random);
      break;
    default:
      replace_number(bytes, random);
  }
}

int run_mutations(long rounds) {
  const std::vector<std::string> seeds = softreel::fuzz::seeds();
  Random random(20081);
  for (const std::string& seed : seeds) {
    run(seed);
    for (long round = 0; round < rounds; ++round) {
      std::string bytes = seed;
      const std::size_t edits = 1 + below(random, 4);
      for (std::size_t e = 0; e < edits && bytes.size() > 1; ++e)
        mutate(bytes, seeds[below(random, seeds.size())], random);
      run(std::move(bytes));
    }
  }
  std::printf("%zu seeds, %ld inputs of each\n", seeds.size(), rounds);
  return 0;
}

int run_files(int count, char** names) {
  for (int i = 0; i < count; ++i) {
    std::ifstream file(names[i], std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "%s: cannot be read\n", names[i]);
      return 2;
    }
    run(std::string(std::istreambuf_iterator<char>(file), {}));
  }
  std::printf("%d files\n", count);
  return 0;
}

}  // namespace

/// All memory of the target comes from here; a sanitizer still sees it through malloc.
void* operator new(std::size_t size) {
  if (size > kBytesPerByte * current.size() + kBytesBeside) {
    std::fprintf(stderr, "%zu bytes asked for an input of %zu\n", size, current.size());
    std::abort();
  }
  if (void* const memory = std::malloc(size); memory != nullptr) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return ::operator new(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

int main(int argc, char** argv) {
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGALRM}) std::signal(signal, keep_input);
  long rounds = 0;
  const std::string first = argc > 1 ? argv[1] : "";
  const auto parsed = std::from_chars(first.data(), first.data() + first.size(), rounds);
  if (argc == 2 && parsed.ec == std::errc() && parsed.ptr == first.data() + first.size()) return run_mutations(rounds);
  if (argc > 1) return run_files(argc - 1, argv + 1);
  std::fprintf(stderr, "accepted: a number of rounds, or files\n");
  return 2;
}
