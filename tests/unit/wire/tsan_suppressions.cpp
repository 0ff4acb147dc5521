// libzmq as distributions build it does not tell the thread sanitizer how its pipes order memory,
// so whatever travels through them looks like a race. What it receives is not even tracked:
// comparing every word of a large message with the reports so far takes minutes.
extern "C" const char* __tsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier)

extern "C" const char* __tsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "race:libzmq.so\ncalled_from_lib:libzmq.so\n";
}
