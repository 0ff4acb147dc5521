#include "processing/waves/transform.hpp"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>
#include <new>
#include <numbers>
#include <utility>

namespace kolsky {

namespace {

/// FFTW's planner, unlike its execution, must not run in two threads at once.
std::mutex& planner_lock() {
  static std::mutex lock;
  return lock;
}

bool has_small_factors(std::size_t n) {
  for (const std::size_t factor : {2U, 3U, 5U}) {
    while (n % factor == 0) {
      n /= factor;
    }
  }
  return n == 1;
}

struct FftwFree {
  void operator()(void* memory) const { fftw_free(memory); }
};

using TimeArray = std::unique_ptr<double[], FftwFree>;
using FrequencyArray = std::unique_ptr<fftw_complex[], FftwFree>;

/// There and back for one length, on any arrays of FFTW's alignment and in any number of threads.
class Plans {
 public:
  /// @pre the planner's lock is held
  explicit Plans(std::size_t length) {
    const TimeArray time(fftw_alloc_real(length));
    const FrequencyArray frequency(fftw_alloc_complex(length / 2 + 1));
    if (!time || !frequency) {
      throw std::bad_alloc();
    }
    const int n = static_cast<int>(length);
    // FFTW remembers parts of earlier plans, even estimated ones, and would build on them: the same
    // transform would round differently in a program that has planned other lengths before.
    fftw_forget_wisdom();
    to_frequency_ = fftw_plan_dft_r2c_1d(n, time.get(), frequency.get(), FFTW_ESTIMATE);
    to_time_ = fftw_plan_dft_c2r_1d(n, frequency.get(), time.get(), FFTW_ESTIMATE);
  }
  ~Plans() {
    const std::scoped_lock lock(planner_lock());
    fftw_destroy_plan(to_frequency_);
    fftw_destroy_plan(to_time_);
  }
  Plans(const Plans&) = delete;
  Plans& operator=(const Plans&) = delete;

  void to_frequency(double* time, fftw_complex* frequency) const {
    fftw_execute_dft_r2c(to_frequency_, time, frequency);
  }
  void to_time(fftw_complex* frequency, double* time) const {
    fftw_execute_dft_c2r(to_time_, frequency, time);
  }

 private:
  fftw_plan to_frequency_;
  fftw_plan to_time_;
};

/// Planning costs as much as hundreds of transforms, and a plan depends on its length alone: those
/// of the lengths in use are kept, which changes no bit of any result.
std::shared_ptr<const Plans> plans_of(std::size_t length) {
  constexpr std::size_t kMostLengths = 32;
  std::map<std::size_t, std::shared_ptr<const Plans>> old;  // goes after the lock
  const std::scoped_lock lock(planner_lock());
  static std::map<std::size_t, std::shared_ptr<const Plans>> known;
  const auto found = known.find(length);
  if (found != known.end()) {
    return found->second;
  }
  if (known.size() >= kMostLengths) {
    old.swap(known);
  }
  return known.emplace(length, std::make_shared<Plans>(length)).first->second;
}

}  // namespace

std::size_t good_transform_length(std::size_t samples) {
  std::size_t n = std::max<std::size_t>(samples, 16);
  n += n % 2;
  while (!has_small_factors(n)) {
    n += 2;
  }
  return n;
}

std::size_t quick_transform_length(std::size_t samples) {
  const std::size_t least = good_transform_length(samples);
  std::size_t best = least;
  const auto twos = [](std::size_t n) { return std::countr_zero(n); };
  for (std::size_t n = least; 10 * n <= 11 * samples; n += 2) {
    if (twos(n) > twos(best) && has_small_factors(n)) {
      best = n;
    }
  }
  return best;
}

struct DampedTransform::State {
  std::size_t length;
  double bin_width_Hz;
  double eta_per_s;
  TimeArray time;
  FrequencyArray frequency;
  std::shared_ptr<const Plans> plans;
  std::vector<double> damping;    // exp(-eta t)
  std::vector<double> undamping;  // exp(+eta t) / length

  State(std::size_t samples, double period_s, double wrap_damping)
      : length(samples),
        bin_width_Hz(1.0 / (static_cast<double>(length) * period_s)),
        eta_per_s(-std::log(wrap_damping) * bin_width_Hz),
        time(fftw_alloc_real(length)),
        frequency(fftw_alloc_complex(length / 2 + 1)),
        plans(plans_of(length)),
        damping(length, 1.0),
        undamping(length, 1.0 / static_cast<double>(length)) {
    if (!time || !frequency) {
      throw std::bad_alloc();
    }
    if (eta_per_s > 0.0) {
      damp(eta_per_s * period_s);
    }
  }

  void damp(double eta_per_sample) {
    constexpr std::size_t kBlock = 64;
    const auto after = [&](std::size_t n) {
      return std::exp(-eta_per_sample * static_cast<double>(n));
    };
    std::array<double, kBlock> within;
    for (std::size_t n = 0; n < kBlock; ++n) {
      within[n] = after(n);
    }
    for (std::size_t first = 0; first < length; first += kBlock) {
      const double before = after(first);
      for (std::size_t n = first; n < std::min(first + kBlock, length); ++n) {
        damping[n] = before * within[n - first];
        undamping[n] = 1.0 / (damping[n] * static_cast<double>(length));
      }
    }
  }
};

DampedTransform::DampedTransform(std::size_t samples, double period_s, double wrap_damping)
    : state_(std::make_unique<State>(good_transform_length(samples), period_s, wrap_damping)) {}
DampedTransform::DampedTransform(std::unique_ptr<State> state) : state_(std::move(state)) {}

DampedTransform DampedTransform::of_window(std::size_t samples, double period_s) {
  return DampedTransform(std::make_unique<State>(samples, period_s, 1.0));
}

DampedTransform::~DampedTransform() = default;
DampedTransform::DampedTransform(DampedTransform&&) noexcept = default;
DampedTransform& DampedTransform::operator=(DampedTransform&&) noexcept = default;

std::size_t DampedTransform::length() const {
  return state_->length;
}

std::size_t DampedTransform::bins() const {
  return state_->length / 2 + 1;
}

double DampedTransform::bin_width_Hz() const {
  return state_->bin_width_Hz;
}

Complex DampedTransform::s(std::size_t bin) const {
  return {state_->eta_per_s,
          2.0 * std::numbers::pi * state_->bin_width_Hz * static_cast<double>(bin)};
}

void DampedTransform::forward(std::span<const double> record, std::span<Complex> spectrum) {
  double* time = state_->time.get();
  const double* damping = state_->damping.data();
  for (std::size_t n = 0; n < record.size(); ++n) {
    time[n] = record[n] * damping[n];
  }
  std::fill(time + record.size(), time + state_->length, 0.0);
  state_->plans->to_frequency(time, state_->frequency.get());
  // FFTW's complex numbers are laid out as those of the standard library.
  const auto* frequency = reinterpret_cast<const Complex*>(state_->frequency.get());
  std::copy_n(frequency, spectrum.size(), spectrum.begin());
}

void DampedTransform::inverse(std::span<const Complex> spectrum, std::span<double> record,
                              std::size_t first) {
  auto* frequency = reinterpret_cast<Complex*>(state_->frequency.get());
  std::copy(spectrum.begin(), spectrum.end(), frequency);
  std::fill(frequency + spectrum.size(), frequency + bins(), 0.0);
  state_->plans->to_time(state_->frequency.get(), state_->time.get());
  const double* time = state_->time.get() + first;
  const double* undamping = state_->undamping.data() + first;
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] = time[n] * undamping[n];
  }
}

}  // namespace kolsky
