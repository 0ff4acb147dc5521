// Drives a libFuzzer target without libFuzzer: runs every seed file, then seeded mutations of them.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kLargestInput = std::size_t{64} << 10U;
constexpr unsigned kSecondsPerInput = 20;

struct Options {
  std::uint64_t iterations = 10'000;
  double seconds = 60.0;
  std::uint64_t seed = 1;
  std::vector<std::string> seeds;
};

// What runs now, for the handler of the signal it may end in.
const std::string* current_input = nullptr;

void save_current_input(int signal_number) {
  constexpr std::string_view kText = "fuzz: the input is saved as fuzz-crash\n";
  const int file = ::open("fuzz-crash", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0 && current_input != nullptr &&
      ::write(file, current_input->data(), current_input->size()) >= 0) {
    (void)!::write(STDERR_FILENO, kText.data(), kText.size());
  }
  if (signal_number == SIGALRM) {
    constexpr std::string_view kSlow = "fuzz: one input took too long\n";
    (void)!::write(STDERR_FILENO, kSlow.data(), kSlow.size());
    ::_exit(1);
  }
  (void)std::signal(signal_number, SIG_DFL);
  (void)std::raise(signal_number);
}

void run_one(const std::string& input) {
  current_input = &input;
  (void)::alarm(kSecondsPerInput);
  // A copy of exactly this size, so that reading past its end is seen.
  const std::vector<std::uint8_t> bytes(input.begin(), input.end());
  (void)LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  (void)::alarm(0);
}

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::string> read_seeds(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::string& path : paths) {
    if (!std::filesystem::is_directory(path)) {
      files.emplace_back(path);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> seeds{""};
  for (const auto& file : files) {
    seeds.push_back(read_all(file));
  }
  return seeds;
}

class Mutator {
 public:
  Mutator(const std::vector<std::string>& seeds, std::uint64_t seed)
      : seeds_(seeds), random_(seed) {}

  std::string next() {
    std::string input = pick(seeds_);
    for (std::size_t i = 1 + below(4); i > 0; --i) {
      mutate(input);
    }
    input.resize(std::min(input.size(), kLargestInput));
    return input;
  }

 private:
  std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

  const std::string& pick(const std::vector<std::string>& from) { return from[below(from.size())]; }

  char any_byte() {
    using std::string_view_literals::operator""sv;
    constexpr std::string_view kTelling = "\"'[]{}=.,;\t\n\r#-+e_0123456789\\\0\x80\xFF()/"sv;
    return below(2) == 0 ? kTelling[below(kTelling.size())] : static_cast<char>(below(256));
  }

  std::string slice_of(const std::string& text) {
    const std::size_t start = below(text.size() + 1);
    return text.substr(start, below(std::min<std::size_t>(64, text.size() - start) + 1));
  }

  void mutate(std::string& input) {
    const std::size_t at = below(input.size() + 1);
    switch (below(6)) {
      case 0:
        input.insert(at, 1, any_byte());
        break;
      case 1:
        input.erase(at, 1 + below(16));
        break;
      case 2:
        if (at < input.size()) {
          input[at] = any_byte();
        }
        break;
      case 3:
        input.insert(at, slice_of(input));
        break;
      case 4:
        input.insert(at, slice_of(pick(seeds_)));
        break;
      default:
        input.insert(at, below(200), any_byte());
        break;
    }
  }

  const std::vector<std::string>& seeds_;
  std::mt19937_64 random_;
};

template <typename Number>
bool take_number(std::string_view text, std::string_view option, Number& number) {
  if (!text.starts_with(option)) {
    return false;
  }
  const std::string_view digits = text.substr(option.size());
  return std::from_chars(digits.data(), digits.data() + digits.size(), number).ec == std::errc();
}

Options parse_options(int count, char** values) {
  Options options;
  for (int i = 1; i < count; ++i) {
    const std::string_view text = values[i];
    if (!take_number(text, "--iterations=", options.iterations) &&
        !take_number(text, "--seconds=", options.seconds) &&
        !take_number(text, "--seed=", options.seed)) {
      options.seeds.emplace_back(text);
    }
  }
  return options;
}

}  // namespace

int main(int count, char** values) {
  for (const int signal_number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGALRM}) {
    (void)std::signal(signal_number, save_current_input);
  }
  const Options options = parse_options(count, values);
  const std::vector<std::string> seeds = read_seeds(options.seeds);
  for (const std::string& seed : seeds) {
    run_one(seed);
  }
  Mutator mutator(seeds, options.seed);
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t done = 0;
  std::chrono::duration<double> took{0.0};
  while (done < options.iterations && took.count() < options.seconds) {
    run_one(mutator.next());
    ++done;
    took = std::chrono::steady_clock::now() - start;
  }
  (void)std::printf("%zu seeds, %llu mutations in %.1f s, seed %llu\n", seeds.size() - 1,
                    static_cast<unsigned long long>(done), took.count(),
                    static_cast<unsigned long long>(options.seed));
  return 0;
}
