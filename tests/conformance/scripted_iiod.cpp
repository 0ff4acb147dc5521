#include "tests/conformance/scripted_iiod.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace kolsky {
namespace {

/// libiio's parser grumbles without one.
constexpr const char* kHead =
    R"(<?xml version="1.0" encoding="utf-8"?><!DOCTYPE context [)"
    R"(<!ELEMENT context ANY><!ELEMENT device ANY><!ELEMENT channel ANY>)"
    R"(<!ELEMENT scan-element EMPTY><!ELEMENT attribute EMPTY><!ELEMENT debug-attribute EMPTY>)"
    R"(<!ATTLIST context name CDATA #IMPLIED version-major CDATA #IMPLIED)"
    R"( version-minor CDATA #IMPLIED version-git CDATA #IMPLIED description CDATA #IMPLIED>)"
    R"(<!ATTLIST device id CDATA #REQUIRED name CDATA #IMPLIED>)"
    R"(<!ATTLIST channel id CDATA #REQUIRED type CDATA #REQUIRED>)"
    R"(<!ATTLIST scan-element index CDATA #REQUIRED format CDATA #REQUIRED>)"
    R"(<!ATTLIST attribute name CDATA #REQUIRED><!ATTLIST debug-attribute name CDATA #REQUIRED>]>)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at)) {
    text.replace(at, what.size(), with);
    at += with.size();
  }
  return text;
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

std::string text_reply(const std::string& text) {
  return std::to_string(text.size()) + "\n" + text + "\n";
}

/// Of READ DEV attribute, READ DEV DEBUG attribute, READ DEV INPUT channel attribute; also of
/// WRITE.
std::string attribute_key(const std::vector<std::string>& words) {
  if (words.size() > 4 && words[2] == "INPUT") {
    return words[3] + "/" + words[4];
  }
  return words.size() > 3 && words[2] == "DEBUG" ? "DEBUG/" + words[3] : words.at(2);
}

}  // namespace

ScriptedClient::~ScriptedClient() {
  close(socket_);
}

bool ScriptedClient::read_line(std::string& line) {
  line.clear();
  char c = 0;
  while (recv(socket_, &c, 1, 0) == 1) {
    if (c == '\n') {
      return true;
    }
    if (c != '\r') {
      line += c;
    }
  }
  return false;
}

bool ScriptedClient::read_exactly(std::string& bytes) {
  const auto wanted = static_cast<ssize_t>(bytes.size());
  return recv(socket_, bytes.data(), bytes.size(), MSG_WAITALL) == wanted;
}

bool ScriptedClient::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return false;
    }
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

void ScriptedClient::hang_up() {
  shutdown(socket_, SHUT_RDWR);
}

std::string ScriptedDevice::xml() const {
  std::string text = std::string(kHead) +
                     R"(<context name="network" version-major="0" )"
                     R"(version-minor="24" version-git="v0.24" description="scripted">)"
                     R"(<device id="iio:device0" name="scripted-adc">)";
  int index = 0;
  for (const Channel& channel : channels) {
    text += R"(<channel id=")" + channel.id + R"(" type="input"><scan-element index=")" +
            std::to_string(index++) + R"(" format=")" + replaced(channel.format, ">>", "&gt;&gt;") +
            R"("/>)";
    for (const std::string& name : channel.attributes) {
      text += R"(<attribute name=")" + name + R"("/>)";
    }
    text += "</channel>";
  }
  for (const std::string& name : device_attributes) {
    text += R"(<attribute name=")" + name + R"("/>)";
  }
  for (const std::string& name : debug_attributes) {
    text += R"(<debug-attribute name=")" + name + R"("/>)";
  }
  return text + "</device></context>";
}

ScriptedIiod::ScriptedIiod(ScriptedDevice device, ReadBuffer read_buffer)
    : device_(std::move(device)), read_buffer_(std::move(read_buffer)) {
  listening_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(listening_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      listen(listening_, 16) != 0 ||
      getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("no port for the scripted server");
  }
  port_ = ntohs(address.sin_port);
  acceptor_ = std::thread([this] { accept_clients(); });
}

ScriptedIiod::~ScriptedIiod() {
  stop_ = true;
  shutdown(listening_, SHUT_RDWR);
  acceptor_.join();
  for (ScriptedClient& client : clients_) {
    client.hang_up();
  }
  for (std::thread& thread : threads_) {
    thread.join();
  }
  close(listening_);
}

std::vector<std::string> ScriptedIiod::lines() const {
  const std::lock_guard lock(mutex_);
  return lines_;
}

void ScriptedIiod::pause(std::chrono::milliseconds time) const {
  const auto end = std::chrono::steady_clock::now() + time;
  while (!stop_ && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void ScriptedIiod::accept_clients() {
  while (!stop_) {
    const int socket = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) {
      continue;
    }
    const int on = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ScriptedClient& client = clients_.emplace_back(socket);
    threads_.emplace_back([this, &client] { serve(client); });
  }
}

void ScriptedIiod::serve(ScriptedClient& client) {
  std::string line;
  while (client.read_line(line)) {
    const std::vector<std::string> words = words_of(line);
    if (words.empty()) {
      continue;
    }
    {
      const std::lock_guard lock(mutex_);
      lines_.push_back(line);
    }
    if (!answer(client, words)) {
      client.hang_up();
      return;
    }
  }
}

bool ScriptedIiod::describe(ScriptedClient& client) const {
  const std::string reply = text_reply(device_.xml());
  if (device_.trickle.count() == 0) {
    return client.send(reply);
  }
  for (const char c : reply) {
    if (stop_ || !client.send({&c, 1})) {
      return false;
    }
    pause(device_.trickle);
  }
  return true;
}

bool ScriptedIiod::answer(ScriptedClient& client, const std::vector<std::string>& words) {
  const std::string& verb = words.front();
  if (verb == "PRINT") {
    return describe(client);
  }
  if (verb == "READ") {
    if (words.at(2) == "DEBUG" && polls_++ == device_.breaks_on_poll) {
      return false;
    }
    return client.send(read_attribute(words));
  }
  if (verb == "WRITE") {
    std::string value(std::stoul(words.back()), '\0');
    if (!client.read_exactly(value)) {
      return false;
    }
    write_attribute(words, value);
    return client.send(device_.writable ? words.back() + "\n" : "-1\n");
  }
  if (verb == "READBUF") {
    int call = 0;
    {
      const std::lock_guard lock(mutex_);
      call = calls_++;
    }
    read_buffer_(client, std::stoul(words.at(2)), call);
    return true;
  }
  if (verb == "EXIT") {
    return false;
  }
  const bool known = verb == "TIMEOUT" || verb == "OPEN" || verb == "CLOSE" || verb == "SET";
  return client.send(known ? "0\n" : "-22\n");
}

std::string ScriptedIiod::read_attribute(const std::vector<std::string>& words) {
  const std::lock_guard lock(mutex_);
  const auto found = device_.texts.find(attribute_key(words));
  return found == device_.texts.end() ? "-2\n" : text_reply(found->second);
}

void ScriptedIiod::write_attribute(const std::vector<std::string>& words,
                                   const std::string& value) {
  const std::lock_guard lock(mutex_);
  if (device_.writable && device_.sticks) {
    device_.texts[attribute_key(words)] = value.substr(0, value.find('\0'));
  }
}

std::string first_chunk(std::uint32_t mask, std::string_view bytes) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "%08x", mask);
  return std::to_string(bytes.size()) + "\n" + digits + "\n" + std::string(bytes);
}

}  // namespace kolsky
