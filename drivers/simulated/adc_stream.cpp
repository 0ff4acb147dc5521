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
      read_until_(buffers_.block_start()),
      codes_(kRunSamples) {}

AdcStream::~AdcStream() {
  const std::lock_guard lock(adc_.mutex_);
  adc_.stream_ = nullptr;
  if (fault_acts_) {
    adc_.fault_gap_from_ = read_until_;
  }
}

std::chrono::steady_clock::time_point AdcStream::due(std::chrono::steady_clock::time_point now) {
  const std::lock_guard lock(adc_.mutex_);
  if (!planned_) {
    const auto complete = adc_.clock_.time_of(buffers_.block_start() + block_samples_);
    if (complete > now) {
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
  Run run;
  (fault_acts_ ? run.injected_before : run.overrun_before) = buffers_.lost_before();
  Tick missing = block_samples_;
  while (missing > 0) {
    adc_.fire_due_shots(at + missing);
    auto due = adc_.faults_.take_before(at + missing);
    if (due) {
      due->tick = std::max(due->tick, at);  // its own sample may have been lost
      adc_.note_fault(*due);
    }
    if (due && due->fault.kind != FaultKind::lose) {
      apply(*due);
      continue;
    }
    run.first = at;
    run.samples = due ? due->tick - at : missing;
    if (run.samples > 0) {
      runs_.push_back(run);
      at += run.samples;
      missing -= run.samples;
      run = {};
    }
    if (due) {
      adc_.raise_overflow();
      run.injected_before += due->fault.samples;
      at += due->fault.samples;
    }
  }
  block_end_ = at;
  std::reverse(runs_.begin(), runs_.end());
  std::reverse(faults_.begin(), faults_.end());
  adc_.clock_.settle(block_end_);
}

void AdcStream::apply(const FaultQueue::Due& due) {
  switch (due.fault.kind) {
    case FaultKind::overflow:
      adc_.raise_overflow();
      break;
    case FaultKind::clip:
      std::erase_if(clipped_, [this](const Run& run) {
        return run.first + run.samples <= buffers_.block_start();
      });
      clipped_.push_back({due.tick, due.fault.samples, 0, 0});
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
    count_losses(run);
    const std::size_t samples = std::min(
        {out.size() / layout().bytes(), kRunSamples, static_cast<std::size_t>(run.samples)});
    fill(run.first, out.first(samples * layout().bytes()));
    run.first += static_cast<Tick>(samples);
    run.samples -= static_cast<Tick>(samples);
    left_ -= samples;
    read_until_ = run.first;
    if (run.samples == 0) {
      runs_.pop_back();
    }
    if (runs_.empty()) {
      finish_block();
    }
    out = out.subspan(samples * layout().bytes());
  }
}

void AdcStream::count_losses(Run& run) {
  adc_.overrun_lost_samples_ += run.overrun_before;
  adc_.injected_lost_samples_ += run.injected_before;
  run.overrun_before = 0;
  run.injected_before = 0;
}

void AdcStream::finish_block() {
  planned_ = false;
  const Tick now = std::max(adc_.clock_.now(), block_end_);
  buffers_.finish_block(block_end_, now);
  if (buffers_.lost_before() > 0) {
    adc_.raise_overflow();
  } else if (now < buffers_.block_start() + block_samples_) {
    fault_acts_ = false;  // the client has caught up
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
