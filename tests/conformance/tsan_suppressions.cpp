// libiio advances a socket by recv(NULL, n, MSG_TRUNC), which writes nowhere; the thread sanitizer
// takes it for a write to one address from many threads.
extern "C" const char* __tsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __tsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "race:libiio.so\n";
}
