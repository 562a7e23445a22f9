/// Parts of the program that stand on heavy libraries (Embree, EGL, assimp) and are loaded when first used.
///
/// A part is one fenced source with one entry function of C linkage. With SOFTREEL_LAZY_PARTS it is a module of its
/// own, so that a command which needs no part does not pay for its libraries; without, it is linked like any other
/// source.
#pragma once

namespace softreel {

namespace detail {

/// Loads the module of `part` ("embree") if it is not loaded yet, and finds a function in it. A module stays loaded
/// until the program ends. Thread-safe. Throws work_error if the module or the function cannot be had.
void* part_symbol(const char* part, const char* symbol);

}  // namespace detail

/// The entry function of a part that was built in; `symbol` is its name. Thread-safe.
/// Throws work_error where the part cannot be loaded. Cost: the loading, once; keep the result all the same.
template <auto Function>
decltype(Function) part_function([[maybe_unused]] const char* part, [[maybe_unused]] const char* symbol) {
#if SOFTREEL_LAZY_PARTS
  // Function serves as a type only: naming it would make the linker ask for the part.
  return reinterpret_cast<decltype(Function)>(detail::part_symbol(part, symbol));
#else
  return Function;
#endif
}

}  // namespace softreel
