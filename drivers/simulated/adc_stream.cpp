#include "drivers/simulated/adc_stream.hpp"

#include <algorithm>

#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kRunSamples = 1024;

}  // namespace

AdcStream::AdcStream(SimulatedAdc& adc, std::vector<std::uint32_t> mask, Tick block_samples)
    : adc_(adc),
      asked_(std::move(mask), adc.element_bytes()),
      block_samples_(block_samples),
      buffers_(adc.clock_.next(), adc.buffers_count_),
      codes_(kRunSamples) {}

AdcStream::~AdcStream() {
  const std::lock_guard lock(adc_.mutex_);
  adc_.stream_ = nullptr;
  if (fault_acts_) {
    adc_.fault_gap_from_ = position();
  }
}

Tick AdcStream::position() const noexcept {
  return planned_ && !runs_.empty() ? runs_.back().first : buffers_.block_start();
}

std::chrono::steady_clock::time_point AdcStream::due() {
  const std::lock_guard lock(adc_.mutex_);
  if (!planned_) {
    const auto complete = adc_.clock_.time_of(buffers_.block_start() + block_samples_);
    if (complete > ConverterClock::Clock::now()) {
      return complete;
    }
    plan_block();
  }
  return adc_.clock_.time_of(block_end_);
}

/// Fixes what the block holds: its time has come, so every shot in it has been fired. Samples that
/// the script loses make it end later.
void AdcStream::plan_block() {
  planned_ = true;
  left_ = static_cast<std::size_t>(block_samples_);
  runs_.clear();
  faults_.clear();
  Tick at = buffers_.block_start();
  adc_.skip_faults(at);
  Tick missing = block_samples_;
  while (missing > 0) {
    adc_.fire_due_shots(at + missing);
    const auto due = adc_.faults_.take_before(at + missing);
    if (due && due->fault.kind != FaultKind::lose) {
      apply(*due);
      continue;
    }
    const Tick whole = due ? std::max<Tick>(due->tick - at, 0) : missing;
    if (whole > 0) {
      runs_.push_back({at, whole});
    }
    at += whole;
    missing -= whole;
    if (due) {
      adc_.note_fault(*due);
      adc_.lose(due->fault.samples, true);
      at += due->fault.samples;
      adc_.skip_faults(at);
    }
  }
  block_end_ = at;
  std::reverse(runs_.begin(), runs_.end());
  std::reverse(faults_.begin(), faults_.end());
  adc_.clock_.settle(block_end_);
}

void AdcStream::apply(const FaultQueue::Due& due) {
  adc_.note_fault(due);
  switch (due.fault.kind) {
    case FaultKind::overflow:
      adc_.raise_overflow();
      break;
    case FaultKind::clip:
      std::erase_if(clipped_, [this](const Run& run) {
        return run.first + run.samples <= buffers_.block_start();
      });
      clipped_.push_back({due.tick, due.fault.samples});
      break;
    default:
      faults_.push_back(due.fault);
  }
}

std::optional<Fault> AdcStream::take_fault() {
  if (faults_.empty()) {
    return std::nullopt;
  }
  const Fault fault = faults_.back();
  faults_.pop_back();
  fault_acts_ = fault_acts_ || fault.kind == FaultKind::late_block ||
                fault.kind == FaultKind::timeout || fault.kind == FaultKind::hang ||
                fault.kind == FaultKind::drop;
  return fault;
}

bool AdcStream::add_channel() {
  const std::vector<std::size_t> bytes = adc_.element_bytes();
  for (std::size_t element = 0; element < bytes.size(); ++element) {
    if (!enables(asked_.mask(), element)) {
      std::vector<std::uint32_t> mask = asked_.mask();
      mask[element / 32] |= std::uint32_t{1} << (element % 32);
      extra_.emplace(std::move(mask), bytes);
      return true;
    }
  }
  return false;
}

void AdcStream::read(std::span<std::byte> out) {
  while (!out.empty()) {
    const std::lock_guard lock(adc_.mutex_);
    Run& run = runs_.back();
    const std::size_t samples = std::min(
        {out.size() / layout().bytes(), kRunSamples, static_cast<std::size_t>(run.samples)});
    fill(run.first, out.first(samples * layout().bytes()));
    run.first += static_cast<Tick>(samples);
    run.samples -= static_cast<Tick>(samples);
    left_ -= samples;
    if (run.samples == 0) {
      runs_.pop_back();
    }
    if (runs_.empty()) {
      finish_block();
    }
    out = out.subspan(samples * layout().bytes());
  }
}

void AdcStream::finish_block() {
  planned_ = false;
  const Tick now = std::max(adc_.clock_.now(), block_end_);
  buffers_.finish_block(block_end_, now);
  adc_.lose(buffers_.lost_before(), fault_acts_);
  const bool caught_up = now < buffers_.block_start() + block_samples_;
  if (buffers_.lost_before() == 0 && caught_up) {
    fault_acts_ = false;
  }
}

void AdcStream::fill(Tick first, std::span<std::byte> out) {
  std::fill(out.begin(), out.end(), std::byte{0});  // between elements too
  const std::span<std::int32_t> codes(codes_.data(), out.size() / layout().bytes());
  for (const ScanLayout::Element& element : layout().elements()) {
    if (element.channel == adc_.settings_.channels.size()) {
      layout().place_count(element, first, out);
    } else {
      adc_.source_->convert(element.channel, first, codes);
      clip(first, codes);
      layout().place(element, codes, out);
    }
  }
}

void AdcStream::clip(Tick first, std::span<std::int32_t> codes) const {
  const Tick end = first + static_cast<Tick>(codes.size());
  for (const Run& run : clipped_) {
    const Tick from = std::max(run.first, first);
    const Tick to = std::min(run.first + run.samples, end);
    for (Tick tick = from; tick < to; ++tick) {
      codes[static_cast<std::size_t>(tick - first)] = adc_.highest_code();
    }
  }
}

}  // namespace kolsky
