#include "daemon/publish/reply_memory.hpp"

#include <utility>

namespace kolsky {

ReplyMemory::Entry* ReplyMemory::find(const RequestKey& key) {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second;
}

void ReplyMemory::begin(const RequestKey& key, std::string command, Route asker) {
  Entry& entry = entries_[key];
  entry.command = std::move(command);
  entry.waiting.push_back(std::move(asker));
}

std::vector<Route> ReplyMemory::finish(const RequestKey& key, std::string reply) {
  Entry& entry = entries_.at(key);
  std::vector<Route> waiting = std::exchange(entry.waiting, {});
  bytes_ += reply.size();
  entry.reply = std::move(reply);
  entry.finished = true;
  finished_.push_back(key);
  while (finished_.size() > most_replies_ || bytes_ > most_bytes_) {
    forget_oldest();
  }
  return waiting;
}

void ReplyMemory::forget_oldest() {
  const auto oldest = entries_.find(finished_.front());
  bytes_ -= oldest->second.reply.size();
  entries_.erase(oldest);
  finished_.pop_front();
}

}  // namespace kolsky
