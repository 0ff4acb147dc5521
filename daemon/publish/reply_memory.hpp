#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace kolsky {

/// Where a reply goes: the frames that go before it, as they came before the request. The peer's
/// routing id, then what proxies on the way and the peer's own socket put there.
using Route = std::vector<std::string>;

/// What makes two requests the same.
struct RequestKey {
  std::string client_id;
  std::string request_id;
  friend bool operator<(const RequestKey& a, const RequestKey& b) {
    return std::tie(a.client_id, a.request_id) < std::tie(b.client_id, b.request_id);
  }
};

/// The requests under way and the replies given lately, so that none is carried out twice. Requests
/// under way stay; the oldest replies go first when there are too many or too many bytes of them.
class ReplyMemory {
 public:
  struct Entry {
    std::string command;  ///< serialised: the same id with another command is a mistake
    bool finished = false;
    std::string reply;           ///< serialised, once finished
    std::vector<Route> waiting;  ///< the first is who asked first
  };

  ReplyMemory(std::size_t most_replies, std::size_t most_bytes)
      : most_replies_(most_replies), most_bytes_(most_bytes) {}

  /// Null if this request was never seen, or too long ago. Holds until the next `finish`.
  [[nodiscard]] Entry* find(const RequestKey& key);
  /// @pre not there yet
  void begin(const RequestKey& key, std::string command, Route asker);
  /// Remembers the reply. @return who waits for it. @pre begun, not finished
  std::vector<Route> finish(const RequestKey& key, std::string reply);

 private:
  void forget_oldest();

  std::size_t most_replies_;
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::map<RequestKey, Entry> entries_;
  std::deque<RequestKey> finished_;  ///< oldest first
};

}  // namespace kolsky
