#include "tests/generators/campaign_files.hpp"

#include <fmt/format.h>

#include <fstream>

#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"

namespace kolsky::testing {

namespace {

void put(std::string& text, const std::string& key, const Measured& number) {
  text += fmt::format("{} = {:.12g}\n", key, number.value);
  if (number.sd > 0.0) {
    text += fmt::format("{}_sd = {:.12g}\n", key, number.sd);
  }
}

void put(std::string& text, const std::string& key, const std::optional<Measured>& number) {
  if (number) {
    put(text, key, *number);
  }
}

void put_bar(std::string& text, const std::string& name, const Bar& bar) {
  text += "\n[bars." + name + "]\n";
  put(text, "length_m", bar.length_m);
  put(text, "diameter_m", bar.diameter_m);
  put(text, "density_kg_m3", bar.density_kg_m3);
  put(text, "poisson_ratio", bar.poisson_ratio);
  put(text, "youngs_modulus_Pa", bar.youngs_modulus_Pa);
}

void put_gauge(std::string& text, const Gauge& gauge) {
  text += fmt::format("\n[[gauges]]\nname = \"{}\"\nbar = \"{}\"\n", gauge.name, gauge.bar);
  put(text, "position_m", gauge.position_m);
  text += fmt::format("unit = \"{}\"\n", gauge.unit);
  put(text, "strain_per_V", gauge.strain_per_V);
  put(text, "length_m", gauge.length_m);
}

std::string kind_of(BenchKind kind) {
  return kind == BenchKind::bar ? "bar" : kind == BenchKind::shpb ? "shpb" : "impact";
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out.flush()) {
    throw InputError(path.string(), "cannot be written", "choose another folder");
  }
}

std::string table_of(const Shot& shot, bool time_from_trigger) {
  std::string text = "time_s";
  for (const ChannelRecord& channel : shot.channels) {
    text += "," + channel.gauge;
  }
  text += "\n";
  const double zero = time_from_trigger && shot.trigger
                          ? static_cast<double>(shot.trigger->tick) * shot.rate.period_s()
                          : 0.0;
  for (std::size_t n = 0; n < shot.samples(); ++n) {
    text += fmt::format("{:.9g}", static_cast<double>(n) * shot.rate.period_s() - zero);
    for (const ChannelRecord& channel : shot.channels) {
      text += fmt::format(",{:.9g}", channel.value(channel.codes[n]));
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::string bench_text(const Bench& bench) {
  std::string text = fmt::format("kind = \"{}\"\nsampling_frequency_Hz = {:.12g}\n",
                                 kind_of(bench.kind), bench.sampling_frequency_Hz.value);
  text += fmt::format("positive = \"{}\"\n",
                      bench.positive == PositiveSense::compression ? "compression" : "tension");
  put(text, "temperature_K", bench.temperature_K);
  put_bar(text, "input", bench.input);
  if (bench.output) {
    put_bar(text, "output", *bench.output);
  }
  for (const Gauge& gauge : bench.gauges) {
    put_gauge(text, gauge);
  }
  if (bench.specimen) {
    text += "\n[specimen]\n";
    put(text, "length_m", bench.specimen->length_m);
    put(text, "diameter_m", bench.specimen->diameter_m);
    put(text, "density_kg_m3", bench.specimen->density_kg_m3);
    put(text, "poisson_ratio", bench.specimen->poisson_ratio);
  }
  if (bench.ball) {
    text += "\n[ball]\n";
    put(text, "outer_diameter_m", bench.ball->outer_diameter_m);
    put(text, "core_diameter_m", bench.ball->core_diameter_m);
    put(text, "mass_kg", bench.ball->mass_kg);
  }
  return text;
}

void write_bars(const CampaignFolder& to, const Material& bars) {
  std::string text;
  put(text, "density_kg_m3", bars.density_kg_m3);
  put(text, "poisson_ratio", bars.poisson_ratio);
  put(text, "E1_Pa", bars.E1_Pa());
  put(text, "E2_Pa", bars.E2_Pa());
  put(text, "eta2_Pa_s", bars.eta2_Pa_s());
  std::filesystem::create_directories(to.folder);
  write_text(to.folder / "bars.toml", text);
}

std::vector<std::filesystem::path> write_campaign(const CampaignFolder& to,
                                                  std::vector<Shot> shots) {
  std::filesystem::create_directories(to.folder);
  std::vector<std::filesystem::path> files;
  std::string commands = "#!/bin/sh -e\n";
  for (std::size_t i = 0; i < shots.size(); ++i) {
    Shot& shot = shots[i];
    shot.id = fmt::format("shot{:02}", i + 1);
    shot.bench_toml = bench_text(shot.bench);
    if (i == 0) {
      write_text(to.folder / "bench.toml", shot.bench_toml);
    }
    commands +=
        fmt::format("kolsky import csv {}.csv --bench bench.toml -o {}.h5", shot.id, shot.id);
    for (const auto& [key, value] : shot.meta) {
      commands += fmt::format(" --meta {}={}", key, value);
    }
    commands += "\n";
    if (to.tables) {
      write_text(to.folder / (shot.id + ".csv"), table_of(shot, to.time_from_trigger));
    }
    if (to.captures) {
      write_capture(shot, to.folder / (shot.id + ".h5"));
    }
    files.push_back(to.folder / (shot.id + (to.captures ? ".h5" : ".csv")));
  }
  if (to.tables) {
    write_text(to.folder / "import.sh", commands);
  }
  return files;
}

}  // namespace kolsky::testing
