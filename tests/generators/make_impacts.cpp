// Writes a campaign of impacts with a hidden effect: bench file and captures in one folder.
#include <CLI/CLI.hpp>
#include <iostream>

#include "processing/base/error.hpp"
#include "tests/generators/campaign_files.hpp"
#include "tests/generators/impact_campaign.hpp"

int main(int argc, char** argv) {
  using namespace kolsky::testing;
  ImpactWishes wishes;
  std::string out = "impacts";
  CLI::App app("Writes impacts of a golf ball on a bar, made by a solver of its own.");
  app.add_option("--out", out, "folder");
  app.add_option("--seed", wishes.seed);
  app.add_option("--speeds", wishes.speeds_m_per_s, "m/s");
  app.add_option("--shots", wishes.shots, "at each speed");
  app.add_option("--noise", wishes.noise_strain, "rms strain");
  app.add_option("--speed-error", wishes.speed_error, "relative deviation of the speeds filed");
  app.add_option("--core-nonlinearity", wishes.core_b, "b");
  app.add_option("--core-damage", wishes.core_damage,
                 "d, softening by the largest strain so far, which no effect of the library is");
  app.add_option("--cover-nonlinearity", wishes.cover_b, "b");
  app.add_option("--core-relaxation", wishes.core_D_per_Pa, "D, 1/Pa");
  app.add_option("--core-relaxation-time", wishes.core_tau_s, "s");
  app.add_option("--cover-relaxation", wishes.cover_D_per_Pa, "D, 1/Pa");
  app.add_option("--cover-relaxation-time", wishes.cover_tau_s, "s");
  app.add_option("--offset", wishes.offset_m, "m, of the ball's axis from the bar's");
  app.add_option("--bending", wishes.bending_m, "m, eccentricity of the push times imbalance");
  app.add_option("--moduli", wishes.moduli, "E1 E2 eta2 of core and cover over the paper's");
  app.add_option("--rebound-error", wishes.rebound_error,
                 "relative deviation of the rebound speeds filed");
  app.add_option("--bridge-nonlinearity", wishes.bridge_b, "b");
  app.add_option("--gauge-factor", wishes.gauge_factor, "kappa");
  app.add_option("--friction", wishes.friction, "mu");
  app.add_option("--core-off", wishes.core_off_m, "m, true diameter less the filed one");
  app.add_option("--ball-off", wishes.ball_off_m, "m, true diameter less the filed one");
  app.add_option("--diameter-sd", wishes.diameter_sd_m, "m, filed beside both diameters");
  app.add_option("--sabot", wishes.sabot_mass_kg, "kg, that follows the ball and pushes it");
  app.add_option("--drift", wishes.drift_per_s, "1/s, of the gauge");
  app.add_option("--hum", wishes.hum_strain, "strain, of 50 Hz, a phase of its own in each shot");
  app.add_option("--across", wishes.across, "cells of the solver's mesh");
  CLI11_PARSE(app, argc, argv);
  try {
    write_campaign({out, false, true, false}, impact_shots(wishes));
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
  return 0;
}
