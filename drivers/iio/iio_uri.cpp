#include "drivers/iio/iio_uri.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

/// libiio asks the server to give up after half of this, so a read comes to nothing in half a
/// second, and a silent network is known after one. A server has one time-out for all its clients:
/// each must ask alike.
constexpr unsigned int kTimeout_ms = 1000;

constexpr const char* kForms =
    "give ip:HOST[:PORT], usb:BUS.ADDRESS.INTERFACE, local: or replay:PATH";

std::string known_schemes() {
  std::string text;
  for (unsigned int i = 0; i < iio_get_backends_count(); ++i) {
    text += std::string(iio_get_backend(i)) + ": ";
  }
  return text + "replay:";
}

void check_port(const std::string& uri, const std::string& port) {
  unsigned int number = 0;
  const char* end = port.data() + port.size();
  const auto parsed = std::from_chars(port.data(), end, number);
  if (parsed.ec != std::errc{} || parsed.ptr != end || number < 1 || number > 65535) {
    throw InputError(uri, "\"" + port + "\" is no TCP port", "give 1 to 65535, or none for 30431");
  }
}

void check_network_address(const std::string& uri, const std::string& address) {
  const auto colons = std::count(address.begin(), address.end(), ':');
  const std::size_t colon = address.find(':');
  const bool has_port = colons == 1;  // more of them: an IPv6 address
  const std::string host = has_port ? address.substr(0, colon) : address;
  if (host.empty()) {
    throw InputError(uri, "names no host", "give ip:HOST[:PORT]");
  }
  if (host.find_first_of(" \t\r\n/") != std::string::npos) {
    throw InputError(uri, "\"" + host + "\" is no host name", "give ip:HOST[:PORT]");
  }
  if (has_port) {
    check_port(uri, address.substr(colon + 1));
  }
}

}  // namespace

void check_uri(const std::string& uri) {
  if (uri.empty()) {
    throw InputError("digitiser uri \"\"", "is empty", kForms);
  }
  const std::size_t colon = uri.find(':');
  if (colon == std::string::npos || colon == 0) {
    throw InputError(uri, "has no scheme", kForms);
  }
  const std::string scheme = uri.substr(0, colon);
  const std::string rest = uri.substr(colon + 1);
  if (!iio_has_backend(scheme.c_str())) {
    throw InputError(uri, "\"" + scheme + ":\" is not known here", "known are " + known_schemes());
  }
  if (scheme == "xml") {
    throw InputError(uri, "is a description of a device, it delivers no samples", kForms);
  }
  if (scheme == "usb" &&
      (rest.empty() || rest.find_first_not_of("0123456789.") != std::string::npos)) {
    throw InputError(uri, "names no USB device",
                     "give usb:BUS.ADDRESS.INTERFACE as iio_info -S usb lists it");
  }
  if (scheme == "ip") {
    check_network_address(uri, rest);
  }
}

ContextHandle open_context(const std::string& uri) {
  std::vector<char> copy(uri.begin(), uri.end());
  copy.push_back('\0');
  const SigpipeBlocked guard;
  errno = 0;
  ContextHandle context(iio_create_context_from_uri(copy.data()));
  if (!context) {
    throw InputError(uri, "no IIO device answers (" + error_text(-errno) + ")",
                     "check that it is on and that iio_info -u shows it");
  }
  const int error = iio_context_set_timeout(context.get(), kTimeout_ms);
  if (error < 0 && error != -ENOSYS) {
    throw InputError(uri, "does not take a time-out (" + error_text(error) + ")",
                     "check the connection with iio_info -u");
  }
  return context;
}

std::string error_text(long negative_errno) {
  char text[128] = "";
  iio_strerror(static_cast<int>(-negative_errno), text, sizeof text);
  return text;
}

}  // namespace kolsky
