#include "processing/reduction/ball/ball_quality.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/formatted.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

namespace {

constexpr double kSignalToNoiseLimit_dB = 30.0;
constexpr double kSignalToNoiseFloor_dB = 15.0;
constexpr double kNoiseless_dB = 200.0;
constexpr double kOverlapLimit = 1.0;
constexpr double kReturnLimit = 0.01;
constexpr double kAgreementLimit = 0.02;
constexpr double kMomentumLimit = 0.02;
constexpr double kBandLossLimit = 0.01;
constexpr double kDeviations = 3.0;

Check check(const char* name, double value, double limit, const char* unit, Verdict verdict,
            std::string text) {
  return {name, value, limit, unit, verdict, std::move(text)};
}

Verdict pass_if(bool good, Verdict otherwise = Verdict::warn) {
  return good ? Verdict::pass : otherwise;
}

Check signal_to_noise(const BallQualityInputs& in) {
  const double dB = std::min(kNoiseless_dB, 20.0 * std::log10(in.peak_over_noise));
  return check("signal_to_noise", dB, kSignalToNoiseLimit_dB, "dB",
               dB >= kSignalToNoiseLimit_dB   ? Verdict::pass
               : dB >= kSignalToNoiseFloor_dB ? Verdict::warn
                                              : Verdict::fail,
               formatted("peak strain over noise rms: %.1f dB at the quietest gauge", dB));
}

Check window_overlap(const BallQualityInputs& in, const BallImpact& ball) {
  if (!ball.contact_over) {
    return check(
        "window_overlap", kOverlapLimit, kOverlapLimit, "1", Verdict::fail,
        formatted("the ball still pushes when the far end answers, %.0f us after first touch: "
                  "a longer bar or a gauge nearer to the struck end is needed",
                  1e6 * ball.clean_until_s));
  }
  const double share = in.contact_end_s / ball.clean_until_s;
  return check("window_overlap", share, kOverlapLimit, "1", Verdict::pass,
               formatted("the contact is over at %.0f us, the far end answers at %.0f us",
                         1e6 * in.contact_end_s, 1e6 * ball.clean_until_s));
}

Check return_to_zero(const BallQualityInputs& in, const BallImpact& ball) {
  const double share = std::abs(in.after_contact_N) / ball.peak_force_N;
  const bool good =
      share <= kReturnLimit || std::abs(in.after_contact_N) <= kDeviations * in.after_contact_sd_N;
  return check(
      "return_to_zero", share, kReturnLimit, "1", pass_if(good),
      formatted(good ? "after the contact the force is back at %.1f %% of its peak (limit %.0f %%)"
                     : "after the contact %.1f %% of the peak force is left (limit %.0f %%): the "
                       "baseline wanders, or something still pushes",
                100.0 * share, 100.0 * kReturnLimit));
}

Check gauges_agree(const BallImpact& ball) {
  double least = ball.impulse_N_s;
  double most = ball.impulse_N_s;
  for (const ForceStation& station : ball.stations) {
    if (station.weight > 0.0) {
      least = std::min(least, station.impulse_N_s);
      most = std::max(most, station.impulse_N_s);
    }
  }
  const double spread = (most - least) / ball.impulse_N_s;
  return check("gauges_agree", spread, kAgreementLimit, "1", pass_if(spread <= kAgreementLimit),
               formatted("impulses at the gauges differ by %.2f %% (limit %.0f %%): gauge factors",
                         100.0 * spread, 100.0 * kAgreementLimit));
}

Check speeds(const BallQualityInputs& in, const BallImpact& ball) {
  const bool known = ball.incident_speed_m_per_s && ball.rebound_speed_m_per_s;
  std::string text = in.speed_problem;
  if (known) {
    text = formatted("in at %.4g m/s, out at %.4g m/s, by ", ball.incident_speed_m_per_s->value,
                     ball.rebound_speed_m_per_s->value) +
           ball.speed_source;
  }
  const double count =
      (ball.incident_speed_m_per_s ? 1.0 : 0.0) + (ball.rebound_speed_m_per_s ? 1.0 : 0.0);
  return check("speeds", count, 2.0, "speeds", pass_if(known), text);
}

Check restitution(const BallImpact& ball) {
  const Measured& gap = *ball.restitution_difference;
  const bool good = std::abs(gap) <= kDeviations * gap.sd || std::abs(gap) <= kAgreementLimit;
  return check(
      "restitution", std::abs(gap), kAgreementLimit, "1", pass_if(good),
      formatted(good ? "%.4f by speed and %.4f by impulse agree (apart %.4f, sd %.4f)"
                     : "%.4f by speed and %.4f by impulse disagree (apart %.4f, sd %.4f): a gauge "
                       "factor, the mass, a speed or the bar's modulus is off",
                ball.restitution_by_speed->value, ball.restitution_by_impulse->value, gap.value,
                gap.sd));
}

/// A ball that bounces neither stays behind nor leaves faster than it came.
Check restitution_possible(const Measured& value, const char* by) {
  const bool good =
      value.value >= -kDeviations * value.sd && value.value <= 1.0 + kDeviations * value.sd;
  return check("restitution_possible", value.value, 1.0, "1", pass_if(good),
               formatted(good ? "%.4f by %s lies between 0 and 1"
                              : "%.4f by %s is not between 0 and 1: a gauge factor, the mass or a "
                                "speed is off",
                         value.value, by));
}

Check momentum(const BallImpact& ball) {
  const Measured& excess = *ball.momentum_excess;
  const bool good =
      std::abs(excess) <= kMomentumLimit || std::abs(excess) <= kDeviations * excess.sd;
  return check("momentum", std::abs(excess), kMomentumLimit, "1", pass_if(good),
               formatted("the impulse is %+.2f %% (sd %.2f %%) off the ball's change of momentum",
                         100.0 * excess, 100.0 * excess.sd));
}

}  // namespace

void judge(const BallQualityInputs& in, Reduction& reduction) {
  const BallImpact& ball = *reduction.ball;
  std::vector<Check>& checks = reduction.quality.checks;
  reduction.quality.reducible = true;
  checks.push_back(signal_to_noise(in));
  checks.push_back(clipping(in.flat_top));
  checks.push_back(window_overlap(in, ball));
  if (ball.contact_over) {
    checks.push_back(return_to_zero(in, ball));
  }
  const auto used = std::count_if(ball.stations.begin(), ball.stations.end(),
                                  [](const ForceStation& s) { return s.weight > 0.0; });
  if (used > 1) {
    checks.push_back(gauges_agree(ball));
  }
  checks.push_back(
      check("band", in.band_loss, kBandLossLimit, "1", pass_if(in.band_loss <= kBandLossLimit),
            formatted("the low-pass at %.3g kHz takes %.2f %% of the wave's energy (limit %.0f %%)",
                      1e-3 * ball.low_pass_Hz, 100.0 * in.band_loss, 100.0 * kBandLossLimit)));
  checks.push_back(speeds(in, ball));
  if (ball.restitution_difference) {
    checks.push_back(restitution(ball));
  }
  if (ball.restitution_by_impulse) {
    checks.push_back(restitution_possible(*ball.restitution_by_impulse, "impulse"));
  } else if (ball.restitution_by_speed) {
    checks.push_back(restitution_possible(*ball.restitution_by_speed, "speed"));
  }
  if (ball.momentum_excess) {
    checks.push_back(momentum(ball));
  }
}

}  // namespace kolsky
