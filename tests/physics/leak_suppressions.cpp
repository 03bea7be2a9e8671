// Read by LeakSanitizer where the tests are built with it. A step that ODE stops with a failed
// assertion forgets the job it was running, 80 bytes; the tests of divergence do that on purpose.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:PreallocateJobInfos";
}
