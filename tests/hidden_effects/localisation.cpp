#include "tests/hidden_effects/localisation.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>

namespace kolsky::scoring {

namespace {

using Json = nlohmann::json;

// What `compare` lets be false of what it marks.
constexpr double kFalseDiscovery = 0.005;

double chance_of_marking(const PlaceTruth& truth) {
  if (truth.freedom <= 0.0 || (truth.trace && truth.excess > 0.0)) {
    return 0.0;
  }
  using namespace boost::math;
  const double limit = quantile(complement(chi_squared(truth.freedom), kFalseDiscovery));
  return truth.excess > 0.0
             ? cdf(complement(non_central_chi_squared(truth.freedom, truth.excess), limit))
             : kFalseDiscovery;
}

std::size_t shot_number(const Json& compared, const std::string& id) {
  const Json& shots = compared.at("places").at("shots");
  return static_cast<std::size_t>(std::ranges::find(shots, Json(id)) - shots.begin());
}

double ratio(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 1.0;
}

}  // namespace

Hits& Hits::operator+=(const Hits& other) {
  failing += other.failing;
  marked += other.marked;
  both += other.both;
  return *this;
}

double Hits::precision() const {
  return ratio(both, marked);
}

double Hits::recall() const {
  return ratio(both, failing);
}

double Hits::f1() const {
  return ratio(2 * both, failing + marked);
}

Localisation& Localisation::operator+=(const Localisation& other) {
  all += other.all;
  touched += other.touched;
  ideal_marked += other.ideal_marked;
  ideal_both += other.ideal_both;
  return *this;
}

double Localisation::ideal_f1() const {
  const double sum = static_cast<double>(all.failing) + ideal_marked;
  return sum > 0.0 ? 2.0 * ideal_both / sum : 1.0;
}

Json json_of(const Localisation& places) {
  const auto described = [](const Hits& hits) {
    return Json{{"failing", hits.failing},       {"marked", hits.marked},   {"both", hits.both},
                {"precision", hits.precision()}, {"recall", hits.recall()}, {"f1", hits.f1()}};
  };
  Json json = described(places.all);
  json["of_gauges_touched"] = described(places.touched);
  json["ideal"] = {
      {"marked", places.ideal_marked}, {"both", places.ideal_both}, {"f1", places.ideal_f1()}};
  return json;
}

Places places_of(const Json& compared) {
  Places places;
  const Json& said = compared.at("places");
  for (const Json& band : said.at("bands_Hz")) {
    places.bands_Hz.emplace_back(band.at(0).get<double>(), band.at(1).get<double>());
  }
  for (const Json& one : said.at("windows")) {
    const std::string window = one.at("window").get<std::string>();
    places.stretches.push_back({one.at("gauge").get<std::string>(), window,
                                shot_number(compared, one.at("shot").get<std::string>()),
                                one.at("start_s").get<double>(), one.at("end_s").get<double>(),
                                one.at("fade_in_s").get<double>(),
                                one.at("fade_out_s").get<double>(), window == "before the pulse"});
  }
  return places;
}

std::set<Place> marked_by(const Json& compared) {
  const Json& bands = compared.at("places").at("bands_Hz");
  std::set<Place> marked;
  for (const Json& tile : compared.at("where")) {
    if (tile.at("significant").get<bool>()) {
      const auto band = std::ranges::find(bands, tile.at("band_Hz")) - bands.begin();
      marked.emplace(tile.at("gauge").get<std::string>(), tile.at("window").get<std::string>(),
                     shot_number(compared, tile.at("shot").get<std::string>()),
                     static_cast<std::size_t>(band));
    }
  }
  return marked;
}

Localisation localisation(const std::vector<PlaceTruth>& truth, const std::set<Place>& marked) {
  Localisation out;
  for (const PlaceTruth& one : truth) {
    const Hits own{one.fails() ? 1U : 0U, marked.contains(one.place) ? 1U : 0U,
                   one.fails() && marked.contains(one.place) ? 1U : 0U};
    out.all += own;
    if (one.touched) {
      out.touched += own;
    }
    const double chance = chance_of_marking(one);
    out.ideal_marked += chance;
    out.ideal_both += one.fails() ? chance : 0.0;
  }
  return out;
}

}  // namespace kolsky::scoring
