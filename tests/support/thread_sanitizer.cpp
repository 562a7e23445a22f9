/// What the thread sanitizer is not to report: how oneTBB, which is not compiled with it, hands work to its threads. By
/// the path of its headers, as g++ names inlined functions without their namespaces.

extern "C" const char* __tsan_default_suppressions();

extern "C" const char* __tsan_default_suppressions() {
  return "race:/oneapi/tbb/\n";
}
