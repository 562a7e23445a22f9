# How every source of softreel is compiled; linked PRIVATE by every target.
add_library(softreel_warnings INTERFACE)
target_compile_options(softreel_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow)
# g++ 12 warns wrongly about std::string inside of std::optional and of std::string + (its bugs 105562 and 105329).
target_compile_options(softreel_warnings INTERFACE -Wno-maybe-uninitialized -Wno-restrict)
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # CHECK catches its operands by an operator << of higher precedence on purpose; the one function of a part that is
  # loaded when first used has a plain name, but is called from C++ only.
  target_compile_options(softreel_warnings INTERFACE -Wno-unknown-warning-option -Wno-overloaded-shift-op-parentheses
                         -Wno-return-type-c-linkage)
endif()
if(SOFTREEL_WERROR)
  target_compile_options(softreel_warnings INTERFACE -Werror)
endif()

# One baseline for all machines, and no contraction behind our back: equal bits everywhere (design sec. 4.6).
add_library(softreel_numerics INTERFACE)
target_compile_options(softreel_numerics INTERFACE -march=x86-64-v3 -mtune=generic -ffp-contract=off)
if(SOFTREEL_SANITIZE)
  # Left out, for the time to compile: null, vptr and object-size, most of whose findings end under the address sanitizer
  # too. It misses what alignment and pointer-overflow find: these are for core, which takes a sixth more time to compile
  # so; elsewhere they would judge code of others (stb, toml++) as well.
  target_compile_options(softreel_numerics INTERFACE -fsanitize=${SOFTREEL_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=undefined -fno-sanitize=null,vptr,object-size
                         $<$<NOT:$<STREQUAL:$<TARGET_PROPERTY:NAME>,softreel_core>>:-fno-sanitize=alignment,pointer-overflow>)
  target_link_options(softreel_numerics INTERFACE -fsanitize=${SOFTREEL_SANITIZE})
endif()
if(SOFTREEL_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "SOFTREEL_BUILD_FUZZERS is ON but ${CMAKE_CXX_COMPILER_ID} has no libFuzzer. "
                        "Configure with -DCMAKE_CXX_COMPILER=clang++ (packages clang, libclang-rt-14-dev).")
  endif()
  target_compile_options(softreel_numerics INTERFACE -fsanitize=fuzzer-no-link)
endif()
