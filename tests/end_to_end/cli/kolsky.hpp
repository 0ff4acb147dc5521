#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "tests/end_to_end/scene.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky::scene {

/// What the program `kolsky` came to.
struct Answer {
  int code = -1;
  std::string out;
  std::string err;
};

/// Runs the real program with pipes for a terminal. @param environment  as "NAME=value"
[[nodiscard]] Answer kolsky(const std::vector<std::string>& words,
                            const std::vector<std::string>& environment = {});

/// The one JSON object that a command printed; fails the test where there is anything else.
[[nodiscard]] nlohmann::json json_of(const Answer& answer);

/// Exit code 2, nothing on stdout, and one line on stderr that holds all of these.
[[nodiscard]] ::testing::AssertionResult refused(const Answer& answer,
                                                 const std::vector<std::string>& named);

[[nodiscard]] std::vector<std::string> lines_of(const std::string& text);

/// A shot on elastic bars, with what really happened in the specimen, as the files a person has.
class Bench {
 public:
  explicit Bench(const testing::ElasticShpb& model = {});

  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  /// The records as a table, `share` of their size, with Gaussian noise of that rms strain.
  [[nodiscard]] std::string table(double share, double noise_strain, unsigned seed) const;
  /// Imports the table. @return the capture
  [[nodiscard]] std::string capture(const std::string& name = "shot.h5") const;
  [[nodiscard]] const testing::ElasticShpb& model() const { return model_; }
  [[nodiscard]] const testing::ElasticShpb::Records& records() const { return records_; }

 private:
  testing::ScratchFolder folder_;
  testing::ElasticShpb model_;
  testing::ElasticShpb::Records records_;
};

}  // namespace kolsky::scene
