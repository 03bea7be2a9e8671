// LeakSanitizer reads this if the tests are built with it. A step that ODE stops with a failed
// assertion leaks the job that it was running, 80 bytes. The tests of divergence cause that on
// purpose.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:PreallocateJobInfos";
}
