# The compiler flags of the SIMD kernels, in ARMWRIGHT_KERNEL_FLAGS_LEVEL for every instruction set LEVEL. The program chooses one of
# the kernels at run time. Their results need not agree to the last bit, so the compiler may fuse multiplications with additions.
set(instructions_scalar "")
set(instructions_sse2 "")
set(instructions_avx2 -mavx2 -mfma)
set(instructions_avx512 -mavx512f -mavx512vl -mavx512dq -mavx512bw -mfma)
foreach(level scalar sse2 avx2 avx512)
  set(flags -ffp-contract=fast)
  # In straight-line code of two thousand instructions the order of the instructions matters. The code runs 1.2 times as fast if
  # GCC schedules it before it assigns registers, and keeps no values for later iterations of the loop. GCC's warnings about
  # uninitialised values are wrong in this code.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    list(APPEND flags -Wno-maybe-uninitialized -fno-tree-pre -fschedule-insns -fsched-pressure)
    # The ideal arm's step just fits into the store of decoded instructions of some processors (AMD Zen 3). Where its loop lies otherwise
    # decides its speed: from 26 to 38 ns per step in one program.
    list(APPEND flags -falign-loops=64)
  endif()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
    list(APPEND flags ${instructions_${level}})
  endif()
  # Other flags, as -O1 and assertions in the preset ci, change which operations the compiler fuses, and so the last bits. Every Release
  # build compiles the kernels with these flags, so CI tests the machine code that is shipped. So do Debug builds, whose tests would
  # otherwise wait for the kernels.
  foreach(flag -O3 -DNDEBUG -U_GLIBCXX_ASSERTIONS)
    list(APPEND flags $<$<CONFIG:Release,Debug>:${flag}>)
  endforeach()
  # With sanitizers a compiler takes more than a minute per file. All levels are the same source, so only one of them has sanitizers,
  # and scripts/sanitize runs the tests with it.
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize=" AND NOT level STREQUAL "sse2")
    list(APPEND flags -fno-sanitize=all)
  endif()
  set(ARMWRIGHT_KERNEL_FLAGS_${level} ${flags})
endforeach()
