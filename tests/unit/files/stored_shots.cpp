#include "tests/unit/files/stored_shots.hpp"

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <span>

#include "drivers/files/settings/bench_file.hpp"

namespace kolsky::testing {

std::string bench_text(std::size_t gauges) {
  std::string text = R"(kind = "bar"
sampling_frequency_Hz = 1.0e6

[bars.input]
length_m = 2.0
diameter_m = 0.020
density_kg_m3 = 1180.0
poisson_ratio = 0.36
)";
  for (std::size_t i = 1; i <= gauges; ++i) {
    text += "\n[[gauges]]\nname = \"g" + std::to_string(i) +
            "\"\nbar = \"input\"\nposition_m = " + std::to_string(0.3 * static_cast<double>(i)) +
            "\nunit = \"strain\"\n";
  }
  return text;
}

namespace {

ChannelRecord make_channel(std::size_t index, const ShotShape& shape, std::mt19937& random) {
  const std::int32_t top = static_cast<std::int32_t>((std::int64_t{1} << (shape.bits - 1)) - 1);
  std::uniform_int_distribution<std::int32_t> code(-top - 1, top);
  ChannelRecord channel;
  channel.gauge = "g" + std::to_string(index + 1);
  channel.unit = "strain";
  channel.scale = 1.0 / (3.0 + static_cast<double>(random() % 1000));
  channel.offset = -0.1 * static_cast<double>(random() % 100);
  channel.bits = shape.bits;
  channel.code_min = -top - 1;
  channel.code_max = top;
  channel.codes.resize(shape.samples);
  for (std::int32_t& value : channel.codes) {
    value = code(random);
  }
  return channel;
}

}  // namespace

Shot make_shot(std::uint32_t seed, const ShotShape& shape) {
  std::mt19937 random(seed);
  Shot shot;
  shot.id = "shot-" + std::to_string(seed);
  shot.bench_toml = bench_text(shape.channels);
  shot.bench = parse_bench(shot.bench_toml, "bench");
  shot.bar_model = paper_pmma();
  shot.bar_model->E1_Pa().sd = 1.0e8 / 3.0;
  shot.rate = {1'000'000, 3};
  shot.first_tick = 1'000'000'000'000 + seed;
  shot.trigger = TriggerEvent{shot.first_tick + 40, 0.1 + 1e-17, 0.03 / 7.0, TriggerKind::forced};
  for (std::size_t i = 0; i < shape.channels; ++i) {
    shot.channels.push_back(make_channel(i, shape, random));
  }
  shot.gaps = {{shot.first_tick + 7, 3, true}, {shot.first_tick + 90, 0, false}};
  shot.meta = {{"specimen", "PA6 #4, \"dry\""}, {"striker_speed_m_per_s", "12.5"}, {"note", ""}};
  shot.utc_ns = 1'709'210'096'123'456'789 + seed;
  shot.monotonic_ns = 98'765'432'101'234 + seed;
  shot.software_version = "0.1.0 (β)";
  return shot;
}

Material two_kelvin_bar() {
  Material bar = paper_pmma();
  bar.solid = SolidKind::two_kelvin;
  bar.parameters = {{5.7e9, 1e6}, {4e10, 1e9 / 3.0}, {1.9e6, 0.0}, {1.6e11, 5e9}, {5e7, 3e6}};
  auto& covariance = bar.covariance.emplace(25, 0.0);
  for (std::size_t i = 0; i < bar.parameters.size(); ++i) {
    covariance[6 * i] = std::pow(bar.parameters[i].sd, 2);
  }
  bar.identified = Material::Identified{15e3, 296.5};
  return bar;
}

Shot asked_shot() {
  Shot shot = make_shot(9);
  shot.reduction = {.dispersion = "exact",
                    .separate = "never",
                    .stress = "one-wave",
                    .inertia = "both",
                    .friction = 0.1 / 3.0,
                    .band_limit_Hz = 2e4 / 7.0,
                    .duration_s = 1e-3 / 3.0,
                    .with_true = true};
  return shot;
}

namespace {

Shot golden_shot() {
  Shot shot;
  shot.id = "golden-1";
  shot.bench_toml = bench_text(2);
  shot.bench = parse_bench(shot.bench_toml, "bench");
  shot.bar_model = three_element_material({1180.0, 0.0}, {0.36, 0.01}, {5.5e9, 1e7}, {37e9, 0.0},
                                          {1.8e6, 0.0}, "β");
  shot.rate = {1'000'000, 1};
  shot.first_tick = 123'456'789'012;
  shot.trigger = TriggerEvent{123'456'789'014, 0.25, 0.05, TriggerKind::marked};
  shot.channels = {
      {"g1", "strain", 1e-7, -0.5, 16, -32768, 32767, {-32768, -1, 0, 1, 32767}},
      {"g2", "strain", 2e-9, 0.0, 24, -8388608, 8388607, {-8388608, 5, 6, 7, 8388607}}};
  shot.gaps = {{123'456'789'013, 1, true}, {123'456'789'016, 0, false}};
  shot.meta = {{"a/b", "slash"}, {"specimen", "PA6"}, {"empty", ""}};
  shot.utc_ns = 1'709'210'096'123'456'789;
  shot.monotonic_ns = 42;
  shot.software_version = "0.1.0";
  return shot;
}

}  // namespace

std::vector<GoldenShot> make_golden_shots() {
  const Shot usual = golden_shot();
  Shot identified = usual;
  identified.id = "golden-2";
  identified.bar_model->covariance = {1e14, -2e14, 3e9, -2e14, 9e16, 1e10, 3e9, 1e10, 4e8};
  identified.bar_model->identified = Material::Identified{15e3, 296.5};
  Shot asked = identified;
  asked.id = "golden-3";
  asked.bar_model->covariance.reset();
  asked.bar_model->identified->temperature_K.reset();
  asked.reduction.dispersion = "exact";
  asked.reduction.stress = "one-wave";
  asked.reduction.friction = 0.1;
  asked.reduction.with_true = true;
  Shot solid = asked;
  solid.id = "golden-4";
  solid.bar_model = two_kelvin_bar();
  return {
      {"shot", 1, usual}, {"identified", 2, identified}, {"asked", 3, asked}, {"solid", 4, solid}};
}

namespace {

void expect_bits(double actual, double expected) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(actual), std::bit_cast<std::uint64_t>(expected));
}

void expect_bits(const Measured& actual, const Measured& expected) {
  expect_bits(actual.value, expected.value);
  expect_bits(actual.sd, expected.sd);
}

}  // namespace

void expect_same(const Shot& actual, const Shot& expected) {
  EXPECT_EQ(actual.id, expected.id);
  EXPECT_EQ(actual.bench_toml, expected.bench_toml);
  EXPECT_EQ(actual.reduction, expected.reduction);
  ASSERT_EQ(actual.bar_model.has_value(), expected.bar_model.has_value());
  if (expected.bar_model) {
    expect_bits(actual.bar_model->density_kg_m3, expected.bar_model->density_kg_m3);
    expect_bits(actual.bar_model->poisson_ratio, expected.bar_model->poisson_ratio);
    EXPECT_EQ(actual.bar_model->solid, expected.bar_model->solid);
    ASSERT_EQ(actual.bar_model->parameters.size(), expected.bar_model->parameters.size());
    for (std::size_t i = 0; i < expected.bar_model->parameters.size(); ++i) {
      expect_bits(actual.bar_model->parameters[i], expected.bar_model->parameters[i]);
    }
    EXPECT_EQ(actual.bar_model->source, expected.bar_model->source);
    EXPECT_EQ(actual.bar_model->covariance, expected.bar_model->covariance);
    EXPECT_EQ(actual.bar_model->identified, expected.bar_model->identified);
  }
  EXPECT_EQ(actual.rate, expected.rate);
  EXPECT_EQ(actual.first_tick, expected.first_tick);
  EXPECT_EQ(actual.trigger, expected.trigger);
  EXPECT_EQ(actual.channels, expected.channels);
  EXPECT_EQ(actual.gaps, expected.gaps);
  EXPECT_EQ(actual.meta, expected.meta);
  EXPECT_EQ(actual.utc_ns, expected.utc_ns);
  EXPECT_EQ(actual.monotonic_ns, expected.monotonic_ns);
  EXPECT_EQ(actual.software_version, expected.software_version);
}

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void write_bytes(const std::filesystem::path& path, const std::vector<std::byte>& bytes) {
  std::filesystem::remove(path);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace kolsky::testing
